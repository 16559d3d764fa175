#pragma once

#include <exception>
#include <new>
#include <utility>

namespace winnow {

/// What `work` answers, or `refused` where it was left by an exception, by which memory resources
/// refuse. Built without exceptions nothing is caught.
template <typename Work, typename Answer = decltype(std::declval<Work&>()())>
[[nodiscard]] Answer guarded(Work&& work, Answer refused) noexcept {
#ifdef __cpp_exceptions
  try {
    return work();
  } catch (...) {
    return refused;
  }
#else
  static_cast<void>(refused);
  return work();
#endif
}

/// Leaves guarded work, because memory was refused. Built without exceptions that ends the program,
/// as it does in every container of the standard library.
[[noreturn]] inline void leave_without_memory() {
#ifdef __cpp_exceptions
  throw std::bad_alloc();
#else
  std::terminate();
#endif
}

}  // namespace winnow
