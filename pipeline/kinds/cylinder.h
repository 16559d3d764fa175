#pragma once

#include "pipeline/kinds/capsule.h"

namespace winnow {

template <typename Direction>
[[nodiscard]] SupportExtent extent_of(const CylinderShape& cylinder,
                                      const Direction& direction) noexcept {
  return symmetric(cylinder.radius * direction.across() +
                   cylinder.half_length * std::abs(direction.d.z()) +
                   cylinder.rounding * direction.length());
}
[[nodiscard]] inline double radius_of(const CylinderShape& cylinder) noexcept {
  return hypotenuse(cylinder.radius, cylinder.half_length) + cylinder.rounding;
}
[[nodiscard]] inline double rounding_of(const CylinderShape& cylinder) noexcept {
  return cylinder.rounding;
}
[[nodiscard]] inline double inner_radius_of(const CylinderShape& /*cylinder*/) noexcept {
  return 0.0;
}
[[nodiscard]] inline double size_of(const CylinderShape& cylinder) noexcept {
  return std::max({cylinder.radius, cylinder.half_length, cylinder.rounding});
}
[[nodiscard]] inline ShapeCore core_of(const CylinderShape& cylinder) noexcept {
  if (!(cylinder.radius > 0.0)) return segment_core(cylinder.half_length, cylinder.rounding);
  return ShapeCore::of_lengths(ShapeKind::cylinder,
                               {cylinder.radius, cylinder.radius, cylinder.half_length},
                               cylinder.rounding);
}

}  // namespace winnow
