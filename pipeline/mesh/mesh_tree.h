#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/memory.h>
#include "pipeline/mesh/mesh_view.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Rounds a count up to a multiple of 16: full leaves, or full blocks of nodes.
[[nodiscard]] constexpr std::size_t whole_leaves(std::size_t count) noexcept {
  return (count + kMeshFanout - 1) / kMeshFanout * kMeshFanout;
}

/// Converts x to node units on an axis. Monotonic, rounding included, so that comparisons in these
/// units miss nothing.
[[nodiscard]] inline double mesh_units(const MeshView& view, std::size_t axis, double x) noexcept {
  return (x - static_cast<double>(view.origin[axis])) / static_cast<double>(view.step[axis]);
}

/// Plans the levels above `view.triangle_count` triangles: sets levels and counts, and returns the
/// number of 16-bit integers that they need.
[[nodiscard]] std::size_t plan_mesh_levels(MeshView& view) noexcept;

/// Points the levels of a planned view into `words`.
void link_mesh_levels(MeshView& view, const std::uint16_t* words) noexcept;

/// Fits the tree to the vertices: writes the bounds of nodes and triangles to `words`, into which
/// the levels of `view` point, and the quantised vertices to `points`, which `view.leaf_point`
/// points to (may be null). Sets origin, step and span, and writes the box of all triangles to
/// `low` and `high`. O(n).
void fit_mesh_levels(MeshView& view, std::uint16_t* words, std::uint32_t* points, float low[3],
                     float high[3], const Execution& execution) noexcept;

/// Computes the order in which nearby triangles share leaves: slot i is triangle order[i]. `corner`
/// is indexed by the caller's triangle numbers. Returns false if memory is refused.
[[nodiscard]] bool order_triangles(const float* vertex, const std::uint32_t* const corner[3],
                                   Column<std::uint32_t>& order, const Execution& execution);

}  // namespace winnow
