#pragma once

#include <winnow/pipeline/shapes.h>
#include "pipeline/motion/impact.h"
#include "pipeline/motion/moving_pair.h"

namespace winnow::impact {

/// Finds the first impact within an interval. The shapes must be convex and in the tables, the
/// motions valid, and the shapes disjoint before the interval. `tolerance` is relative to the
/// smaller shape's size. An impact after `until` may be reported as none; other results do not
/// depend on `until`.
[[nodiscard]] Impact find_impact(const ShapeTables& tables, const MovingPart& a,
                                 const MovingPart& b, double tolerance,
                                 const Interval& within = {0.0, 1.0}, double until = 1.0) noexcept;

/// Converts the result for (b, a) into the result for (a, b); the arguments are the motions of a
/// and b.
void mirror_impact(const RigidMotion& of_a, const RigidMotion& of_b, Impact& impact) noexcept;

}  // namespace winnow::impact
