#pragma once

#include <exception>
#include <new>
#include <utility>

namespace winnow {

/// Returns the result of `work`, or `refused` if it throws, which is how memory resources refuse.
/// Without exception support nothing is caught.
template <typename Work, typename Answer = decltype(std::declval<Work&>()())>
[[nodiscard]] Answer catch_bad_alloc(Work&& work, Answer refused) noexcept {
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

/// Throws std::bad_alloc. Without exception support, ends the program, as every container of the
/// standard library does if memory is refused.
[[noreturn]] inline void throw_bad_alloc() {
#ifdef __cpp_exceptions
  throw std::bad_alloc();
#else
  std::terminate();
#endif
}

}  // namespace winnow
