// Interfaces of everything that is raced: winnow, and other libraries by the adapters in
// bench/peers. The harness times `start` and `frame`, or `run`, from outside, and calls all other
// functions outside its timers. All work that a user pays for (updates, rebuilds, sorting hits,
// removing duplicates and false candidates, copying results out of a callback) therefore belongs in
// these functions; converting shapes and poses to the types of an engine does not. All calls come
// from one thread, inside a `tbb::task_arena` of the thread count that the engine was made for.

#pragma once

#include <winnow/core/results.h>
#include <winnow/core/volumes.h>
#include <winnow/pipeline/shape_rays.h>
#include "bench/common/interface.h"
#include "bench/scenes/body_scenes.h"
#include "bench/scenes/moving_pairs.h"
#include "bench/scenes/query_set.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace winnow::bench {

/// Finds the pairs of boxes of a scene, frame by frame. An object is identified by its row, 0..N-1,
/// for the whole run; later frames may add rows.
class Engine : public NamedInterface {
 public:
  /// Number of objects above which a run takes unreasonably long. Larger scenes are skipped, and
  /// reported as skipped.
  [[nodiscard]] virtual std::size_t largest() const {
    return std::numeric_limits<std::size_t>::max();
  }

  /// True if it uses one thread, whatever number it was made for.
  [[nodiscard]] virtual bool is_serial() const { return false; }

  /// Frame 0: takes the boxes (row = index) and finds their pairs. Called once, before `frame`,
  /// `pairs`, `bytes` and `update_ms`.
  virtual void start(std::span<const Aabb> boxes) = 0;

  /// A later frame: updates the boxes and finds all pairs. `changed_rows` (ascending, unique, maybe
  /// empty) are the objects whose boxes differ from the last frame. `all_boxes` are the boxes of
  /// all objects, changed or not; rows that the last frame did not have are new objects. The spans
  /// are valid only during the call.
  virtual void frame(std::span<const std::uint32_t> changed_rows,
                     std::span<const Aabb> all_boxes) = 0;

  /// Pairs of rows that the last `start` or `frame` found: each unordered pair once, as (i, j) or
  /// (j, i), in any order. All overlapping pairs (closed boxes: touching is overlapping) must be
  /// included. Other pairs may be included; the harness filters them out and counts them as
  /// reported. Valid until the next non-const call.
  [[nodiscard]] virtual std::span<const Pair> pairs() const = 0;

  /// Bytes allocated now, without the pairs found; 0 if unavailable.
  [[nodiscard]] virtual std::size_t bytes() const = 0;

  /// Milliseconds that the last `start` or `frame` spent on updating boxes before the search for
  /// pairs; 0 if the update and the search cannot be separated.
  [[nodiscard]] virtual double update_ms() const { return 0.0; }
};

/// Queries are run by one call each, or by one call for many.
enum class QueryMode { single, batch };

/// Runs queries on boxes. An object is identified by its row, 0..N-1.
class QueryEngine : public NamedInterface {
 public:
  /// True if the engine supports these queries, single or batched.
  [[nodiscard]] virtual bool takes(const QuerySet& set, QueryMode mode) const = 0;

  /// Number of queries of a set that can be run in reasonable time.
  [[nodiscard]] virtual std::size_t most_questions() const {
    return std::numeric_limits<std::size_t>::max();
  }

  /// Takes the boxes (row = index) and prepares everything. Called once, before any query; `boxes`
  /// outlives the engine.
  virtual void start(std::span<const Aabb> boxes) = 0;

  /// Runs the first `count` queries of the set and returns the number of objects found. Results are
  /// written where a caller can read them, and overwritten by the next query or batch.
  virtual std::uint64_t run(const QuerySet& set, QueryMode mode, std::size_t count) = 0;

  /// Runs the queries and returns the results. Not timed; single queries run on one thread.
  [[nodiscard]] virtual QueryResults answers(const QuerySet& set, QueryMode mode,
                                             std::size_t count) = 0;
};

/// An engine's result for one pair. Members that the engine does not compute keep these defaults.
struct NarrowAnswer {
  bool overlap = false;
  std::uint32_t contacts = 0;
  /// Negative if the bodies overlap, by the penetration depth.
  double distance = std::numeric_limits<double>::quiet_NaN();
  /// NaN if the engine returns none.
  double error_bound = std::numeric_limits<double>::quiet_NaN();
  /// Unit length, from a to b; zero if the engine returns none.
  Vec3d normal{};
  /// A point on a, in world coordinates.
  Vec3d point{};
};

/// Computes contacts of pairs of bodies. Nothing is cached per pair between runs.
class NarrowEngine : public NamedInterface {
 public:
  /// True if the engine supports such pairs at the level.
  [[nodiscard]] virtual bool takes(const PairKind& kind, ContactLevel level) const = 0;
  /// Prepares everything. Called once, before any run; `set` outlives the engine.
  virtual void start(const PairSet& set) = 0;
  /// Computes some of the set's pairs.
  virtual void run(ContactLevel level, std::span<const BodyPair> pairs) = 0;
  /// Returns the result for pair i of the last run.
  [[nodiscard]] virtual NarrowAnswer answer(std::size_t i) const = 0;
  /// Share of the pairs of the last run that were computed a second time; NaN if unavailable.
  [[nodiscard]] virtual double recomputed() const {
    return std::numeric_limits<double>::quiet_NaN();
  }
};

/// The time of impact of a pair.
struct ImpactAnswer {
  bool hit = false;
  double time = 1.0;
};

/// Computes times of impact of pairs of moving bodies.
class ImpactEngine : public NamedInterface {
 public:
  /// True if the engine supports such pairs.
  [[nodiscard]] virtual bool takes(const PairKind& kind, PairTurn turn) const = 0;
  /// Prepares everything. Called once, before any run; `set` outlives the engine.
  virtual void start(const MovingPairSet& set) = 0;
  /// Computes some of the set's pairs.
  virtual void run(std::span<const BodyPair> pairs) = 0;
  /// Returns the result for pair i of the last run.
  [[nodiscard]] virtual ImpactAnswer answer(std::size_t i) const = 0;
};

/// The result of a ray query: the first hit on the mesh; whether there is any; or the first hit of
/// every body, sorted (a list of one, as there is one mesh).
enum class RayQueryType { closest, any, all };

/// Casts rays at one triangle mesh, on one thread.
class RayEngine : public NamedInterface {
 public:
  /// Prepares everything. Called once; `mesh` outlives the engine.
  virtual void start(const Triangles& mesh) = 0;
  /// Bytes of the mesh and its tree; 0 if unavailable.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  /// Stores the rays for the next `run`, converted to the engine's types.
  virtual void take(std::span<const ShapeRay> rays) = 0;
  /// Runs a query for each ray.
  virtual void run(RayQueryType query_type, QueryMode mode) = 0;
  /// Returns the ray parameter t of each ray's first hit in the last `run`, infinity without a hit.
  /// For RayQueryType::any a hit has t = 0.
  [[nodiscard]] virtual std::vector<double> hits() const = 0;
};

/// Number of contacts found in a frame. Reports show it beside the time, because an engine that
/// finds fewer contacts does less work.
struct SceneFinds {
  std::size_t touching = 0;  ///< touching pairs; the mesh counts as a body
  std::size_t points = 0;    ///< contact points
};

/// Finds the contacts of a scene, from poses to contact points.
class SceneEngine : public NamedInterface {
 public:
  /// True if it reuses contacts of the last frame, so that scenes at rest are cheaper.
  [[nodiscard]] virtual bool caches_contacts() const = 0;
  /// Prepares everything. Called once, before any frame; `set` outlives the engine.
  virtual void start(const BodySet& set) = 0;
  /// Sets the poses of all bodies and finds all contacts with their points.
  virtual void frame(std::span<const Pose> poses) = 0;
  /// Returns the numbers for the last frame.
  [[nodiscard]] virtual SceneFinds finds() const = 0;
  /// Bytes allocated in total after the last frame; 0 if unavailable.
  [[nodiscard]] virtual std::size_t bytes() const { return 0; }
};

/// Builds a triangle mesh and finds the triangles that overlap triangles of a copy.
class MeshEngine : public NamedInterface {
 public:
  using TrianglePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

  /// Builds the mesh anew.
  virtual void build(const Triangles& mesh) = 0;
  /// Bytes of the mesh and its tree.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  /// Finds all overlapping triangles, with contact points, for the mesh at two poses.
  virtual void collide(const Pose& a, const Pose& b) = 0;
  /// Returns the pairs of the last `collide`.
  [[nodiscard]] virtual TrianglePairs pairs() const = 0;
};

}  // namespace winnow::bench
