#pragma once

#include <winnow/core/export.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/core/vectors.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/scene.h>

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct ContinuousState;

/// Which pairs of bodies are tested. At least one body of a pair moves, and one is dynamic, as in
/// the scene itself.
enum class ContinuousPairs : std::uint8_t {
  all,                ///< all pairs
  fixed,              ///< all bodies against fixed bodies
  bullets,            ///< bullets against all bodies
  bullets_and_fixed,  ///< union of `fixed` and `bullets`
};

/// Options of `ContinuousCollision::find_impacts`.
struct ContinuousOptions {
  ContinuousPairs pairs = ContinuousPairs::all;  ///< which pairs are tested
  /// For each moving body, whether it is a bullet: 0 or 1. Empty if there are none.
  std::span<const std::uint8_t> bullets{};
  /// See ImpactOptions::tolerance.
  double tolerance = 1e-6;
  /// True: bodies that share a point at the start touch at time 0. False: such pairs are skipped,
  /// so that a body that rests on a floor reports what it hits.
  bool touching = true;
  /// True: finds only the first impact of each moving body, with identical results. Later impacts
  /// are then not computed.
  bool first_only = false;
};

/// An impact of two bodies.
struct SceneImpact {
  Key a;                               ///< body with the smaller id
  Key b;                               ///< body with the larger id
  ClientData data_a = 0;               ///< client data of a
  ClientData data_b = 0;               ///< client data of b
  std::uint32_t part_a = kWholeShape;  ///< triangle or child of a; kWholeShape for a convex body
  std::uint32_t part_b = kWholeShape;  ///< triangle or child of b; kWholeShape for a convex body
  double time = 0.0;                   ///< in [0, 1], never late: the two are apart before it
  double gap = 0.0;                    ///< see ImpactResult::gap
  double error_bound = 0.0;            ///< the true gap is within gap +- error_bound
  Vec3d normal{};                      ///< unit vector from a to b, at that time
  Vec3d point{};                       ///< contact point of a at that time, in the world
};

/// Index of no impact; see `ContinuousCollision::first`.
inline constexpr std::uint32_t kNoImpact = ~0U;

/// Counters of the last call of `find_impacts`; never timings.
struct ContinuousStatistics {
  std::uint64_t boxes = 0;       ///< boxes around paths of bodies, or around pieces of paths
  std::uint64_t body_pairs = 0;  ///< pairs whose boxes overlap at some time
};

/// Finds the times at which bodies of a scene touch while they move from one frame to the next
/// (continuous collision detection, CCD). It moves nothing in the scene; a scene without it pays
/// nothing.
///
///     winnow::ContinuousCollision ccd(scene);
///     ccd.find_impacts(keys, end_poses);
///     for (const winnow::SceneImpact& impact : ccd.impacts()) { ... }
///
/// Every body moves along its whole path: an impact does not stop it, and each impact is computed
/// as if there were no earlier ones. Filters, layers, ignored pairs and the predicate of the scene
/// apply as in `collide`. Results and their order are the same for any number of threads and any
/// instruction set. A failed call keeps the previous results.
class WINNOW_API ContinuousCollision {
 public:
  /// Works on `scene`, which must outlive this object. Every allocation comes from
  /// `memory`, which must also outlive it. If memory for the object itself is refused, calls return
  /// `out_of_memory`.
  explicit ContinuousCollision(Scene& scene,
                               std::pmr::memory_resource* memory = default_memory()) noexcept;
  ~ContinuousCollision();
  ContinuousCollision& operator=(ContinuousCollision&&) = delete;  // neither copied nor moved

  /// Moves bodies from their poses in the scene, which is refreshed first, to the given ends,
  /// along RigidMotion::between; without orientations they do not rotate. All other bodies are at
  /// rest. `size_mismatch`; `invalid_key`, also if a key occurs twice; `invalid_pose` for an end
  /// that is invalid or too far away; `invalid_argument` for invalid options; `out_of_memory`
  /// leaves no impacts. O(n log n) for n moving bodies, about log(all bodies) for each, and one
  /// `time_of_impact` for each pair whose boxes overlap. The boxes contain the whole path, rotation
  /// included; a path that is diagonal to the axes gets up to eight boxes. If most moving bodies
  /// travel together, their common displacement is subtracted before they are tested against each
  /// other.
  Status find_impacts(std::span<const Key> keys, const PoseView& ends,
                      const ContinuousOptions& options = {});
  /// As above, for any motions, such as from velocities. Each body starts at the start of its
  /// motion.
  Status find_impacts(std::span<const Key> keys, std::span<const RigidMotion> motions,
                      const ContinuousOptions& options = {});

  /// Returns the first impact of each pair (with `first_only`, only impacts that are the first of a
  /// moving body), sorted by time, then by the ids of a and b.
  [[nodiscard]] std::span<const SceneImpact> impacts() const noexcept;
  /// Returns, for each moving body in the order of the keys, the index of its first impact, or
  /// kNoImpact.
  [[nodiscard]] std::span<const std::uint32_t> first() const noexcept;

  /// Returns the counters of the last call of `find_impacts`.
  [[nodiscard]] ContinuousStatistics statistics() const noexcept;
  /// Returns the bytes of impacts under `results`, the rest under `scratch` and `structure`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  std::pmr::memory_resource* memory_;
  /// Null if memory was refused.
  ContinuousState* state_;
};

}  // namespace winnow
