#pragma once

// What every public header includes first: the language that winnow is written in, and how its
// names leave a shared library.

// Of cl _MSVC_LANG alone says it, unless it is told otherwise.
#if !(defined(__cplusplus) && __cplusplus >= 202002L) && \
    !(defined(_MSVC_LANG) && _MSVC_LANG >= 202002L)
#error "winnow needs C++20: compile with -std=c++20 or later"
#endif

// Inline functions of the headers round outward and refuse NaN, which compilers leave out if they
// may take numbers for what they are not.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || \
    defined(__ASSOCIATIVE_MATH__) || defined(_M_FP_FAST)
#error "winnow needs strict floating point: compile what includes it without -ffast-math"
#endif

/// Marks what a shared winnow exports. Its users get the definition of WINNOW_SHARED from CMake or
/// pkg-config; with archives it is not defined, and nothing of winnow is exported from what they
/// are linked into. What builds a shared winnow defines WINNOW_EXPORTS, too: Windows tells the two
/// apart.
#ifndef WINNOW_SHARED
#define WINNOW_API
#elif defined(_WIN32) && defined(WINNOW_EXPORTS)
#define WINNOW_API __declspec(dllexport)
#elif defined(_WIN32)
#define WINNOW_API __declspec(dllimport)
#else
#define WINNOW_API __attribute__((visibility("default")))
#endif
