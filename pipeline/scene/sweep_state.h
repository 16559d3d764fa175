#pragma once

#include <winnow/core/column.h>
#include <winnow/core/pose.h>
#include <winnow/partitions/partition.h>
#include <winnow/pipeline/scene_sweep.h>
#include "core/sort/stretches.h"
#include "pipeline/motion/body_impact.h"
#include "pipeline/motion/passage.h"
#include "pipeline/scene/scene_state.h"
#include "pipeline/scene/swept_balls.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

inline constexpr std::uint32_t kNoMover = ~0U;
inline constexpr std::size_t kMoversPerStretch = 64;

/// Part `index` of `count` equal ones of the way of a body, in time, which has a box of its own.
struct WayPiece {
  std::uint32_t mover;
  std::uint8_t index;
  std::uint8_t count;
  Motion motion;
  bool bullet;

  /// Whether the two have a moment in common.
  [[nodiscard]] bool meets(const WayPiece& other) const noexcept {
    return index * other.count <= (other.index + 1) * count &&
           other.index * count <= (index + 1) * other.count;
  }
};

/// A candidate, and until when its impact is wanted.
struct SweptPair {
  std::uint32_t candidate;
  double until;
};

/// Where the impact of a candidate is in `SweepState::found`.
struct FoundImpact {
  double time;
  std::uint32_t candidate;
  std::uint32_t at;
};

/// What a sweep holds between its steps: of `swept_ways.cpp`, which puts boxes around ways and
/// finds the candidates, and of `swept_impacts.cpp`, which finds their impacts.
struct SweepState {
  SweepState(Scene& swept_scene, SceneState& its_state, std::pmr::memory_resource* memory) noexcept
      : scene(swept_scene),
        bodies(its_state),
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
  [[nodiscard]] Status find_pairs(const SweepOptions& options);
  [[nodiscard]] Status find_all(const SweepOptions& options);
  [[nodiscard]] Status find_first(const SweepOptions& options);
  [[nodiscard]] bool show_impacts() noexcept;
  void forget() noexcept {
    impacts.clear();
    std::fill(first.begin(), first.end(), kNoImpact);
  }

  Scene& scene;
  SceneState& bodies;
  PartTraversal parts;
  Partition ways;
  /// By mover: its motion, which body it is and the ball around it; by body, which mover.
  Column<RigidMotion> motions;
  Column<std::uint32_t> movers;
  Column<MovingBall> balls;
  Column<std::uint32_t> mover_of;
  /// By Motion, how many bodies move.
  std::array<std::size_t, kMotions> movers_in{};
  /// How the frame moves in which ways are boxed, and what movers go along one axis.
  Eigen::Vector3d drift = Eigen::Vector3d::Zero();
  Column<double> along_axis;
  /// By mover, and one more.
  Column<std::uint32_t> first_piece;
  Column<PlainBox> boxes;
  Column<Key> piece_keys;
  /// By object of `ways`.
  Column<WayPiece> pieces;
  PairBuffer pairs;
  /// Pairs of bodies as (smaller id << 32 | larger id), sorted.
  Column<std::uint64_t> candidates;
  Column<std::uint64_t> spare;
  /// Candidates whose balls meet, as (when << 32 | candidate), sorted; when in time steps.
  Column<std::uint64_t> chances;
  /// By kinds of shapes, and as they were listed.
  Column<SweptPair> round;
  Column<SweptPair> listed;
  Column<impact::BodyImpact> answers;
  /// By answer: what other threads have written is looked at only where it is 1.
  Column<std::uint8_t> hits;
  /// By candidate or, where there is one, by mover; and when the latter is.
  Column<impact::BodyImpact> found;
  Column<double> first_time;
  /// The impacts to be shown, sorted.
  Column<FoundImpact> order;
  Column<SceneImpact> impacts;
  Column<std::uint32_t> first;
  SweepStatistics statistics;

 private:
  /// Calls body(mover) for all whose motions are known, in parallel.
  template <typename Body>
  void for_movers(Body&& body) const {
    for_stretches(bodies.options.execution, motions.size(), kMoversPerStretch,
                  [&](std::size_t begin, std::size_t end) {
                    for (std::size_t mover = begin; mover < end; ++mover) body(mover);
                  });
  }
  [[nodiscard]] MovingBall ball_of(const RigidMotion& motion, std::uint32_t body) const noexcept {
    const double(&at)[3] = motion.start.position;
    const double(&way)[3] = motion.travel;
    return {{at[0], at[1], at[2]}, {way[0], way[1], way[2]}, bodies.radius(body)};
  }
  [[nodiscard]] std::array<std::uint32_t, 2> bodies_of(std::size_t candidate) const noexcept {
    return {static_cast<std::uint32_t>(candidates[candidate] >> 32U),
            static_cast<std::uint32_t>(candidates[candidate])};
  }

  // Boxes and candidates.

  [[nodiscard]] Status take_bodies(std::span<const Key> keys) noexcept;
  [[nodiscard]] bool choose_drift() noexcept;
  /// From which boxes are measured.
  [[nodiscard]] RigidMotion frame() const noexcept {
    const Eigen::Vector3d& at = bodies.origin;
    RigidMotion frame = RigidMotion::standing(Pose::at(at.x(), at.y(), at.z()));
    Eigen::Vector3d::Map(frame.travel) = drift;
    return frame;
  }
  [[nodiscard]] impact::MovingShape way_of(std::size_t mover) const noexcept {
    const double radius = balls[mover].radius;
    return {{bodies.shape[movers[mover]], {}}, motions[mover], radius, radius, 0.0};
  }
  [[nodiscard]] bool count_pieces() noexcept;
  void box_way(std::uint32_t mover) noexcept;
  [[nodiscard]] Status box_ways(const SweepOptions& options);
  void name_pieces(std::uint32_t mover, const SweepOptions& options) noexcept;
  [[nodiscard]] Status set_filters();
  template <typename Body>
  [[nodiscard]] Status collect(Body&& second_body);
  [[nodiscard]] bool sort_candidates() noexcept;
  [[nodiscard]] Status find_pairs_among(const SweepOptions& options);
  [[nodiscard]] bool is_met(Motion motion, const SweepOptions& options) const noexcept;
  [[nodiscard]] Status find_pairs_with(Motion motion, const SweepOptions& options);

  // Impacts of candidates.

  /// In `room` if the body stands.
  [[nodiscard]] const MovingBall& ball_of(std::uint32_t body, MovingBall& room) const noexcept {
    const std::uint32_t mover = mover_of[body];
    if (mover != kNoMover) return balls[mover];
    return room = ball_of(RigidMotion::standing(bodies.pose[body]), body);
  }
  /// Starts to load the ball of the second body: the first is mostly that of the candidate before.
  void fetch_ball(std::size_t candidate) const noexcept {
    const std::uint32_t mover = mover_of[bodies_of(candidate)[1]];
    if (mover != kNoMover) __builtin_prefetch(&balls[mover]);
  }
  /// Of balls that are grown by a share of their sizes.
  [[nodiscard]] Approach approach_of(std::uint32_t a, std::uint32_t b,
                                     double tolerance) const noexcept;
  [[nodiscard]] std::uint64_t chance_of(std::size_t candidate, double tolerance) const noexcept;
  [[nodiscard]] Status list_chances(double tolerance);
  [[nodiscard]] bool list_round(std::size_t& at) noexcept;
  [[nodiscard]] bool sort_round() noexcept;
  void find_impacts(std::span<const SweptPair> asked, const SweepOptions& options,
                    impact::BodyImpact* impacts_of, std::uint8_t* hits_of) const noexcept;
  void keep_first(std::uint32_t candidate, const impact::BodyImpact& impact) noexcept;
  [[nodiscard]] RigidMotion motion_of(std::uint32_t body) const noexcept {
    const std::uint32_t mover = mover_of[body];
    return mover == kNoMover ? RigidMotion::standing(bodies.pose[body]) : motions[mover];
  }
  [[nodiscard]] SceneImpact shown(std::uint64_t candidate,
                                  const impact::BodyImpact& impact) const noexcept;
};

}  // namespace winnow
