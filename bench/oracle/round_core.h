#pragma once

#include "bench/oracle/polytope.h"

namespace winnow::oracle {

/// Returns a polytope inside the core of a cylinder or a cone, with its vertices on the rims: a
/// dozen around each rim, and increasingly dense ones near `aim`, a direction in the frame of the
/// shape.
[[nodiscard]] Polytope inscribed(const ShapeTables& tables, ShapeId shape,
                                 const Vector<Number>& aim);

/// Returns the minimum of n.x over a shape other than a half-space in its own frame, rounding
/// included, for a unit direction n.
[[nodiscard]] Number least_along(const ShapeTables& tables, ShapeId shape, const Vector<Number>& n);

}  // namespace winnow::oracle
