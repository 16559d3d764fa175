#pragma once

// Features of the platform that some tests need. Without a feature its tests are skipped or left
// out.

#include <gtest/gtest.h>

#include <cstdlib>
#include <mutex>
#include <new>

/// Threads; libc++ defines a macro if it lacks them.
#ifdef _LIBCPP_HAS_NO_THREADS
#define WINNOW_TEST_THREADS 0
#else
#define WINNOW_TEST_THREADS 1
#endif

/// Exceptions that can be caught.
#if defined(__cpp_exceptions) && !defined(__wasm__)
#define WINNOW_TEST_EXCEPTIONS 1
#else
#define WINNOW_TEST_EXCEPTIONS 0
#endif

/// Without exceptions refused memory ends the program.
#define WINNOW_TEST_NEEDS_EXCEPTIONS() \
  if (WINNOW_TEST_EXCEPTIONS == 0) GTEST_SKIP() << "memory is refused by an exception"

namespace winnow::test {

[[noreturn]] inline void refuse_memory() {
#if WINNOW_TEST_EXCEPTIONS
  throw std::bad_alloc();
#else
  std::abort();
#endif
}

}  // namespace winnow::test
