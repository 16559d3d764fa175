#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace winnow {

/// Largest float that is <= `value`. NaN stays NaN; below the float range gives -infinity.
[[nodiscard]] inline float round_down(double value) noexcept {
  const float nearest = static_cast<float>(value);
  return static_cast<double>(nearest) > value
             ? std::nextafter(nearest, -std::numeric_limits<float>::infinity())
             : nearest;
}

/// Smallest float that is >= `value`. NaN stays NaN; above the float range gives +infinity.
[[nodiscard]] inline float round_up(double value) noexcept {
  const float nearest = static_cast<float>(value);
  return static_cast<double>(nearest) < value
             ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
             : nearest;
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
