#pragma once

#include "pipeline/kinds/support_extent.h"

namespace winnow {

[[nodiscard]] inline Eigen::Vector3d farthest_of_user_shape(
    const void* shape, const Eigen::Vector3d& direction) noexcept {
  const auto& own = *static_cast<const SupportShape*>(shape);
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  if (own.function == nullptr) return point;
  own.function(own.context, direction.data(), point.data());
  if (!point.allFinite()) return Eigen::Vector3d::Zero();
  const double reach = point.stableNorm();
  return reach <= own.radius ? point : Eigen::Vector3d(point * (own.radius / reach));
}

[[nodiscard]] inline SupportCore support_core(const SupportShape& shape) noexcept {
  return {farthest_of_user_shape, &shape, shape.radius, shape.rounding};
}

template <typename Direction>
[[nodiscard]] SupportExtent extent_of(const SupportShape& shape,
                                      const Direction& direction) noexcept {
  const SupportCore core = support_core(shape);
  const Eigen::Vector3d unit = direction.unit();
  const double length = direction.length();
  return rounded({length * unit.dot(core.farthest(-unit)), length * unit.dot(core.farthest(unit)),
                  length * core.radius},
                 shape.rounding * length);
}
[[nodiscard]] inline double radius_of(const SupportShape& shape) noexcept {
  return shape.radius + shape.rounding;
}
[[nodiscard]] inline double rounding_of(const SupportShape& shape) noexcept {
  return shape.rounding;
}
[[nodiscard]] inline double inner_radius_of(const SupportShape& /*shape*/) noexcept {
  return 0.0;
}
[[nodiscard]] inline double size_of(const SupportShape& shape) noexcept {
  return std::max(shape.radius, shape.rounding);
}
[[nodiscard]] inline ShapeCore core_of(const SupportShape& shape) noexcept {
  return ShapeCore::of_support(ShapeKind::support, support_core(shape));
}

}  // namespace winnow
