#pragma once

#include "pipeline/exact/core_difference.h"
#include "pipeline/exact/exact_overlap.h"

namespace winnow {

/// The half-space against the rounded core of any other shape. A stored normal is a unit vector to
/// rounding only: its length, and a disc's radius across it, are roots that are decided by squares.
[[nodiscard]] ExactVerdict half_space_verdict(const HalfSpaceShape& half_space,
                                              const Pose& half_space_pose, const CoreVertices& core,
                                              const Pose& core_pose) noexcept;

/// Half-spaces always overlap, unless their normals are opposite.
[[nodiscard]] ExactVerdict half_spaces_verdict(const HalfSpaceShape& a, const Pose& pose_a,
                                               const HalfSpaceShape& b,
                                               const Pose& pose_b) noexcept;

}  // namespace winnow
