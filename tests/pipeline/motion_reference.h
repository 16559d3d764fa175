#pragma once

#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstddef>
#include <cstdint>
#include <functional>

#include "tests/pipeline/pair_scenes.h"

namespace winnow::test {

/// Two shapes and their motions.
struct MovingShapes {
  ShapeId shape[2];
  RigidMotion motion[2];
};

/// The kinds of random motion in tests.
enum class MotionStyle {
  /// Translation only.
  travelling,
  /// Rotation only, by up to half a turn.
  turning,
  /// Translation and rotation by up to half a turn.
  moving,
  /// Rotation by up to twenty turns.
  whirling,
  /// From up to 1e6 sizes away.
  bullet,
  /// At 1e9 sizes from the origin.
  far_away,
  /// Starts in the poses of the scene, possibly overlapping.
  touching,
  /// Small motions past each other.
  grazing,
};
inline constexpr MotionStyle kMotionStyles[] = {
    MotionStyle::travelling, MotionStyle::turning,  MotionStyle::moving,   MotionStyle::whirling,
    MotionStyle::bullet,     MotionStyle::far_away, MotionStyle::touching, MotionStyle::grazing};
[[nodiscard]] const char* to_string(MotionStyle style);

/// Returns all kinds, user shapes included.
[[nodiscard]] std::vector<ShapeKind> moving_kinds();

/// Returns motions that bring a pair of a scene into its poses at some time.
[[nodiscard]] MovingShapes moving_pair(const PairScene& scene, BodyPair pair, MotionStyle style,
                                       Random& random);

/// Distance of two moving shapes at a time. Poses are computed in long double, the distance by the
/// solver, within its error bound.
struct DistanceAt {
  double distance;
  double error;
};
[[nodiscard]] DistanceAt distance_at(const ShapePool& pool, const MovingShapes& pair, double time);

/// Returns an upper bound of the speed at which any point of one shape and any point of the other
/// approach each other.
[[nodiscard]] double speed_bound(const ShapePool& pool, const MovingShapes& pair);

/// The relation of two shapes before a time.
enum class Before : std::uint8_t {
  /// Proved: the sampled distances exclude any overlap between the samples.
  apart,
  /// Apart at all samples, but too near for a proof.
  likely_apart,
  /// The shapes overlap at a sampled time.
  overlapping,
};
[[nodiscard]] Before before(const ShapePool& pool, const MovingShapes& pair, double time,
                            std::size_t max_samples);
/// As above for any distance function that changes no faster than `speed`. Distances may be off by
/// `doubt` beyond their error bound.
[[nodiscard]] Before before(const std::function<DistanceAt(double)>& distance, double speed,
                            double doubt, double time, std::size_t max_samples);

/// Returns the pose of a body at a time relative to `origin`, computed in long double.
[[nodiscard]] Pose place_at(const RigidMotion& motion, double time, const Vec3d& origin);

/// Returns the smaller half size of the two shapes, or the larger one if the smaller is 0. The half
/// size of a half-space counts as 0.
[[nodiscard]] double size_of(const ShapePool& pool, const MovingShapes& pair);

/// Returns the error of the solver beyond its bound: above zero for curved shapes beside much
/// larger shapes.
[[nodiscard]] double doubt_of(const ShapePool& pool, const MovingShapes& pair);

/// Returns the smallest gap that can be resolved.
[[nodiscard]] double resolution_of(const ShapePool& pool, const MovingShapes& pair);

}  // namespace winnow::test
