#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <span>

namespace winnow {

/// `value_of_rank` accepts ranks below this.
inline constexpr std::size_t kMaxRank = 64;

/// Returns the value that would be at index `at` if the values were sorted by `before`. Requires
/// `at` < kMaxRank and more than `at` values. If `at` is small, most values take one comparison,
/// and its branch is predictable.
template <typename Before>
[[nodiscard]] float value_of_rank(std::span<const float> values, std::size_t at,
                                  Before before) noexcept {
  std::array<float, kMaxRank> end;
  std::partial_sort_copy(values.begin(), values.end(), end.begin(), end.begin() + at + 1, before);
  return end[at];
}

/// Returns the upper median of the first `count` values; `count` is not 0.
template <typename T, std::size_t Room>
[[nodiscard]] T median_of(std::array<T, Room> values, std::size_t count) noexcept {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

/// A range that contains most of a set of values: from their 2 % to their 98 % quantile, extended
/// by half of its length on either side.
struct InterquantileRange {
  double low;
  double high;

  /// Requires at least one value, and fewer than 50 * kMaxRank.
  explicit InterquantileRange(std::span<const float> values) noexcept {
    const std::size_t at = values.size() / 50;
    const double q02 = static_cast<double>(value_of_rank(values, at, std::less<>()));
    const double q98 = static_cast<double>(value_of_rank(values, at, std::greater<>()));
    const double margin = 0.5 * (q98 - q02);
    low = q02 - margin;
    high = q98 + margin;
  }
};

}  // namespace winnow
