#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <span>

namespace winnow {

/// How far from an end `value_near_end` looks.
inline constexpr std::size_t kMostFromEnd = 64;

/// The value that comes at place `at`, below kMostFromEnd, of all in the order of `before`; there
/// are more of them. So near an end most values need one comparison, which is foreseen.
template <typename Before>
[[nodiscard]] float value_near_end(std::span<const float> values, std::size_t at,
                                   Before before) noexcept {
  std::array<float, kMostFromEnd> end;
  std::partial_sort_copy(values.begin(), values.end(), end.begin(), end.begin() + at + 1, before);
  return end[at];
}

/// From where to where most of some values lie: the middle 96 % of them, and half as much again on
/// either side.
struct RangeOfMost {
  double low;
  double high;

  /// Of one value or more, fewer than fifty times kMostFromEnd.
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
