// TriangleMesh: validation, build, refit and snapshots. The tree is in mesh_tree.cpp, active edges
// in mesh_edges.cpp, vertex lists of leaves in leaf_corners.cpp; traversals read the MeshView.

#include <winnow/pipeline/surfaces.h>

#include "core/memory/new_in.h"
#include "core/memory/snapshot_frame.h"
#include "core/threads/float_environment.h"
#include "pipeline/mesh/leaf_corners.h"
#include "pipeline/mesh/mesh_edges.h"
#include "pipeline/mesh/mesh_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace winnow {
namespace {

constexpr std::string_view kMeshMagic = "WINNOWTM";
constexpr std::uint32_t kMeshVersion = 1;

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

/// The columns and the view of them.
struct TriangleMesh::State {
  explicit State(std::pmr::memory_resource* memory) noexcept;

  [[nodiscard]] Status take(const PointView& vertices, const IndexView& triangles,
                            const MeshOptions& given, const Execution& execution) noexcept;
  [[nodiscard]] Status refit(const PointView& vertices, const Execution& execution) noexcept;
  void put(ByteWriter& out) const noexcept;
  [[nodiscard]] Status read(ByteReader& in, const Execution& execution) noexcept;
  [[nodiscard]] Status check_read() noexcept;
  void place_vertices(const PointView& vertices) noexcept;
  void link() noexcept;
  [[nodiscard]] bool list_corners() noexcept;
  void fit_levels(const Execution& execution) noexcept;
  void fit(const Execution& execution) noexcept;

  Column<float> vertex;
  /// By slot; empty if leaves list their vertices.
  Column<std::uint32_t> corner[3];
  LeafCorners leaf_corners;
  Column<std::uint32_t> triangle;
  Column<std::uint16_t> nodes;
  /// See find_neighbours; kept only by meshes that were refitted.
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
      leaf_corners(memory),
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
  const DefaultFloatEnvironment environment;
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
  if (!find_neighbours(view, neighbours) || !list_corners()) return Status::out_of_memory;
  fit(execution);
  neighbours.release();
  return Status::ok;
}

Status TriangleMesh::refit(const PointView& vertices, const Execution& execution) {
  const DefaultFloatEnvironment environment;
  if (vertices.count != this->vertices()) return Status::size_mismatch;
  if (vertices.count == 0) return Status::ok;
  if (!has_columns(vertices)) return Status::invalid_argument;
  if (!all_finite(vertices)) return Status::invalid_shape;
  return state_->refit(vertices, execution);
}

Status TriangleMesh::State::refit(const PointView& vertices, const Execution& execution) noexcept {
  // Computed from the old vertex positions, so that vertices that move to one position stay
  // distinct.
  if (neighbours.empty() && !find_neighbours(view, neighbours)) return Status::out_of_memory;
  place_vertices(vertices);
  fit(execution);
  return Status::ok;
}

void TriangleMesh::State::put(ByteWriter& out) const noexcept {
  const auto slots = [&](const auto& column) {
    return std::span(column.data(), view.triangle_count);
  };
  out.put(options.active_edge_angle);
  out.put_array(std::span(vertex.data(), std::size_t{3} * view.vertex_count));
  for (std::size_t k = 0; k < 3; ++k) {
    out.put(std::uint64_t{view.triangle_count});
    for (std::size_t slot = 0; slot < view.triangle_count; ++slot) {
      out.put(corner_of(view, k, slot));
    }
  }
  out.put_array(slots(triangle));
  out.put_array(std::span(neighbours.data(), neighbours.size()));
}

Status TriangleMesh::State::read(ByteReader& in, const Execution& execution) noexcept {
  options.active_edge_angle = in.get<double>();
  Column<float> given(vertex.memory());
  (void)in.get_array(given);
  for (auto& column : corner) (void)in.get_array(column);
  (void)in.get_array(triangle);
  (void)in.get_array(neighbours);
  if (!in.ok() || !in.rest().empty()) return in.ok() ? Status::invalid_argument : status_of(in);
  const std::size_t count = triangle.size();
  if (count > kMaxTriangles || given.size() / 3 > kMaxVertices) return Status::invalid_argument;
  view.triangle_count = static_cast<std::uint32_t>(count);
  view.vertex_count = static_cast<std::uint32_t>(given.size() / 3);
  const float* const first = given.data();
  const bool is_good =
      count != 0 && given.size() != 0 && given.size() % 3 == 0 &&
      std::all_of(given.begin(), given.end(), [](float x) { return std::isfinite(x); });
  if (!is_good) return Status::invalid_argument;
  if (const Status status = check_read(); status != Status::ok) return status;
  bool room = triangle.resize(whole_leaves(count)) && vertex.resize(given.size() + 1) &&
              nodes.resize(plan_mesh_levels(view));
  for (auto& column : corner) room = room && column.resize(whole_leaves(count));
  if (!room) return Status::out_of_memory;
  for (std::size_t slot = count; slot < whole_leaves(count); ++slot) {
    triangle[slot] = triangle[count - 1];
    for (auto& column : corner) column[slot] = column[count - 1];
  }
  place_vertices(PointView({first, first + 1, first + 2}, view.vertex_count, 3 * sizeof(float)));
  link();
  if (!list_corners()) return Status::out_of_memory;
  fit_levels(execution);
  return Status::ok;
}

/// Checks that numbers of corners, triangles and neighbours are valid and each triangle occurs
/// once.
Status TriangleMesh::State::check_read() noexcept {
  const std::size_t count = view.triangle_count;
  Column<std::uint8_t> seen(vertex.memory());
  if (!seen.resize(count)) return Status::out_of_memory;
  std::fill(seen.begin(), seen.end(), std::uint8_t{0});
  for (const std::uint32_t marked : triangle) {
    const std::uint32_t number = marked & kTriangleNumberMask;
    if (marked >> (kActiveEdgeShift + 3U) != 0 || number >= count || seen[number] != 0) {
      return Status::invalid_argument;
    }
    seen[number] = 1;
  }
  for (const auto& column : corner) {
    const auto is_vertex = [&](std::uint32_t number) { return number < view.vertex_count; };
    if (column.size() != count || !std::all_of(column.begin(), column.end(), is_vertex)) {
      return Status::invalid_argument;
    }
  }
  const auto is_neighbour = [&](std::uint32_t code) {
    if (code == kNoNeighbour || code == kCoveredEdge) return true;
    const std::uint32_t edge = code & ~kSameDirection;
    return edge >> 2U < count && (edge & 3U) < 3;
  };
  const bool fits = neighbours.empty() || neighbours.size() == 3 * count;
  return fits && options.active_edge_angle >= 0.0 &&
                 options.active_edge_angle <= std::numbers::pi &&
                 std::all_of(neighbours.begin(), neighbours.end(), is_neighbour)
             ? Status::ok
             : Status::invalid_argument;
}

Status TriangleMesh::save(Column<std::byte>& out) const {
  return write_snapshot(out, kMeshMagic, kMeshVersion, [&](ByteWriter& writer) {
    if (state_ != nullptr) state_->put(writer);
  });
}

Status TriangleMesh::load(std::span<const std::byte> saved, const Execution& execution) {
  const DefaultFloatEnvironment environment;
  ByteReader in = open_snapshot(saved, kMeshMagic, kMeshVersion);
  if (!in.ok()) return status_of(in);
  State* fresh = nullptr;
  Status status = Status::ok;
  if (!in.rest().empty()) {
    fresh = new_in<State>(memory_, memory_);
    status = fresh == nullptr ? Status::out_of_memory : fresh->read(in, execution);
  }
  if (status == Status::ok) std::swap(state_, fresh);
  delete_in(memory_, fresh);
  return status;
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
  // Covers three roundings of the sum and one of the root, each of half an ulp.
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

/// Moves the corners to vertex lists by leaf, unless too many leaves have long lists (see
/// LeafCorners::take). Returns false if memory is refused.
bool TriangleMesh::State::list_corners() noexcept {
  if (!leaf_corners.take(view)) return false;
  if (leaf_corners.empty()) return true;
  leaf_corners.link(view);
  for (auto& column : corner) column.release();
  return true;
}

void TriangleMesh::State::fit_levels(const Execution& execution) noexcept {
  fit_mesh_levels(view, nodes.data(), leaf_corners.points(), bounds.min.data(), bounds.max.data(),
                  execution);
}

void TriangleMesh::State::fit(const Execution& execution) noexcept {
  fit_levels(execution);
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
  const DefaultFloatEnvironment environment;
  return state_ != nullptr ? state_->bounds : Aabb{};
}

double TriangleMesh::radius() const noexcept {
  const DefaultFloatEnvironment environment;
  return state_ != nullptr ? state_->radius : 0.0;
}

Footprint TriangleMesh::footprint() const noexcept {
  Footprint result;
  if (state_ == nullptr) return result;
  for (std::size_t k = 0; k < 3; ++k) {
    result.keys += state_->corner[k].bytes();
  }
  result.keys += state_->leaf_corners.bytes();
  result.bounds += state_->vertex.bytes();
  result.keys += state_->triangle.bytes();
  result.structure += {sizeof(State), sizeof(State)};
  result.structure += state_->nodes.bytes();
  result.scratch += state_->neighbours.bytes();
  return result;
}

}  // namespace winnow
