#pragma once

#include <winnow/core/rotation.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/solver/problem.h"

#include <array>

namespace winnow::impact {

using solver::Vec;

/// Times between which something may happen; none where `first` is above `last`.
struct Interval {
  double first;
  double last;
};

/// When two balls, of radii whose sum is `reach`, overlap: the second is at `between` from the
/// first at time 0 and travels on. All the time where the reach is infinite.
[[nodiscard]] Interval ball_window(const Vec& between, const Vec& travel, double reach) noexcept;

/// A convex shape that moves with a body.
struct MovingPart {
  ShapeId shape;
  /// Of the body, with the shape's own orientation at the start.
  RigidMotion motion;
  /// From the body's position to the shape's at the start, in the axes of the world.
  Vec arm = Vec::Zero();
  /// Of a triangle that bends, three: how far each corner gets, evenly, from where the body takes
  /// it. Such a body does not turn, and its shape has no arm.
  const Vec* drift = nullptr;
};

/// How a core turns about the axis through its body's position.
struct TurningCore {
  // Of a triangle and of a half-space, as they are unturned.
  std::array<Vec, 3> corner;
  std::array<Vec, 3> side;
  Vec normal;
  /// Of a triangle that bends: see MovingPart.
  bool drifts = false;
  std::array<Vec, 3> drift;
  Quaternion from{1.0, 0.0, 0.0, 0.0};
  Vec axis = Vec::UnitZ();
  /// Radians in all; 0 where turning changes nothing.
  double angle = 0.0;
  /// No point of the core is farther from the axis.
  double reach = 0.0;
  /// Of the core along the axis, from the body's position.
  solver::Range along{0.0, 0.0};
  /// From the body's position to the shape's at the start.
  Vec first_arm = Vec::Zero();
  /// The same to the center where it is placed: zero for a half-space, whose offset is from the
  /// position of the body.
  Vec arm = Vec::Zero();

  [[nodiscard]] Vec arm_at(double time) const noexcept;
  /// How fast corners that drift get on along an axis at most.
  [[nodiscard]] double drift_along(const Vec& n) const noexcept;
  [[nodiscard]] double drift_speed() const noexcept;
  /// How fast a point of the placed core drifts, that is at y from its center.
  [[nodiscard]] Vec drift_at(const solver::Core& core, const Vec& y) const noexcept;
};

/// Two shapes that move, at any time in [0, 1]: a problem of the solver, in the axes of the world
/// and about the center of a, with what bounds their approach, in the order of the solver. Lengths
/// are those of the problem.
class MovingPair {
 public:
  MovingPair(const ShapeTables& tables, const MovingPart& a, const MovingPart& b) noexcept;

  /// Brings both to where they are at a time.
  void place(double time) noexcept;
  /// The same as poses in the caller's lengths, about the position of body a.
  void poses(double time, Pose& pose_a, Pose& pose_b) const noexcept;
  [[nodiscard]] const solver::Problem& problem() const noexcept { return problem_; }
  [[nodiscard]] const solver::Core& a() const noexcept { return problem_.a; }
  [[nodiscard]] const solver::Core& b() const noexcept { return problem_.b; }
  /// From the position of body a to the center of a where it is placed.
  [[nodiscard]] const Vec& arm() const noexcept { return turn_a_.arm; }
  [[nodiscard]] double roundings() const noexcept { return a().rounding + b().rounding; }
  [[nodiscard]] bool has_half_space() const noexcept {
    return b().kind == solver::CoreKind::half_space;
  }
  /// One of them is a triangle that bends.
  [[nodiscard]] bool bends() const noexcept { return turn_a_.drifts || turn_b_.drifts; }
  /// Of two half-spaces that touch as soon as they turn.
  [[nodiscard]] bool touches_soon() const noexcept {
    return a().kind == solver::CoreKind::half_space && (turn_a_.angle > 0.0 || turn_b_.angle > 0.0);
  }

  /// What rounding of numbers and poses does to any gap, with room to spare.
  [[nodiscard]] double noise() const noexcept { return noise_ + problem_.noise(); }
  /// The smaller extent of the two, of which tolerances are shares.
  [[nodiscard]] double size() const noexcept { return size_; }

  /// Surely apart before and after: by the balls about the positions of their bodies.
  [[nodiscard]] Interval window() const noexcept;

  /// The gap along a unit axis from a to b where they are placed, less the noise. Of a half-space,
  /// along its normal as it is.
  [[nodiscard]] double gap(const Vec& axis) const noexcept;
  /// The same of all that they sweep as they turn about their axes where they are placed: as they
  /// move it closes no faster than `swept_closing`. Minus infinity if there is no such gap.
  [[nodiscard]] double swept_gap(const Vec& axis) const noexcept;
  [[nodiscard]] double swept_closing(const Vec& axis) const noexcept {
    return turn_a_.drift_along(axis) + turn_b_.drift_along(-axis) - axis.dot(travel_);
  }
  /// How fast a point of b that is at y_b from its center parts, along an axis, from one of a.
  [[nodiscard]] double parting(const Vec& axis, const Vec& y_a, const Vec& y_b) const noexcept;
  /// No gap along the axis, or along a half-space's normal as it turns, falls below its chord
  /// between two times by more than half of this times the product of the times to either end.
  [[nodiscard]] double curvature(const Vec& axis) const noexcept;
  /// The same along an axis that turns evenly from one to another in `width`, to where the pair is
  /// placed; infinite if they are farther apart than a radian.
  [[nodiscard]] double curvature_between(const Vec& from, const Vec& to,
                                         double width) const noexcept;
  /// No two points approach each other faster.
  [[nodiscard]] double most_closing() const noexcept;

 private:
  solver::Problem problem_;
  TurningCore turn_a_;
  TurningCore turn_b_;
  /// No two points of bounded shapes are faster against each other.
  [[nodiscard]] double fastest() const noexcept;
  [[nodiscard]] double arms() const noexcept {
    return turn_a_.first_arm.norm() + turn_b_.first_arm.norm();
  }

  /// From body a to body b at time 0, how it changes, and what it is where they are placed.
  Vec between_ = Vec::Zero();
  Vec travel_ = Vec::Zero();
  Vec placed_ = Vec::Zero();
  double noise_ = 0.0;
  double size_ = 0.0;
};

}  // namespace winnow::impact
