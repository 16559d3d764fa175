#pragma once

#include "pipeline/kinds/sphere.h"
#include "pipeline/kinds/support_extent.h"

namespace winnow {

template <typename Direction>
[[nodiscard]] SupportExtent extent_of(const CapsuleShape& capsule,
                                      const Direction& direction) noexcept {
  return symmetric(capsule.radius * direction.length() +
                   capsule.half_length * std::abs(direction.d.z()));
}
[[nodiscard]] inline double radius_of(const CapsuleShape& capsule) noexcept {
  return capsule.radius + capsule.half_length;
}
[[nodiscard]] inline double rounding_of(const CapsuleShape& capsule) noexcept {
  return capsule.radius;
}
[[nodiscard]] inline double inner_radius_of(const CapsuleShape& capsule) noexcept {
  return capsule.radius;
}
[[nodiscard]] inline double size_of(const CapsuleShape& capsule) noexcept {
  return std::max(capsule.radius, capsule.half_length);
}
inline constexpr CornerTable kSegmentCorners{2, {{0, 0, -1}, {0, 0, 1}}, 1, {{0, 1}}, 0, {}, {},
                                             {}};

[[nodiscard]] inline ShapeCore segment_core(double half_length, double rounding) noexcept {
  return ShapeCore::of_corners(ShapeKind::capsule, kSegmentCorners, {0.0, 0.0, half_length},
                               rounding);
}
[[nodiscard]] inline ShapeCore core_of(const CapsuleShape& capsule) noexcept {
  if (!(capsule.half_length > 0.0)) return core_of(SphereShape{capsule.radius});
  return segment_core(capsule.half_length, capsule.radius);
}

}  // namespace winnow
