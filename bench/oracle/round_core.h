#pragma once

#include "bench/oracle/polytope.h"

namespace winnow::oracle {

/// A polytope inside the core of a cylinder or a cone, with its vertices on the rims: a dozen all
/// around, and more and more towards where `aim`, a direction in the frame of the shape, points.
[[nodiscard]] Polytope inscribed(const ShapeTables& tables, ShapeId shape,
                                 const Vector<Number>& aim);

/// The least of n.x over any shape but a half-space in its own frame, rounding included, for a
/// direction of length 1.
[[nodiscard]] Number least_along(const ShapeTables& tables, ShapeId shape, const Vector<Number>& n);

}  // namespace winnow::oracle
