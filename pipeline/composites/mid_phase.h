#pragma once

// The mid phase: the functions by which scenes and queries use the composite shapes of a
// CompositePool. They split pairs of bodies into pairs of convex primitives, which the narrow phase
// computes, and traverse the primitives of a shape. The sources of this folder implement them:
// find_primitive_pairs.cpp, surface_contacts.cpp, manifold_reduction.cpp, composite_traversal.cpp,
// rays.cpp and solids.cpp.
//
// Ids and poses are valid, and the shapes exist, unless stated otherwise.

#include <winnow/core/execution.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/shape_rays.h>
#include "pipeline/mesh/mesh_view.h"
#include "pipeline/narrow/contact_regions.h"
#include "pipeline/narrow/primitive_pairs.h"

#include <cstdint>
#include <span>

namespace winnow {

/// One primitive of a composite shape.
struct Primitive {
  /// For a triangle see `triangle`, for a convex solid `hull`; all other shapes are in the
  /// ShapePool.
  ShapeId shape;
  std::uint32_t part = kWholeShape;  ///< part of its body; kWholeShape for a convex body
  Pose pose;                         ///< in the world
  TriangleShape triangle;            ///< in the frame of `pose`
  /// For a one-sided triangle: 1 if its vertices are counter-clockwise as seen from its front, -1
  /// if clockwise. 0 for all other primitives. A visitor must ignore objects behind a one-sided
  /// triangle.
  int front = 0;
  bool is_mirrored = false;  ///< a triangle of a mesh that its scale mirrors
  /// The hull of a convex solid; else null.
  const HullShape* hull = nullptr;
};

/// Callback for primitives that may be within `limit` (a value of t, or a distance).
struct PrimitiveVisitor {
  /// Returns the new limit: a smaller one skips primitives beyond it, a negative one ends the
  /// traversal. Must not throw.
  double (*visit)(void* context, const Primitive& primitive, double limit) = nullptr;
  void* context = nullptr;  ///< passed to `visit`
};

/// A mesh or height field at a pose, prepared for rays.
struct RaySurface {
  ShapeId shape;                   ///< the default id if nothing was prepared
  Pose pose;                       ///< pose of the surface
  std::uint64_t revision = 0;      ///< CompositePool::revision when it was prepared
  const MeshView* mesh = nullptr;  ///< the mesh, in its own frame; null for a height field
  SurfaceFrame frame = {};         ///< frame of the surface in the world
  bool is_one_sided = false;       ///< see CompositePool::set_one_sided
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
  double min[3];       ///< at t = 0
  double max[3];       ///< at t = 0, not below `min`
  Vec3d direction{};   ///< finite; zero for a static box
  double max_t = 0.0;  ///< finite, >= 0
};

namespace mid {

/// The pairs of bodies of a call of the mid phase.
struct CollidedPairs {
  const CompositePool& pool;
  const ShapePool& shapes;
  Bodies bodies;
  std::span<const BodyPair> pairs;
};

/// Finds all pairs of primitives that are within the margin of their bodies, and some that are not.
/// At least one body of each pair is composite; shapes that do not exist have no pairs. O(pairs of
/// bodies + pairs of primitives); each traversal is O(log n + found).
///
/// Tasks search fixed chunks of body pairs and write numbers to a shared arena. Then the results
/// are counted, and tasks for the same chunks write them to their final positions. Neither step
/// depends on the number of threads, nor does the order on the instruction set.
Status find_primitive_pairs(const CompositePool& pool, const ShapePool& shapes,
                            const Bodies& bodies, std::span<const BodyPair> pairs,
                            const PairMargins& margins, const Execution& execution,
                            PrimitivePairs& out);

/// Corrects the contacts of surfaces of triangles, so that they are those of the surface, not of
/// its single triangles: ghost contacts at internal edges are gone. Call it after the narrow phase
/// has computed `pairs` at level distance or manifold. `margins` are the margins of pairs of
/// primitives that the narrow phase used. Memory of `pairs` is used for scratch. `out_of_memory`
/// changes nothing.
///
/// A triangle touches with its face, an edge or a corner: its supporting feature along the contact
/// normal. The normal is valid if it is in the normal cone of the surface at the touched point: no
/// triangle around the point reaches farther along it (SurfaceCones). For two surfaces it must be
/// in the cones of both. All valid contacts of one convex piece of a surface have the same depth,
/// that of the piece. Other contacts are changed:
/// - If a valid contact of the same two bodies parts the primitives, too (both lie on their sides
/// of
///   its plane), they are dropped. If the face lies in that plane, the other shape is clipped along
///   the normal of the valid contact instead, so that a manifold spans all triangles of a flat
///   floor; only points over the triangle are kept.
/// - Else, if the shapes overlap, they get the normal and the depth of the convex patch of touched
///   triangles around them (ConvexPatch), if that normal is valid.
/// - Else they get the normal of the face, and overlapping shapes are clipped against the face. The
///   distance is kept if the deepest point is not over the triangle, or if its depth would exceed
///   kMaxDeeper times the largest depth of the contacts of the two bodies with the same kinds.
///   Spheres, and shapes that overlap only by their rounding, keep their distance; the point of a
///   sphere is moved to its deepest point along the new normal, so that the contact exerts no
///   torque. Contacts of two surfaces are left as they are.
///
/// Contacts whose normal points to the back of a one-sided triangle are not valid; if the shapes
/// are apart, they are dropped. So is the contact of a triangle that is touched from behind, if the
/// valid contact of a neighbour parts the bodies, and if the shapes are apart, any valid contact of
/// overlapping shapes. Parts of a compound that lie flush or overlap count as one shape.
///
/// O(answers of a pair of bodies squared) at worst; linear if all normals are those of faces.
Status correct_surface_contacts(const CollidedPairs& collided, PrimitivePairs& pairs,
                                const PairMargins& margins, const Execution& execution,
                                NarrowResult& result) noexcept;

/// Merges the manifolds of each pair of bodies within its margin into contact regions. The deepest
/// manifold (among equals, the first in `pairs`) and all manifolds whose normals are within 5
/// degrees of its normal (kRegionCosine) form the first region; the deepest remaining manifold
/// starts the next region, and so on. Each region keeps at most kManifoldPoints points: the deepest
/// one, and points that span the largest area. Candidates include vertices of contact polygons that
/// did not fit into the manifold of a single part. `invalid_argument` unless `answers` are the
/// results for `pairs` at level manifold. O(manifolds x regions of a pair of bodies). The result is
/// the same for any number of threads and any instruction set.
Status reduce_contacts(const ShapePool& shapes, const PrimitivePairs& pairs,
                       const NarrowResult& answers, const PairMargins& margins,
                       const Execution& execution, ContactRegions& out);

/// The form in which convex solids are visited.
enum class Solids : bool { hulls, triangles };

/// Visits every primitive whose box the moving box may hit, roughly in order of time. O(log n +
/// hits). Visits nothing if the shape does not exist, as do the functions below.
void visit(const CompositePool& pool, ShapeId id, const Pose& pose, const MovingBox& moving_box,
           Solids solids, const PrimitiveVisitor& visitor);
/// Finds the closest hit of each ray on a shape at t up to its limit, which is at most its max_t;
/// of equal t, the hit on the part with the smallest number. With `any`, finds any hit. A ray with
/// a negative limit hits nothing. Rays are valid. The closest hit of a ray does not depend on the
/// other rays; with `any`, the hit that is found may. `prepared` may be null; else a mesh is
/// prepared in it, unless it was by an earlier call.
void cast_rays(const CompositePool& pool, ShapeId id, const Pose& pose,
               std::span<const ShapeRay> rays, const double* limits, bool any, RaySurface* prepared,
               PartHit* hits);
/// Visits every primitive whose box may be within `limit` of the static box `from`, roughly nearest
/// first.
void visit_near(const CompositePool& pool, ShapeId id, const Pose& pose, const MovingBox& from,
                double limit, const PrimitiveVisitor& visitor);
/// Visits every pair of primitives of two meshes that may share a point. Returns false and visits
/// nothing unless both shapes are meshes.
bool visit_pairs(const CompositePool& pool, ShapeId a, const Pose& pose_a, ShapeId b,
                 const Pose& pose_b, const PrimitivePairVisitor& visitor);
/// Visits pairs of primitives of two meshes, roughly nearest first. Returns false and visits
/// nothing unless both shapes are meshes and the first one has a uniform scale.
bool visit_near_pairs(const CompositePool& pool, ShapeId a, const Pose& pose_a, ShapeId b,
                      const Pose& pose_b, double limit, const NearPairVisitor& visitor);

/// True for a solid that is not convex, and for a compound with such a child. Convex solids are
/// hulls, see Primitive::hull.
[[nodiscard]] bool has_solids(const CompositePool& pool, ShapeId id) noexcept;
/// True if a solid (see CompositePool::set_solid), or a solid child of a compound, contains a point
/// of the world.
[[nodiscard]] bool solid_contains_point(const CompositePool& pool, ShapeId id, const Pose& pose,
                                        const Vec3d& point) noexcept;
/// As above, for a point of another shape, convex or not: for a compound, one point of each child;
/// for a surface, one vertex. A connected shape whose surface does not intersect the surface of the
/// solid is inside entirely or not at all, so one point decides.
[[nodiscard]] bool solid_contains_shape(const CompositePool& pool, ShapeId id, const Pose& pose,
                                        ShapeId other, const Pose& other_pose) noexcept;

/// The functions above, and members of CompositePool. Scenes and queries call them by this table,
/// which each pool refers to, because a program without a pool then links none of them.
struct MidPhase {
  bool (*contains)(const CompositePool& pool, ShapeId id) noexcept;
  Aabb (*bounds)(const CompositePool& pool, ShapeId id, const Pose& pose) noexcept;
  double (*radius)(const CompositePool& pool, ShapeId id) noexcept;
  decltype(&mid::find_primitive_pairs) find_primitive_pairs;
  decltype(&mid::correct_surface_contacts) correct_surface_contacts;
  decltype(&mid::reduce_contacts) reduce_contacts;
  decltype(&mid::visit) visit;
  decltype(&mid::cast_rays) cast_rays;
  decltype(&mid::visit_near) visit_near;
  decltype(&mid::visit_pairs) visit_pairs;
  decltype(&mid::visit_near_pairs) visit_near_pairs;
  decltype(&mid::has_solids) has_solids;
  decltype(&mid::solid_contains_point) solid_contains_point;
  decltype(&mid::solid_contains_shape) solid_contains_shape;
};

/// Reads private members of a pool.
struct PoolAccess {
  /// Returns the functions for the shapes of a pool.
  [[nodiscard]] static const MidPhase& mid_phase(const CompositePool& pool) noexcept {
    return *pool.mid_phase_;
  }
  /// Returns the shapes of a pool; null if it never had one.
  [[nodiscard]] static const Composites* composites(const CompositePool& pool) noexcept {
    return pool.state_;
  }
};

}  // namespace mid
}  // namespace winnow
