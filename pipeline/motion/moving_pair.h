#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/solver/problem.h"

#include <array>

namespace winnow::impact {

using solver::Vec;

/// A time interval; empty if `first` is above `last`.
struct Interval {
  double first;
  double last;
};

/// Returns a part of [0, 1] that contains all times at which two balls overlap. Their radii sum to
/// `reach`; the second ball is at `between` relative to the first at time 0 and moves by `travel`.
/// Returns [0, 1] if the reach is infinite.
[[nodiscard]] Interval ball_window(const Vec& between, const Vec& travel, double reach) noexcept;

/// A convex shape that moves with a body.
struct MovingPart {
  ShapeId shape;
  /// The body's motion, but with the shape's orientation at the start.
  RigidMotion motion;
  /// From the body's position to the shape's at the start, in world axes.
  Vec arm = Vec::Zero();
  /// For a triangle that deforms, three vectors: each corner's total displacement, linear in time,
  /// relative to the motion of the body; else null. Such a body does not rotate, and its shape has
  /// no arm.
  const Vec* drift = nullptr;
};

/// The rotation of a core about the axis through its body's position.
struct TurningCore {
  // Corners and sides of a triangle, and the normal of a half-space, before rotation.
  std::array<Vec, 3> corner;
  std::array<Vec, 3> side;
  Vec normal;
  /// For a triangle that deforms; see MovingPart.
  bool drifts = false;
  std::array<Vec, 3> drift;
  Quaternion from{1.0, 0.0, 0.0, 0.0};
  Vec axis = Vec::UnitZ();
  /// In radians; 0 if rotation changes nothing.
  double angle = 0.0;
  /// Upper bound on the distance of the core's points from the axis.
  double reach = 0.0;
  /// The range of the core along the axis, from the body's position.
  solver::AxisRange along{0.0, 0.0};
  /// From the body's position to the shape's at the start.
  Vec first_arm = Vec::Zero();
  /// From the body's position to the core's centre, at the current placement. Zero for a
  /// half-space, whose offset is measured from the body's position.
  Vec arm = Vec::Zero();

  [[nodiscard]] Vec arm_at(double time) const noexcept;
  /// The largest speed along `n` at which the corners of a deforming triangle move.
  [[nodiscard]] double drift_along(const Vec& n) const noexcept;
  [[nodiscard]] double drift_speed() const noexcept;
  /// The velocity of deformation of the point of the placed core at y from its centre.
  [[nodiscard]] Vec drift_at(const solver::Core& core, const Vec& y) const noexcept;
};

/// Two moving shapes at any time in [0, 1]: a problem of the solver, in world axes and relative to
/// the centre of a, with bounds on their approach. The shapes are in the solver's order; lengths
/// are in units of the problem.
class MovingPair {
 public:
  MovingPair(const ShapeTables& tables, const MovingPart& a, const MovingPart& b) noexcept;

  /// Places both shapes at a time.
  void place(double time) noexcept;
  /// The placement as poses in the caller's lengths, relative to the position of body a.
  void poses(double time, Pose& pose_a, Pose& pose_b) const noexcept;
  [[nodiscard]] const solver::Problem& problem() const noexcept { return problem_; }
  [[nodiscard]] const solver::Core& a() const noexcept { return problem_.a; }
  [[nodiscard]] const solver::Core& b() const noexcept { return problem_.b; }
  /// From the position of body a to the centre of a, at the current placement.
  [[nodiscard]] const Vec& arm() const noexcept { return turn_a_.arm; }
  [[nodiscard]] double roundings() const noexcept { return a().rounding + b().rounding; }
  [[nodiscard]] bool has_half_space() const noexcept { return b().kind == ShapeKind::half_space; }
  /// One of the shapes is a triangle that deforms.
  [[nodiscard]] bool bends() const noexcept { return turn_a_.drifts || turn_b_.drifts; }
  /// Both shapes are half-spaces and at least one rotates. They touch at time 0 or right after it.
  [[nodiscard]] bool touches_soon() const noexcept {
    return a().kind == ShapeKind::half_space && (turn_a_.angle > 0.0 || turn_b_.angle > 0.0);
  }

  /// Upper bound on the rounding of any gap.
  [[nodiscard]] double noise() const noexcept { return noise_ + problem_.noise(); }
  /// The size that tolerances are relative to: the smaller extent of both shapes, or the larger one
  /// if the smaller is 0.
  [[nodiscard]] double size() const noexcept { return size_; }

  /// Returns the interval in which the balls about the positions of both bodies overlap. At other
  /// times the shapes are disjoint.
  [[nodiscard]] Interval window() const noexcept;

  /// The gap along a unit axis from a to b at the current placement, minus the noise. For a
  /// half-space the axis must be its current normal.
  [[nodiscard]] double gap(const Vec& axis) const noexcept;
  /// The gap between the volumes that both shapes sweep as they rotate about their axes, at their
  /// current positions. While the shapes travel, it closes no faster than `swept_closing`. Minus
  /// infinity if there is no bound.
  [[nodiscard]] double swept_gap(const Vec& axis) const noexcept;
  [[nodiscard]] double swept_closing(const Vec& axis) const noexcept {
    return turn_a_.drift_along(axis) + turn_b_.drift_along(-axis) - axis.dot(travel_);
  }
  /// The velocity, along an axis, of a point of b at y_b from its centre, relative to a point of a
  /// at y_a.
  [[nodiscard]] double parting(const Vec& axis, const Vec& y_a, const Vec& y_b) const noexcept;
  /// At a time t between two times u and v, a gap along the axis (or along the rotating normal of a
  /// half-space) is below its chord by at most curvature / 2 * (t - u) * (v - t).
  [[nodiscard]] double curvature(const Vec& axis) const noexcept;
  /// As above, along an axis that rotates uniformly from `from` to `to` during a time of `width`,
  /// which ends at the time of the current placement. Infinite if |to - from| exceeds 1.
  [[nodiscard]] double curvature_between(const Vec& from, const Vec& to,
                                         double width) const noexcept;
  /// Upper bound on the speed at which two points approach each other.
  [[nodiscard]] double most_closing() const noexcept;

 private:
  solver::Problem problem_;
  TurningCore turn_a_;
  TurningCore turn_b_;
  /// Upper bound on the relative speed of two points of bounded shapes.
  [[nodiscard]] double fastest() const noexcept;
  [[nodiscard]] double arms() const noexcept {
    return turn_a_.first_arm.norm() + turn_b_.first_arm.norm();
  }

  /// From body a to body b: at time 0, the total change, and at the current placement.
  Vec between_ = Vec::Zero();
  Vec travel_ = Vec::Zero();
  Vec placed_ = Vec::Zero();
  double noise_ = 0.0;
  double size_ = 0.0;
};

}  // namespace winnow::impact
