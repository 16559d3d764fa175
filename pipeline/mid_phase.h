#pragma once

// The interface between a Scene and its composite shapes: it splits pairs of bodies into pairs of
// convex primitives, which the narrow phase computes. CompositePool is its implementation.

#include <winnow/core/aabb.h>
#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/contact_regions.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/shape_rays.h>
#include <winnow/pipeline/surface_frame.h>

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Margins of pairs of bodies or primitives: one for all pairs, or one per pair. Pairs farther
/// apart than their margin are ignored.
struct PairMargins {
  /// Uses the same margin for all pairs; implicit, so that a number can be passed.
  PairMargins(double margin) noexcept : largest(margin) {}
  /// Uses one margin per pair; `most` is not below any of them.
  PairMargins(double most, std::span<const double> margins) noexcept
      : largest(most), each(margins) {}

  double largest;                ///< upper bound of all margins
  std::span<const double> each;  ///< one per pair; empty if all equal `largest`

  /// Returns the margin of a pair.
  [[nodiscard]] double of(std::size_t pair) const noexcept {
    return each.empty() ? largest : each[pair];
  }
};

/// Pairs of convex primitives that may touch: the input of the narrow phase for pairs of bodies
/// with composite shapes. Coordinates are relative to the position of body a of the pair of bodies,
/// in world axes, so that precision is the same far from the origin of the world.
class WINNOW_API PrimitivePairs {
 public:
  /// Creates an empty list. Every allocation comes from `memory`, which must outlive the object;
  /// there are none before the first use.
  explicit PrimitivePairs(std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// Removes all pairs; memory is kept.
  void clear() noexcept;
  /// Returns the bytes of readable columns under `results`, the rest under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

  /// The primitives, one entry per use: shape (triangles are in `triangles`, all others in the
  /// ShapePool) and pose.
  Column<ShapeId> shapes;
  Column<Pose> poses;  ///< pose of each primitive
  /// Part of the body: the number of the triangle or child; kWholeShape for a convex body.
  Column<std::uint32_t> part;
  /// All triangles, of meshes, height fields and the ShapePool, each in the frame of its pose.
  /// Triangle ids in `shapes` are indices of this column.
  Column<TriangleShape> triangles;
  /// Flags of each entry of `triangles`. Bit k is set if edge k (from vertex k to the next) is
  /// active, that is, not internal to the surface. Bit 3 + k is set if vertex k is on an active
  /// edge of any triangle. A contact at an active feature may have a normal other than the face
  /// normal. kAllActive for triangles that belong to no mesh. kOneSided is set if the triangle is
  /// one-sided; kClockwise is set if it is one-sided and its vertices are clockwise as seen from
  /// its front.
  Column<std::uint8_t> active_edges;
  static constexpr std::uint8_t kAllActive = 63;   ///< all edges and vertices are active
  static constexpr std::uint8_t kOneSided = 64;    ///< the triangle is one-sided
  static constexpr std::uint8_t kClockwise = 128;  ///< clockwise vertices as seen from the front
  /// Pairs of primitives, grouped by pair of bodies, in the order of the pairs of bodies; `a`
  /// belongs to body a.
  Column<BodyPair> pairs;
  /// The pairs of primitives of body pair i are [first[i], first[i + 1]).
  Column<std::uint32_t> first;
  /// Output of parallel tasks before it is put in order.
  Column<std::uint32_t> scratch;

  /// Returns the tables of the pool with `triangles` in place of the pool's triangles.
  [[nodiscard]] ShapeTables tables(const ShapePool& pool) const noexcept;
};

/// One primitive of a composite shape.
struct Primitive {
  /// For a triangle see `triangle`; all other shapes are in the ShapePool.
  ShapeId shape;
  std::uint32_t part = kWholeShape;  ///< part of its body; kWholeShape for a convex body
  Pose pose;                         ///< in the world
  TriangleShape triangle;            ///< in the frame of `pose`
  /// For a one-sided triangle: 1 if its vertices are counter-clockwise as seen from its front, -1
  /// if clockwise. 0 for all other primitives. A visitor must ignore objects behind a one-sided
  /// triangle.
  int front = 0;
};

/// Callback for primitives that may be within `limit` (a value of t, or a distance).
struct PrimitiveVisitor {
  /// Returns the new limit: a smaller one skips primitives beyond it, a negative one ends the
  /// traversal. Must not throw.
  double (*visit)(void* context, const Primitive& primitive, double limit) = nullptr;
  void* context = nullptr;  ///< passed to `visit`
};

/// Callbacks for the hits of several rays. Each returns the new limit of its ray, as in
/// PrimitiveVisitor.
struct RayVisitor {
  /// Called for a triangle that the ray certainly hits.
  double (*visit_hit)(void* context, std::size_t ray, std::uint32_t part, const ShapeHit& hit,
                      double limit) = nullptr;
  /// Called for a primitive that the ray may hit. The primitive is relative to the position of
  /// the composite shape's pose. Test it with a ray whose origin is relative to that position too:
  /// the difference of the two, rounded to double.
  double (*visit_candidate)(void* context, std::size_t ray, const Primitive& primitive,
                            double limit) = nullptr;
  void* context = nullptr;  ///< passed to both
};

struct MeshView;

/// A mesh at a pose, prepared for single rays; see MidPhase::prepare_ray_surface.
struct RaySurface {
  ShapeId shape;                   ///< the default id if nothing was prepared
  Pose pose;                       ///< pose of the mesh
  std::uint64_t revision = 0;      ///< MidPhase::revision when it was prepared
  const MeshView* mesh = nullptr;  ///< the mesh, in its own frame
  SurfaceFrame frame = {};         ///< frame of the mesh in the world
  int front = 0;                   ///< see Primitive::front
};

/// Callback for pairs of primitives that may share a point.
struct PrimitivePairVisitor {
  /// Returns false to end the traversal. Must not throw.
  bool (*visit)(void* context, const Primitive& a, const Primitive& b) = nullptr;
  void* context = nullptr;  ///< passed to `visit`
};

/// Callback for pairs of primitives that may be within `limit` of each other.
struct NearPairVisitor {
  /// Returns the new limit, negative to end the traversal. Must not throw.
  double (*visit)(void* context, const Primitive& a, const Primitive& b, double limit) = nullptr;
  void* context = nullptr;  ///< passed to `visit`
  /// Unit vector from a to b that separates the nearest pair so far, or zero. Read again after each
  /// call of `visit`.
  const double* normal = nullptr;
};

/// A box that moves by t * direction for t in [0, max_t], in double, in world axes. max_t = 0: a
/// static box.
struct MovingBox {
  double min[3];                          ///< at t = 0
  double max[3];                          ///< at t = 0, not below `min`
  double direction[3] = {0.0, 0.0, 0.0};  ///< finite; zero for a static box
  double max_t = 0.0;                     ///< finite, >= 0
};

/// Interface through which Scene and its queries use composite shapes. Programs without composite
/// shapes link and allocate none of its implementation, CompositePool.
class WINNOW_API MidPhase {
 public:
  /// Links the kernels for triangles.
  MidPhase() noexcept;
  MidPhase(const MidPhase&) = delete;
  MidPhase& operator=(const MidPhase&) = delete;
  virtual ~MidPhase() = default;

  /// True if the shape exists.
  [[nodiscard]] virtual bool contains(ShapeId id) const noexcept = 0;
  /// Returns a float box that contains the shape at a valid pose, rounded outward.
  [[nodiscard]] virtual Aabb bounds(ShapeId id, const Pose& pose) const noexcept = 0;
  /// Returns an upper bound on the distance of the shape's points from the origin of its frame.
  [[nodiscard]] virtual double radius(ShapeId id) const noexcept = 0;
  /// Returns a counter that grows when a shape is changed in place (refit) or removed. Cached data
  /// about pairs of composite shapes are then invalid.
  [[nodiscard]] virtual std::uint64_t revision() const noexcept = 0;

  /// Finds all pairs of primitives that are within the margin of their bodies, and some that are
  /// not. At least one body of each pair is composite. Ids and poses are valid. The order is the
  /// same for any number of threads and any instruction set.
  virtual Status find_primitive_pairs(const ShapePool& shapes, const Bodies& bodies,
                                      std::span<const BodyPair> pairs, const PairMargins& margins,
                                      const Execution& execution, PrimitivePairs& out) const = 0;
  /// Corrects contacts at internal edges of meshes (ghost contacts): sets their normals to the
  /// normal of the face. Call it after the narrow phase has computed `pairs` at level distance or
  /// manifold. `margins` are the margins of pairs of primitives that the narrow phase used.
  virtual void correct_internal_edges(const ShapePool& shapes, const PrimitivePairs& pairs,
                                      const PairMargins& margins, const Execution& execution,
                                      NarrowResult& result) const = 0;
  /// Merges the manifolds of each pair of bodies within its margin into contact regions. The
  /// deepest manifold (among equals, the first in `pairs`) and all manifolds whose normals are
  /// within 5 degrees of its normal (kRegionCosine) form the first region; the deepest remaining
  /// manifold starts the next region, and so on. Each region keeps at most kManifoldPoints points:
  /// the deepest one, and points that span the largest area. Candidates include vertices of contact
  /// polygons that did not fit into the manifold of a single part. `invalid_argument` unless
  /// `answers` are the results for `pairs` at level manifold. O(manifolds x regions of a pair of
  /// bodies). The result is the same for any number of threads and any instruction set.
  virtual Status reduce_contacts(const ShapePool& shapes, const PrimitivePairs& pairs,
                                 const NarrowResult& answers, const PairMargins& margins,
                                 const Execution& execution, ContactRegions& out) const = 0;

  /// Visits every primitive whose box the moving box may hit, roughly in order of time. O(log n +
  /// hits).
  virtual void visit(ShapeId id, const Pose& pose, const MovingBox& moving_box,
                     const PrimitiveVisitor& visitor) const = 0;
  /// Reports every primitive that a ray hits or may hit at t up to its limit, roughly in order of t
  /// along each ray; the order between rays is arbitrary. Rays are valid. There is one limit per
  /// ray, at most its max_t; a ray with a negative limit hits nothing. The hits of a ray do not
  /// depend on the other rays.
  virtual void visit_rays(ShapeId id, const Pose& pose, std::span<const ShapeRay> rays,
                          const double* limits, const RayVisitor& visitor) const = 0;
  /// Prepares a mesh for `visit_ray`. Returns false and writes nothing for all other shapes.
  [[nodiscard]] virtual bool prepare_ray_surface(ShapeId id, const Pose& pose,
                                                 RaySurface& surface) const {
    (void)id, (void)pose, (void)surface;
    return false;
  }
  /// As `visit_rays`, for one ray, whose number is 0. The surface was prepared by
  /// `prepare_ray_surface` of this object, which has not changed since.
  virtual void visit_ray(const RaySurface& surface, const ShapeRay& ray, double limit,
                         const RayVisitor& visitor) const {
    (void)surface, (void)ray, (void)limit, (void)visitor;
  }
  /// Visits every primitive whose box may be within `limit` of the static box `from`, roughly
  /// nearest first.
  virtual void visit_near(ShapeId id, const Pose& pose, const MovingBox& from, double limit,
                          const PrimitiveVisitor& visitor) const = 0;

  /// Visits every pair of primitives of two meshes that may share a point. Returns false and visits
  /// nothing unless both shapes are meshes.
  virtual bool visit_pairs(ShapeId a, const Pose& pose_a, ShapeId b, const Pose& pose_b,
                           const PrimitivePairVisitor& visitor) const = 0;

  /// Visits pairs of primitives of two meshes, roughly nearest first. Returns false and visits
  /// nothing unless both shapes are meshes and the first one has a uniform scale.
  virtual bool visit_near_pairs(ShapeId a, const Pose& pose_a, ShapeId b, const Pose& pose_b,
                                double limit, const NearPairVisitor& visitor) const = 0;

  /// True if a solid (see CompositePool::set_solid), or a solid child of a compound, contains a
  /// point of the world. Ids and poses are valid.
  [[nodiscard]] virtual bool solid_contains(ShapeId id, const Pose& pose,
                                            const double point[3]) const {
    (void)id, (void)pose, (void)point;
    return false;
  }
  /// As above, for a point of another shape, convex or not: for a compound, one point of each
  /// child; for a surface, one vertex. A connected shape whose surface does not intersect the
  /// surface of the solid is inside entirely or not at all, so one point decides.
  [[nodiscard]] virtual bool solid_contains(ShapeId id, const Pose& pose, ShapeId other,
                                            const Pose& other_pose) const {
    (void)id, (void)pose, (void)other, (void)other_pose;
    return false;
  }

  /// Returns the bytes of all shapes: exactly what is allocated from the resource.
  [[nodiscard]] virtual Footprint footprint() const noexcept = 0;
};

}  // namespace winnow
