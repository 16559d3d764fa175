// MovingPair: the solver's problem for two moving shapes at any time, and the bounds on gaps,
// speeds and curvature that impact_search.cpp and resting_contacts.cpp need for their proofs.

#include "pipeline/motion/moving_pair.h"

#include "core/numbers/rotation.h"
#include "pipeline/motion/core_reach.h"
#include "pipeline/motion/deterministic_trig.h"
#include "pipeline/shapes/two_diff.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace winnow::impact {
namespace {

using solver::AxisRange;
using solver::Core;
using solver::kEpsilon;

constexpr double kForever = std::numeric_limits<double>::infinity();
/// Squares above this keep all their digits.
constexpr double kExact = 1e-290;
/// Makes a half-space's offset relative to the position of its body.
void take_arm(Core& core, const Quaternion& from, const Vec& arm) noexcept {
  const solver::Mat to_world = rotation_of(from);
  core.offset += solver::unit(to_world * core.normal).dot(arm);
  core.size = std::abs(core.offset);
}

void take_drift(Core& core, const Vec* drift, const solver::Scale& scaled,
                TurningCore& turning) noexcept {
  turning.drifts = true;
  core.size = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    turning.drift[i] = drift[i].unaryExpr(scaled);
    core.size =
        std::max({core.size, core.corner[i].norm(), (core.corner[i] + turning.drift[i]).norm()});
  }
  core.size += core.rounding;
}

/// `core` is not rotated yet.
TurningCore turning(Core& core, const RigidMotion& motion, const Vec& arm) noexcept {
  TurningCore result;
  if (core.kind == ShapeKind::sphere && arm.isZero(0.0)) return result;
  result.from = normalized(scale_to_unit_max(motion.start.orientation));
  result.first_arm = arm;
  if (core.kind == ShapeKind::half_space) {
    take_arm(core, result.from, arm);
    result.normal = core.normal;
  } else {
    result.arm = arm;
  }
  if (core.kind == ShapeKind::triangle) {
    result.corner = core.corner;
    result.side = core.side;
  }
  const double angle = motion.turn.norm();
  if (angle == 0.0) return result;
  result.axis = as_eigen(motion.turn) / angle;
  const solver::Mat to_world = rotation_of_unit(result.from);
  const Vec local_axis = to_world.transpose() * result.axis;
  if (result.arm.isZero(0.0) && is_invariant(core, local_axis)) return result;
  result.angle = angle;
  if (core.kind == ShapeKind::half_space) return result;
  result.reach =
      (reach_about(core, local_axis) + result.arm.cross(result.axis).norm()) * (1.0 + kSameAxis);
  const AxisRange range = project(core, local_axis);
  const double height = result.arm.dot(result.axis);
  result.along = {height + range.low, height + range.high};
  return result;
}

Quaternion orientation_at(const TurningCore& turning, double time) noexcept {
  if (turning.angle == 0.0) return turning.from;
  return turned(turning.from, turning.axis.data(), time * turning.angle);
}

void bend(const TurningCore& turning, double time, Core& core) noexcept {
  for (std::size_t i = 0; i < 3; ++i) core.corner[i] += time * turning.drift[i];
  for (std::size_t i = 0; i < 3; ++i) {
    core.side[i] = solver::unit(core.corner[(i + 1) % 3] - core.corner[i]);
  }
}

void place_core(TurningCore& turning, double time, Core& core) noexcept {
  if (core.kind != ShapeKind::half_space) turning.arm = turning.arm_at(time);
  core.rotation = rotation_of(orientation_at(turning, time));
  if (core.kind == ShapeKind::triangle) {
    for (std::size_t i = 0; i < 3; ++i) {
      core.corner[i] = core.rotation * turning.corner[i];
      core.side[i] = core.rotation * turning.side[i];
    }
    if (turning.drifts) bend(turning, time, core);
  } else if (core.kind == ShapeKind::half_space) {
    core.normal = solver::unit(core.rotation * turning.normal);
  }
}

/// Support of a core along the axis, from its centre. For a half-space the axis must be its normal.
double high(const Core& core, const Vec& axis) noexcept {
  return core.kind == ShapeKind::half_space ? core.offset : highest(core, axis);
}

/// Support, from the body's position, of the volume that the core sweeps as it rotates.
double swept_high(const TurningCore& turning, const Core& core, const Vec& axis) noexcept {
  if (turning.angle == 0.0) return high(core, axis) + axis.dot(turning.arm);
  const double along = axis.dot(turning.axis);
  return std::max(along * turning.along.low, along * turning.along.high) +
         axis.cross(turning.axis).norm() * turning.reach;
}

double acceleration(const TurningCore& turning, const Vec& axis) noexcept {
  if (turning.angle == 0.0) return 0.0;
  const double across = axis.cross(turning.axis).norm() + kSameAxis;
  return turning.angle * turning.angle * across * turning.reach;
}

}  // namespace

Vec TurningCore::arm_at(double time) const noexcept {
  if (angle == 0.0 || first_arm.isZero(0.0)) return first_arm;
  const SineCosine by = sine_cosine(time * angle);
  const Vec height = axis * axis.dot(first_arm);
  return height + (first_arm - height) * by.cosine + axis.cross(first_arm) * by.sine;
}

double TurningCore::drift_along(const Vec& n) const noexcept {
  if (!drifts) return 0.0;
  return std::max({drift[0].dot(n), drift[1].dot(n), drift[2].dot(n)});
}

double TurningCore::drift_speed() const noexcept {
  return drifts ? std::max({drift[0].norm(), drift[1].norm(), drift[2].norm()}) : 0.0;
}

Vec TurningCore::drift_at(const Core& core, const Vec& y) const noexcept {
  if (!drifts) return Vec::Zero();
  const Vec first = core.corner[1] - core.corner[0];
  const Vec second = core.corner[2] - core.corner[0];
  const Vec n = first.cross(second);
  const double area = n.squaredNorm();
  if (!(area > 0.0)) return (drift[0] + drift[1] + drift[2]) / 3.0;
  const Vec at = y - core.corner[0];
  const double u = std::clamp(n.dot(at.cross(second)) / area, 0.0, 1.0);
  const double v = std::clamp(n.dot(first.cross(at)) / area, 0.0, 1.0);
  return (1.0 - u - v) * drift[0] + u * drift[1] + v * drift[2];
}

MovingPair::MovingPair(const ShapeTables& tables, const MovingPart& a,
                       const MovingPart& b) noexcept {
  const RigidMotion& of_a = a.motion;
  const RigidMotion& of_b = b.motion;
  const TwoDiff apart = difference(of_b.start.position.data(), of_a.start.position.data());
  const Vec start = Vec::Map(apart.difference);
  const Vec way = as_eigen(of_b.travel) - as_eigen(of_a.travel);
  const Vec end = start + way;
  // Use one unit for all times: the unit for the largest distance.
  Pose there;
  as_eigen(there.position) = start.cwiseAbs().maxCoeff() > end.cwiseAbs().maxCoeff() ? start : end;
  there.position[0] += std::copysign(a.arm.norm() + b.arm.norm(), there.position[0]);
  prepare(tables, a.shape, Pose{}, b.shape, there, false, problem_);
  const solver::Scale scaled(problem_.exponent);
  between_ = placed_ = start.unaryExpr(scaled);
  travel_ = way.unaryExpr(scaled);
  turn_a_ = turning(problem_.a, of_a, a.arm.unaryExpr(scaled));
  turn_b_ = turning(problem_.b, of_b, b.arm.unaryExpr(scaled));
  if (a.drift != nullptr) take_drift(problem_.a, a.drift, scaled, turn_a_);
  if (b.drift != nullptr) take_drift(problem_.b, b.drift, scaled, turn_b_);
  const double sizes = problem_.a.size + problem_.b.size + arms();
  noise_ = kEpsilon * (8.0 * (between_.norm() + travel_.norm()) +
                       (64.0 + 4.0 * (turn_a_.angle + turn_b_.angle)) * sizes);
  if (has_half_space()) {
    // The normal of a half-space is rotated with rounding, which moves points far from its
    // position.
    noise_ += kEpsilon * (64.0 + 4.0 * turn_b_.angle) * (between_.norm() + travel_.norm());
  }
  const double least = std::min(extent(problem_.a), extent(problem_.b));
  size_ = least > 0.0 ? least : std::max(extent(problem_.a), extent(problem_.b));
}

void MovingPair::place(double time) noexcept {
  placed_ = between_ + time * travel_;
  place_core(turn_a_, time, problem_.a);
  place_core(turn_b_, time, problem_.b);
  problem_.b.center = placed_ + (turn_b_.arm - turn_a_.arm);
  problem_.size = problem_.b.center.norm() + problem_.a.size + problem_.b.size;
}

void MovingPair::poses(double time, Pose& pose_a, Pose& pose_b) const noexcept {
  for (const auto& [turning, pose] : {std::pair{&turn_a_, &pose_a}, {&turn_b_, &pose_b}}) {
    const Quaternion q = orientation_at(*turning, time);
    pose->orientation = q;
  }
  const Vec at_a = turn_a_.arm_at(time);
  const Vec at_b = between_ + time * travel_ + turn_b_.arm_at(time);
  for (int i = 0; i < 3; ++i) {
    pose_a.position[i] = unscaled(problem_, at_a[i]);
    pose_b.position[i] = unscaled(problem_, at_b[i]);
  }
}

Interval MovingPair::window() const noexcept {
  if (has_half_space()) return {0.0, 1.0};
  return ball_window(between_, travel_, a().size + b().size + arms());
}

Interval ball_window(const Vec& between, const Vec& travel, double reach) noexcept {
  constexpr Interval kAll{0.0, 1.0};
  // Most pairs of a scene do not touch because their line of relative motion is too far away. This
  // is tested without a square root.
  const double rounding = between.cwiseAbs().sum() + travel.cwiseAbs().sum() + reach;
  const double wide = reach + 128.0 * kEpsilon * rounding;
  const double limit = wide * wide * travel.squaredNorm();
  if (limit > kExact && between.cross(travel).squaredNorm() > limit) return {1.0, 0.0};
  const double speed = travel.norm();
  const double path = between.norm() + speed;
  if (!std::isfinite(reach + path)) return kAll;
  const double radius = reach + 64.0 * kEpsilon * (path + reach);
  // If the travel is so short that its square underflows, the distance at the start is used for all
  // times.
  const double nearest = speed > 1e-140 ? -(between.dot(travel) / speed) / speed : 0.0;
  const double distance = (between + nearest * travel).norm();
  if (distance > radius + (speed > 1e-140 ? 0.0 : speed)) return {1.0, 0.0};
  if (!(speed > 1e-140)) return kAll;
  const double half = std::sqrt((radius - distance) * (radius + distance)) / speed;
  return {std::max(0.0, nearest - half), std::min(1.0, nearest + half)};
}

double MovingPair::gap(const Vec& axis) const noexcept {
  return axis.dot(b().center) - high(b(), -axis) - high(a(), axis) - roundings() - noise();
}

double MovingPair::swept_gap(const Vec& axis) const noexcept {
  if (has_half_space() && turn_b_.angle > 0.0) return -kForever;
  return axis.dot(placed_) - swept_high(turn_b_, b(), -axis) - swept_high(turn_a_, a(), axis) -
         roundings() - noise();
}

double MovingPair::parting(const Vec& axis, const Vec& y_a, const Vec& y_b) const noexcept {
  Vec v = travel_;
  if (turn_a_.angle > 0.0) v -= turn_a_.angle * turn_a_.axis.cross(turn_a_.arm + y_a);
  if (turn_b_.angle > 0.0) v += turn_b_.angle * turn_b_.axis.cross(turn_b_.arm + y_b);
  v += turn_b_.drift_at(b(), y_b) - turn_a_.drift_at(a(), y_a);
  return axis.dot(v);
}

double MovingPair::curvature(const Vec& axis) const noexcept {
  if (has_half_space() && turn_b_.angle > 0.0) {
    // Product rule: the normal rotates, and so do the points, about a position that moves.
    const double far = std::max(between_.norm(), (between_ + travel_).norm()) + arms() + a().size;
    const double fast = travel_.norm() + turn_a_.angle * turn_a_.reach + turn_a_.drift_speed();
    return turn_b_.angle * (turn_b_.angle * far + 2.0 * fast) +
           turn_a_.angle * turn_a_.angle * turn_a_.reach;
  }
  return acceleration(turn_a_, axis) + acceleration(turn_b_, axis);
}

// With P the vector from a point of a to a point of b, their gap along an axis n with angular speed
// r is n . P. Its second derivative is n . P'' + 2 n' . P' - r^2 n . P. The last term is positive
// only where the gap is negative; there it is at most r^2 times the amount by which the gap can
// fall below 0.
double MovingPair::curvature_between(const Vec& from, const Vec& to, double width) const noexcept {
  const double turned = (to - from).norm();
  if (turned > 1.0) return kForever;
  // An upper bound on the angle whose chord is `turned`, divided by the width.
  const double rate = turned * (1.0 + 0.05 * turned * turned) / width;
  const double reach =
      turn_a_.reach * turn_a_.angle * turn_a_.angle + turn_b_.reach * turn_b_.angle * turn_b_.angle;
  const double speed = fastest();
  const double far = placed_.norm() + width * travel_.norm() + arms() + a().size + b().size;
  const double below = width * (rate * far + speed);
  return reach + 2.0 * rate * speed + rate * rate * below;
}

double MovingPair::fastest() const noexcept {
  return travel_.norm() + turn_a_.angle * turn_a_.reach + turn_b_.angle * turn_b_.reach +
         turn_a_.drift_speed() + turn_b_.drift_speed();
}

double MovingPair::most_closing() const noexcept {
  double speed = fastest();
  if (has_half_space()) {
    const double far = std::max(between_.norm(), (between_ + travel_).norm());
    speed += turn_b_.angle * (far + arms() + a().size);
  }
  return speed;
}

}  // namespace winnow::impact
