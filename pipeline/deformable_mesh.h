#pragma once

// Cloth and soft bodies: self-collisions, collisions with other meshes and with rigid shapes. Pairs
// of features are tested by `feature_impact`, rigid shapes as in `time_of_impact`. The
// implementation is in motion/.

#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/memory.h>
#include <winnow/core/point_view.h>
#include <winnow/core/results.h>
#include <winnow/core/status.h>
#include <winnow/core/vectors.h>
#include <winnow/core/volumes.h>
#include <winnow/pipeline/impacts.h>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <type_traits>

namespace winnow {

/// Options of a deformable mesh, fixed at construction.
struct DeformableMeshOptions {
  /// Source of every allocation. It must outlive the mesh.
  std::pmr::memory_resource* memory = default_memory();
  /// How boxes are updated and candidates are tested in parallel; results do not depend on it.
  Execution execution = Execution::serial();
  /// Finite. Origin of the float boxes: a point near the mesh keeps them tight in a world far from
  /// (0, 0, 0). Two meshes that are tested against each other must have the same origin.
  Vec3d origin{};
  /// Largest number of results per callback, at least 1. A call allocates memory for this number of
  /// results and of candidates (twice as many candidates on several threads), with one answer per
  /// candidate, and no more.
  std::size_t chunk = 16384;
};

/// Two features of meshes that touch during the step.
struct MeshImpact {
  /// Numbers of a vertex and a face, or of two edges. For two edges of one mesh, the lower number
  /// is first.
  Pair features;
  double time = 0.0;  ///< time of the first touch, never late; see FeatureImpact
};

/// Two features of meshes whose distance at the end of the step is at most the given thickness.
struct MeshProximity {
  Pair features;               ///< see MeshImpact
  double distance = 0.0;       ///< exact to a few rounding errors of the vertices
  std::array<Vec3d, 2> point;  ///< closest points, on the first and the second feature
  /// Barycentric weights of the points. The first point is weight[0] times the vertex or, for
  /// edges, weight[0] and weight[1] times the ends. The remaining weights are for the second point:
  /// one per corner of the face, or weight[2] and weight[3] for the ends of the second edge. Each
  /// is >= 0; the weights of one feature sum to 1.
  std::array<double, 4> weight{};
};

/// A rigid shape of any kind, and its motion during the step, to be tested against meshes.
struct MeshObstacle {
  const ShapePool& shapes;  ///< contains the shape, or its convex parts
  ShapeId shape;            ///< the shape
  RigidMotion motion;       ///< its motion during the step
  /// Gap at which a face touches the shape: finite, >= 0, at most half of the distance given to
  /// `move`.
  double separation = 0.0;
};

/// A face of a mesh and a rigid shape that touch during the step.
struct MeshShapeImpact {
  std::uint32_t face = 0;  ///< number of the face
  std::uint32_t part =
      kWholeShape;           ///< triangle or child of the shape; kWholeShape for a convex shape
  double time = 0.0;         ///< in [0, 1], never late: the two are apart before it
  double gap = 0.0;          ///< at that time, beyond the separation; see ImpactResult
  double error_bound = 0.0;  ///< the true gap is within gap +- error_bound
  Vec3d normal{};            ///< unit vector from the shape to the face, at that time
  Vec3d point{};             ///< contact point on the shape at that time, in the world
};

/// A function of the caller that takes chunks of results: any function object that can be called
/// with a `std::span<const Result>`. It is used only during the call that it is passed to.
template <typename Result>
struct ResultChunks {
  void* context;                                               ///< the function object
  void (*take)(void* context, std::span<const Result> chunk);  ///< calls it

  /// Refers to `function`, which must outlive this object.
  template <typename Take>
  requires(!std::same_as<std::remove_cvref_t<Take>, ResultChunks> &&
           std::invocable<Take&, std::span<const Result>>) ResultChunks(Take&& function)
  noexcept  // NOLINT(google-explicit-constructor)
      : context(const_cast<void*>(static_cast<const void*>(&function))),
        take([](void* to, std::span<const Result> chunk) {
          (*static_cast<std::remove_reference_t<Take>*>(to))(chunk);
        }) {}
};

/// A mesh whose vertices move in every step, for cloth and soft bodies. It finds the pairs (vertex,
/// face) and (edge, edge), within the mesh or with another mesh, that may touch, that touch, or
/// that are within a distance of each other. Features that share a vertex are not paired.
///
///     winnow::DeformableMesh cloth;
///     cloth.build(rest, triangles);
///     cloth.move(before, after);  // in every step
///     cloth.self_impacts(winnow::FeaturePair::vertex_face, {},
///                        [](std::span<const winnow::MeshImpact> impacts) { ... });
///
/// Vertices stay in the caller's memory and are read by every call until the next `move`. Faces and
/// edges are sorted in space once, by the rest positions. Blocks of 16 of them are the leaves of a
/// tree whose boxes are refitted in every step. A closed mesh takes about 114 bytes per triangle.
/// After the first step only results are allocated, at most one chunk at a time. The order of
/// results is the same for any number of threads and any instruction set. Const calls may run
/// concurrently. Nothing throws; the callbacks must not throw either.
class WINNOW_API DeformableMesh {
 public:
  /// Creates a mesh without triangles.
  explicit DeformableMesh(const DeformableMeshOptions& options = {}) noexcept;
  /// Takes the contents of `other`, which is then without triangles.
  DeformableMesh(DeformableMesh&& other) noexcept;
  ~DeformableMesh();

  /// Copies the triangles and sorts them by the rest positions of their vertices. Call `move`
  /// before any query. Calling `build` again replaces the mesh, for example after triangles or
  /// vertices were added or removed. A failed call changes nothing. `invalid_shape` if there is no
  /// triangle or a corner is not a vertex; `invalid_bounds` if a coordinate or the origin is not
  /// finite or exceeds 2^1020; `too_many_objects` beyond 2^28 triangles or 2^31 - 1 vertices;
  /// `invalid_argument` for views without columns or a chunk of 0. O(n log n).
  Status build(const PointView& rest, const IndexView& triangles) noexcept;

  /// Sets the step: every vertex moves linearly from its position in `start` to its position in
  /// `end`, which may be the same view. Boxes contain the whole motion and are enlarged by half of
  /// `distance`: candidates are all features that come within `distance` of each other, such as a
  /// separation or a thickness. `size_mismatch` for another number of vertices; `invalid_bounds` if
  /// a coordinate is not finite or exceeds 2^1020; `invalid_argument` if `distance` is negative or
  /// not finite, or before `build`. O(n).
  Status move(const PointView& start, const PointView& end, double distance = 0.0) noexcept;

  [[nodiscard]] std::size_t triangles() const noexcept;  ///< 0 before `build`
  [[nodiscard]] std::size_t vertices() const noexcept;   ///< 0 before `build`
  [[nodiscard]] std::size_t edges() const noexcept;      ///< each counted once
  /// Returns the vertices of an edge below `edges()`, the lower one first. Edges are sorted by
  /// their vertices.
  [[nodiscard]] std::array<std::uint32_t, 2> edge(std::size_t i) const noexcept;

  /// Calls `take` with chunks of all pairs of features whose boxes overlap, each once: (vertex,
  /// face), or (edge, edge) with the lower one first. `invalid_argument` before the first `move`;
  /// `out_of_memory` if a chunk cannot be allocated.
  Status self_candidates(FeaturePair kind, ResultChunks<Pair> take) const noexcept;
  /// As above, for pairs of a feature of this mesh (first) and one of another mesh: vertices of
  /// this mesh with faces of the other, or edges. `invalid_argument` also if the origins differ.
  Status candidates_with(const DeformableMesh& other, FeaturePair kind,
                         ResultChunks<Pair> take) const noexcept;

  /// Calls `take` with chunks of all candidates that touch during the step; see `feature_impact`.
  /// Errors as for `self_candidates`; `invalid_argument` also for invalid options or a separation
  /// that exceeds the distance given to `move`.
  Status self_impacts(FeaturePair kind, const FeatureImpactOptions& options,
                      ResultChunks<MeshImpact> take) const noexcept;
  /// As above, with another mesh. The separation is at most half the sum of the distances given to
  /// `move` of the two meshes.
  Status impacts_with(const DeformableMesh& other, FeaturePair kind,
                      const FeatureImpactOptions& options,
                      ResultChunks<MeshImpact> take) const noexcept;

  /// Calls `take` with chunks of all faces that a rigid shape touches during the step, each with
  /// its first impact, in the spatial order of the faces. Impacts are certified as in
  /// `time_of_impact`, with linear motion of the corners and rotation of the shape. `options` are
  /// used as in `time_of_impact`, but the mesh's own execution is used. `invalid_argument` also for
  /// invalid options or separation; `invalid_key` if the shape does not exist; `unsupported` for a
  /// composite shape without a pool of them; `invalid_pose` for an invalid motion.
  Status impacts_with(const MeshObstacle& obstacle, const ImpactOptions& options,
                      ResultChunks<MeshShapeImpact> take) const noexcept;

  /// Calls `take` with chunks of all pairs whose distance at the end of the step is at most
  /// `thickness`. `invalid_argument` also if it is negative, not finite, or exceeds the distance
  /// given to `move`.
  Status self_proximity(FeaturePair kind, double thickness,
                        ResultChunks<MeshProximity> take) const noexcept;
  /// As above, with another mesh. The thickness is at most half the sum of the distances given to
  /// `move` of the two meshes.
  Status proximity_with(const DeformableMesh& other, FeaturePair kind, double thickness,
                        ResultChunks<MeshProximity> take) const noexcept;

  /// Returns every byte that is allocated from the memory resource.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  struct State;
  struct Faces;

  DeformableMeshOptions options_;
  /// Null until something is built.
  State* state_ = nullptr;
};

}  // namespace winnow
