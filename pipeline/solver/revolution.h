#pragma once

#include "pipeline/solver/axis_search.h"
#include "pipeline/solver/problem.h"

namespace winnow::solver {

/// For points, segments, cylinders and cones whose axes are parallel: their difference is a body of
/// revolution, its outline through the origin a polygon, and the axis of least depth one of that
/// polygon's normals. Looks at all of them; false, and nothing is looked at, for other pairs.
bool look_at_revolution(const Problem& problem, AxisSearch& search) noexcept;

}  // namespace winnow::solver
