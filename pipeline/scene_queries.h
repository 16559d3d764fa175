#pragma once

// Rays, casts, overlaps, distances and nearest bodies in a Scene. The partitions of the scene find
// candidates by their boxes; exact shapes decide. The implementation is in scene/queries/.

#include <winnow/core/export.h>
#include <winnow/core/filter.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include <winnow/core/pose.h>
#include <winnow/core/results.h>
#include <winnow/core/status.h>
#include <winnow/core/vectors.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/shape_rays.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <span>

namespace winnow {

struct QueryState;

/// Hit of a ray or a moving shape on a body.
struct SceneHit {
  Key key;              ///< the body; the null key if nothing was hit
  ClientData data = 0;  ///< client data of the body
  /// Triangle or child that is hit; kWholeShape for a convex body.
  std::uint32_t part = kWholeShape;
  /// Parameter of the hit, in units of the direction. For a ray: where it enters the body's shape,
  /// or its min_t if it starts inside.
  /// For a moving shape: the time of impact, never later than the true one.
  double t = 0.0;
  /// Unit normal of the body's surface, against the motion. If a moving shape overlaps the body at
  /// the start: the direction of the shortest way out.
  Vec3d normal{};
  /// Point of contact, in the world.
  Vec3d point{};

  /// True if there is a hit.
  [[nodiscard]] explicit operator bool() const noexcept { return key.id != kNoObject; }
};

/// Output columns of a batch of rays with one hit per ray, in the caller's memory. Null columns are
/// not written. A ray without a hit gets the null key, client data 0, kWholeShape, t = infinity and
/// zeros.
struct SceneHitColumns {
  Key* key = nullptr;               ///< bodies
  ClientData* data = nullptr;       ///< client data of the bodies
  std::uint32_t* part = nullptr;    ///< triangles or children that are hit
  double* t = nullptr;              ///< infinity if the ray hits nothing
  std::array<double*, 3> normal{};  ///< x, y, z
  std::array<double*, 3> point{};   ///< x, y, z, in the world
};

/// Hits of a batch of rays: hits [first[i], first[i + 1]) are the hits of ray i.
struct SceneHitLists {
  std::span<const SceneHit> hits;      ///< hits of all rays, in the order of the rays
  std::span<const std::size_t> first;  ///< number of rays + 1 entries
};

/// A point at which a ray crosses the surface of a body.
struct SceneCrossing {
  Key key{};            ///< the body
  ClientData data = 0;  ///< client data of the body
  /// Triangle or child that is crossed; kWholeShape for a convex body.
  std::uint32_t part = kWholeShape;
  double t = 0.0;  ///< parameter of the point, in units of the direction
  /// True if the ray leaves a convex shape there, or comes from the back of a triangle, from which
  /// its corners are clockwise.
  bool exits = false;
  /// Unit normal that points out of a convex shape, or away from the front of a triangle.
  Vec3d normal{};
  Vec3d point{};  ///< in the world
  /// Weights of the corners of a triangle of a mesh or field, to interpolate values of its
  /// vertices; their sum is 1. Zero for convex shapes.
  Vec3d barycentric{};
};

/// A body that overlaps the query shape.
struct SceneOverlap {
  Key key;              ///< the body
  ClientData data = 0;  ///< client data of the body
  /// One of its parts that overlap, the same one in each run.
  std::uint32_t part = kWholeShape;
};

/// Closest points of two bodies, or of a point and a body, and their distance.
struct SceneDistance {
  /// Key of the second body.
  Key key;
  ClientData data = 0;  ///< client data of the second body
  /// Closest part of the first body; kWholeShape for a point or a convex body.
  std::uint32_t part_a = kWholeShape;
  std::uint32_t part = kWholeShape;  ///< closest part of the second body
  /// Signed distance: minus the penetration depth if the bodies overlap. For composite shapes, the
  /// depth of the deepest pair of parts; for solids, of the bodies, see CompositePool::set_solid.
  double distance = 0.0;
  double error_bound = 0.0;  ///< the true distance is within distance +- error_bound
  /// Unit vector from the first body (or the point) to the second body.
  Vec3d normal{};
  Vec3d point_a{};  ///< closest point of the first body, in the world
  Vec3d point_b{};  ///< closest point of the second body, in the world

  /// True if a second body was found.
  [[nodiscard]] explicit operator bool() const noexcept { return key.id != kNoObject; }
};

/// Which pairs of bodies a query for two bodies, or for sets of bodies, considers.
enum class PairRules : std::uint8_t {
  /// The pairs that `Scene::collide` would generate if their boxes overlapped: one of the two is
  /// dynamic, their filters and layers let them collide, they are not ignored, and the predicate
  /// accepts them. Two fixed or two sleeping bodies are thus never a pair.
  scene,
  none,  ///< all pairs
};

/// Closest pair of bodies of two sets.
struct SetDistance {
  Key a;                  ///< body of the first set; the null key if no pair was found
  ClientData data_a = 0;  ///< client data of `a`
  SceneDistance to;       ///< distance from `a` to the body of the second set

  /// True if a pair was found.
  [[nodiscard]] explicit operator bool() const noexcept { return a.id != kNoObject; }
};

/// A shape of the scene's pools that moves along a line without rotation (shape cast).
struct ShapeCast {
  ShapeId shape;  ///< convex, mesh, height field or compound; not a half-space
  Pose pose;      ///< pose at t = 0
  /// Displacement per unit of t; finite, not zero.
  Vec3d direction = {1.0, 0.0, 0.0};
  double max_t = 1.0;  ///< finite, >= 0
  /// True: a body that touches the shape at the start is hit at t = 0. False: it is hit at t = 0
  /// only if the motion increases the penetration by more than the tolerance. If the shape slides
  /// along such a body or leaves it, the hit is with whatever it hits later, possibly another part
  /// of the same body.
  bool touching = true;
};

/// A shape of the scene's pools that translates and rotates (motion cast).
struct MotionCast {
  ShapeId shape;       ///< convex, mesh, height field or compound; not a half-space
  RigidMotion motion;  ///< from one pose to another, or at constant velocities
  /// See ShapeCast::touching.
  bool touching = true;
};

/// Queries against the exact shapes of a scene. Use one object per thread: it keeps scratch memory
/// between queries, so that a query with no more candidates and results than an earlier one
/// allocates nothing. Any number of these objects may query a scene at the same time while nothing
/// changes the scene. Call `Scene::refresh` first, and again after every change of bodies and every
/// in-place change of composite shapes; otherwise queries return `invalid_argument`. A failed query
/// changes nothing (but see batches of rays). Lists are valid until the next query.
class WINNOW_API SceneQueries {
 public:
  /// Creates queries on `scene`, which must outlive this object. Every allocation comes from
  /// `memory`, which must also outlive it. If memory for the object itself is refused, queries
  /// return `out_of_memory`.
  explicit SceneQueries(const Scene& scene,
                        std::pmr::memory_resource* memory = default_memory()) noexcept;
  explicit SceneQueries(Scene&& scene, std::pmr::memory_resource* memory = nullptr) = delete;
  ~SceneQueries();
  SceneQueries(const SceneQueries&) = delete;
  SceneQueries& operator=(const SceneQueries&) = delete;

  // Rays. Shapes are closed sets; errors are as for `cast_ray`. Hits of equal t are ordered by
  // body id, then by part.

  /// Finds the hit of least t; a null hit if there is none.
  Answer<SceneHit> closest(const ShapeRay& ray, const SceneFilter& filter = {});
  /// Finds any one hit; a null hit if there is none.
  Answer<SceneHit> any(const ShapeRay& ray, const SceneFilter& filter = {});
  /// Finds the first hit on every body that the ray hits, sorted by t.
  Answer<std::span<const SceneHit>> all(const ShapeRay& ray, const SceneFilter& filter = {});
  /// Finds the hit of least t of each ray; results equal the single query. One invalid ray makes
  /// any call with a batch fail. If memory is refused, some rays' columns may have been written.
  Status closest(const ShapeRayBatch& rays, const SceneHitColumns& hits,
                 const SceneFilter& filter = {});
  /// Finds any one hit of each ray.
  Status any(const ShapeRayBatch& rays, const SceneHitColumns& hits,
             const SceneFilter& filter = {});
  /// Finds the first hit on every body that each ray hits, as lists.
  Answer<SceneHitLists> all(const ShapeRayBatch& rays, const SceneFilter& filter = {});

  /// Finds every point at which the ray crosses the surface of a body, sorted by t, then by body id
  /// and part: where it enters and leaves convex shapes, and each triangle of a mesh or field, from
  /// either side (one-sided or not). A ray that starts in a convex shape only leaves it. A ray
  /// through an edge or a corner crosses each of the triangles there. Exits have the errors of
  /// entries; see `cast_ray`. Errors are as for `all`.
  Answer<std::span<const SceneCrossing>> crossings(const ShapeRay& ray,
                                                   const SceneFilter& filter = {});

  /// Finds every body that shares a point with the shape at this pose, sorted by id. The shape may
  /// be composite. The test is exact, as in NarrowTier::robust.
  Answer<std::span<const SceneOverlap>> overlap(ShapeId shape, const Pose& pose,
                                                const SceneFilter& filter = {});
  /// Finds every body within distance `limit` of the shape at this pose (finite; 0 finds the bodies
  /// that overlap it, with their depths), sorted by distance, then by id. The answers are those of
  /// `distance`, with the shape as the first body.
  Answer<std::span<const SceneDistance>> distances(ShapeId shape, const Pose& pose,
                                                   double limit = 0.0,
                                                   const SceneFilter& filter = {});

  /// Finds the first body that the moving shape touches, by conservative advancement (Mirtich
  /// 1996). The returned t is never later than the true time of impact, and earlier by at most
  /// `tolerance` (a length along the path, finite, >= 0) plus rounding: about 1e-14 of the sizes
  /// divided by the sine of the angle of impact, and 1e-15 of the path. No shape is too thin to be
  /// hit. t = 0 if the shapes overlap at the start (but see ShapeCast::touching). For a composite
  /// moving shape, t is the first time over its parts; only parts whose boxes the other body
  /// reaches are tested. `unsupported` for a half-space.
  Answer<SceneHit> closest(const ShapeCast& cast, const SceneFilter& filter = {},
                           double tolerance = 1e-6);
  /// Finds the first hit on every body, sorted by t.
  Answer<std::span<const SceneHit>> all(const ShapeCast& cast, const SceneFilter& filter = {},
                                        double tolerance = 1e-6);

  /// Finds the first body that the shape touches while it translates and rotates; t is a time in
  /// [0, 1], never later than the true one. At that time the gap is at most `tolerance`, relative
  /// to the size of the shapes as in ImpactOptions; ImpactOptions also covers shapes that touch at
  /// the start or pass close by. A path that is diagonal to the axes is queried in up to eight
  /// pieces. `unsupported` for a half-space; `invalid_pose` for an invalid motion.
  Answer<SceneHit> closest(const MotionCast& cast, const SceneFilter& filter = {},
                           double tolerance = 1e-6);
  /// Finds the first hit on every body, sorted by t.
  Answer<std::span<const SceneHit>> all(const MotionCast& cast, const SceneFilter& filter = {},
                                        double tolerance = 1e-6);

  // Two bodies, or sets of bodies. `invalid_key` if a key is not of a live body; `invalid_argument`
  // for a limit that is NaN, a contact margin that is negative or not finite, or an invalid
  // `rules`. In sets, a body is never paired with itself. For sets, the rules are tested only for
  // pairs whose boxes are within the limit or margin.

  /// Finds the closest (or deepest) points of two bodies. A null answer if the rules exclude the
  /// pair, or if the distance exceeds `limit`. The limit may be negative; the smaller it is, the
  /// sooner a pair is rejected.
  Answer<SceneDistance> distance(Key a, Key b,
                                 double limit = std::numeric_limits<double>::infinity(),
                                 PairRules rules = PairRules::scene);
  /// Finds the two bodies of two sets that are closest (or overlap the deepest), such as the links
  /// of a robot against its surroundings or against each other (the same set twice). Among equal
  /// distances, the pair with the least ids is returned. A null answer if the rules exclude all
  /// pairs, or if all distances exceed `limit`. O(a x b) gaps between boxes, and exact distances
  /// only for pairs whose boxes are not farther apart than the closest pair found so far.
  Answer<SetDistance> least_distance(std::span<const Key> a, std::span<const Key> b,
                                     double limit = std::numeric_limits<double>::infinity(),
                                     PairRules rules = PairRules::scene);
  /// Finds the pairs (body of a, body of b) that share a point, in the order of the sets, at most
  /// `most` of them: with 1 the search stops at the first pair. O(a x b) gaps between boxes, and an
  /// exact test for each gap of 0.
  Answer<std::span<const KeyPair>> overlaps(
      std::span<const Key> a, std::span<const Key> b,
      std::size_t most = std::numeric_limits<std::size_t>::max(),
      PairRules rules = PairRules::scene);
  /// Finds out if any body of one set touches a body of the other set, or is within
  /// `contact_margin` of one; a null pair if not. Returns the first such pair (body of a, body of
  /// b) in the order of the sets and stops there. If both spans are the same, each pair of the set
  /// is tested once. O(a x b) gaps between boxes; for each gap within the margin an exact overlap
  /// test and, if the margin is above 0, a distance.
  Answer<KeyPair> any_contact(std::span<const Key> a, std::span<const Key> b,
                              double contact_margin = 0.0, PairRules rules = PairRules::scene);
  /// Finds out if any body of the scene has a contact. Returns the body with the least id that has
  /// one (under PairRules::scene, among the dynamic bodies) and, of the bodies that it touches, the
  /// one with the least id. O(n log n), and a test for each pair of boxes within the margin until
  /// the first contact is found.
  Answer<KeyPair> any_contact(double contact_margin = 0.0, PairRules rules = PairRules::scene);
  /// Finds the bodies nearest to a point, at most `count`, within distance `radius`, sorted by
  /// distance. Inside a solid the distance is negative.
  Answer<std::span<const SceneDistance>> nearest(const Vec3d& point, std::size_t count,
                                                 double radius, const SceneFilter& filter = {});

  /// Returns the bytes of results and scratch; all others under `structure`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  std::pmr::memory_resource* memory_;
  /// Null if memory was refused; queries then return `out_of_memory`.
  QueryState* state_ = nullptr;
};

}  // namespace winnow
