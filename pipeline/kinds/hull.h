#pragma once

#include "pipeline/kinds/support_extent.h"

namespace winnow {

/// Upper bound on |d . p| over the points p of a hull's core.
[[nodiscard]] inline double height_bound(const HullShape& hull,
                                         const AnyDirection& direction) noexcept {
  return direction.d.lpNorm<1>() * (as_eigen(hull.center).cwiseAbs().maxCoeff() + hull.radius);
}
[[nodiscard]] inline double height_bound(const HullShape& hull,
                                         const UnitDirection& /*direction*/) noexcept {
  return as_eigen(hull.center).norm() + hull.radius;
}

// Vertex columns are padded to a multiple of 16 with copies of vertex 0. Four independent minima
// and maxima hide the latency of the comparisons.
[[nodiscard]] inline SupportExtent extent_of_vertices(const HullShape& hull,
                                                      const Eigen::Vector3d& d,
                                                      double scale) noexcept {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr std::uint32_t kBlock = 4;
  double low[kBlock];
  double high[kBlock];
  std::fill_n(low, kBlock, kInfinity);
  std::fill_n(high, kBlock, -kInfinity);
  const double* const x = hull.vertex[0];
  const double* const y = hull.vertex[1];
  const double* const z = hull.vertex[2];
  for (std::uint32_t i = 0; i < hull.vertex_count; i += kBlock) {
    for (std::uint32_t k = 0; k < kBlock; ++k) {
      const double v = x[i + k] * d.x() + y[i + k] * d.y() + z[i + k] * d.z();
      low[k] = v < low[k] ? v : low[k];
      high[k] = v > high[k] ? v : high[k];
    }
  }
  return {std::min({low[0], low[1], low[2], low[3]}),
          std::max({high[0], high[1], high[2], high[3]}), scale};
}

template <typename Direction>
[[nodiscard]] SupportExtent extent_of(const HullShape& hull, const Direction& direction) noexcept {
  return rounded(extent_of_vertices(hull, direction.d, height_bound(hull, direction)),
                 hull.rounding * direction.length());
}
[[nodiscard]] inline double radius_of(const HullShape& hull) noexcept {
  return length_bound(as_eigen(hull.center)) + hull.radius + hull.rounding;
}
[[nodiscard]] inline double rounding_of(const HullShape& hull) noexcept {
  return hull.rounding;
}
[[nodiscard]] inline double inner_radius_of(const HullShape& hull) noexcept {
  return hull.inner_radius;
}
[[nodiscard]] inline double size_of(const HullShape& hull) noexcept {
  return std::max({hull.radius, hull.rounding, as_eigen(hull.center).cwiseAbs().maxCoeff()});
}
/// Upper bound of the distance of the vertices from the position; finite even if the hull's numbers
/// are not.
[[nodiscard]] inline double reach_of_vertices(const HullShape& hull) noexcept {
  const double sum = as_eigen(hull.center).cwiseAbs().sum() + hull.radius;
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::max();
}
[[nodiscard]] inline ShapeCore core_of(const HullShape& hull) noexcept {
  ShapeCore core;
  core.kind = ShapeKind::hull;
  core.rounding = hull.rounding;
  core.largest = std::max(hull.rounding, reach_of_vertices(hull));
  core.hull = &hull;
  return core;
}

}  // namespace winnow
