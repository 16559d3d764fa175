#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>

namespace winnow::test {

/// Returns the signed distance of two hulls without rounding, in long double and without pruning.
/// If the hulls are apart, it is the least distance over all pairs of features. If they overlap, it
/// is minus the least overlap along all face normals and cross products of edges. O(vertices x
/// edges^2).
[[nodiscard]] long double brute_force_distance(const HullShape& a, const Pose& pose_a,
                                               const HullShape& b, const Pose& pose_b);

}  // namespace winnow::test
