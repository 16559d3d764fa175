#pragma once

#include "pipeline/composites/transformed_shape.h"

namespace winnow::mid {

/// True if one of the shapes is a solid that contains a point of the other, see
/// mid::solid_contains_shape.
[[nodiscard]] bool is_either_inside(const TransformedShape& a, const TransformedShape& b) noexcept;

/// Returns how often a closed mesh winds around a point in its scaled frame, 1 inside a simple
/// solid, as the sum of the solid angles of its triangles. O(n).
[[nodiscard]] double winding_number(const Composites& all, ShapeId mesh,
                                    const Vec3d& point) noexcept;

}  // namespace winnow::mid
