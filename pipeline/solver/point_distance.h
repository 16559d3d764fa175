#pragma once

#include "pipeline/solver/problem.h"

namespace winnow::solver {

/// Of a problem of a point and an ellipsoid or tapered capsule: the unit axis, from the point to
/// the other, along which they are farthest apart or overlap least. Zero for all others.
///
/// Where a point is nearest to the surface of an ellipsoid is a root of one equation (Eberly,
/// "Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid", 2013), by Newton's
/// method; of the least radius's square only differences are taken, so that points near the middle
/// are no worse than others.
[[nodiscard]] Vec axis_from_point(const Problem& problem) noexcept;

}  // namespace winnow::solver
