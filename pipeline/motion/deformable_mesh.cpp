// DeformableMesh: a tree over the swept boxes of faces and another over the swept boxes of edges;
// streams the pairs of features whose boxes overlap, their impacts (feature_impacts.cpp) and
// proximities (feature_proximity.cpp).

#include <winnow/core/volumes.h>
#include <winnow/pipeline/deformable_mesh.h>

#include "core/memory/bounds_pool.h"
#include "core/memory/columns.h"
#include "core/memory/new_in.h"
#include "core/numbers/rounding.h"
#include "core/sort/parallel_ranges.h"
#include "core/threads/float_environment.h"
#include "partitions/tree/block_tree.h"
#include "partitions/tree/kd_order.h"
#include "pipeline/motion/deformable_faces.h"
#include "pipeline/motion/feature_proximity.h"
#include "pipeline/motion/feature_stage.h"
#include "pipeline/motion/pair_stream.h"
#include "pipeline/motion/result_chunk.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace winnow {
namespace {

constexpr std::size_t kMaxFaces = std::size_t{1} << 28U;
constexpr std::size_t kMaxVertices = 0x7FFFFFFF;
constexpr std::size_t kRowsPerRange = 8192;
constexpr std::size_t kPairsPerRange = 512;
/// Query rows per unit of work.
constexpr std::uint32_t kQueryRows = 256;
/// Differences of numbers up to this magnitude, and differences of two such differences, are in the
/// range of double.
constexpr double kFarthest = 0x1p1020;

bool has_three_columns(const PointView& points) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (points.single[axis] == nullptr && points.precise[axis] == nullptr) return false;
  }
  return true;
}

bool are_near_enough(const PointView& points) noexcept {
  for (std::size_t i = 0; i < points.count; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!(std::abs(points.coordinate(i, axis)) <= kFarthest)) return false;
    }
  }
  return true;
}

/// Clamps to the finite floats: infinite bounds would overlap the empty boxes that pad the last
/// block.
float bound(float x) noexcept {
  constexpr float kMaxFloat = std::numeric_limits<float>::max();
  return std::clamp(x, -kMaxFloat, kMaxFloat);
}

bool share_a_number(const std::uint32_t* a, const std::uint32_t* b) noexcept {
  return a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1];
}

/// Boxes of features in spatial order, and the tree over them. A row's id is the number of its
/// feature.
class FeatureRows {
 public:
  explicit FeatureRows(std::pmr::memory_resource* memory) noexcept
      : boxes(memory, Volume::aabb), tree(memory), memory_(memory) {}

  [[nodiscard]] RowView view() const noexcept {
    RowView rows;
    for (std::size_t c = 0; c < 6; ++c) rows.column[c] = boxes.column(c);
    rows.id = boxes.ids();
    return rows;
  }

  /// Makes rows for `count` features, in the order of their numbers. Returns false if memory is
  /// refused.
  [[nodiscard]] bool make(std::size_t count) noexcept {
    if (!boxes.reserve_exact(count)) return false;
    boxes.append(count);
    for (std::size_t i = 0; i < count; ++i) boxes.ids()[i] = static_cast<std::uint32_t>(i);
    boxes.pad();
    return true;
  }

  /// Sets the box of each row to the union of the boxes of its vertices: corner[Corners * id] and
  /// the next ones.
  template <std::size_t Corners>
  void fit(const FeatureRows& vertices, const std::uint32_t* corner,
           const Execution& execution) noexcept {
    for_each_range(execution, boxes.rows(), kRowsPerRange, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        const std::uint32_t* const own = corner + Corners * boxes.ids()[row];
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const float* const low = vertices.boxes.column(axis);
          const float* const high = vertices.boxes.column(3 + axis);
          float least = low[own[0]];
          float most = high[own[0]];
          for (std::size_t k = 1; k < Corners; ++k) {
            least = std::min(least, low[own[k]]);
            most = std::max(most, high[own[k]]);
          }
          boxes.column(axis)[row] = least;
          boxes.column(3 + axis)[row] = most;
        }
      }
    });
  }

  /// Writes the ids in spatial order of the current boxes to `order`.
  [[nodiscard]] bool find_order(Column<std::uint32_t>& order,
                                const Execution& execution) const noexcept {
    const std::size_t count = boxes.rows();
    Column<std::uint32_t> room(memory_);
    Column<float> scratch(memory_);
    if (!order.resize(count) || !room.resize(count)) return false;
    std::copy_n(boxes.ids(), count, order.data());
    return sort_by_kd_cuts(boxes, {order.data(), count}, room.data(), scratch, execution,
                           KdPrecision::blocks);
  }

  /// Reorders the ids spatially. Does not move the boxes: call `fit` afterwards.
  [[nodiscard]] bool sort(const Execution& execution) noexcept {
    Column<std::uint32_t> order(memory_);
    if (!find_order(order, execution)) return false;
    std::copy_n(order.data(), boxes.rows(), boxes.ids());
    return tree.cover(0, boxes.blocks());
  }

  BoundsPool boxes;
  BlockTree tree;

 private:
  std::pmr::memory_resource* memory_;
};

/// Streams the pairs that `walk` finds over all units to `take`.
template <typename Walk, typename Take>
Status stream(const DeformableMeshOptions& options, std::uint32_t units, Walk&& walk,
              Take& take) noexcept {
  return stream_pairs(options.execution, options.memory, options.chunk, units, walk, take)
             ? Status::ok
             : Status::out_of_memory;
}

/// Streams the overlapping pairs of query rows (in `order`, if it is not null) and rows of a tree
/// to `take`.
template <typename Take>
Status query_tree(const DeformableMeshOptions& options, const FeatureRows& tree_rows,
                  const FeatureRows& query_rows, const std::uint32_t* order, Take& take) noexcept {
  if (tree_rows.boxes.rows() == 0) return Status::ok;
  const TreeView tree = tree_rows.tree.view(tree_rows.view());
  const auto rows = static_cast<std::uint32_t>(query_rows.boxes.rows());
  QueryBatch batch;
  const RowView own = query_rows.view();
  std::copy_n(own.column, 6, batch.column);
  batch.id = own.id;
  batch.rows = order;
  batch.mode = HitMode::query_first;
  const auto walk = [&](std::uint32_t begin, std::uint32_t end, PairSink& sink) {
    QueryBatch range = batch;
    range.begin = begin * kQueryRows;
    range.end = std::min(rows, end * kQueryRows);
    return block_tree_kernels().query(tree, range, sink);
  };
  return stream(options, (rows + kQueryRows - 1) / kQueryRows, walk, take);
}

}  // namespace

struct DeformableMesh::State {
  explicit State(const DeformableMeshOptions& options) noexcept
      : vertices(options.memory),
        faces(options.memory),
        edges(options.memory),
        vertex_order(options.memory),
        face_corners(options.memory),
        edge_ends(options.memory) {}

  [[nodiscard]] bool take(const PointView& rest, const IndexView& triangles,
                          const DeformableMeshOptions& options) noexcept;
  [[nodiscard]] bool link() noexcept;
  void fit(const DeformableMeshOptions& options) noexcept;

  [[nodiscard]] std::array<std::uint32_t, 2> ends_of(std::uint32_t edge) const noexcept {
    return {edge_ends[std::size_t{2} * edge], edge_ends[std::size_t{2} * edge + 1]};
  }
  [[nodiscard]] const std::uint32_t* corners_of(std::uint32_t face) const noexcept {
    return face_corners.data() + std::size_t{3} * face;
  }

  /// For two features of this mesh.
  [[nodiscard]] bool share_a_vertex(FeaturePair kind, const Pair& pair) const noexcept {
    if (kind == FeaturePair::edge_edge) {
      return share_a_number(edge_ends.data() + std::size_t{2} * pair.first,
                            edge_ends.data() + std::size_t{2} * pair.second);
    }
    const std::uint32_t* const corner = corners_of(pair.second);
    return corner[0] == pair.first || corner[1] == pair.first || corner[2] == pair.first;
  }

  /// Finds the impacts of a mesh with another one, or with itself if that is null.
  static Status find_impacts(const DeformableMesh& first, const DeformableMesh* other,
                             FeaturePair kind, const FeatureImpactOptions& options,
                             ResultChunks<MeshImpact> chunks) noexcept;
  /// As above, for features that are near at the end of the step.
  static Status find_near(const DeformableMesh& first, const DeformableMesh* other,
                          FeaturePair kind, double thickness,
                          ResultChunks<MeshProximity> chunks) noexcept;

  // Rows of vertices stay in the order of their numbers, by which faces and edges index them, and
  // have no tree.
  FeatureRows vertices;
  FeatureRows faces;
  FeatureRows edges;
  Column<std::uint32_t> vertex_order;
  Column<std::uint32_t> face_corners;
  Column<std::uint32_t> edge_ends;
  PointView start;
  PointView end;
  double distance = 0.0;
  bool moved = false;
};

bool DeformableMesh::State::take(const PointView& rest, const IndexView& triangles,
                                 const DeformableMeshOptions& options) noexcept {
  if (!face_corners.resize(3 * triangles.count)) return false;
  for (std::size_t i = 0; i < triangles.count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) face_corners[3 * i + k] = triangles.corner(i, k);
  }
  if (!link() || !vertices.make(rest.count) || !faces.make(triangles.count) ||
      !edges.make(edge_ends.size() / 2)) {
    return false;
  }
  start = end = rest;
  fit(options);
  return vertices.find_order(vertex_order, options.execution) && faces.sort(options.execution) &&
         edges.sort(options.execution);
}

/// Lists each edge once, sorted by its ends. An edge from a vertex to itself is skipped.
bool DeformableMesh::State::link() noexcept {
  Column<std::uint64_t> all(face_corners.memory());
  if (!all.reserve(face_corners.size())) return false;
  for (std::size_t i = 0; i < face_corners.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(face_corners[i + k], face_corners[i + (k + 1) % 3]);
      if (low == high) continue;
      static_cast<void>(all.push_back(std::uint64_t{low} << 32U | high));
    }
  }
  std::sort(all.begin(), all.end());
  const auto count = static_cast<std::size_t>(std::unique(all.begin(), all.end()) - all.begin());
  if (!edge_ends.resize(2 * count)) return false;
  for (std::size_t i = 0; i < count; ++i) {
    edge_ends[2 * i] = static_cast<std::uint32_t>(all[i] >> 32U);
    edge_ends[2 * i + 1] = static_cast<std::uint32_t>(all[i]);
  }
  return true;
}

/// Computes the swept boxes of the step. The union of rounded vertex boxes equals the rounded
/// union, because rounding is monotonic.
void DeformableMesh::State::fit(const DeformableMeshOptions& options) noexcept {
  const double half = 0.5 * distance;
  for_each_range(options.execution, vertices.boxes.rows(), kRowsPerRange,
                 [&](std::size_t begin, std::size_t past) {
                   for (std::size_t axis = 0; axis < 3; ++axis) {
                     float* const low = vertices.boxes.column(axis);
                     float* const high = vertices.boxes.column(3 + axis);
                     const double origin = options.origin[axis];
                     for (std::size_t i = begin; i < past; ++i) {
                       const double a = start.coordinate(i, axis);
                       const double b = end.coordinate(i, axis);
                       const double least = add_down(std::min(a, b), -origin);
                       const double most = add_up(std::max(a, b), -origin);
                       low[i] = bound(round_down(half > 0.0 ? add_down(least, -half) : least));
                       high[i] = bound(round_up(half > 0.0 ? add_up(most, half) : most));
                     }
                   }
                 });
  faces.fit<3>(vertices, face_corners.data(), options.execution);
  edges.fit<2>(vertices, edge_ends.data(), options.execution);
}

DeformableMesh::DeformableMesh(const DeformableMeshOptions& options) noexcept : options_(options) {}

DeformableMesh::DeformableMesh(DeformableMesh&& other) noexcept
    : options_(other.options_), state_(std::exchange(other.state_, nullptr)) {}

DeformableMesh::~DeformableMesh() {
  delete_in(options_.memory, state_);
}

Status DeformableMesh::build(const PointView& rest, const IndexView& triangles) noexcept {
  const DefaultFloatEnvironment environment;
  if (triangles.count == 0 || rest.count == 0) return Status::invalid_shape;
  if (triangles.count > kMaxFaces || rest.count > kMaxVertices) return Status::too_many_objects;
  if (!has_three_columns(rest) || (triangles.wide == nullptr && triangles.narrow == nullptr) ||
      options_.chunk == 0) {
    return Status::invalid_argument;
  }
  const PointView origin(std::span<const Vec3d>(&options_.origin, 1));
  if (!are_near_enough(rest) || !are_near_enough(origin)) return Status::invalid_bounds;
  for (std::size_t i = 0; i < triangles.count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (triangles.corner(i, k) >= rest.count) return Status::invalid_shape;
    }
  }
  State* fresh = new_in<State>(options_.memory, options_);
  if (fresh == nullptr) return Status::out_of_memory;
  const bool taken = fresh->take(rest, triangles, options_);
  if (taken) std::swap(state_, fresh);
  delete_in(options_.memory, fresh);
  return taken ? Status::ok : Status::out_of_memory;
}

Status DeformableMesh::move(const PointView& start, const PointView& end,
                            double distance) noexcept {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr || !(distance >= 0.0 && distance <= kFarthest)) {
    return Status::invalid_argument;
  }
  if (start.count != vertices() || end.count != vertices()) return Status::size_mismatch;
  if (!has_three_columns(start) || !has_three_columns(end)) return Status::invalid_argument;
  if (!are_near_enough(start) || !are_near_enough(end)) return Status::invalid_bounds;
  state_->start = start;
  state_->end = end;
  state_->distance = distance;
  state_->moved = true;
  state_->fit(options_);
  state_->faces.tree.refit_all(state_->faces.view(), options_.execution);
  state_->edges.tree.refit_all(state_->edges.view(), options_.execution);
  return Status::ok;
}

std::size_t DeformableMesh::triangles() const noexcept {
  return state_ == nullptr ? 0 : state_->faces.boxes.rows();
}

std::size_t DeformableMesh::vertices() const noexcept {
  return state_ == nullptr ? 0 : state_->vertices.boxes.rows();
}

std::size_t DeformableMesh::edges() const noexcept {
  return state_ == nullptr ? 0 : state_->edges.boxes.rows();
}

std::array<std::uint32_t, 2> DeformableMesh::edge(std::size_t i) const noexcept {
  return state_->ends_of(static_cast<std::uint32_t>(i));
}

Status DeformableMesh::self_candidates(FeaturePair kind, ResultChunks<Pair> chunks) const noexcept {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr || !state_->moved) return Status::invalid_argument;
  // Removes the pairs that share a vertex, in place and without branches: a branch would often be
  // mispredicted.
  const auto take = [&](std::span<Pair> pairs) {
    std::size_t kept = 0;
    for (const Pair pair : pairs) {
      pairs[kept] = pair;
      kept += state_->share_a_vertex(kind, pair) ? 0U : 1U;
    }
    if (kept != 0) chunks.take(chunks.context, pairs.first(kept));
  };
  if (kind == FeaturePair::edge_edge) {
    const TreeView tree = state_->edges.tree.view(state_->edges.view());
    const auto walk = [&](std::uint32_t begin, std::uint32_t end, PairSink& sink) {
      return block_tree_kernels().self_pairs(tree, begin, end, sink);
    };
    const auto groups = static_cast<std::uint32_t>(state_->edges.tree.groups());
    return stream(options_, groups, walk, take);
  }
  return query_tree(options_, state_->faces, state_->vertices, state_->vertex_order.data(), take);
}

Status DeformableMesh::candidates_with(const DeformableMesh& other, FeaturePair kind,
                                       ResultChunks<Pair> chunks) const noexcept {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr || !state_->moved || other.state_ == nullptr || !other.state_->moved ||
      !(options_.origin == other.options_.origin)) {
    return Status::invalid_argument;
  }
  const auto take = [&](std::span<Pair> pairs) { chunks.take(chunks.context, pairs); };
  if (kind == FeaturePair::edge_edge) {
    return query_tree(options_, other.state_->edges, state_->edges, nullptr, take);
  }
  return query_tree(options_, other.state_->faces, state_->vertices, state_->vertex_order.data(),
                    take);
}

bool DeformableMesh::Faces::are_moved() const noexcept {
  return mesh.state_ != nullptr && mesh.state_->moved;
}

double DeformableMesh::Faces::reach() const noexcept {
  return mesh.state_->distance;
}

void DeformableMesh::Faces::place(std::uint32_t face, std::array<Vec3d, 3>& start,
                                  std::array<Vec3d, 3>& end) const noexcept {
  const std::uint32_t* const corner = mesh.state_->corners_of(face);
  for (std::size_t i = 0; i < 3; ++i) {
    start[i] = mesh.state_->start[corner[i]];
    end[i] = mesh.state_->end[corner[i]];
  }
}

Status DeformableMesh::Faces::find(const Aabb& box, ResultChunks<Pair> chunks) const noexcept {
  const auto take = [&](std::span<Pair> pairs) { chunks.take(chunks.context, pairs); };
  FeatureRows query_rows(mesh.options_.memory);
  if (!query_rows.make(1)) return Status::out_of_memory;
  for (int axis = 0; axis < 3; ++axis) {
    query_rows.boxes.column(static_cast<std::size_t>(axis))[0] = bound(box.min[axis]);
    query_rows.boxes.column(static_cast<std::size_t>(axis) + 3)[0] = bound(box.max[axis]);
  }
  return query_tree(mesh.options_, mesh.state_->faces, query_rows, nullptr, take);
}

namespace {

/// Returns the vertices of the first feature of a pair, then the vertices of the second feature.
template <typename State>
std::array<std::uint32_t, 4> vertices_of(FeaturePair kind, const Pair& pair, const State& first,
                                         const State& second) noexcept {
  if (kind == FeaturePair::vertex_face) {
    const std::uint32_t* const corner = second.corners_of(pair.second);
    return {pair.first, corner[0], corner[1], corner[2]};
  }
  const auto a = first.ends_of(pair.first);
  const auto b = second.ends_of(pair.second);
  return {a[0], a[1], b[0], b[1]};
}

/// Returns the positions of the vertices that `vertices_of` returned. Vertex 0 and, for two edges,
/// vertex 1 are of the first mesh, the remaining vertices of the second mesh.
std::array<Vec3d, 4> points_of(FeaturePair kind, const std::array<std::uint32_t, 4>& vertex,
                               const PointView& first, const PointView& second) noexcept {
  const bool of_edges = kind == FeaturePair::edge_edge;
  return {first[vertex[0]], of_edges ? first[vertex[1]] : second[vertex[1]], second[vertex[2]],
          second[vertex[3]]};
}

/// Computes the first times of contact for pairs of a feature of mesh `a` and a feature of mesh
/// `b`.
template <typename State>
void find_times(FeaturePair kind, std::span<const Pair> pairs, const State& a, const State& b,
                const FeatureImpactOptions& options, double* times) noexcept {
  FeatureStage stage;
  double found[kFeatureLanes];
  const auto settle = [&] {
    stage.find(kind, found, options);
    times = std::copy_n(found, stage.size(), times);
    stage.clear();
  };
  for (const Pair& pair : pairs) {
    const auto vertex = vertices_of(kind, pair, a, b);
    stage.add(points_of(kind, vertex, a.start, b.start), points_of(kind, vertex, a.end, b.end));
    if (stage.is_full()) settle();
  }
  settle();
}

}  // namespace

Status DeformableMesh::State::find_impacts(const DeformableMesh& first, const DeformableMesh* other,
                                           FeaturePair kind, const FeatureImpactOptions& options,
                                           ResultChunks<MeshImpact> chunks) noexcept {
  const DefaultFloatEnvironment environment;
  const DeformableMesh& second = other == nullptr ? first : *other;
  if (first.state_ == nullptr || second.state_ == nullptr || !are_in_range(options) ||
      !(options.min_separation <= 0.5 * first.state_->distance + 0.5 * second.state_->distance)) {
    return Status::invalid_argument;
  }
  ResultChunk<MeshImpact> results(first.options_.memory, chunks);
  Column<double> times(first.options_.memory);
  if (!results.reserve(first.options_.chunk) || !times.resize(first.options_.chunk)) {
    return Status::out_of_memory;
  }
  const State& a = *first.state_;
  const State& b = *second.state_;
  const auto take = [&](std::span<const Pair> pairs) {
    for_each_range(first.options_.execution, pairs.size(), kPairsPerRange,
                   [&](std::size_t begin, std::size_t end) {
                     find_times(kind, pairs.subspan(begin, end - begin), a, b, options,
                                times.data() + begin);
                   });
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (times[i] <= 1.0) results.add({pairs[i], times[i]});
    }
  };
  const Status status = other == nullptr ? first.self_candidates(kind, take)
                                         : first.candidates_with(*other, kind, take);
  if (status != Status::ok) return status;
  results.flush();
  return Status::ok;
}

Status DeformableMesh::State::find_near(const DeformableMesh& first, const DeformableMesh* other,
                                        FeaturePair kind, double thickness,
                                        ResultChunks<MeshProximity> chunks) noexcept {
  const DefaultFloatEnvironment environment;
  const DeformableMesh& second = other == nullptr ? first : *other;
  if (first.state_ == nullptr || second.state_ == nullptr || !(thickness >= 0.0) ||
      !(thickness <= 0.5 * first.state_->distance + 0.5 * second.state_->distance)) {
    return Status::invalid_argument;
  }
  ResultChunk<MeshProximity> results(first.options_.memory, chunks);
  Column<MeshProximity> near(first.options_.memory);
  if (!results.reserve(first.options_.chunk) || !near.resize(first.options_.chunk)) {
    return Status::out_of_memory;
  }
  const auto take = [&](std::span<const Pair> pairs) {
    for_each_range(
        first.options_.execution, pairs.size(), kPairsPerRange,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            const auto vertex = vertices_of(kind, pairs[i], *first.state_, *second.state_);
            near[i] = {};
            near[i].features = pairs[i];
            find_nearest_points(
                kind, points_of(kind, vertex, first.state_->end, second.state_->end), near[i]);
          }
        });
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (near[i].distance <= thickness) results.add(near[i]);
    }
  };
  const Status status = other == nullptr ? first.self_candidates(kind, take)
                                         : first.candidates_with(*other, kind, take);
  if (status != Status::ok) return status;
  results.flush();
  return Status::ok;
}

Status DeformableMesh::self_impacts(FeaturePair kind, const FeatureImpactOptions& options,
                                    ResultChunks<MeshImpact> take) const noexcept {
  return State::find_impacts(*this, nullptr, kind, options, take);
}

Status DeformableMesh::impacts_with(const DeformableMesh& other, FeaturePair kind,
                                    const FeatureImpactOptions& options,
                                    ResultChunks<MeshImpact> take) const noexcept {
  return State::find_impacts(*this, &other, kind, options, take);
}

Status DeformableMesh::self_proximity(FeaturePair kind, double thickness,
                                      ResultChunks<MeshProximity> take) const noexcept {
  return State::find_near(*this, nullptr, kind, thickness, take);
}

Status DeformableMesh::proximity_with(const DeformableMesh& other, FeaturePair kind,
                                      double thickness,
                                      ResultChunks<MeshProximity> take) const noexcept {
  return State::find_near(*this, &other, kind, thickness, take);
}

Footprint DeformableMesh::footprint() const noexcept {
  Footprint footprint;
  if (state_ == nullptr) return footprint;
  for (const FeatureRows* rows : {&state_->vertices, &state_->faces, &state_->edges}) {
    footprint.bounds += rows->boxes.bytes();
    footprint.structure += rows->tree.bytes();
  }
  footprint.structure += bytes_of(state_->vertex_order, state_->face_corners, state_->edge_ends);
  footprint.structure += {sizeof(State), sizeof(State)};
  return footprint;
}

}  // namespace winnow
