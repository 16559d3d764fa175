#pragma once

#include "pipeline/kinds/support_extent.h"

namespace winnow {

template <typename Direction>
[[nodiscard]] SupportExtent extent_of(const SphereShape& sphere,
                                      const Direction& direction) noexcept {
  return symmetric(sphere.radius * direction.length());
}
[[nodiscard]] inline double radius_of(const SphereShape& sphere) noexcept {
  return sphere.radius;
}
[[nodiscard]] inline double rounding_of(const SphereShape& sphere) noexcept {
  return sphere.radius;
}
[[nodiscard]] inline double inner_radius_of(const SphereShape& sphere) noexcept {
  return sphere.radius;
}
[[nodiscard]] inline double size_of(const SphereShape& sphere) noexcept {
  return sphere.radius;
}
inline constexpr CornerTable kPointCorners{1, {}, 0, {}, 0, {}, {}, {}};

[[nodiscard]] inline ShapeCore core_of(const SphereShape& sphere) noexcept {
  return ShapeCore::of_corners(ShapeKind::sphere, kPointCorners, Eigen::Vector3d::Zero(),
                               sphere.radius);
}

}  // namespace winnow
