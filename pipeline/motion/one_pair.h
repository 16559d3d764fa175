#pragma once

#include <winnow/pipeline/shapes.h>
#include "pipeline/solver/solver.h"

namespace winnow::impact {

/// The distance of two shapes, in the order of the solver, by the lanes of their kinds where
/// these certify it and else by the solver, which takes many times as long.
[[nodiscard]] PairAnswer distance_of(const ShapeTables& tables, ShapeId a, const Pose& pose_a,
                                     ShapeId b, const Pose& pose_b) noexcept;

}  // namespace winnow::impact
