#pragma once

#include "pipeline/shapes/hull_builder.h"

#include <Eigen/Core>
#include <span>

namespace winnow {

/// Computes the convex hull of `points` with exact predicates and writes it to `surface`, which
/// must be empty, as triangles that are counter-clockwise seen from outside. Coplanar, collinear
/// and duplicate points are allowed. Returns false if all points lie in one plane. The absolute
/// value of each coordinate must be at most 2. Throws if the surface's memory throws. O(n log n)
/// for most inputs.
///
/// Quickhull: each step adds the farthest point beyond some triangle (Barber, Dobkin and Huhdanpaa,
/// "The quickhull algorithm for convex hulls", 1996). The side of a triangle on which a point lies
/// is computed in double if the error bound permits (Shewchuk, "Adaptive precision floating-point
/// arithmetic and fast robust geometric predicates", 1997), else exactly.
[[nodiscard]] bool exact_hull(std::span<const Eigen::Vector3d> points, HullSurface& surface);

/// Sign of the turn at b on the path a, b, c, projected on the axes `u` and `v`: 1 for a left turn,
/// -1 for a right turn, 0 if straight. Exact.
[[nodiscard]] int turn_in_plane(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                const Eigen::Vector3d& c, int u, int v);

}  // namespace winnow
