#pragma once

#include "pipeline/composites/composites.h"

namespace winnow::mid {

/// See MidPhase. `id` is there, `pose` is valid.
void visit(const Composites& all, ShapeId id, const Pose& pose, const BoxSweep& sweep,
           const PrimitiveVisitor& visitor);
void visit_near(const Composites& all, ShapeId id, const Pose& pose, const BoxSweep& from,
                double limit, const PrimitiveVisitor& visitor);

}  // namespace winnow::mid
