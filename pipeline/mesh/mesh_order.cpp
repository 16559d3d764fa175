#include "core/memory/bounds_pool.h"
#include "partitions/tree/morton_order.h"
#include "pipeline/mesh/mesh_tree.h"

#include <algorithm>
#include <span>

namespace winnow {
namespace {

constexpr std::size_t kTrianglesPerTask = 8192;

void box_triangle(BoundsPool& pool, const float* const vertex[3],
                  const std::uint32_t* const corner[3], std::size_t i) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float* x = vertex[axis];
    const float a = x[corner[0][i]];
    const float b = x[corner[1][i]];
    const float c = x[corner[2][i]];
    pool.column(axis)[i] = std::min({a, b, c});
    pool.column(3 + axis)[i] = std::max({a, b, c});
  }
}

}  // namespace

// Here partition code serves the mid phase: triangles are put in the order in which a LinearBvh
// puts its rows, by size and along Hilbert's curve.
bool order_triangles(const float* const vertex[3], const std::uint32_t* const corner[3],
                     Column<std::uint32_t>& order, const Execution& execution) {
  const std::size_t count = order.size();
  BoundsPool pool(order.memory(), Volume::aabb);
  Column<std::uint64_t> scratch(order.memory());
  if (!pool.reserve_exact(count) || !scratch.reserve(2 * count)) return false;
  pool.append(count);
  execution.for_each((count + kTrianglesPerTask - 1) / kTrianglesPerTask, [&](std::size_t task) {
    const std::size_t end = std::min(count, (task + 1) * kTrianglesPerTask);
    for (std::size_t i = task * kTrianglesPerTask; i < end; ++i) {
      box_triangle(pool, vertex, corner, i);
      order[i] = static_cast<std::uint32_t>(i);
    }
  });
  return sort_by_morton(pool, std::span<std::uint32_t>(order.data(), count), scratch, execution);
}

}  // namespace winnow
