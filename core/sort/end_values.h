#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <span>

namespace winnow {

/// Upper bound of the ranks that `value_near_end` accepts.
inline constexpr std::size_t kMostFromEnd = 64;

/// Returns the value of rank `at`, below kMostFromEnd, in the order of `before`; there must be more
/// than `at` values. Near an end, most values take one comparison, which branch prediction guesses
/// right.
template <typename Before>
[[nodiscard]] float value_near_end(std::span<const float> values, std::size_t at,
                                   Before before) noexcept {
  std::array<float, kMostFromEnd> end;
  std::partial_sort_copy(values.begin(), values.end(), end.begin(), end.begin() + at + 1, before);
  return end[at];
}

/// Range of most of some values: from the 2 % to the 98 % quantile, extended by half its length on
/// either side.
struct RangeOfMost {
  double low;
  double high;

  /// Requires at least one value, and fewer than 50 * kMostFromEnd.
  explicit RangeOfMost(std::span<const float> values) noexcept {
    const std::size_t at = values.size() / 50;
    const double q02 = static_cast<double>(value_near_end(values, at, std::less<>()));
    const double q98 = static_cast<double>(value_near_end(values, at, std::greater<>()));
    const double margin = 0.5 * (q98 - q02);
    low = q02 - margin;
    high = q98 + margin;
  }
};

}  // namespace winnow
