#pragma once

#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/pose_view.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/mid_phase.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/scene.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct SweepState;

/// Which pairs of bodies, of which one moves, are looked at. As in the scene itself one of them is
/// dynamic.
enum class SweepPairs : std::uint8_t {
  all,                ///< all against all
  fixed,              ///< everything against fixed bodies
  bullets,            ///< bullets against everything
  bullets_and_fixed,  ///< both of these
};

/// How a scene is swept.
struct SweepOptions {
  SweepPairs pairs = SweepPairs::all;  ///< which of them
  /// By moving body, whether it is a bullet: 0 or 1. Empty if none is.
  std::span<const std::uint8_t> bullets{};
  /// As ImpactOptions have it.
  double tolerance = 1e-6;
  /// Bodies that share a point at the start meet at time 0. False: they are left out, so that what
  /// rests on a floor is told what it runs into.
  bool touching = true;
  /// Only the first impact of each moving body is looked for, the same to the bit: several times as
  /// fast where ways are long and much is in them.
  bool first_only = false;
};

/// Two bodies that meet.
struct SceneImpact {
  Key a;                               ///< the body with the smaller id
  Key b;                               ///< the other
  ClientData data_a = 0;               ///< that a was added with
  ClientData data_b = 0;               ///< that b was added with
  std::uint32_t part_a = kWholeShape;  ///< triangle or child of a; kWholeShape of a convex body
  std::uint32_t part_b = kWholeShape;  ///< the same of b
  double time = 0.0;                   ///< in [0, 1], never late: before it the two are apart
  double gap = 0.0;                    ///< as ImpactResult has it
  double error_bound = 0.0;            ///< of the gap
  double normal[3] = {0.0, 0.0, 0.0};  ///< unit, from a to b, at that time
  double point[3] = {0.0, 0.0, 0.0};   ///< of a at that time, in the world
};

/// No impact: see `SceneSweep::first`.
inline constexpr std::uint32_t kNoImpact = ~0U;

/// What the last sweep looked at; counters, never timings.
struct SweepStatistics {
  std::uint64_t boxes = 0;       ///< around ways of bodies, or parts of these
  std::uint64_t body_pairs = 0;  ///< whose boxes meet at some time
};

/// When bodies of a scene that move between two frames meet each other and what stands: what no
/// look at single moments finds. Nothing of the scene is moved, and one without a sweep pays
/// nothing.
///
///     winnow::SceneSweep sweep(scene);
///     sweep.sweep(keys, end_poses);
///     for (const winnow::SceneImpact& impact : sweep.impacts()) { ... }
///
/// Every body goes its whole way, whatever it meets: an impact is one of two bodies that meet
/// nothing before. Filters, ignored pairs and the predicate of the scene count as in `collide`.
/// Answers and their order are the same on any number of threads and any instruction set. A refused
/// call leaves the answers of the one before.
class WINNOW_API SceneSweep {
 public:
  /// Looks at bodies of `scene`, which must outlive this. Every allocation comes from `memory`,
  /// which must too; where its state is refused, calls are `out_of_memory`.
  explicit SceneSweep(Scene& scene, std::pmr::memory_resource* memory = default_memory()) noexcept;
  ~SceneSweep();
  SceneSweep(const SceneSweep&) = delete;
  SceneSweep& operator=(const SceneSweep&) = delete;

  /// The bodies move from where they are in the scene, which this refreshes, to their ends as
  /// RigidMotion::between has it; without orientations they do not turn. All others stand.
  /// `size_mismatch`, `invalid_key` (also for a key that occurs twice), `invalid_pose` for an end
  /// that is none or too far away, `invalid_argument` for bad options; `out_of_memory` leaves no
  /// impacts. O(n log n) of the moving bodies, about log n of all for each, and `time_of_impact`
  /// for each pair whose boxes meet. The boxes contain all of the way, turning included; a way that
  /// runs across the axes is boxed in up to eight pieces. What most of the moving bodies have in
  /// common of their ways is left out where these are held against each other.
  Status sweep(std::span<const Key> keys, const PoseView& ends, const SweepOptions& options = {});
  /// The same of any motions, such as those of given velocities; each starts where it says.
  Status sweep(std::span<const Key> keys, std::span<const RigidMotion> motions,
               const SweepOptions& options = {});

  /// The first impact of each pair, or those that are the first one of a moving body, by time, then
  /// by the ids of a and b.
  [[nodiscard]] std::span<const SceneImpact> impacts() const noexcept;
  /// By moving body, in the order of the keys, the number of its first impact; kNoImpact.
  [[nodiscard]] std::span<const std::uint32_t> first() const noexcept;

  /// Of the last sweep.
  [[nodiscard]] SweepStatistics statistics() const noexcept;
  /// Impacts under `results`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  /// Both kinds of sweeps, once `take` has taken over the motions.
  template <typename Take>
  Status run(std::span<const Key> keys, const SweepOptions& options, Take&& take);

  std::pmr::memory_resource* memory_;
  /// Null where memory was refused.
  SweepState* state_;
};

}  // namespace winnow
