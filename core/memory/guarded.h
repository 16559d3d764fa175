#pragma once

#include <exception>
#include <new>
#include <utility>

namespace winnow {

/// Returns the result of `work`, or `refused` if it throws, which is how memory resources refuse.
/// Without exception support nothing is caught.
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

/// Throws out of guarded work because memory was refused. Without exception support this ends the
/// program, as in every container of the standard library.
[[noreturn]] inline void leave_without_memory() {
#ifdef __cpp_exceptions
  throw std::bad_alloc();
#else
  std::terminate();
#endif
}

}  // namespace winnow
