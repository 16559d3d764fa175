#pragma once

#include "pipeline/kinds/support_extent.h"

namespace winnow {

// Support point: radii^2 * direction, normalised by the ellipsoid norm. Scaled by the largest
// component first, so that nothing overflows and no significant square underflows.
[[nodiscard]] inline Eigen::Vector3d farthest_of_ellipsoid(
    const void* shape, const Eigen::Vector3d& direction) noexcept {
  using Vec = Eigen::Vector3d;
  const Vec radius = as_eigen(static_cast<const EllipsoidShape*>(shape)->radius);
  const Vec stretched = radius.cwiseProduct(direction);
  const double largest = stretched.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return Vec::Zero();
  const Vec share = stretched / largest;
  return radius.cwiseProduct(share / share.norm());
}

[[nodiscard]] inline double least_curvature_radius(const EllipsoidShape& ellipsoid) noexcept {
  const auto [least, most] =
      std::minmax({ellipsoid.radius[0], ellipsoid.radius[1], ellipsoid.radius[2]});
  return most > 0.0 ? least * (least / most) : 0.0;
}

[[nodiscard]] inline Eigen::Vector3d farthest_of_eroded(const void* shape,
                                                        const Eigen::Vector3d& direction) noexcept {
  const double radius = least_curvature_radius(*static_cast<const EllipsoidShape*>(shape));
  return farthest_of_ellipsoid(shape, direction) - radius * direction;
}

[[nodiscard]] inline SupportCore support_core(const EllipsoidShape& ellipsoid) noexcept {
  return {farthest_of_ellipsoid, &ellipsoid,
          std::max({ellipsoid.radius[0], ellipsoid.radius[1], ellipsoid.radius[2]}),
          ellipsoid.rounding};
}

template <typename Direction>
[[nodiscard]] SupportExtent extent_of(const EllipsoidShape& ellipsoid,
                                      const Direction& direction) noexcept {
  return symmetric(as_eigen(ellipsoid.radius).cwiseProduct(direction.d).stableNorm() +
                   ellipsoid.rounding * direction.length());
}
[[nodiscard]] inline double radius_of(const EllipsoidShape& ellipsoid) noexcept {
  return std::max({ellipsoid.radius[0], ellipsoid.radius[1], ellipsoid.radius[2]}) +
         ellipsoid.rounding;
}
[[nodiscard]] inline double rounding_of(const EllipsoidShape& ellipsoid) noexcept {
  return ellipsoid.rounding;
}
[[nodiscard]] inline double inner_radius_of(const EllipsoidShape& ellipsoid) noexcept {
  return std::min({ellipsoid.radius[0], ellipsoid.radius[1], ellipsoid.radius[2]}) +
         ellipsoid.rounding;
}
[[nodiscard]] inline double size_of(const EllipsoidShape& ellipsoid) noexcept {
  return std::max(
      {ellipsoid.radius[0], ellipsoid.radius[1], ellipsoid.radius[2], ellipsoid.rounding});
}
/// Eroded by the largest ball that rolls freely inside the ellipsoid; the ball's radius becomes
/// rounding. The radius is the least radius of curvature (Blaschke, "Kreis und Kugel", 1916). Two
/// overlapping shapes have disjoint cores if the overlap is shallower than this radius, as it is
/// for most contacts.
[[nodiscard]] inline ShapeCore core_of(const EllipsoidShape& ellipsoid) noexcept {
  SupportCore core = support_core(ellipsoid);
  const double radius = least_curvature_radius(ellipsoid);
  const double rounding = core.rounding + radius;
  if (rounding <= std::numeric_limits<double>::max()) {
    core = {farthest_of_eroded, &ellipsoid, core.radius - radius, rounding};
  }
  return ShapeCore::of_support(ShapeKind::ellipsoid, core);
}

}  // namespace winnow
