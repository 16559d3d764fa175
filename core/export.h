#pragma once

// Every public header includes this one, directly or through another header. It checks the language
// version and the floating-point mode, and defines how names are exported from a shared library.

// MSVC states the language version in _MSVC_LANG; __cplusplus is outdated without /Zc:__cplusplus.
#if !(defined(__cplusplus) && __cplusplus >= 202002L) && \
    !(defined(_MSVC_LANG) && _MSVC_LANG >= 202002L)
#error "winnow needs C++20: compile with -std=c++20 or later"
#endif

// Inline functions in the headers round outward and reject NaN. With fast-math options compilers
// may remove the rounding and the tests for NaN.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || \
    defined(__ASSOCIATIVE_MATH__) || defined(_M_FP_FAST)
#error "winnow needs strict floating point: compile what includes it without -ffast-math"
#endif

/// Marks the names that a shared winnow exports. CMake and pkg-config define WINNOW_SHARED for
/// users of the shared library. Users of static archives do not define it, and the binary that they
/// link exports nothing of winnow. The build of the shared library also defines WINNOW_EXPORTS,
/// because Windows distinguishes export from import.
#ifndef WINNOW_SHARED
#define WINNOW_API
#elif defined(_WIN32) && defined(WINNOW_EXPORTS)
#define WINNOW_API __declspec(dllexport)
#elif defined(_WIN32)
#define WINNOW_API __declspec(dllimport)
#else
#define WINNOW_API __attribute__((visibility("default")))
#endif
