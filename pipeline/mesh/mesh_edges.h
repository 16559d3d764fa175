#pragma once

#include <winnow/core/memory.h>
#include "pipeline/mesh/mesh_view.h"

#include <cstdint>

namespace winnow {

/// Flag in a result of find_neighbours. For an edge of a slot with exactly one neighbour, entry 3 *
/// slot + edge is 4 * slot + edge of the other triangle, plus this bit if both triangles traverse
/// the edge in the same direction, that is if they are wound inconsistently.
inline constexpr std::uint32_t kSameDirection = 1U << 30U;
/// The entry of an edge of only one triangle, or of more than two.
inline constexpr std::uint32_t kNoNeighbour = ~0U;
/// The entry of all three edges of a triangle with fewer than three distinct corners (a segment),
/// if a triangle with three distinct corners has an edge with the same ends.
inline constexpr std::uint32_t kCoveredEdge = ~0U - 1U;

/// Finds for each edge the one other triangle that shares it. Vertices at equal positions count as
/// one, because files split vertices where colours or normals differ. Triangles with fewer than
/// three distinct corners are no neighbours, so that a sliver collapsed to a segment does not
/// separate the triangles on its two sides. `neighbours` gets three entries per slot. Returns false
/// and leaves `neighbours` empty if memory is refused. O(n log n); O(n) if few triangles share a
/// vertex.
[[nodiscard]] bool find_neighbours(const MeshView& mesh, Column<std::uint32_t>& neighbours);

/// Stores in the top bits of `triangle` which edges are active: edges without a neighbour, and
/// edges where the surface bends outward by more than `angle`. Outward is the side from which the
/// corners are counter-clockwise. If two triangles are wound inconsistently, bends to both sides
/// count; an edge of a triangle without area is active, because there is no plane to measure from.
/// Covered edges are not active, because an object that touches a covered edge also touches the
/// other triangle of this edge. So triangles without area and without active edges can be dropped.
void mark_active_edges(const MeshView& mesh, const Column<std::uint32_t>& neighbours, double angle,
                       std::uint32_t* triangle) noexcept;

}  // namespace winnow
