#pragma once

// What the platform has that some tests need. Where it lacks that, they are skipped or left out.

#include <gtest/gtest.h>

#include <cstdlib>
#include <mutex>
#include <new>

/// Threads; libc++ says in <mutex> where it has none.
#ifdef _LIBCPP_HAS_NO_THREADS
#define WINNOW_TEST_THREADS 0
#else
#define WINNOW_TEST_THREADS 1
#endif

/// Exceptions that are caught.
#if defined(__cpp_exceptions) && !defined(__wasm__)
#define WINNOW_TEST_EXCEPTIONS 1
#else
#define WINNOW_TEST_EXCEPTIONS 0
#endif

/// Where nothing is caught memory that is refused ends the program.
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
