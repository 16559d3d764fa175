#pragma once

#include <winnow/core/export.h>
#include <winnow/core/vec3.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace winnow {

/// The float after a finite or -infinite `value`, going up. By its bits: cheaper than
/// std::nextafter.
[[nodiscard]] constexpr float next_up(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  // One more in its bits, or one less of a negative one; 0 of either sign comes before the
  // smallest.
  const std::uint32_t next = bits + 1U - 2U * (bits >> 31U);
  return std::bit_cast<float>((bits & 0x7FFFFFFFU) == 0 ? 1U : next);
}

/// Smallest float that is >= `value`. NaN stays NaN; above the float range gives +infinity.
[[nodiscard]] constexpr float round_up(double value) noexcept {
  const float nearest = static_cast<float>(value);
  // Of a mask: which of the two it is cannot be foreseen, and a branch would cost more.
  const std::uint32_t up = static_cast<double>(nearest) < value ? ~0U : 0U;
  const auto bits = std::bit_cast<std::uint32_t>(nearest);
  const auto above = std::bit_cast<std::uint32_t>(next_up(nearest));
  return std::bit_cast<float>(bits ^ ((bits ^ above) & up));
}

/// Largest float that is <= `value`. NaN stays NaN; below the float range gives -infinity.
[[nodiscard]] constexpr float round_down(double value) noexcept {
  return -round_up(-value);
}

/// The float nearest to `value`, but at most the largest: what is finite stays so. NaN stays NaN.
[[nodiscard]] constexpr float finite_float(double value) noexcept {
  constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
  return static_cast<float>(value < -kMost ? -kMost : (kMost < value ? kMost : value));
}

/// Largest double that is <= the exact a + b, for finite sums. The rounding error of the sum is
/// itself a double and found exactly (Knuth, TAOCP vol. 2, 4.2.2, theorem B).
[[nodiscard]] inline double add_down(double a, double b) noexcept {
  const double sum = a + b;
  const double shadow = sum - a;
  const double error = (a - (sum - shadow)) + (b - shadow);
  // One less in its bits, or one more of a negative sum; without a branch, as above. A sum of 0 has
  // no error.
  const std::int64_t below = error < 0.0 ? 1 : 0;
  const auto bits = std::bit_cast<std::int64_t>(sum);
  return std::bit_cast<double>(bits - below * (2 * (bits >> 63) + 1));
}

/// Smallest double that is >= the exact a + b, for finite sums.
[[nodiscard]] inline double add_up(double a, double b) noexcept {
  return -add_down(-a, -b);
}

/// Component-wise `round_down`.
[[nodiscard]] inline Vec3f round_down(const Vec3d& v) noexcept {
  return {round_down(v.x()), round_down(v.y()), round_down(v.z())};
}

/// Component-wise `round_up`.
[[nodiscard]] inline Vec3f round_up(const Vec3d& v) noexcept {
  return {round_up(v.x()), round_up(v.y()), round_up(v.z())};
}

}  // namespace winnow
