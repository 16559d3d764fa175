#include <winnow/pipeline/triangle_mesh.h>

#include "pipeline/mesh/mesh_neighbours.h"
#include "pipeline/mesh/mesh_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace winnow {
namespace {

constexpr std::size_t kMaxTriangles = std::size_t{1} << kActiveEdgeShift;
// Instructions that gather take signed numbers.
constexpr std::size_t kMaxVertices = std::numeric_limits<std::int32_t>::max();

std::size_t padded(std::size_t count) {
  return (count + kMeshFanout - 1) / kMeshFanout * kMeshFanout;
}

bool has_columns(const PointView& points) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (points.single[axis] == nullptr && points.precise[axis] == nullptr) return false;
  }
  return true;
}

bool all_finite(const PointView& points) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < points.count; ++i) {
      if (!std::isfinite(static_cast<float>(points.coordinate(i, axis)))) return false;
    }
  }
  return true;
}

Status check(const PointView& vertices, const IndexView& triangles, const MeshOptions& options) {
  if (!(options.active_edge_angle >= 0.0 && options.active_edge_angle <= std::numbers::pi)) {
    return Status::invalid_argument;
  }
  if (triangles.count == 0 || vertices.count == 0) return Status::invalid_shape;
  if (triangles.count > kMaxTriangles || vertices.count > kMaxVertices) {
    return Status::too_many_objects;
  }
  if (!has_columns(vertices) || (triangles.wide == nullptr && triangles.narrow == nullptr)) {
    return Status::invalid_argument;
  }
  if (!all_finite(vertices)) return Status::invalid_shape;
  for (std::size_t i = 0; i < triangles.count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (triangles.corner(i, k) >= vertices.count) return Status::invalid_shape;
    }
  }
  return Status::ok;
}

}  // namespace

TriangleMesh::TriangleMesh(std::pmr::memory_resource* memory) noexcept
    : vertex_{Column<float>(memory), Column<float>(memory), Column<float>(memory)},
      corner_{Column<std::uint32_t>(memory), Column<std::uint32_t>(memory),
              Column<std::uint32_t>(memory)},
      triangle_(memory),
      nodes_(memory),
      neighbours_(memory) {}

TriangleMesh::TriangleMesh(TriangleMesh&& other) noexcept : TriangleMesh(other.nodes_.memory()) {
  swap(other);
}

void TriangleMesh::swap(TriangleMesh& other) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    vertex_[k].swap(other.vertex_[k]);
    corner_[k].swap(other.corner_[k]);
  }
  triangle_.swap(other.triangle_);
  nodes_.swap(other.nodes_);
  neighbours_.swap(other.neighbours_);
  std::swap(options_, other.options_);
  std::swap(view_, other.view_);
  std::swap(bounds_, other.bounds_);
  std::swap(radius_, other.radius_);
}

Status TriangleMesh::build(const PointView& vertices, const IndexView& triangles,
                           const MeshOptions& options, const Execution& execution) {
  const Status status = check(vertices, triangles, options);
  if (status != Status::ok) return status;
  TriangleMesh fresh(nodes_.memory());
  const Status taken = fresh.take(vertices, triangles, options, execution);
  if (taken == Status::ok) swap(fresh);
  return taken;
}

Status TriangleMesh::take(const PointView& vertices, const IndexView& triangles,
                          const MeshOptions& options, const Execution& execution) {
  options_ = options;
  const std::size_t count = triangles.count;
  view_.vertex_count = static_cast<std::uint32_t>(vertices.count);
  view_.triangle_count = static_cast<std::uint32_t>(count);
  Column<std::uint32_t> order(nodes_.memory());
  Column<std::uint32_t> unsorted[3] = {Column<std::uint32_t>(nodes_.memory()),
                                       Column<std::uint32_t>(nodes_.memory()),
                                       Column<std::uint32_t>(nodes_.memory())};
  bool room = order.resize(count) && triangle_.resize(padded(count)) &&
              nodes_.resize(plan_mesh_levels(view_));
  for (std::size_t k = 0; k < 3; ++k) {
    room = room && vertex_[k].resize(vertices.count) && corner_[k].resize(padded(count)) &&
           unsorted[k].resize(count);
  }
  if (!room) return Status::out_of_memory;
  place_vertices(vertices);
  link();
  const std::uint32_t* columns[3];
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < count; ++i) unsorted[k][i] = triangles.corner(i, k);
    columns[k] = unsorted[k].data();
  }
  if (!order_triangles(view_.vertex, columns, order, execution)) return Status::out_of_memory;
  for (std::size_t slot = 0; slot < padded(count); ++slot) {
    const std::uint32_t number = order[std::min(slot, count - 1)];
    triangle_[slot] = number;
    for (std::size_t k = 0; k < 3; ++k) corner_[k][slot] = columns[k][number];
  }
  if (!find_neighbours(view_, neighbours_)) return Status::out_of_memory;
  fit(execution);
  neighbours_.release();
  return Status::ok;
}

Status TriangleMesh::refit(const PointView& vertices, const Execution& execution) {
  if (vertices.count != view_.vertex_count) return Status::size_mismatch;
  if (vertices.count == 0) return Status::ok;
  if (!has_columns(vertices)) return Status::invalid_argument;
  if (!all_finite(vertices)) return Status::invalid_shape;
  // Found where the vertices are now, so that those which come to lie at one place stay apart.
  if (neighbours_.empty() && !find_neighbours(view_, neighbours_)) return Status::out_of_memory;
  place_vertices(vertices);
  fit(execution);
  return Status::ok;
}

void TriangleMesh::place_vertices(const PointView& vertices) noexcept {
  double farthest = 0.0;
  for (std::size_t i = 0; i < vertices.count; ++i) {
    double square = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto x = static_cast<float>(vertices.coordinate(i, axis));
      vertex_[axis][i] = x;
      square += static_cast<double>(x) * static_cast<double>(x);
    }
    farthest = std::max(farthest, square);
  }
  // Three roundings of the sum and one of the root, each of half an ulp.
  radius_ = std::sqrt(farthest) * (1.0 + 4.0 * std::numeric_limits<double>::epsilon());
}

void TriangleMesh::link() noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    view_.vertex[k] = vertex_[k].data();
    view_.corner[k] = corner_[k].data();
  }
  view_.triangle = triangle_.data();
  link_mesh_levels(view_, nodes_.data());
}

void TriangleMesh::fit(const Execution& execution) noexcept {
  fit_mesh_levels(view_, nodes_.data(), bounds_.min.data(), bounds_.max.data(), execution);
  mark_active_edges(view_, neighbours_, options_.active_edge_angle, triangle_.data());
}

Footprint TriangleMesh::footprint() const noexcept {
  Footprint result;
  for (std::size_t k = 0; k < 3; ++k) {
    result.bounds += vertex_[k].bytes();
    result.keys += corner_[k].bytes();
  }
  result.keys += triangle_.bytes();
  result.structure += nodes_.bytes();
  result.scratch += neighbours_.bytes();
  return result;
}

}  // namespace winnow
