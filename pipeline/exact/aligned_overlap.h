#pragma once

#include <winnow/core/pose.h>
#include "pipeline/exact/exact_overlap.h"
#include "pipeline/kinds/shape_core.h"

namespace winnow {

/// Exact verdict for points, segments, boxes, cylinders and half-spaces (with a normal along an
/// axis of their frame) whose orientations are multiples of quarter turns: stacked or grid-aligned
/// shapes touch exactly in every frame. The cores are products of segments and discs along the
/// world axes, so that closed forms of degree 4 at most decide.
///
/// Returns `undecided` for all other shapes and orientations, for rounded cylinders with orthogonal
/// axes, and if the exponents of cylinders or triangles span too wide a range. A triangle
/// orthogonal to an axis is decided only if the shapes are disjoint or touch; a triangle in any
/// plane is decided against a point. O(1).
[[nodiscard]] ExactVerdict aligned_overlap(const ShapeCore& a, const Pose& pose_a,
                                           const ShapeCore& b, const Pose& pose_b) noexcept;

}  // namespace winnow
