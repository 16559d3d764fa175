#pragma once

// The state of a ContinuousCollision. continuous_collision.cpp drives it: continuous_candidates.cpp
// computes boxes of the moving bodies' paths and finds candidate pairs, continuous_impacts.cpp
// finds their first impacts.

#include <winnow/core/memory.h>
#include <winnow/core/pose.h>
#include <winnow/partitions/partition.h>
#include <winnow/pipeline/continuous_collision.h>
#include "core/sort/parallel_ranges.h"
#include "pipeline/motion/body_impact.h"
#include "pipeline/motion/relative_motion_bounds.h"
#include "pipeline/scene/moving_balls.h"
#include "pipeline/scene/scene_state.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

inline constexpr std::uint32_t kNoMover = ~0U;
inline constexpr std::size_t kMoversPerRange = 64;

/// Part `index` of the `count` equal intervals of time into which a body's path is split; each part
/// has its own box.
struct PathPiece {
  std::uint32_t mover;
  std::uint8_t index;
  std::uint8_t count;
  BodyState body_state;
  bool bullet;

  /// True if the two time intervals overlap.
  [[nodiscard]] bool overlaps(const PathPiece& other) const noexcept {
    return index * other.count <= (other.index + 1) * count &&
           other.index * count <= (index + 1) * other.count;
  }
};

/// A candidate pair and the latest time at which its impact still matters.
struct CandidatePair {
  std::uint32_t candidate;
  double until;
};

/// An impact: its index in `ContinuousState::found` and its candidate pair.
struct FoundImpact {
  double time;
  std::uint32_t candidate;
  std::uint32_t at;
};

/// State of a call that its steps share.
struct ContinuousState {
  ContinuousState(SceneState& its_state, std::pmr::memory_resource* memory) noexcept
      : bodies(its_state),
        parts(its_state.shapes, its_state.options.composites),
        ways(linear_bvh(), {.memory = memory, .execution = its_state.options.execution}),
        motions(memory),
        movers(memory),
        balls(memory),
        mover_of(memory),
        along_axis(memory),
        first_piece(memory),
        boxes(memory),
        piece_keys(memory),
        pieces(memory),
        pairs(memory),
        candidates(memory),
        spare(memory),
        chances(memory),
        round(memory),
        listed(memory),
        answers(memory),
        hits(memory),
        found(memory),
        first_time(memory),
        order(memory),
        impacts(memory),
        first(memory) {}

  [[nodiscard]] Status take(std::span<const Key> keys, const PoseView& ends) noexcept;
  [[nodiscard]] Status take(std::span<const Key> keys, std::span<const RigidMotion> given) noexcept;
  [[nodiscard]] Status find_pairs(const ContinuousOptions& options);
  [[nodiscard]] Status find_all(const ContinuousOptions& options);
  [[nodiscard]] Status find_first(const ContinuousOptions& options);
  [[nodiscard]] bool show_impacts() noexcept;
  void forget() noexcept {
    impacts.clear();
    std::fill(first.begin(), first.end(), kNoImpact);
  }

  SceneState& bodies;
  SubShapeQuery parts;
  Partition ways;
  /// By mover: its motion, its body and its bounding ball. By body: its mover, or kNoMover.
  Column<RigidMotion> motions;
  Column<std::uint32_t> movers;
  Column<MovingBall> balls;
  Column<std::uint32_t> mover_of;
  /// Number of moving bodies by BodyState.
  std::array<std::size_t, kBodyStates> movers_in{};
  /// Translation of the reference frame in which path boxes are computed; and scratch for its
  /// choice: the movers' travel along one axis.
  Eigen::Vector3d drift = Eigen::Vector3d::Zero();
  Column<double> along_axis;
  /// Index of each mover's first box, and one past the end.
  Column<std::uint32_t> first_piece;
  Column<PlainBox> boxes;
  Column<Key> piece_keys;
  /// By object id of `ways`.
  Column<PathPiece> pieces;
  PairBuffer pairs;
  /// Pairs of bodies as (smaller id << 32 | larger id), sorted.
  Column<std::uint64_t> candidates;
  Column<std::uint64_t> spare;
  /// Candidates whose balls overlap at some time, as (time << 32 | candidate), sorted; the time is
  /// a number of time steps (see kTimeSteps).
  Column<std::uint64_t> chances;
  /// The pairs of a round: `round` is sorted by the kinds of their shapes, `listed` by their order
  /// in `chances`.
  Column<CandidatePair> round;
  Column<CandidatePair> listed;
  Column<impact::BodyImpact> answers;
  /// By result: 1 if there is an impact. Results whose flag is 0 are not written.
  Column<std::uint8_t> hits;
  /// First impacts by candidate (find_all) or by mover (find_first); and the time of a mover's
  /// first impact.
  Column<impact::BodyImpact> found;
  Column<double> first_time;
  /// The impacts to be returned, sorted.
  Column<FoundImpact> order;
  Column<SceneImpact> impacts;
  Column<std::uint32_t> first;
  ContinuousStatistics statistics;

 private:
  /// Calls body(mover) in parallel for every mover that has a motion.
  template <typename Body>
  void for_movers(Body&& body) const {
    for_each_range(bodies.options.execution, motions.size(), kMoversPerRange,
                   [&](std::size_t begin, std::size_t end) {
                     for (std::size_t mover = begin; mover < end; ++mover) body(mover);
                   });
  }
  [[nodiscard]] MovingBall ball_of(const RigidMotion& motion, std::uint32_t body) const noexcept {
    const Vec3d& at = motion.start.position;
    const Vec3d& way = motion.travel;
    return {{at[0], at[1], at[2]}, {way[0], way[1], way[2]}, bodies.radius(body)};
  }
  [[nodiscard]] std::array<std::uint32_t, 2> bodies_of(std::size_t candidate) const noexcept {
    return {static_cast<std::uint32_t>(candidates[candidate] >> 32U),
            static_cast<std::uint32_t>(candidates[candidate])};
  }

  // Boxes and candidates (continuous_candidates.cpp).

  [[nodiscard]] Status take_bodies(std::span<const Key> keys) noexcept;
  [[nodiscard]] bool choose_drift() noexcept;
  /// Reference frame of the path boxes.
  [[nodiscard]] RigidMotion frame() const noexcept {
    const Eigen::Vector3d& at = bodies.origin;
    RigidMotion frame = RigidMotion::stationary(Pose::at(at.x(), at.y(), at.z()));
    as_eigen(frame.travel) = drift;
    return frame;
  }
  [[nodiscard]] impact::MovingShape path_of(std::size_t mover) const noexcept {
    const double radius = balls[mover].radius;
    return {{bodies.shape[movers[mover]], {}}, motions[mover], radius, radius, 0.0};
  }
  [[nodiscard]] bool count_pieces() noexcept;
  void box_path(std::uint32_t mover) noexcept;
  [[nodiscard]] Status box_paths(const ContinuousOptions& options);
  void name_pieces(std::uint32_t mover, const ContinuousOptions& options) noexcept;
  [[nodiscard]] Status set_filters();
  template <typename Body>
  [[nodiscard]] Status collect(Body&& second_body);
  [[nodiscard]] bool sort_candidates() noexcept;
  [[nodiscard]] Status find_pairs_among(const ContinuousOptions& options);
  [[nodiscard]] bool is_included(BodyState body_state,
                                 const ContinuousOptions& options) const noexcept;
  [[nodiscard]] Status find_pairs_with(BodyState body_state, const ContinuousOptions& options);

  // Impacts of candidates (continuous_impacts.cpp).

  /// Returns the ball of a body; for a body that does not move it is computed into `room`.
  [[nodiscard]] const MovingBall& ball_of(std::uint32_t body, MovingBall& room) const noexcept {
    const std::uint32_t mover = mover_of[body];
    if (mover != kNoMover) return balls[mover];
    return room = ball_of(RigidMotion::stationary(bodies.pose[body]), body);
  }
  /// Prefetches the ball of the second body. The first body is mostly the same as in the candidate
  /// before.
  void fetch_ball(std::size_t candidate) const noexcept {
    const std::uint32_t mover = mover_of[bodies_of(candidate)[1]];
    if (mover != kNoMover) __builtin_prefetch(&balls[mover]);
  }
  /// Relative motion of two balls, which are enlarged by the factor 1 + `tolerance`.
  [[nodiscard]] Approach approach_of(std::uint32_t a, std::uint32_t b,
                                     double tolerance) const noexcept;
  [[nodiscard]] std::uint64_t chance_of(std::size_t candidate, double tolerance) const noexcept;
  [[nodiscard]] Status list_chances(double tolerance);
  [[nodiscard]] bool list_round(std::size_t& at) noexcept;
  [[nodiscard]] bool sort_round() noexcept;
  void find_impacts(std::span<const CandidatePair> requested, const ContinuousOptions& options,
                    impact::BodyImpact* impacts_of, std::uint8_t* hits_of) const noexcept;
  void keep_first(std::uint32_t candidate, const impact::BodyImpact& impact) noexcept;
  [[nodiscard]] RigidMotion motion_of(std::uint32_t body) const noexcept {
    const std::uint32_t mover = mover_of[body];
    return mover == kNoMover ? RigidMotion::stationary(bodies.pose[body]) : motions[mover];
  }
  [[nodiscard]] SceneImpact shown(std::uint64_t candidate,
                                  const impact::BodyImpact& impact) const noexcept;
};

}  // namespace winnow
