#pragma once

#include "pipeline/composites/transformed_shape.h"

namespace winnow::mid {

/// Checks that the triangles of a mesh enclose a volume. `invalid_shape` unless each edge is shared
/// by exactly two triangles that traverse it in opposite directions, and the enclosed volume is
/// positive (corners counter-clockwise seen from outside). Vertices at the same position count as
/// one; triangles that are segments are skipped. `out_of_memory` if memory is refused. O(n log n).
[[nodiscard]] Status check_solid(const Composites& all, ShapeId mesh) noexcept;

}  // namespace winnow::mid
