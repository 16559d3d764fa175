#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
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

}  // namespace winnow
