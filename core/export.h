#pragma once

// What every public header includes first: the language that winnow is written in, and how its
// names leave a shared library.

#if !(defined(__cplusplus) && __cplusplus >= 202002L)
#error "winnow needs C++20: compile with -std=c++20 or later"
#endif

// Inline functions of the headers round outward and refuse NaN, which compilers leave out if they
// may take numbers for what they are not.
#if defined(__FAST_MATH__) || __FINITE_MATH_ONLY__ || defined(__ASSOCIATIVE_MATH__)
#error "winnow needs strict floating point: compile what includes it without -ffast-math"
#endif

/// Marks what a shared winnow exports. Its users get the definition of WINNOW_SHARED from CMake or
/// pkg-config; with archives it is not defined, and nothing of winnow is exported from what they
/// are linked into.
#ifdef WINNOW_SHARED
#define WINNOW_API __attribute__((visibility("default")))
#else
#define WINNOW_API
#endif
