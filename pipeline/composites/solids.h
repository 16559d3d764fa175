#pragma once

#include "pipeline/composites/transformed_shape.h"

namespace winnow::mid {

/// Checks that the triangles of a mesh enclose a volume. `invalid_shape` unless each edge is shared
/// by exactly two triangles that traverse it in opposite directions, and the enclosed volume is
/// positive (corners counter-clockwise seen from outside). Vertices at the same position count as
/// one; triangles that are segments are skipped. `out_of_memory` if memory is refused. O(n log n).
[[nodiscard]] Status check_solid(const Composites& all, ShapeId mesh) noexcept;

/// True if one of the shapes is a solid that contains a point of the other, see
/// mid::solid_contains_shape.
[[nodiscard]] bool is_either_inside(const TransformedShape& a, const TransformedShape& b) noexcept;

/// Returns how often a closed mesh winds around a point in its scaled frame, 1 inside a simple
/// solid, as the sum of the solid angles of its triangles. O(n).
[[nodiscard]] double winding_number(const Composites& all, ShapeId mesh,
                                    const Vec3d& point) noexcept;

}  // namespace winnow::mid
