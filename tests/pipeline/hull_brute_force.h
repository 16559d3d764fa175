#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>

namespace winnow::test {

/// Signed distance of two hulls without rounding: where they are apart over all pairs of features,
/// where they overlap over all normals of faces and products of edges, without any pruning, in long
/// double. O(vertices x edges^2).
[[nodiscard]] long double brute_force_distance(const HullShape& a, const Pose& pose_a,
                                               const HullShape& b, const Pose& pose_b);

}  // namespace winnow::test
