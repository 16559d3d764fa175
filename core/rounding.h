#pragma once

#include <winnow/core/export.h>

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace winnow {

/// The float after a finite or -infinite `value`, going up. By its bits: cheaper than
/// std::nextafter.
[[nodiscard]] constexpr float next_up(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  if ((bits & 0x7FFFFFFFU) == 0) return std::numeric_limits<float>::denorm_min();
  return std::bit_cast<float>((bits >> 31U) != 0 ? bits - 1U : bits + 1U);
}

/// Smallest float that is >= `value`. NaN stays NaN; above the float range gives +infinity.
[[nodiscard]] constexpr float round_up(double value) noexcept {
  const float nearest = static_cast<float>(value);
  return static_cast<double>(nearest) < value ? next_up(nearest) : nearest;
}

/// Largest float that is <= `value`. NaN stays NaN; below the float range gives -infinity.
[[nodiscard]] constexpr float round_down(double value) noexcept {
  return -round_up(-value);
}

/// The float nearest to `value`, but at most the largest: what is finite stays so. NaN stays NaN.
[[nodiscard]] constexpr float finite_float(double value) noexcept {
  constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
  return static_cast<float>(std::clamp(value, -kMost, kMost));
}

/// Largest double that is <= the exact a + b, for finite sums. The rounding error of the sum is
/// itself a double and found exactly (Knuth, TAOCP vol. 2, 4.2.2, theorem B).
[[nodiscard]] inline double add_down(double a, double b) noexcept {
  const double sum = a + b;
  const double shadow = sum - a;
  const double error = (a - (sum - shadow)) + (b - shadow);
  return error < 0.0 ? std::nextafter(sum, -std::numeric_limits<double>::infinity()) : sum;
}

/// Smallest double that is >= the exact a + b, for finite sums.
[[nodiscard]] inline double add_up(double a, double b) noexcept {
  return -add_down(-a, -b);
}

/// Component-wise `round_down`.
[[nodiscard]] inline Eigen::Vector3f round_down(const Eigen::Vector3d& v) noexcept {
  return {round_down(v.x()), round_down(v.y()), round_down(v.z())};
}

/// Component-wise `round_up`.
[[nodiscard]] inline Eigen::Vector3f round_up(const Eigen::Vector3d& v) noexcept {
  return {round_up(v.x()), round_up(v.y()), round_up(v.z())};
}

}  // namespace winnow
