#pragma once

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
[[nodiscard]] inline ShapeCore core_of(const CapsuleShape& capsule) noexcept {
  const CoreKind kind = capsule.half_length > 0.0 ? CoreKind::segment : CoreKind::point;
  return ShapeCore::of_lengths(kind, {0.0, 0.0, capsule.half_length}, capsule.radius);
}

}  // namespace winnow
