#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/exact/exact_overlap.h"

namespace winnow::test {

/// What exact_overlap must say about shapes whose lengths, positions and quaternions are integers
/// of one digit, by trying every point, pair and triple of the differences of vertices, in
/// integers. Spheres, capsules, boxes, triangles and hulls; O(n^6) in the vertices of a shape.
[[nodiscard]] ExactVerdict lattice_truth(const ShapeTables& tables, ShapeId a, const Pose& pose_a,
                                         ShapeId b, const Pose& pose_b);

}  // namespace winnow::test
