#pragma once

#include "pipeline/shapes/hull_builder.h"

#include <Eigen/Core>
#include <span>

namespace winnow {

/// Fills `surface`, which is empty, with triangles, counter-clockwise seen from outside, that bound
/// the convex hull of the points without any rounding, whatever of them is coplanar, collinear or
/// there twice. False if all lie in one plane. Coordinates are at most 2 in size. Throws what the
/// surface's memory throws. O(points log points) for most sets.
///
/// Points are added one by one, the one that lies the farthest beyond some triangle next (Barber,
/// Dobkin and Huhdanpaa, "The quickhull algorithm for convex hulls", 1996). On which side of a
/// triangle a point lies is told in double where its error bound allows (Shewchuk, "Adaptive
/// precision floating-point arithmetic and fast robust geometric predicates", 1997), else exactly.
[[nodiscard]] bool exact_hull(std::span<const Eigen::Vector3d> points, HullSurface& surface);

/// Sign of the turn at b of the way from a to c, along the axes `u` and `v` alone: 1 to the left.
[[nodiscard]] int turn_in_plane(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                const Eigen::Vector3d& c, int u, int v);

}  // namespace winnow
