#pragma once

#include <winnow/core/column.h>
#include "pipeline/mesh/mesh_view.h"

#include <cstdint>

namespace winnow {

/// What find_neighbours says of an edge of a slot, at 3 * slot + edge, where it has one neighbour:
/// 4 * slot + edge of the other triangle, and this bit if both run along the edge the same way,
/// that is if they are wound inconsistently.
inline constexpr std::uint32_t kSameWay = 1U << 30U;
/// A border, or an edge of more than two triangles.
inline constexpr std::uint32_t kNoNeighbour = ~0U;
/// All edges of a triangle that is a segment, where a triangle with area has that edge.
inline constexpr std::uint32_t kCoveredEdge = ~0U - 1U;

/// Finds for every edge the one other triangle that has it. Vertices at the same place count as
/// one, since files split them where colours or normals differ; triangles whose corners are fewer
/// than three places then are no one's neighbours, so that a sliver closed to a segment does not
/// part the triangles on both its sides. `neighbours` holds three numbers per slot. False, and it
/// is empty, if memory is refused. O(n log n), O(n) where few triangles share a vertex.
[[nodiscard]] bool find_neighbours(const MeshView& mesh, Column<std::uint32_t>& neighbours);

/// Says in the top bits of `triangle` which edges are active: those without a neighbour, and those
/// where the surface bends outward by more than `angle`. Outward is the side from which corners run
/// counter-clockwise; where two triangles do not agree on it, every bend beyond the angle counts,
/// as it does where one of them has no area, which leaves no plane to measure from. Edges that are
/// covered are not active: what touches them touches a triangle with area, so that one without area
/// and without active edges may be left out.
void mark_active_edges(const MeshView& mesh, const Column<std::uint32_t>& neighbours, double angle,
                       std::uint32_t* triangle) noexcept;

}  // namespace winnow
