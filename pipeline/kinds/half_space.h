#pragma once

#include "pipeline/kinds/support_extent.h"

namespace winnow {

[[nodiscard]] inline SupportExtent extent_of(const HalfSpaceShape& /*half_space*/,
                                             const AnyDirection& /*direction*/) noexcept {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {-kInfinity, kInfinity, 0.0};
}
/// Finite only if the direction equals the half-space's normal or its opposite bit for bit.
[[nodiscard]] inline SupportExtent extent_of(const HalfSpaceShape& half_space,
                                             const UnitDirection& direction) noexcept {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto n = as_eigen(half_space.normal);
  const bool is_above = direction.d == n;
  const bool is_below = direction.d == -n;
  return {is_below ? -half_space.offset : -kInfinity, is_above ? half_space.offset : kInfinity,
          is_above || is_below ? std::abs(half_space.offset) : 0.0};
}
[[nodiscard]] inline double radius_of(const HalfSpaceShape& /*half_space*/) noexcept {
  return std::numeric_limits<double>::infinity();
}
[[nodiscard]] inline double rounding_of(const HalfSpaceShape& /*half_space*/) noexcept {
  return 0.0;
}
[[nodiscard]] inline double inner_radius_of(const HalfSpaceShape& /*half_space*/) noexcept {
  return 0.0;
}
[[nodiscard]] inline double size_of(const HalfSpaceShape& half_space) noexcept {
  return std::abs(half_space.offset);
}
[[nodiscard]] inline ShapeCore core_of(const HalfSpaceShape& half_space) noexcept {
  ShapeCore core;
  core.kind = ShapeKind::half_space;
  core.largest = size_of(half_space);
  core.half_space = &half_space;
  return core;
}

}  // namespace winnow
