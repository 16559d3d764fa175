#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include "pipeline/mesh/mesh_view.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// How many there are with the last leaf, or the last sixteen nodes, filled up.
[[nodiscard]] constexpr std::size_t whole_leaves(std::size_t count) noexcept {
  return (count + kMeshFanout - 1) / kMeshFanout * kMeshFanout;
}

/// x in the units of the nodes on an axis. Grows with x, rounding included, so that of two values
/// neither passes the other: tests made in these units miss nothing.
[[nodiscard]] inline double mesh_units(const MeshView& view, std::size_t axis, double x) noexcept {
  return (x - static_cast<double>(view.origin[axis])) / static_cast<double>(view.step[axis]);
}

/// Lays out the levels above `view.triangle_count` triangles: sets levels and counts, and gives
/// the number of 16-bit words they take.
[[nodiscard]] std::size_t plan_mesh_levels(MeshView& view) noexcept;

/// Points the levels of a planned view at `words`.
void link_mesh_levels(MeshView& view, const std::uint16_t* words) noexcept;

/// Fills `words`, to which the levels of `view` point, with the bounds of its triangles, and
/// `points`, which are its leaf_point; sets origin and step, and gives the box of all triangles.
/// O(n).
void fit_mesh_levels(MeshView& view, std::uint16_t* words, std::uint32_t* points, float low[3],
                     float high[3], const Execution& execution) noexcept;

/// The order of triangles by which near ones share leaves: slot i is triangle order[i]. False if
/// memory is refused. Corners are those of the caller's triangles.
[[nodiscard]] bool order_triangles(const float* vertex, const std::uint32_t* const corner[3],
                                   Column<std::uint32_t>& order, const Execution& execution);

}  // namespace winnow
