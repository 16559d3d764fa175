#include <winnow/pipeline/triangle_mesh.h>

#include "core/memory/new_in.h"
#include "pipeline/mesh/mesh_edges.h"
#include "pipeline/mesh/mesh_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace winnow {
namespace {

constexpr std::size_t kMaxVertices = std::numeric_limits<std::int32_t>::max();

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

/// Columns and the view of them.
struct TriangleMesh::State {
  explicit State(std::pmr::memory_resource* memory) noexcept;

  [[nodiscard]] Status take(const PointView& vertices, const IndexView& triangles,
                            const MeshOptions& given, const Execution& execution) noexcept;
  [[nodiscard]] Status refit(const PointView& vertices, const Execution& execution) noexcept;
  void place_vertices(const PointView& vertices) noexcept;
  void link() noexcept;
  void fit(const Execution& execution) noexcept;

  Column<float> vertex;
  Column<std::uint32_t> corner[3];
  Column<std::uint32_t> triangle;
  Column<std::uint16_t> nodes;
  /// See find_neighbours; kept by meshes that are refitted.
  Column<std::uint32_t> neighbours;
  MeshOptions options;
  MeshView view;
  Aabb bounds;
  double radius = 0.0;
};

TriangleMesh::State::State(std::pmr::memory_resource* memory) noexcept
    : vertex(memory),
      corner{Column<std::uint32_t>(memory), Column<std::uint32_t>(memory),
             Column<std::uint32_t>(memory)},
      triangle(memory),
      nodes(memory),
      neighbours(memory) {}

TriangleMesh::TriangleMesh(TriangleMesh&& other) noexcept
    : memory_(other.memory_), state_(std::exchange(other.state_, nullptr)) {}

TriangleMesh::~TriangleMesh() {
  delete_in(memory_, state_);
}

Status TriangleMesh::build(const PointView& vertices, const IndexView& triangles,
                           const MeshOptions& options, const Execution& execution) {
  const Status status = check(vertices, triangles, options);
  if (status != Status::ok) return status;
  State* fresh = new_in<State>(memory_, memory_);
  if (fresh == nullptr) return Status::out_of_memory;
  const Status taken = fresh->take(vertices, triangles, options, execution);
  if (taken == Status::ok) std::swap(state_, fresh);
  delete_in(memory_, fresh);
  return taken;
}

Status TriangleMesh::State::take(const PointView& vertices, const IndexView& triangles,
                                 const MeshOptions& given, const Execution& execution) noexcept {
  options = given;
  const std::size_t count = triangles.count;
  view.vertex_count = static_cast<std::uint32_t>(vertices.count);
  view.triangle_count = static_cast<std::uint32_t>(count);
  std::pmr::memory_resource* const memory = nodes.memory();
  Column<std::uint32_t> order(memory);
  Column<std::uint32_t> unsorted[3] = {Column<std::uint32_t>(memory), Column<std::uint32_t>(memory),
                                       Column<std::uint32_t>(memory)};
  bool room = order.resize(count) && triangle.resize(whole_leaves(count)) &&
              nodes.resize(plan_mesh_levels(view));
  room = room && vertex.resize(3 * vertices.count + 1);
  for (std::size_t k = 0; k < 3; ++k) {
    room = room && corner[k].resize(whole_leaves(count)) && unsorted[k].resize(count);
  }
  if (!room) return Status::out_of_memory;
  place_vertices(vertices);
  link();
  const std::uint32_t* columns[3];
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < count; ++i) unsorted[k][i] = triangles.corner(i, k);
    columns[k] = unsorted[k].data();
  }
  if (!order_triangles(view.vertex, columns, order, execution)) return Status::out_of_memory;
  for (std::size_t slot = 0; slot < whole_leaves(count); ++slot) {
    const std::uint32_t number = order[std::min(slot, count - 1)];
    triangle[slot] = number;
    for (std::size_t k = 0; k < 3; ++k) corner[k][slot] = columns[k][number];
  }
  if (!find_neighbours(view, neighbours)) return Status::out_of_memory;
  fit(execution);
  neighbours.release();
  return Status::ok;
}

Status TriangleMesh::refit(const PointView& vertices, const Execution& execution) {
  if (vertices.count != this->vertices()) return Status::size_mismatch;
  if (vertices.count == 0) return Status::ok;
  if (!has_columns(vertices)) return Status::invalid_argument;
  if (!all_finite(vertices)) return Status::invalid_shape;
  return state_->refit(vertices, execution);
}

Status TriangleMesh::State::refit(const PointView& vertices, const Execution& execution) noexcept {
  // Found where the vertices are now, so that those which come to lie at one place stay apart.
  if (neighbours.empty() && !find_neighbours(view, neighbours)) return Status::out_of_memory;
  place_vertices(vertices);
  fit(execution);
  return Status::ok;
}

void TriangleMesh::State::place_vertices(const PointView& vertices) noexcept {
  double farthest = 0.0;
  for (std::size_t i = 0; i < vertices.count; ++i) {
    double square = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto x = static_cast<float>(vertices.coordinate(i, axis));
      vertex[3 * i + axis] = x;
      square += static_cast<double>(x) * static_cast<double>(x);
    }
    farthest = std::max(farthest, square);
  }
  vertex[3 * vertices.count] = 0.0F;
  // Three roundings of the sum and one of the root, each of half an ulp.
  radius = std::sqrt(farthest) * (1.0 + 4.0 * std::numeric_limits<double>::epsilon());
}

void TriangleMesh::State::link() noexcept {
  view.vertex = vertex.data();
  for (std::size_t k = 0; k < 3; ++k) {
    view.corner[k] = corner[k].data();
  }
  view.triangle = triangle.data();
  link_mesh_levels(view, nodes.data());
}

void TriangleMesh::State::fit(const Execution& execution) noexcept {
  fit_mesh_levels(view, nodes.data(), bounds.min.data(), bounds.max.data(), execution);
  mark_active_edges(view, neighbours, options.active_edge_angle, triangle.data());
}

const MeshView& view_of(const TriangleMesh& mesh) noexcept {
  static constexpr MeshView kNothing;
  return mesh.state_ != nullptr ? mesh.state_->view : kNothing;
}

std::size_t TriangleMesh::triangles() const noexcept {
  return view_of(*this).triangle_count;
}

std::size_t TriangleMesh::vertices() const noexcept {
  return view_of(*this).vertex_count;
}

Aabb TriangleMesh::bounds() const noexcept {
  return state_ != nullptr ? state_->bounds : Aabb{};
}

double TriangleMesh::radius() const noexcept {
  return state_ != nullptr ? state_->radius : 0.0;
}

Footprint TriangleMesh::footprint() const noexcept {
  Footprint result;
  if (state_ == nullptr) return result;
  for (std::size_t k = 0; k < 3; ++k) {
    result.keys += state_->corner[k].bytes();
  }
  result.bounds += state_->vertex.bytes();
  result.keys += state_->triangle.bytes();
  result.structure += {sizeof(State), sizeof(State)};
  result.structure += state_->nodes.bytes();
  result.scratch += state_->neighbours.bytes();
  return result;
}

}  // namespace winnow
