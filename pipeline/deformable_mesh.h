#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/pair_buffer.h>
#include <winnow/core/point_view.h>
#include <winnow/core/status.h>
#include <winnow/core/vec3.h>
#include <winnow/pipeline/feature_impacts.h>
#include <winnow/pipeline/time_of_impact.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <type_traits>

namespace winnow {

/// What a deformable mesh is made with.
struct DeformableMeshOptions {
  /// Every allocation comes from here. It must outlive the mesh.
  std::pmr::memory_resource* memory = default_memory();
  /// On whose threads boxes are made, and candidates looked at; results are the same on all.
  Execution execution = Execution::serial();
  /// Finite. Boxes are of floats, measured from here: a point near the mesh keeps them tight in a
  /// world far away. Meshes that are asked about each other have the same.
  Vec3d origin{};
  /// Results that are handed over at a time at most, at least 1: with as many candidates (twice
  /// that on several threads), and an answer for each of these, all the memory that a call takes.
  std::size_t chunk = 16384;
};

/// Two features of meshes that touch during the step.
struct MeshImpact {
  /// A vertex and a face, or two edges, by number. Of one mesh the first edge has the lower one.
  Pair features;
  double time = 0.0;  ///< of the first touch, never later; see FeatureImpact
};

/// Two features of meshes that are near each other at the end of the step.
struct MeshProximity {
  Pair features;               ///< as in MeshImpact
  double distance = 0.0;       ///< in the units of the vertices, to a few last digits of these
  std::array<Vec3d, 2> point;  ///< nearest to each other: on the first feature and on the second
  /// The first point is weight[0] times the vertex; of edges weight[0] and weight[1] times the
  /// ends. The second is made of the other weights: those of the face's corners, or of the other
  /// edge's ends, weight[2] and weight[3]. Each is >= 0, and those of a feature add up to 1.
  std::array<double, 4> weight{};
};

/// A rigid shape that meshes may run into, of any kind, and how it moves during the step.
struct MeshObstacle {
  const ShapePool& shapes;  ///< what holds it, or the convex shapes that it is made of
  ShapeId shape;            ///< which
  RigidMotion motion;       ///< where it goes
  /// How near a face has to come to touch it: finite, >= 0, at most half of the distance that the
  /// mesh was moved with.
  double separation = 0.0;
};

/// A face of a mesh and a rigid shape that touch during the step.
struct MeshShapeImpact {
  std::uint32_t face = 0;  ///< by number
  std::uint32_t part =
      kWholeShape;           ///< triangle or child of the shape; kWholeShape of a convex one
  double time = 0.0;         ///< in [0, 1], never late: before it the two are apart
  double gap = 0.0;          ///< at that time, beyond the separation; see ImpactResult
  double error_bound = 0.0;  ///< of the gap
  Vec3d normal;              ///< unit, from the shape to the face, at that time
  Vec3d point;               ///< of the shape at that time, in the world
};

/// A function of the caller that takes chunks of results.
template <typename Result>
struct ResultChunks {
  void* context;                                               ///< the function
  void (*take)(void* context, std::span<const Result> chunk);  ///< calls it

  /// `function` must outlive this.
  template <typename Take>
  explicit ResultChunks(Take& function) noexcept
      : context(const_cast<void*>(static_cast<const void*>(&function))),
        take([](void* to, std::span<const Result> chunk) {
          (*static_cast<std::remove_reference_t<Take>*>(to))(chunk);
        }) {}
};

/// A mesh whose vertices move in every step, for cloth and soft bodies: which of its vertices and
/// faces, and which of its edges, may touch, do touch, or are near each other, among themselves
/// and those of another mesh. Features that share a vertex are no pair.
///
///     winnow::DeformableMesh cloth;
///     cloth.build(rest, triangles);
///     cloth.move(before, after);  // in every step
///     cloth.self_impacts(winnow::FeaturePair::vertex_face, {},
///                        [](std::span<const winnow::MeshImpact> impacts) { ... });
///
/// Vertices stay where the caller keeps them, and are read again by every call until the next
/// `move`. Faces and edges are sorted in space once, by where vertices are at rest, and blocks of
/// 16 of them stand below a tree whose boxes a step refits: about 114 bytes per triangle of a
/// closed mesh, and no allocation after the first step but for results, of which as many as a chunk
/// holds are handed over at a time, in an order that neither threads nor the instruction set
/// change. Const calls may run at the same time. Nothing throws; what is called with results must
/// not either.
class WINNOW_API DeformableMesh {
 public:
  /// A mesh without triangles.
  explicit DeformableMesh(const DeformableMeshOptions& options = {}) noexcept;
  /// Takes over everything; `other` is left without triangles.
  DeformableMesh(DeformableMesh&& other) noexcept;
  ~DeformableMesh();
  DeformableMesh(const DeformableMesh&) = delete;
  DeformableMesh& operator=(const DeformableMesh&) = delete;

  /// Takes copies of the triangles and sorts them by where vertices are at rest. O(n log n). The
  /// mesh has to be moved before it is asked. Again where triangles or vertices were added or taken
  /// away: it is a new mesh then; a call that is refused changes nothing. `invalid_shape` if there
  /// is no triangle or a corner is not a vertex, `invalid_bounds` if a coordinate or the origin is
  /// not finite or beyond 2^1020, `too_many_objects` beyond 2^28 triangles or 2^31 - 1 vertices,
  /// `invalid_argument` for views without columns or a chunk of 0.
  Status build(const PointView& rest, const IndexView& triangles) noexcept;

  /// The step: every vertex moves linearly from its place in `start` to that in `end`, which may be
  /// the same view. Boxes hold all of it and reach half of `distance` farther: what comes within a
  /// distance of two features, be it their separation or a thickness, is among the candidates.
  /// `size_mismatch` for another number of vertices, `invalid_bounds` if a coordinate is not finite
  /// or beyond 2^1020, `invalid_argument` if `distance` is negative or not finite, or before
  /// `build`. O(n).
  Status move(const PointView& start, const PointView& end, double distance = 0.0) noexcept;

  [[nodiscard]] std::size_t triangles() const noexcept;  ///< 0 before `build`
  [[nodiscard]] std::size_t vertices() const noexcept;   ///< 0 before `build`
  [[nodiscard]] std::size_t edges() const noexcept;      ///< each counted once
  /// The vertices of an edge below `edges()`, the lower one first. Edges are sorted by them.
  [[nodiscard]] std::array<std::uint32_t, 2> edge(std::size_t i) const noexcept;

  /// Calls `take(std::span<const Pair>)` with chunks of all pairs of features whose boxes overlap,
  /// each once: (vertex, face), or (edge, edge) with the lower one first. `invalid_argument` before
  /// the first `move`, `out_of_memory` if there is none for a chunk.
  template <typename Take>
  Status self_candidates(FeaturePair kind, Take&& take) const noexcept {
    return find_self(kind, ResultChunks<Pair>(take));
  }
  /// The same of features of this mesh, first, and of another: its vertices with the other's
  /// faces, or edges. `invalid_argument` also if the two have different origins.
  template <typename Take>
  Status candidates_with(const DeformableMesh& other, FeaturePair kind,
                         Take&& take) const noexcept {
    return find_with(other, kind, ResultChunks<Pair>(take));
  }

  /// Calls `take(std::span<const MeshImpact>)` with chunks of all candidates that touch during the
  /// step: see `feature_impact`. `invalid_argument` also for bad options, or for a separation
  /// larger than the distance that the mesh was moved with.
  template <typename Take>
  Status self_impacts(FeaturePair kind, const FeatureImpactOptions& options,
                      Take&& take) const noexcept {
    return find_impacts(nullptr, kind, options, ResultChunks<MeshImpact>(take));
  }
  /// The same with another mesh, where the separation is at most half of both distances.
  template <typename Take>
  Status impacts_with(const DeformableMesh& other, FeaturePair kind,
                      const FeatureImpactOptions& options, Take&& take) const noexcept {
    return find_impacts(&other, kind, options, ResultChunks<MeshImpact>(take));
  }

  /// Calls `take(std::span<const MeshShapeImpact>)` with chunks of all faces that meet a rigid
  /// shape during the step, in the order of space that faces stand in: each with its first impact,
  /// certified as `time_of_impact` does it, corners moving linearly and the shape turning. Options
  /// are those of `time_of_impact`; the mesh's own execution counts. `invalid_argument` also for
  /// bad options or separation, `invalid_key` for a shape that is not there, `unsupported` for a
  /// composite one where no composites are given, `invalid_pose` for a motion that is not valid.
  template <typename Take>
  Status impacts_with(const MeshObstacle& obstacle, const ImpactOptions& options,
                      Take&& take) const noexcept {
    return find_shape_impacts(obstacle, options, ResultChunks<MeshShapeImpact>(take));
  }

  /// Calls `take(std::span<const MeshProximity>)` with chunks of all pairs that are at a distance
  /// of at most `thickness` at the end of the step. `invalid_argument` also if it is negative, not
  /// finite or larger than the distance that the mesh was moved with.
  template <typename Take>
  Status self_proximity(FeaturePair kind, double thickness, Take&& take) const noexcept {
    return find_near(nullptr, kind, thickness, ResultChunks<MeshProximity>(take));
  }
  /// The same with another mesh, where the thickness is at most half of both distances.
  template <typename Take>
  Status proximity_with(const DeformableMesh& other, FeaturePair kind, double thickness,
                        Take&& take) const noexcept {
    return find_near(&other, kind, thickness, ResultChunks<MeshProximity>(take));
  }

  /// Every byte that the memory resource was asked for and has not got back.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  struct State;

  Status find_self(FeaturePair kind, const ResultChunks<Pair>& chunks) const noexcept;
  Status find_with(const DeformableMesh& other, FeaturePair kind,
                   const ResultChunks<Pair>& chunks) const noexcept;
  Status find_impacts(const DeformableMesh* other, FeaturePair kind,
                      const FeatureImpactOptions& options,
                      const ResultChunks<MeshImpact>& chunks) const noexcept;
  Status find_near(const DeformableMesh* other, FeaturePair kind, double thickness,
                   const ResultChunks<MeshProximity>& chunks) const noexcept;

  Status find_shape_impacts(const MeshObstacle& obstacle, const ImpactOptions& options,
                            const ResultChunks<MeshShapeImpact>& chunks) const noexcept;
  /// Hands over the faces whose boxes overlap a box, which is measured from the origin, as second
  /// ones of pairs.
  Status find_faces(const Aabb& box, const ResultChunks<Pair>& chunks) const noexcept;
  /// Where the corners of a face are at the start and at the end of the step.
  void place_face(std::uint32_t face, std::array<Vec3d, 3>& start,
                  std::array<Vec3d, 3>& end) const noexcept;
  [[nodiscard]] bool is_moved() const noexcept;
  /// The distance that it was moved with.
  [[nodiscard]] double reach() const noexcept;

  DeformableMeshOptions options_;
  /// Null until something is built.
  State* state_ = nullptr;
};

}  // namespace winnow
