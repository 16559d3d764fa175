#pragma once

#include "pipeline/solver/problem.h"

namespace winnow::solver {

/// For a point and an ellipsoid or tapered capsule: returns the unit axis, from the point to the
/// other core, along which the two are farthest apart or overlap least. Returns zero for all other
/// pairs.
///
/// The nearest point of an ellipsoid is the root of one equation (Eberly, "Distance from a point to
/// an ellipse, an ellipsoid, or a hyperellipsoid", 2013), found by Newton's method. The squared
/// radii enter only as differences from the smallest, so that results for points near the center
/// are as accurate as for others.
[[nodiscard]] Vec axis_from_point(const Problem& problem) noexcept;

}  // namespace winnow::solver
