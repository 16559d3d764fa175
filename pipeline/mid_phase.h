#pragma once

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

/// Up to which distance pairs matter, of bodies or of primitives: one for all, or one for each.
struct PairMargins {
  /// The same for all pairs: a number does.
  PairMargins(double margin) noexcept : largest(margin) {}
  /// One for each pair; `most` is not below any of them.
  PairMargins(double most, std::span<const double> margins) noexcept
      : largest(most), each(margins) {}

  double largest;                ///< that of no pair is larger
  std::span<const double> each;  ///< by pair; empty if all have the largest

  /// That of a pair.
  [[nodiscard]] double of(std::size_t pair) const noexcept {
    return each.empty() ? largest : each[pair];
  }
};

/// Pairs of convex primitives that may touch: what the narrow phase is given for pairs of bodies of
/// which one or both are composite. Coordinates are relative to the position of body a of the pair
/// of bodies, in the axes of the world, so that answers do not depend on where the bodies stand.
class WINNOW_API PrimitivePairs {
 public:
  /// Every allocation comes from `memory`, which must outlive the object; none before the first
  /// use.
  explicit PrimitivePairs(std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// Forgets all pairs; memory is kept.
  void clear() noexcept;
  /// Everything that can be read under `results`, the rest under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

  /// The primitives, one entry each time one is used: its shape (triangles in `triangles`, all
  /// others in the ShapePool) and its pose.
  Column<ShapeId> shapes;
  Column<Pose> poses;  ///< where each primitive stands
  /// Which part of its body it is: the number of the triangle or child; kWholeShape.
  Column<std::uint32_t> part;
  /// All triangles, of meshes, height fields and the ShapePool, each in the frame of its pose; ids
  /// of that kind in `shapes` lead here.
  Column<TriangleShape> triangles;
  /// Of `triangles`, one for each: bit k is set where edge k (from corner k to the next) is not one
  /// that a neighbour continues, bit 3 + k where corner k is on such an edge of any triangle: a
  /// contact there may have a normal of its own. kAllActive for triangles that are no mesh's. Bit 6
  /// where the triangle is one-sided, and bit 7 where it is clockwise then, seen from its front.
  Column<std::uint8_t> active_edges;
  static constexpr std::uint8_t kAllActive = 63;   ///< all three edges and all three corners
  static constexpr std::uint8_t kOneSided = 64;    ///< has a front
  static constexpr std::uint8_t kClockwise = 128;  ///< has it where its corners run clockwise
  /// Pairs of primitives, those of one pair of bodies next to each other in the order of the
  /// bodies' pairs; a is of body a.
  Column<BodyPair> pairs;
  /// Pairs of primitives of pair i of bodies: [first[i], first[i + 1]).
  Column<std::uint32_t> first;
  /// What tasks write before it is put in order.
  Column<std::uint32_t> scratch;

  /// The pool's tables with `triangles` in the place of its own.
  [[nodiscard]] ShapeTables tables(const ShapePool& pool) const noexcept;
};

/// One primitive of a composite shape.
struct Primitive {
  /// Of kind triangle: see `triangle`. All others are in the ShapePool.
  ShapeId shape;
  std::uint32_t part = kWholeShape;  ///< which of its body; kWholeShape of a convex one
  Pose pose;                         ///< in the world
  TriangleShape triangle;            ///< corners in the frame of `pose`
  /// Of a one-sided triangle: 1 if its corners run counter-clockwise seen from its front, -1 if
  /// clockwise. Who is shown it leaves out what stands behind it. 0 of all others.
  int front = 0;
};

/// Is shown primitives that may lie within `limit` (a value of t, or a distance) and gives back the
/// limit to go on with: a smaller one to hear only of what comes before, below zero to end.
struct PrimitiveVisitor {
  /// Gives back the limit to go on with. Must not throw.
  double (*visit)(void* context, const Primitive& primitive, double limit) = nullptr;
  void* context = nullptr;  ///< handed to `visit`
};

/// Is told what each of several rays meets by `limit`, and gives back the limit for that ray to go
/// on with, as above.
struct RayVisitor {
  /// Of a triangle that the ray meets for certain.
  double (*meet)(void* context, std::size_t ray, std::uint32_t part, const ShapeHit& hit,
                 double limit) = nullptr;
  /// Of a primitive that it may meet: where that is once the position of the pose is subtracted
  /// from the ray's origin, rounded to double.
  double (*look)(void* context, std::size_t ray, const Primitive& primitive,
                 double limit) = nullptr;
  void* context = nullptr;  ///< handed to both
};

struct MeshView;

/// What every ray needs of a mesh where it stands: see MidPhase::place.
struct RaySurface {
  ShapeId shape;                   ///< of no kind: nothing was placed
  Pose pose;                       ///< where it stands
  std::uint64_t revision = 0;      ///< MidPhase::revision, as it was
  const MeshView* mesh = nullptr;  ///< in its own frame
  SurfaceFrame frame = {};         ///< which lies so in the world
  int front = 0;                   ///< as Primitive::front
};

/// Is shown pairs of primitives that may share a point, and gives back whether to go on.
struct PrimitivePairVisitor {
  /// False ends the visit. Must not throw.
  bool (*visit)(void* context, const Primitive& a, const Primitive& b) = nullptr;
  void* context = nullptr;  ///< handed to `visit`
};

/// Is shown pairs of primitives that may lie within `limit` of each other and gives back the limit
/// to go on with, below zero to end.
struct NearPairVisitor {
  /// Gives back the limit to go on with. Must not throw.
  double (*visit)(void* context, const Primitive& a, const Primitive& b, double limit) = nullptr;
  void* context = nullptr;  ///< handed to `visit`
  /// Unit, from a to b, along which the nearest pair so far is apart, or zero. Read again after
  /// each visit.
  const double* normal = nullptr;
};

/// A box that moves by t * direction for t in [0, max_t]; max_t = 0 for one that stands. In double,
/// in the axes of the world.
struct BoxSweep {
  double min[3];                          ///< at t = 0
  double max[3];                          ///< at t = 0, not below `min`
  double direction[3] = {0.0, 0.0, 0.0};  ///< finite; zero for a box that stands
  double max_t = 0.0;                     ///< finite, >= 0
};

/// What composite shapes are made of, as the Scene and its queries see it. An interface, so that
/// who has no composite shapes links and allocates nothing of it. A CompositePool is one.
class WINNOW_API MidPhase {
 public:
  /// Links the kernels of triangles, which composite shapes are made of.
  MidPhase() noexcept;
  MidPhase(const MidPhase&) = delete;
  MidPhase& operator=(const MidPhase&) = delete;
  virtual ~MidPhase() = default;

  /// True for ids of shapes that are there.
  [[nodiscard]] virtual bool contains(ShapeId id) const noexcept = 0;
  /// A float box that contains the shape at a valid pose, rounded outward.
  [[nodiscard]] virtual Aabb bounds(ShapeId id, const Pose& pose) const noexcept = 0;
  /// No point of the shape is farther than this from its own origin.
  [[nodiscard]] virtual double radius(ShapeId id) const noexcept = 0;
  /// Grows each time a shape is changed in place (refit) or removed: what was known about pairs of
  /// composite shapes is void then.
  [[nodiscard]] virtual std::uint64_t revision() const noexcept = 0;

  /// All pairs of primitives that are no farther apart than the margin of their bodies, and some
  /// more, of pairs of bodies of which one at least is composite. Ids and poses are valid. The
  /// order is the same on any number of threads and any instruction set.
  virtual Status expand(const ShapePool& shapes, const Bodies& bodies,
                        std::span<const BodyPair> pairs, const PairMargins& margins,
                        const Execution& execution, PrimitivePairs& out) const = 0;
  /// Gives contacts with internal edges of meshes the normal of the face, after the narrow phase
  /// has answered `pairs` at level distance or manifold. `margins` are those of pairs of
  /// primitives that the narrow phase was given.
  virtual void smooth(const ShapePool& shapes, const PrimitivePairs& pairs,
                      const PairMargins& margins, const Execution& execution,
                      NarrowResult& result) const = 0;
  /// Merges the manifolds of each pair of bodies no farther apart than its margin into regions of
  /// contact: the deepest manifold (of equally deep ones the first in the order of `pairs`) and all
  /// whose normals are within 5 degrees of its own (kRegionCosine) are the first region, the
  /// deepest of what is left leads the next, and so on. Of a region at most kManifoldPoints points
  /// stay: the deepest, and those that span the widest area; corners that manifolds of single parts
  /// had no room for come into question as well. `answers` are those about `pairs` at level
  /// manifold, else `invalid_argument`. O(manifolds x regions of a pair of bodies). The same on any
  /// number of threads and any instruction set.
  virtual Status reduce(const ShapePool& shapes, const PrimitivePairs& pairs,
                        const NarrowResult& answers, const PairMargins& margins,
                        const Execution& execution, ContactRegions& out) const = 0;

  /// Shows `visitor` every primitive whose box the sweep may meet, roughly in the order in which it
  /// does. O(log n + met).
  virtual void visit(ShapeId id, const Pose& pose, const BoxSweep& sweep,
                     const PrimitiveVisitor& visitor) const = 0;
  /// Tells it of every primitive that each of the rays, which are valid, meets or may meet at some
  /// t up to its limit, roughly in the order in which it does. There is one limit per ray, no
  /// larger than its max_t; where a primitive is met depends on the ray alone. Of different rays in
  /// any order; one with a limit below zero meets nothing.
  virtual void visit_rays(ShapeId id, const Pose& pose, std::span<const ShapeRay> rays,
                          const double* limits, const RayVisitor& visitor) const = 0;
  /// Makes a mesh ready for rays that come one by one. False, and nothing is written, of all other
  /// shapes.
  [[nodiscard]] virtual bool place(ShapeId id, const Pose& pose, RaySurface& surface) const {
    (void)id, (void)pose, (void)surface;
    return false;
  }
  /// As `visit_rays`, of one ray, whose number is 0. The surface was placed by this, which has not
  /// changed since.
  virtual void visit_ray(const RaySurface& surface, const ShapeRay& ray, double limit,
                         const RayVisitor& visitor) const {
    (void)surface, (void)ray, (void)limit, (void)visitor;
  }
  /// Shows it every primitive whose box may be no farther than `limit` from that of `from`, which
  /// stands, roughly the nearest first.
  virtual void visit_near(ShapeId id, const Pose& pose, const BoxSweep& from, double limit,
                          const PrimitiveVisitor& visitor) const = 0;

  /// Shows it every pair of primitives of two meshes that may share a point. False, and nothing is
  /// shown, if these are no two meshes.
  virtual bool visit_pairs(ShapeId a, const Pose& pose_a, ShapeId b, const Pose& pose_b,
                           const PrimitivePairVisitor& visitor) const = 0;

  /// Shows it pairs of primitives of two meshes, roughly the nearest first. False, and nothing is
  /// shown, if these are no two meshes, or the first has not one scale along all axes.
  virtual bool visit_near_pairs(ShapeId a, const Pose& pose_a, ShapeId b, const Pose& pose_b,
                                double limit, const NearPairVisitor& visitor) const = 0;

  /// True if a solid (see CompositePool::set_solid), or one in a compound, holds a point of the
  /// world. Ids and poses are valid.
  [[nodiscard]] virtual bool holds(ShapeId id, const Pose& pose, const double point[3]) const {
    (void)id, (void)pose, (void)point;
    return false;
  }
  /// The same of a point of another shape, convex or not: of one in each child of a compound, and
  /// of one corner of a surface. Shapes in one piece whose surface does not meet that of the solid
  /// are held as a whole, or not at all.
  [[nodiscard]] virtual bool holds(ShapeId id, const Pose& pose, ShapeId other,
                                   const Pose& other_pose) const {
    (void)id, (void)pose, (void)other, (void)other_pose;
    return false;
  }

  /// Everything it holds, to the byte what its resource gave.
  [[nodiscard]] virtual Footprint footprint() const noexcept = 0;
};

}  // namespace winnow
