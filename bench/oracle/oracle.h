#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>

namespace winnow::oracle {

/// Reference result for a pair, computed in 100 digits: slow, simple and independent of winnow's
/// algorithms.
struct Truth {
  /// False for pairs of half-spaces, user shapes, invalid poses, and pairs that could not be proven
  /// (e.g. cylinders and cones that touch). All other members are unset then.
  bool known = false;
  /// True if the shapes share a point.
  bool overlap = false;
  /// Negative by the penetration depth if they overlap; exactly 0 if they touch.
  long double distance = 0.0L;
  /// Upper bound of how much less the exact distance may be: 0 except for cylinders and cones.
  double slack = 0.0;
  /// Unit length, from a to b, in world axes.
  Vec3d normal{};
  /// True if no direction more than 0.1 degrees away is equally good to within 1e-9 of the sizes.
  bool normal_unique = false;
  /// Sum of the radii of balls that contain the shapes; errors are relative to it.
  double size = 0.0;
};

/// Distances and depths are the widest gap over all directions in which features of the shapes can
/// face each other: normals of faces, cross products of all pairs of edges, and differences of all
/// vertices and edges. Cylinders and cones are replaced by inscribed polytopes that are refined
/// until a supporting plane proves the result. Slow; for hulls the time grows with the product of
/// their numbers of edges.
[[nodiscard]] Truth solve(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
                          const Pose& pose_b);

}  // namespace winnow::oracle
