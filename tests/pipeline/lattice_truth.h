#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/exact/exact_overlap.h"

namespace winnow::test {

/// Returns the exact verdict for two spheres, capsules, boxes, triangles or hulls whose lengths,
/// positions and quaternions are one-digit integers. Tests every point, segment and triangle of
/// vertex differences in integers. O(n^6) in the vertices of a shape.
[[nodiscard]] ExactVerdict lattice_truth(const ShapeTables& tables, ShapeId a, const Pose& pose_a,
                                         ShapeId b, const Pose& pose_b);

}  // namespace winnow::test
