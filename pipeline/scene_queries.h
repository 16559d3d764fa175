#pragma once

#include <winnow/core/export.h>
#include <winnow/core/filter.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/pair_events.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/mid_phase.h>
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

/// Where a ray or a moving shape meets a body.
struct SceneHit {
  Key key;              ///< the body; null if nothing was hit
  ClientData data = 0;  ///< that the body was added with
  /// Triangle or child; kWholeShape of a convex body.
  std::uint32_t part = kWholeShape;
  /// In units of the direction: of a ray, where it enters the body's shape; of a moving shape, the
  /// time of impact, never later than the true one.
  double t = 0.0;
  /// Unit, of the body's surface, against the motion. Of a shape that overlaps the body at its
  /// start, the direction in which it leaves it the soonest.
  double normal[3] = {0.0, 0.0, 0.0};
  /// Where they meet, in the world.
  double point[3] = {0.0, 0.0, 0.0};

  /// True if something was hit.
  [[nodiscard]] explicit operator bool() const noexcept { return key.id != kNoObject; }
};

/// Where a batch of rays that have one answer each writes them: columns of the caller, each null if
/// not wanted. A ray without an answer gets the null key, 0, kWholeShape, infinity and zeros.
struct SceneHitColumns {
  Key* key = nullptr;               ///< bodies
  ClientData* data = nullptr;       ///< what they were added with
  std::uint32_t* part = nullptr;    ///< triangles or children
  double* t = nullptr;              ///< infinity where nothing was hit
  std::array<double*, 3> normal{};  ///< x, y, z
  std::array<double*, 3> point{};   ///< x, y, z, in the world
};

/// The hits of ray i of a batch are hits[first[i]] to hits[first[i + 1]], that excluded.
struct SceneHitLists {
  std::span<const SceneHit> hits;      ///< of all rays, one after the other
  std::span<const std::size_t> first;  ///< one more than there are rays
};

/// A body that a shape overlaps.
struct SceneOverlap {
  Key key;              ///< the body
  ClientData data = 0;  ///< that the body was added with
  /// A part of it that does, the same each time.
  std::uint32_t part = kWholeShape;
};

/// Two points, and how far they are apart.
struct SceneDistance {
  /// The second body.
  Key key;
  ClientData data = 0;  ///< that the second body was added with
  /// The part of the first that is closest; kWholeShape of a point or a convex body.
  std::uint32_t part_a = kWholeShape;
  std::uint32_t part = kWholeShape;  ///< that of the second
  /// Negative by the depth of penetration; of composite shapes that of the deepest pair of parts.
  double distance = 0.0;
  double error_bound = 0.0;  ///< the true distance is within distance +- it
  /// Unit, from the first (or the point) to the second.
  double normal[3] = {0.0, 0.0, 0.0};
  double point_a[3] = {0.0, 0.0, 0.0};  ///< of the first, in the world
  double point_b[3] = {0.0, 0.0, 0.0};  ///< of the second, in the world

  /// True if there is a second body.
  [[nodiscard]] explicit operator bool() const noexcept { return key.id != kNoObject; }
};

/// Which pairs of bodies a question about two bodies or about sets of them takes.
enum class PairRules : std::uint8_t {
  /// Those of which `Scene::collide` would make a pair if their boxes met: one of the two is
  /// dynamic, their filters and their layers let them meet, they are not ignored, and the predicate
  /// accepts them. So two fixed bodies are no pair, nor are two that sleep.
  scene,
  none,  ///< any two bodies
};

/// The closest pair of two sets of bodies.
struct SetDistance {
  Key a;                  ///< of the first set; null if there is none
  ClientData data_a = 0;  ///< that it was added with
  SceneDistance to;       ///< from it to that of the second set

  /// True if there is such a pair.
  [[nodiscard]] explicit operator bool() const noexcept { return a.id != kNoObject; }
};

/// A shape of the scene's pools that moves along a line without turning.
struct ShapeCast {
  ShapeId shape;  ///< convex, a mesh, a height field or a compound; no half-space
  Pose pose;      ///< at t = 0
  /// By which it moves while t grows by 1; finite, not zero.
  double direction[3] = {1.0, 0.0, 0.0};
  double max_t = 1.0;  ///< finite, >= 0
  /// The shape meets what it touches at the start at t = 0. False: only if it gets deeper into it
  /// by more than the tolerance; if it slides along it or leaves it, the hit is with what it runs
  /// into later, which may be another part of the same body.
  bool touching = true;
};

/// A shape of the scene's pools that moves and turns.
struct MotionCast {
  ShapeId shape;       ///< convex, a mesh, a height field or a compound; no half-space
  RigidMotion motion;  ///< between two poses, or at velocities
  /// As ShapeCast has it.
  bool touching = true;
};

/// Questions to the exact shapes of a scene. One object per thread: it keeps scratch memory from
/// question to question, so that one that resembles an earlier one allocates nothing. Any number of
/// them may ask a scene at the same time while nothing changes it; call `Scene::refresh` first, and
/// after every change of bodies or of composite shapes in place, else questions are
/// `invalid_argument`. A refused question leaves its answer alone, but spans of earlier ones are
/// void.
class WINNOW_API SceneQueries {
 public:
  /// Asks `scene`, which must outlive this. Every allocation comes from `memory`, which must too;
  /// where its state is refused, questions are `out_of_memory`.
  explicit SceneQueries(const Scene& scene,
                        std::pmr::memory_resource* memory = default_memory()) noexcept;
  ~SceneQueries();
  SceneQueries(const SceneQueries&) = delete;
  SceneQueries& operator=(const SceneQueries&) = delete;

  // Rays: closed, errors as `cast_ray`'s. Equal t are ordered by the bodies' ids, then by part.

  /// The hit with the least t; a null hit if there is none.
  Status closest(const ShapeRay& ray, SceneHit& hit, const Filter& filter = {});
  /// Any one hit.
  Status any(const ShapeRay& ray, SceneHit& hit, const Filter& filter = {});
  /// The first hit of every body that the ray meets, sorted by t. Valid until the next question.
  Status all(const ShapeRay& ray, std::span<const SceneHit>& hits, const Filter& filter = {});
  /// The closest hit of each ray of a batch, answered as if it were alone. One bad ray refuses the
  /// batch.
  Status closest(const ShapeRayBatch& rays, const SceneHitColumns& hits, const Filter& filter = {});
  /// Any one hit of each ray of a batch; bad rays as above.
  Status any(const ShapeRayBatch& rays, const SceneHitColumns& hits, const Filter& filter = {});
  /// All hits of each ray of a batch, as lists; bad rays as above. Valid until the next question.
  Status all(const ShapeRayBatch& rays, SceneHitLists& hits, const Filter& filter = {});

  /// Every body that the shape at the pose shares a point with, sorted by id. The shape may be
  /// composite. Exact, as tier robust.
  Status overlap(ShapeId shape, const Pose& pose, std::span<const SceneOverlap>& bodies,
                 const Filter& filter = {});

  /// Where the moving shape first touches a body, by conservative advancement (Mirtich 1996): t is
  /// never later than the true time of impact and at most `tolerance` (a length along the path,
  /// finite, >= 0) earlier, or by what rounding makes of it: about 1e-14 of the sizes over the sine
  /// of the angle of impact, and 1e-15 of the path. Nothing is too thin to be hit. t = 0 if they
  /// overlap at the start (but see ShapeCast::touching). Of a composite shape that moves it is the
  /// first time of all its parts; it is asked part by part, those alone that what stands comes
  /// near. Half-spaces do not move: `unsupported`.
  Status closest(const ShapeCast& cast, SceneHit& hit, const Filter& filter = {},
                 double tolerance = 1e-6);
  /// The first hit of every body.
  Status all(const ShapeCast& cast, std::span<const SceneHit>& hits, const Filter& filter = {},
             double tolerance = 1e-6);

  /// Where the shape, which turns as it moves, first meets a body; t is the time in [0, 1], never
  /// later than the true one. The gap then is at most `tolerance`, a share of sizes as that of
  /// ImpactOptions, which see also for shapes that touch at the start or pass close by. Half-spaces
  /// do not move: `unsupported`; `invalid_pose` for a motion that is not valid. A way that runs
  /// across the axes is asked about in up to eight pieces, one after the other.
  Status closest(const MotionCast& cast, SceneHit& hit, const Filter& filter = {},
                 double tolerance = 1e-6);
  /// The first hit of every body, sorted by t. Valid until the next question.
  Status all(const MotionCast& cast, std::span<const SceneHit>& hits, const Filter& filter = {},
             double tolerance = 1e-6);

  // Two bodies, or sets of them. A key that is not of a live body is `invalid_key`; a limit that is
  // NaN, a margin below 0 or not finite and rules that are none are `invalid_argument`. A body is
  // not held against itself. Rules are asked about pairs whose boxes are near enough only.

  /// The closest (or deepest) points of two bodies; a null answer if the rules do not take them, or
  /// if they are farther apart than `limit`, which may be below zero, and is found out the sooner
  /// the less it is.
  Status distance(Key a, Key b, SceneDistance& answer,
                  double limit = std::numeric_limits<double>::infinity(),
                  PairRules rules = PairRules::scene);
  /// The two bodies of two sets that are the closest (or overlap the deepest), such as the links of
  /// a robot and what it works among, or these links twice; of equal ones those with the least ids.
  /// A null answer if the rules take no pair, or if all are farther apart than `limit`. O(a x b)
  /// gaps between boxes, and the exact distances of hardly more than one pair.
  Status least_distance(std::span<const Key> a, std::span<const Key> b, SetDistance& answer,
                        double limit = std::numeric_limits<double>::infinity(),
                        PairRules rules = PairRules::scene);
  /// Pairs (body of a, body of b) of two sets that share a point, in the order of the sets; at most
  /// `most` of them: 1 stops at the first one. O(a x b) gaps between boxes, and an exact test for
  /// each that is closed. Valid until the next question.
  Status overlaps(std::span<const Key> a, std::span<const Key> b, std::span<const KeyPair>& pairs,
                  std::size_t most = std::numeric_limits<std::size_t>::max(),
                  PairRules rules = PairRules::scene);
  /// Whether any body of one set touches one of another, or is no farther from it than `margin`; a
  /// null pair if none does. Stops at the first pair in the order of the sets, (body of a, body of
  /// b), which it answers. A set that is given twice, by one span, is held against itself, each
  /// pair once. O(a x b) gaps between boxes, and for each that is within the margin an exact test,
  /// with a margin also a distance.
  Status any_contact(std::span<const Key> a, std::span<const Key> b, KeyPair& pair,
                     double margin = 0.0, PairRules rules = PairRules::scene);
  /// Asks about the whole scene. Answers the body with the least id that has a contact (by the
  /// rules of the scene: of the dynamic ones), and of those that it touches the one with the least
  /// id. O(n log n), and a test for each pair of boxes within the margin up to there.
  Status any_contact(KeyPair& pair, double margin = 0.0, PairRules rules = PairRules::scene);
  /// The bodies nearest to a point, at most `count`, no farther than `radius`, sorted by distance;
  /// inside a solid the distance is negative.
  Status nearest(const double point[3], std::size_t count, double radius,
                 std::span<const SceneDistance>& bodies, const Filter& filter = {});

  /// All of it but results and scratch under `structure`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend struct SensorsState;

  std::pmr::memory_resource* memory_;
  /// Null where memory was refused: questions are `out_of_memory` then.
  QueryState* state_ = nullptr;
};

}  // namespace winnow
