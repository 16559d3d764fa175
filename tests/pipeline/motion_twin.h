#pragma once

#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstddef>
#include <cstdint>
#include <functional>

#include "tests/pipeline/pair_scenes.h"

namespace winnow::test {

/// Two shapes and how they move.
struct MovingShapes {
  ShapeId shape[2];
  RigidMotion motion[2];
};

/// How the pairs of a test move.
enum class MotionStyle {
  /// Straight on.
  travelling,
  /// About an axis, by up to half a turn.
  turning,
  /// Both, by up to half a turn.
  moving,
  /// Up to twenty turns.
  whirling,
  /// From up to 1e6 sizes away.
  bullet,
  /// 1e9 from the origin.
  far_away,
  /// From where they are found, perhaps overlapping.
  touching,
  /// By little, past each other.
  grazing,
};
inline constexpr MotionStyle kMotionStyles[] = {
    MotionStyle::travelling, MotionStyle::turning,  MotionStyle::moving,   MotionStyle::whirling,
    MotionStyle::bullet,     MotionStyle::far_away, MotionStyle::touching, MotionStyle::grazing};
[[nodiscard]] const char* to_string(MotionStyle style);

/// All kinds but convex sets of the program's own.
[[nodiscard]] std::vector<ShapeKind> moving_kinds();

/// Makes a pair of a scene pass at some time where the scene has it.
[[nodiscard]] MovingShapes moving_pair(const PairScene& scene, BodyPair pair, MotionStyle style,
                                       Random& random);

/// Distance of two moving shapes at a time: places computed in long double, the distance by the
/// solver, which stands in for exact arithmetic within its own bound.
struct DistanceAt {
  double distance;
  double error;
};
[[nodiscard]] DistanceAt distance_at(const ShapePool& pool, const MovingShapes& pair, double time);

/// No two points of the shapes approach each other faster.
[[nodiscard]] double speed_bound(const ShapePool& pool, const MovingShapes& pair);

/// What can be said of the shapes before a time.
enum class Before : std::uint8_t {
  /// Proved: no ball of the size of the distance at some times leaves one between them out.
  apart,
  /// Apart wherever looked at, too near each other for a proof.
  likely_apart,
  /// They overlap at some time.
  met,
};
[[nodiscard]] Before before(const ShapePool& pool, const MovingShapes& pair, double time,
                            std::size_t most_looks);
/// The same of anything whose distance at a time is known, and falls no faster than `speed`.
/// Distances may be wrong by `doubt` beyond their error.
[[nodiscard]] Before before(const std::function<DistanceAt(double)>& distance, double speed,
                            double doubt, double time, std::size_t most_looks);

/// Where a body is at a time, from `origin`, computed in long double.
[[nodiscard]] Pose place_at(const RigidMotion& motion, double time, const double (&origin)[3]);

/// The smaller of the largest distances of the shapes' points from their middles; of the other
/// where one is a point or has no end.
[[nodiscard]] double size_of(const ShapePool& pool, const MovingShapes& pair);

/// What the solver may be wrong by beyond its bound: of curved shapes beside others many times as
/// large.
[[nodiscard]] double doubt_of(const ShapePool& pool, const MovingShapes& pair);

/// What a gap is resolved to at best.
[[nodiscard]] double resolution_of(const ShapePool& pool, const MovingShapes& pair);

}  // namespace winnow::test
