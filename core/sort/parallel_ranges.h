#pragma once

#include <winnow/core/execution.h>

#include <algorithm>
#include <cstddef>

namespace winnow {

/// The number of ranges is a multiple of this if there is more than one: 2, 4 or 8 threads get
/// equally many.
inline constexpr std::size_t kRangeShares = 8;

/// Returns the length of the ranges that [0, count) is divided into: at most `longest`, and such
/// that 2, 4 or 8 threads get equally many ranges if there is more than one (rounding may leave
/// fewer ranges if `count` is small). It is a multiple of 64, or `longest`.
[[nodiscard]] constexpr std::size_t even_range_length(std::size_t count,
                                                      std::size_t longest) noexcept {
  constexpr std::size_t kUnit = 64;
  if (count <= longest) return longest;
  const std::size_t ranges =
      (count + kRangeShares * longest - 1) / (kRangeShares * longest) * kRangeShares;
  const std::size_t each = (count + ranges - 1) / ranges;
  return std::min(longest, (each + kUnit - 1) / kUnit * kUnit);
}

/// As above, but ranges may exceed `longest` so that there are at most `most` of them; `most` must
/// be above kRangeShares.
[[nodiscard]] constexpr std::size_t even_range_length(std::size_t count, std::size_t longest,
                                                      std::size_t most) noexcept {
  return even_range_length(count, std::max(longest, count / (most - kRangeShares) + 1));
}

/// Divides [0, count) into ranges of `length`, the last one shorter, and calls body(first, end) for
/// each, in parallel. The ranges do not depend on the number of threads.
template <typename Body>
void for_each_range(const Execution& execution, std::size_t count, std::size_t length,
                    Body&& body) {
  execution.for_each((count + length - 1) / length, [&](std::size_t range) {
    body(range * length, std::min(count, (range + 1) * length));
  });
}

/// Calls `for_each_range` with ranges of the length that `even_range_length` returns.
template <typename Body>
void for_each_even_range(const Execution& execution, std::size_t count, std::size_t longest,
                         Body&& body) {
  for_each_range(execution, count, even_range_length(count, longest), body);
}

}  // namespace winnow
