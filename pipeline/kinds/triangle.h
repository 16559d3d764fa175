#pragma once

#include "pipeline/kinds/support_extent.h"

namespace winnow {

template <typename Direction>
[[nodiscard]] SupportExtent extent_of(const TriangleShape& triangle,
                                      const Direction& direction) noexcept {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d& d = direction.d;
  SupportExtent core{kInfinity, -kInfinity, 0.0};
  for (const auto& corner : triangle.vertex) {
    const auto v = as_eigen(corner);
    const double at = v.dot(d);
    core.low = std::min(core.low, at);
    core.high = std::max(core.high, at);
    core.scale = std::max(core.scale, v.cwiseAbs().dot(d.cwiseAbs()));
  }
  return rounded(core, triangle.rounding * direction.length());
}
[[nodiscard]] inline double radius_of(const TriangleShape& triangle) noexcept {
  double radius = 0.0;
  for (const auto& corner : triangle.vertex) {
    radius = std::max(radius, as_eigen(corner).stableNorm());
  }
  return radius + triangle.rounding;
}
[[nodiscard]] inline double rounding_of(const TriangleShape& triangle) noexcept {
  return triangle.rounding;
}
[[nodiscard]] inline double inner_radius_of(const TriangleShape& /*triangle*/) noexcept {
  return 0.0;
}
[[nodiscard]] inline double size_of(const TriangleShape& triangle) noexcept {
  double size = triangle.rounding;
  for (const auto& corner : triangle.vertex) {
    for (const double x : corner) size = std::max(size, std::abs(x));
  }
  return size;
}
[[nodiscard]] inline ShapeCore core_of(const TriangleShape& triangle) noexcept {
  ShapeCore core;
  core.kind = ShapeKind::triangle;
  core.rounding = triangle.rounding;
  core.largest = size_of(triangle);
  core.triangle = &triangle;
  return core;
}

}  // namespace winnow
