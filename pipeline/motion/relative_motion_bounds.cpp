// RelativeMotionBounds: bounds a moving shape relative to a moving frame, as a moving box, a fixed
// box, or a time window. body_impact.cpp traverses composite shapes with it; the scene puts boxes
// around motions with it.

#include "pipeline/motion/relative_motion_bounds.h"

#include "core/numbers/rotation.h"
#include "pipeline/motion/deterministic_trig.h"
#include "pipeline/shapes/frame.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace winnow::impact {
namespace {

[[nodiscard]] Quaternion unit_orientation(const Pose& pose) noexcept {
  return normalized(scale_to_unit_max(pose.orientation));
}

/// The plain root is accurate if the square neither overflows nor underflows.
[[nodiscard]] double length(const Vec& v) noexcept {
  const double square = v.squaredNorm();
  return square > 1e-200 && square < 1e200 ? std::sqrt(square) : v.stableNorm();
}

/// The orientation at a time, of length 1; `rate` is the length of `turn`.
[[nodiscard]] Quaternion turn_at(const Quaternion& from, const Vec3d& turn, double rate,
                                 double time) noexcept {
  if (rate == 0.0) return from;
  const double axis[3] = {turn[0] / rate, turn[1] / rate, turn[2] / rate};
  return turned(from, axis, time * rate);
}

}  // namespace

MovingShape whole_shape(const SubShapeQuery& parts, ShapeId shape,
                        const RigidMotion& motion) noexcept {
  const double radius = parts.radius(shape);
  return {{shape, {}}, motion, radius, radius, 0.0};
}

MovingShape moving_part(const SubShapeQuery& parts, const SubShape& part,
                        const RigidMotion& motion) noexcept {
  const double arm = as_eigen(part.pose.position).norm();
  double radius = 0.0;
  if (part.triangle != nullptr) {
    for (const auto& corner : part.triangle->vertex) {
      radius = std::max(radius, as_eigen(corner).norm());
    }
    radius += part.triangle->rounding;
  } else if (part.hull != nullptr) {
    radius = as_eigen(part.hull->center).norm() + part.hull->radius;
  } else {
    radius = parts.radius(part.shape);
  }
  return {part, motion, (arm + radius) * (1.0 + mid::kSlack), radius, arm};
}

RelativeMotionBounds::RelativeMotionBounds(const SubShapeQuery& parts, const RigidMotion& frame,
                                           const MovingShape& shape) noexcept
    : parts_(parts),
      frame_(frame),
      shape_(shape),
      apart_(Vec::Map(
          difference(shape.motion.start.position.data(), frame.start.position.data()).difference)),
      travel_(as_eigen(shape.motion.travel) - as_eigen(frame.travel)),
      frame_rate_(frame.turn.norm()),
      shape_rate_(shape.motion.turn.norm()),
      frame_from_(unit_orientation(frame.start)),
      shape_from_(unit_orientation(shape.motion.start)) {}

Vec RelativeMotionBounds::between(double time) const noexcept {
  const Vec bodies = apart_ + time * travel_;
  if (shape_.arm == 0.0) return bodies;
  const Eigen::Matrix3d axes =
      rotation_of_unit(turn_at(shape_from_, shape_.motion.turn, shape_rate_, time));
  return bodies + axes * as_eigen(shape_.shape.pose.position);
}

RelativeMotionBounds::RelativePose RelativeMotionBounds::place(double time) const noexcept {
  const Quaternion frame = turn_at(frame_from_, frame_.turn, frame_rate_, time);
  const Eigen::Matrix3d axes = rotation_of_unit(frame);
  return {axes.transpose() * between(time),
          frame.inverse() * turn_at(shape_from_, shape_.motion.turn, shape_rate_, time)};
}

/// The box of the shape with its body rotated by `turn`, relative to the shape's own position.
mid::Box3 RelativeMotionBounds::about(const Quaternion& turn) const noexcept {
  SubShape shape = shape_.shape;
  shape.pose.position = {};
  const Quaternion q = turn * scale_to_unit_max(shape_.shape.pose.orientation);
  shape.pose.orientation = q;
  return parts_.box(shape);
}

double RelativeMotionBounds::farthest(const Interval& within) const noexcept {
  const double ends =
      std::max(length(apart_ + within.first * travel_), length(apart_ + within.last * travel_));
  const double speed = length(travel_) + shape_rate_ * shape_.arm;
  const double from_first = length(between(within.first)) + speed * (within.last - within.first);
  return std::min(ends + shape_.arm, from_first) * (1.0 + mid::kSlack);
}

double RelativeMotionBounds::turning_bend(double width) const noexcept {
  const double turned = (frame_rate_ + shape_rate_) * width;
  return 0.125 * turned * turned * shape_.own_radius;
}

double RelativeMotionBounds::path_bend(double far, double width) const noexcept {
  const double turned = frame_rate_ * width;
  const double own = shape_rate_ * width;
  const double way = length(travel_) * width + own * shape_.arm;
  return 0.125 * (turned * (turned * far + 2.0 * way) + own * own * shape_.arm);
}

double RelativeMotionBounds::bend(const Interval& within) const noexcept {
  const double width = within.last - within.first;
  return turning_bend(width) + path_bend(farthest(within), width);
}

MovingBox RelativeMotionBounds::moving_box(const Interval& within) const noexcept {
  const double width = within.last - within.first;
  const double far = farthest(within);
  const double slack = 8.0 * mid::kSlack * (length(apart_) + length(travel_) + shape_.radius);
  const double path = path_bend(far, width);
  const Vec ball = Vec::Constant(shape_.own_radius);
  if (!std::isfinite(shape_.radius) || path > far) {
    return stationary(mid::Box3{-ball, ball}.grown(far + slack));
  }
  const RelativePose first = place(within.first);
  const RelativePose last = place(within.last);
  mid::Box3 box{-ball, ball};
  double bent = turning_bend(width);
  if (bent == 0.0) {
    box = about(first.turn);
  } else if (bent < shape_.own_radius) {
    const Vec most = ball - Vec::Constant(bent);
    box = about(first.turn);
    const mid::Box3 then = about(last.turn);
    box.min = box.min.cwiseMin(then.min).cwiseMax(-most);
    box.max = box.max.cwiseMax(then.max).cwiseMin(most);
  } else {
    bent = 0.0;
  }
  MovingBox moving_box = stationary(box.moved(first.position).grown(bent + path + slack));
  as_eigen(moving_box.direction) = last.position - first.position;
  moving_box.max_t = 1.0;
  return moving_box;
}

std::uint32_t RelativeMotionBounds::piece_count() const noexcept {
  constexpr double kMaxCount = 8.0;
  double way[3] = {std::abs(travel_.x()), std::abs(travel_.y()), std::abs(travel_.z())};
  std::sort(std::begin(way), std::end(way));
  const double count = std::ceil(way[1] / std::max(2.0 * shape_.radius, 1e-300));
  return static_cast<std::uint32_t>(std::clamp(count, 1.0, kMaxCount));
}

mid::Box3 RelativeMotionBounds::box(const Interval& within) const noexcept {
  constexpr double kMaxTurned = 0.5;
  constexpr double kMaxPieces = 256.0;
  const double width = within.last - within.first;
  const double turned = (frame_rate_ + shape_rate_) * width;
  const double pieces = std::clamp(std::ceil(turned / kMaxTurned), 1.0, kMaxPieces);
  mid::Box3 all;
  for (double piece = 0.0; piece < pieces; ++piece) {
    const MovingBox way = moving_box(
        {within.first + piece / pieces * width, within.first + (piece + 1.0) / pieces * width});
    for (const double t : {0.0, way.max_t}) {
      all.min = all.min.cwiseMin(Vec::Map(way.min) + t * as_eigen(way.direction));
      all.max = all.max.cwiseMax(Vec::Map(way.max) + t * as_eigen(way.direction));
    }
  }
  return all;
}

}  // namespace winnow::impact
