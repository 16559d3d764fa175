#pragma once

#include "pipeline/kinds/capsule.h"

namespace winnow {

template <typename Direction>
[[nodiscard]] SupportExtent extent_of(const ConeShape& cone, const Direction& direction) noexcept {
  // The extents of the disc and of the apex.
  const double side = cone.radius * direction.across();
  const double tip = cone.half_length * direction.d.z();
  const SupportExtent core{std::min(tip, -side - tip), std::max(tip, side - tip),
                           side + std::abs(tip)};
  return rounded(core, cone.rounding * direction.length());
}
[[nodiscard]] inline double radius_of(const ConeShape& cone) noexcept {
  return hypotenuse(cone.radius, cone.half_length) + cone.rounding;
}
[[nodiscard]] inline double rounding_of(const ConeShape& cone) noexcept {
  return cone.rounding;
}
[[nodiscard]] inline double inner_radius_of(const ConeShape& /*cone*/) noexcept {
  return 0.0;
}
[[nodiscard]] inline double size_of(const ConeShape& cone) noexcept {
  return std::max({cone.radius, cone.half_length, cone.rounding});
}
[[nodiscard]] inline ShapeCore core_of(const ConeShape& cone) noexcept {
  if (!(cone.radius > 0.0)) return segment_core(cone.half_length, cone.rounding);
  return ShapeCore::of_lengths(ShapeKind::cone, {cone.radius, cone.radius, cone.half_length},
                               cone.rounding);
}

}  // namespace winnow
