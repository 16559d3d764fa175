// Builds the 16-ary tree of a mesh: orders triangles by median cuts, plans the levels, and
// quantises bounds from leaves to the top. triangle_mesh.cpp calls this to build and to refit.

#include "pipeline/mesh/mesh_tree.h"

#include "core/memory/bounds_pool.h"
#include "core/sort/parallel_ranges.h"
#include "partitions/tree/kd_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace winnow {
namespace {

constexpr std::size_t kLeavesPerRange = 512;
constexpr std::size_t kTrianglesPerRange = 8192;

/// Writes the box of triangle i to row i.
void box_triangle(BoundsPool& pool, const float* vertex, const std::uint32_t* const corner[3],
                  std::size_t i) {
  const float* const x = vertex + std::size_t{3} * corner[0][i];
  const float* const y = vertex + std::size_t{3} * corner[1][i];
  const float* const z = vertex + std::size_t{3} * corner[2][i];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float a = x[axis];
    const float b = y[axis];
    const float c = z[axis];
    pool.column(axis)[i] = std::min({a, b, c});
    pool.column(3 + axis)[i] = std::max({a, b, c});
  }
}

/// A reference to a bound of a node; `words` is the array that the view points into.
std::uint16_t& written_bound(const MeshView& view, std::uint16_t* words, std::uint32_t level,
                             std::uint32_t node, std::size_t bound) {
  return words[view.node[level] - words + static_cast<std::ptrdiff_t>(place_of_bound(node, bound))];
}

/// Returns whether each triangle gets its own box: if there are more vertices than triangles. Then
/// few triangles share a vertex, the corners of a leaf are scattered in memory, and a test of
/// sixteen boxes takes a fraction of the time to load them.
bool has_boxes(const MeshView& view) {
  return view.vertex_count > view.triangle_count;
}

/// Calls visit(at) for each index into the vertex list of a leaf.
template <typename Visit>
void each_listed(const MeshView& view, std::size_t leaf, Visit&& visit) {
  const auto each = [&](std::size_t block, std::size_t blocks) {
    for (std::size_t at = block * kMeshFanout; at < (block + blocks) * kMeshFanout; ++at) visit(at);
  };
  each(leaf, 1);
  if (view.leaf_more == nullptr) return;
  each(std::size_t{view.count[0]} + view.leaf_more[leaf],
       view.leaf_more[leaf + 1] - view.leaf_more[leaf]);
}

/// Calls visit(number) for each vertex of a leaf. Vertices may be visited more than once.
template <typename Visit>
void each_vertex(const MeshView& view, std::size_t leaf, Visit&& visit) {
  if (view.corner[0] == nullptr) {
    return each_listed(view, leaf, [&](std::size_t at) { visit(view.leaf_vertex[at]); });
  }
  for (const std::uint32_t* const column : view.corner) {
    const std::uint32_t* const own = column + leaf * kMeshFanout;
    for (std::size_t i = 0; i < kMeshFanout; ++i) visit(own[i]);
  }
}

struct FloatBox {
  float low[3];
  float high[3];

  FloatBox() {
    std::fill_n(low, 3, std::numeric_limits<float>::infinity());
    std::fill_n(high, 3, -std::numeric_limits<float>::infinity());
  }
  void add(const MeshView& view, std::uint32_t vertex) {
    const float* const at = view.vertex + std::size_t{3} * vertex;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], at[axis]);
      high[axis] = std::max(high[axis], at[axis]);
    }
  }
};

FloatBox box_of_leaf(const MeshView& view, std::size_t leaf) {
  FloatBox box;
  each_vertex(view, leaf, [&](std::uint32_t vertex) { box.add(view, vertex); });
  return box;
}
FloatBox box_of_slot(const MeshView& view, std::size_t slot) {
  FloatBox box;
  for (std::size_t k = 0; k < 3; ++k) box.add(view, corner_of(view, k, slot));
  return box;
}

/// Maps the mesh's box to 0..65534; the last number is left for rounding up.
void choose_scale(MeshView& view, const float low[3], const float high[3]) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double extent = static_cast<double>(high[axis]) - static_cast<double>(low[axis]);
    const float step = static_cast<float>(extent / (kMaxNodeBound - 1));
    view.origin[axis] = low[axis];
    view.step[axis] = std::max(step, std::numeric_limits<float>::min()) *
                      (1.0F + std::numeric_limits<float>::epsilon());
  }
}

MeshSpan span_of(const MeshView& mesh) noexcept {
  MeshSpan span{};
  for (int axis = 0; axis < 3; ++axis) {
    span.low[axis] = static_cast<double>(mesh.origin[axis]);
    span.step[axis] = static_cast<double>(mesh.step[axis]);
    span.units[axis] = 1.0 / span.step[axis];
    span.least[axis] = span.low[axis] - span.step[axis];
    span.most[axis] = span.low[axis] + (kMaxNodeBound + 1.0) * span.step[axis];
    span.extent = std::max(span.extent, span.most[axis] - span.least[axis]);
  }
  span.pace = 1.0 / span.extent;
  span.units_volume = span.units[0] * span.units[1] * span.units[2];
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kThinnest = 1e-20;
    const double inverse = span.step[axis] * span.pace;
    span.float_units[axis] = inverse > kThinnest ? static_cast<float>(span.units[axis])
                                                 : std::numeric_limits<float>::infinity();
    span.float_inverse[axis] = static_cast<float>(inverse);
  }
  return span;
}

double decoded(const MeshView& view, std::size_t axis, std::uint32_t q) {
  return static_cast<double>(view.origin[axis]) +
         static_cast<double>(q) * static_cast<double>(view.step[axis]);
}

/// The quotient may be rounded across an integer, so the decoded value is compared: the decoded
/// bound is certainly outside or on x.
std::uint16_t quantised_low(const MeshView& view, std::size_t axis, double x) {
  const double t = mesh_units(view, axis, x);
  auto q = static_cast<std::uint32_t>(t);
  while (q > 0 && decoded(view, axis, q) > x) --q;
  return static_cast<std::uint16_t>(q);
}
std::uint16_t quantised_high(const MeshView& view, std::size_t axis, double x) {
  const double t = mesh_units(view, axis, x);
  auto q = static_cast<std::uint32_t>(std::ceil(t));
  while (q < kMaxNodeBound && decoded(view, axis, q) < x) ++q;
  return static_cast<std::uint16_t>(q);
}

/// Writes the bounds of a box as number `i` of a level.
void write_box(const MeshView& view, const FloatBox& box, std::uint16_t* level, std::size_t i) {
  const auto place = static_cast<std::uint32_t>(i);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    level[place_of_bound(place, axis)] =
        quantised_low(view, axis, static_cast<double>(box.low[axis]));
    level[place_of_bound(place, 3 + axis)] =
        quantised_high(view, axis, static_cast<double>(box.high[axis]));
  }
}

/// Sets the bounds of node i of a level to the union of its `children` in the level below.
void join_boxes(const std::uint16_t* below, std::uint32_t children, std::uint16_t* level,
                std::uint32_t i) {
  const std::uint32_t first = i * kMeshFanout;
  for (std::size_t k = 0; k < 6; ++k) {
    const std::uint16_t* const bounds = below + place_of_bound(first, k);
    std::uint16_t bound = bounds[0];
    for (std::uint32_t child = 1; child < children; ++child) {
      bound = k < 3 ? std::min(bound, bounds[child]) : std::max(bound, bounds[child]);
    }
    level[place_of_bound(i, k)] = bound;
  }
}

/// Writes the quantised positions of a leaf's vertices in the leaf's box, which is already written.
void write_points(const MeshView& view, std::uint32_t leaf, std::uint32_t* points) {
  double low[3];
  double share[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = bound_of(view, 0, leaf, axis);
    const double extent = bound_of(view, 0, leaf, 3 + axis) - low[axis];
    share[axis] = extent > 0.0 ? kMaxLeafPoint / extent : 0.0;
  }
  each_listed(view, leaf, [&](std::size_t at) {
    std::uint32_t packed = 0;
    for (std::size_t axis = 3; axis-- > 0;) {
      const double x = static_cast<double>(coordinate(view, view.leaf_vertex[at], axis));
      const double inside =
          ((x - view.span.low[axis]) * view.span.units[axis] - low[axis]) * share[axis];
      const double nearest = std::clamp(inside + 0.5, 0.0, static_cast<double>(kMaxLeafPoint));
      packed = packed << kLeafPointBits | static_cast<std::uint32_t>(nearest);
    }
    points[at] = packed;
  });
}

/// Fits leaves [first, end), and the boxes of their triangles if there are any.
void fit_leaves(const MeshView& view, std::uint16_t* words, std::uint32_t* points,
                std::size_t first, std::size_t end) {
  std::uint16_t* const leaves = words + (view.node[0] - words);
  std::uint16_t* const boxes = view.box != nullptr ? words + (view.box - words) : nullptr;
  for (std::size_t i = first; i < end; ++i) {
    const std::size_t slot = i * kMeshFanout;
    if (boxes == nullptr) {
      write_box(view, box_of_leaf(view, i), leaves, i);
      if (points != nullptr) write_points(view, static_cast<std::uint32_t>(i), points);
      continue;
    }
    for (std::size_t k = slot; k < slot + kMeshFanout; ++k) {
      write_box(view, box_of_slot(view, k), boxes, k);
    }
    join_boxes(boxes, kMeshFanout, leaves, static_cast<std::uint32_t>(i));
  }
}

/// Fits level `level` from the level below.
void fit_upper_level(const MeshView& view, std::uint32_t level, std::uint16_t* words) {
  const std::uint32_t below = view.count[level - 1];
  for (std::uint32_t i = 0; i < view.count[level]; ++i) {
    const std::uint32_t children = std::min(below - i * kMeshFanout, kMeshFanout);
    join_boxes(view.node[level - 1], children, words + (view.node[level] - words), i);
  }
}

void pad_levels(const MeshView& view, std::uint16_t* words) {
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    const auto whole = static_cast<std::uint32_t>(whole_leaves(view.count[level]));
    for (std::uint32_t i = view.count[level]; i < whole; ++i) {
      for (std::size_t k = 0; k < 6; ++k) {
        written_bound(view, words, level, i, k) =
            k < 3 ? static_cast<std::uint16_t>(kMaxNodeBound) : std::uint16_t{0};
      }
    }
  }
}

}  // namespace

// Median cuts, as in LinearBvh, rather than a sort along a Hilbert curve: meshes are built rarely
// and queried often, so that the quality of the tree counts more than the time to build it.
bool order_triangles(const float* vertex, const std::uint32_t* const corner[3],
                     Column<std::uint32_t>& order, const Execution& execution) {
  const std::size_t count = order.size();
  BoundsPool pool(order.memory(), Volume::aabb);
  Column<std::uint32_t> room(order.memory());
  Column<float> scratch(order.memory());
  if (!pool.reserve_exact(count) || !room.reserve(count)) return false;
  pool.append(count);
  for_each_range(execution, count, kTrianglesPerRange, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      box_triangle(pool, vertex, corner, i);
      order[i] = static_cast<std::uint32_t>(i);
    }
  });
  return sort_by_kd_cuts(pool, std::span<std::uint32_t>(order.data(), count), room.data(), scratch,
                         execution, KdPrecision::blocks);
}

std::size_t plan_mesh_levels(MeshView& view) noexcept {
  std::size_t words = 0;
  std::uint32_t nodes = view.triangle_count;
  view.levels = 0;
  do {
    nodes = (nodes + kMeshFanout - 1) / kMeshFanout;
    view.count[view.levels++] = nodes;
    words += 6 * whole_leaves(nodes);
  } while (nodes > kMeshFanout);
  return words + (has_boxes(view) ? 6 * whole_leaves(view.triangle_count) : 0);
}

void link_mesh_levels(MeshView& view, const std::uint16_t* words) noexcept {
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    view.node[level] = words;
    words += 6 * whole_leaves(view.count[level]);
  }
  view.box = has_boxes(view) ? words : nullptr;
}

void fit_mesh_levels(MeshView& view, std::uint16_t* words, std::uint32_t* points, float low[3],
                     float high[3], const Execution& execution) noexcept {
  FloatBox all;
  for (std::size_t leaf = 0; leaf < view.count[0]; ++leaf) {
    each_vertex(view, leaf, [&](std::uint32_t vertex) { all.add(view, vertex); });
  }
  std::copy_n(all.low, 3, low);
  std::copy_n(all.high, 3, high);
  choose_scale(view, low, high);
  view.span = span_of(view);
  const std::size_t leaves = view.count[0];
  for_each_range(execution, leaves, kLeavesPerRange, [&](std::size_t first, std::size_t end) {
    fit_leaves(view, words, points, first, end);
  });
  pad_levels(view, words);
  for (std::uint32_t level = 1; level < view.levels; ++level) fit_upper_level(view, level, words);
}

}  // namespace winnow
