#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>

namespace winnow::test {

/// Returns the signed distance of two hulls without rounding, in long double and without pruning:
/// the least over all pairs of features if they are apart, the least overlap along all face normals
/// and edge cross products if they overlap. O(vertices x edges^2).
[[nodiscard]] long double brute_force_distance(const HullShape& a, const Pose& pose_a,
                                               const HullShape& b, const Pose& pose_b);

}  // namespace winnow::test
