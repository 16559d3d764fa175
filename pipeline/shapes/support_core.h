#pragma once

// Shapes that are given by a support function only.

#include <winnow/pipeline/shapes.h>

#include <Eigen/Core>

namespace winnow {

/// The core of an ellipsoid, a tapered capsule or a user shape, in its own frame and units.
struct SupportCore {
  using Vec = Eigen::Vector3d;

  /// Support function: a farthest point along a unit direction, with an error of a few roundings of
  /// `radius`. The result is always finite and within `radius` of the origin.
  Vec (*function)(const void* shape, const Vec& direction) noexcept = nullptr;
  const void* shape = nullptr;
  ShapeKind kind = ShapeKind::support;
  /// Upper bound on the distance of the core's points from the origin.
  double radius = 0.0;
  double rounding = 0.0;

  [[nodiscard]] Vec farthest(const Vec& direction) const noexcept {
    return function(shape, direction);
  }
};

/// The core refers to the given shape, which must outlive it.
/// @{
[[nodiscard]] SupportCore support_core(const EllipsoidShape& shape) noexcept;
/// The rounding is the smaller radius, so the core is the convex hull of a ball and a point.
[[nodiscard]] SupportCore support_core(const TaperedCapsuleShape& shape) noexcept;
[[nodiscard]] SupportCore support_core(const SupportShape& shape) noexcept;
/// @}

/// An ellipsoid eroded by the largest ball that rolls freely inside it; the ball's radius becomes
/// rounding. The radius is the least radius of curvature (Blaschke, "Kreis und Kugel", 1916). Two
/// overlapping shapes have disjoint cores if the overlap is shallower than this radius, as it is
/// for most contacts.
[[nodiscard]] SupportCore eroded_core(const EllipsoidShape& shape) noexcept;

/// The core of an ellipsoid, tapered capsule or user shape; a default SupportCore, without a
/// function, for other kinds.
[[nodiscard]] SupportCore support_core(const ShapeTables& tables, ShapeId id) noexcept;

}  // namespace winnow
