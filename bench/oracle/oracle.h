#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>

namespace winnow::oracle {

/// The truth about a pair, as far as 100 digits tell: slow, simple, and made of no code of winnow.
struct Truth {
  /// False for pairs of half-spaces, shapes known by a support function, bad poses, and pairs that
  /// it could not prove (cylinders and cones that touch are among them). Nothing else is set then.
  bool known = false;
  /// They share a point.
  bool overlap = false;
  /// Minus the penetration depth where they overlap; exactly 0 where they touch.
  long double distance = 0.0L;
  /// The truth may be less by this much: 0 but for cylinders and cones.
  double slack = 0.0;
  /// Unit, from a to b, in the axes of the world.
  double normal[3] = {};
  /// No direction more than 0.1 degrees away is as good to within 1e-9 of the sizes.
  bool normal_unique = false;
  /// Sum of the radii of balls that hold the shapes: what errors are relative to.
  double size = 0.0;
};

/// Distances by the point of least norm of the difference of the cores (Gilbert, Johnson and
/// Keerthi, 1988, over all subsets of a simplex), proved by the plane that supports it. Depths by
/// all normals that a face of the difference can have: those of faces, and products of all edges.
/// Cylinders and cones by polytopes inside of them, refined until a supporting plane proves them.
/// About 0.1 ms a pair; hulls take longer by the product of their edges.
[[nodiscard]] Truth solve(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
                          const Pose& pose_b);

}  // namespace winnow::oracle
