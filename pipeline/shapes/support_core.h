#pragma once

// Shapes that are known by their farthest points alone.

#include <winnow/pipeline/shapes.h>

#include <Eigen/Core>

namespace winnow {

/// The core of an ellipsoid, a tapered capsule or a shape of the program's own, in its own frame
/// and lengths.
struct SupportCore {
  using Vec = Eigen::Vector3d;

  /// A point that is farthest along a unit direction, to a few roundings of `radius`: always
  /// finite, and within it.
  Vec (*function)(const void* shape, const Vec& direction) noexcept = nullptr;
  const void* shape = nullptr;
  /// What the shape is.
  ShapeKind kind = ShapeKind::support;
  /// No point is farther from the origin.
  double radius = 0.0;
  double rounding = 0.0;

  [[nodiscard]] Vec farthest(const Vec& direction) const noexcept {
    return function(shape, direction);
  }
};

/// Each points to the shape given.
/// @{
[[nodiscard]] SupportCore support_core(const EllipsoidShape& shape) noexcept;
/// The rounding is the smaller radius: what is left is a ball and a point.
[[nodiscard]] SupportCore support_core(const TaperedCapsuleShape& shape) noexcept;
[[nodiscard]] SupportCore support_core(const SupportShape& shape) noexcept;
/// @}

/// Of an ellipsoid what is left once the largest ball that rolls everywhere inside is taken away,
/// which becomes rounding (Blaschke, "Kreis und Kugel", 1916: its radius is the least radius of
/// curvature). Most overlaps are shallower than that: then the cores are apart.
[[nodiscard]] SupportCore eroded_core(const EllipsoidShape& shape) noexcept;

/// Of a shape of one of these kinds; without a function for all others.
[[nodiscard]] SupportCore support_core(const ShapeTables& tables, ShapeId id) noexcept;

}  // namespace winnow
