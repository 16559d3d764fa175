#pragma once

#include <winnow/pipeline/shapes.h>
#include "pipeline/motion/impact.h"
#include "pipeline/motion/moving_pair.h"

namespace winnow::impact {

/// The first impact within an interval of convex shapes that are in the tables, and valid motions;
/// they are apart before the interval. `tolerance` is a share of the smaller shape's size. An
/// impact after `until` may be given as none; one that is not later is the same whatever `until`
/// is.
[[nodiscard]] Impact find_impact(const ShapeTables& tables, const MovingPart& a,
                                 const MovingPart& b, double tolerance,
                                 const Interval& within = {0.0, 1.0}, double until = 1.0) noexcept;

/// Makes of the answer about (b, a) that about (a, b), of bodies that so move.
void mirror_impact(const RigidMotion& of_a, const RigidMotion& of_b, Impact& impact) noexcept;

}  // namespace winnow::impact
