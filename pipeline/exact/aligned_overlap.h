#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/exact/exact_overlap.h"

namespace winnow {

/// The verdict about spheres, capsules, boxes, cylinders, and half-spaces across one of their axes,
/// whose frames are turned by nothing or by quarters of a turn: what is stacked, or lies on a grid,
/// touches in every frame. They are products of segments and discs along the axes of the world, so
/// that closed forms of degree 4 at most decide; undecided for everything else, and for rounded
/// cylinders whose axes cross. Triangles that lie across an axis are decided where no more than
/// touched, and in any plane against a point. O(1), some 100 ns.
[[nodiscard]] ExactVerdict aligned_overlap(const ShapeTables& tables, ShapeId a, const Pose& pose_a,
                                           ShapeId b, const Pose& pose_b) noexcept;

}  // namespace winnow
