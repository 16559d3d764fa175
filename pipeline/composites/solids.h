#pragma once

#include "pipeline/composites/placed_body.h"

#include <cstdint>

namespace winnow::mid {

/// Whether the triangles of a mesh bound what is inside: `invalid_shape` unless every edge is that
/// of two triangles, which run along it in opposite ways, and the volume that they enclose is
/// positive, that is if corners run counter-clockwise seen from outside. Vertices at the same place
/// count as one; triangles that are segments do not count. `out_of_memory`. O(n log n).
[[nodiscard]] Status check_solid(const Composites& all, ShapeId mesh) noexcept;

/// See MidPhase::holds. Ids are there, poses are valid.
[[nodiscard]] bool holds(const Composites& all, ShapeId id, const Pose& pose,
                         const double point[3]) noexcept;
[[nodiscard]] bool holds(const Composites& all, ShapeId id, const Pose& pose, ShapeId other,
                         const Pose& other_pose) noexcept;

}  // namespace winnow::mid
