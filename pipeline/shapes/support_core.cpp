#include "pipeline/shapes/support_core.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

using Eigen::Vector3d;

constexpr double kLongest = std::numeric_limits<double>::max();

// Support point: radii^2 * direction, normalised by the ellipsoid norm. Scaled by the largest
// component first, so that nothing overflows and no significant square underflows.
[[nodiscard]] Vector3d farthest_of_ellipsoid(const void* shape,
                                             const Vector3d& direction) noexcept {
  const Vector3d radius = Vector3d::Map(static_cast<const EllipsoidShape*>(shape)->radius);
  const Vector3d stretched = radius.cwiseProduct(direction);
  const double largest = stretched.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return Vector3d::Zero();
  const Vector3d share = stretched / largest;
  return radius.cwiseProduct(share / share.norm());
}

[[nodiscard]] double least_curvature_radius(const EllipsoidShape& shape) noexcept {
  const auto [least, most] = std::minmax({shape.radius[0], shape.radius[1], shape.radius[2]});
  return most > 0.0 ? least * (least / most) : 0.0;
}

[[nodiscard]] Vector3d farthest_of_eroded(const void* shape, const Vector3d& direction) noexcept {
  const double radius = least_curvature_radius(*static_cast<const EllipsoidShape*>(shape));
  return farthest_of_ellipsoid(shape, direction) - radius * direction;
}

// The core is the convex hull of a ball and a point: the ball has the difference of the radii and
// the larger end's centre, the point is the smaller end's centre.
[[nodiscard]] Vector3d farthest_of_taper(const void* shape, const Vector3d& direction) noexcept {
  const auto& taper = *static_cast<const TaperedCapsuleShape*>(shape);
  const double excess = std::abs(taper.radius[1] - taper.radius[0]);
  const double end = taper.radius[1] > taper.radius[0] ? taper.half_length : -taper.half_length;
  const double ball = end * direction.z() + excess;
  if (-end * direction.z() >= ball) return {0.0, 0.0, -end};
  const Vector3d out = excess * direction;
  return {out.x(), out.y(), std::clamp(out.z() + end, -kLongest, kLongest)};
}

[[nodiscard]] Vector3d farthest_of_user_shape(const void* shape,
                                              const Vector3d& direction) noexcept {
  const auto& own = *static_cast<const SupportShape*>(shape);
  Vector3d point = Vector3d::Zero();
  if (own.function == nullptr) return point;
  own.function(own.context, direction.data(), point.data());
  if (!point.allFinite()) return Vector3d::Zero();
  const double reach = point.stableNorm();
  return reach <= own.radius ? point : Vector3d(point * (own.radius / reach));
}

}  // namespace

SupportCore support_core(const EllipsoidShape& shape) noexcept {
  return {farthest_of_ellipsoid, &shape, ShapeKind::ellipsoid,
          std::max({shape.radius[0], shape.radius[1], shape.radius[2]}), shape.rounding};
}

SupportCore eroded_core(const EllipsoidShape& shape) noexcept {
  SupportCore core = support_core(shape);
  const double radius = least_curvature_radius(shape);
  const double rounding = core.rounding + radius;
  if (!(rounding <= kLongest)) return core;
  return {farthest_of_eroded, &shape, ShapeKind::ellipsoid, core.radius - radius, rounding};
}

SupportCore support_core(const TaperedCapsuleShape& shape) noexcept {
  const auto [less, more] = std::minmax(shape.radius[0], shape.radius[1]);
  const double reach = std::min(shape.half_length + (more - less), kLongest);
  return {farthest_of_taper, &shape, ShapeKind::tapered_capsule, reach, less};
}

SupportCore support_core(const SupportShape& shape) noexcept {
  return {farthest_of_user_shape, &shape, ShapeKind::support, shape.radius, shape.rounding};
}

SupportCore support_core(const ShapeTables& tables, ShapeId id) noexcept {
  switch (id.kind()) {
    case ShapeKind::ellipsoid:
      return support_core(tables.ellipsoids[id.index()]);
    case ShapeKind::tapered_capsule:
      return support_core(tables.tapered_capsules[id.index()]);
    case ShapeKind::support:
      return support_core(tables.supports[id.index()]);
    default:
      return {};
  }
}

}  // namespace winnow
