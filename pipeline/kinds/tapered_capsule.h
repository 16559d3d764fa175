#pragma once

#include "pipeline/kinds/support_extent.h"

namespace winnow {

// The core is the convex hull of a ball and a point: the ball has the difference of the radii and
// the larger end's centre, the point is the smaller end's centre.
[[nodiscard]] inline Eigen::Vector3d farthest_of_taper(const void* shape,
                                                       const Eigen::Vector3d& direction) noexcept {
  constexpr double kLongest = std::numeric_limits<double>::max();
  const auto& taper = *static_cast<const TaperedCapsuleShape*>(shape);
  const double excess = std::abs(taper.radius[1] - taper.radius[0]);
  const double end = taper.radius[1] > taper.radius[0] ? taper.half_length : -taper.half_length;
  const double ball = end * direction.z() + excess;
  if (-end * direction.z() >= ball) return {0.0, 0.0, -end};
  const Eigen::Vector3d out = excess * direction;
  return {out.x(), out.y(), std::clamp(out.z() + end, -kLongest, kLongest)};
}

/// The rounding is the smaller radius.
[[nodiscard]] inline SupportCore support_core(const TaperedCapsuleShape& taper) noexcept {
  const auto [less, more] = std::minmax(taper.radius[0], taper.radius[1]);
  const double reach =
      std::min(taper.half_length + (more - less), std::numeric_limits<double>::max());
  return {farthest_of_taper, &taper, reach, less};
}

template <typename Direction>
[[nodiscard]] SupportExtent extent_of(const TaperedCapsuleShape& taper,
                                      const Direction& direction) noexcept {
  const double low = taper.half_length * direction.d.z();
  const double first = taper.radius[0] * direction.length();
  const double second = taper.radius[1] * direction.length();
  return {std::min(-low - first, low - second), std::max(first - low, second + low),
          std::abs(low) + std::max(first, second)};
}
[[nodiscard]] inline double radius_of(const TaperedCapsuleShape& taper) noexcept {
  const SupportCore core = support_core(taper);
  return core.radius + core.rounding;
}
[[nodiscard]] inline double rounding_of(const TaperedCapsuleShape& taper) noexcept {
  return std::min(taper.radius[0], taper.radius[1]);
}
[[nodiscard]] inline double inner_radius_of(const TaperedCapsuleShape& taper) noexcept {
  return std::min(taper.radius[0], taper.radius[1]);
}
[[nodiscard]] inline double size_of(const TaperedCapsuleShape& taper) noexcept {
  return std::max({taper.radius[0], taper.radius[1], taper.half_length});
}
[[nodiscard]] inline ShapeCore core_of(const TaperedCapsuleShape& taper) noexcept {
  return ShapeCore::of_support(ShapeKind::tapered_capsule, support_core(taper));
}

}  // namespace winnow
