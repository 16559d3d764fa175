#pragma once

#include <winnow/core/pose.h>

#include <algorithm>
#include <cmath>

namespace winnow {

/// Returns the pose of b in the frame of a, with a unit quaternion.
[[nodiscard]] inline Pose relative_pose(const Pose& a, const Pose& b) noexcept {
  const auto& p = a.orientation;
  const auto& q = b.orientation;
  const double pp = p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3];
  const double qq = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const double d[3] = {b.position[0] - a.position[0], b.position[1] - a.position[1],
                       b.position[2] - a.position[2]};
  Pose pose;
  // R(conj p) d = d + (2 / |p|^2) (v x (v x d) - w (v x d)) for p = (w, v).
  const double x[3] = {p[2] * d[2] - p[3] * d[1], p[3] * d[0] - p[1] * d[2],
                       p[1] * d[1] - p[2] * d[0]};
  const double y[3] = {p[2] * x[2] - p[3] * x[1] - p[0] * x[0],
                       p[3] * x[0] - p[1] * x[2] - p[0] * x[1],
                       p[1] * x[1] - p[2] * x[0] - p[0] * x[2]};
  const double twice = 2.0 / pp;
  for (int k = 0; k < 3; ++k) pose.position[k] = d[k] + twice * y[k];
  const double unit = 1.0 / std::sqrt(pp * qq);
  pose.orientation[0] = unit * (p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3]);
  pose.orientation[1] = unit * (p[0] * q[1] - p[1] * q[0] - p[2] * q[3] + p[3] * q[2]);
  pose.orientation[2] = unit * (p[0] * q[2] + p[1] * q[3] - p[2] * q[0] - p[3] * q[1]);
  pose.orientation[3] = unit * (p[0] * q[3] - p[1] * q[2] + p[2] * q[1] - p[3] * q[0]);
  return pose;
}

/// Upper bound on the distance that a point within `radius` of the origin moves from one pose to
/// another. Both orientations must be unit quaternions. A rotation by t moves a point along a chord
/// of 2 r sin(t / 2), and the quaternions differ by 2 sin(t / 4), so the chord is at most 2 r times
/// this difference.
[[nodiscard]] inline double motion_bound(const Pose& from, const Pose& to, double radius) noexcept {
  double shift = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double d = to.position[k] - from.position[k];
    shift += d * d;
  }
  double minus = 0.0;
  double plus = 0.0;
  for (int k = 0; k < 4; ++k) {
    const double d = to.orientation[k] - from.orientation[k];
    const double s = to.orientation[k] + from.orientation[k];
    minus += d * d;
    plus += s * s;
  }
  const double turn = std::min(minus, plus);
  // Avoids NaN for an infinite radius without rotation.
  const double chord = turn == 0.0 ? 0.0 : 2.0 * radius * std::sqrt(turn);
  return std::sqrt(shift) + chord;
}

/// Returns the pose with its quaternion normalized.
[[nodiscard]] inline Pose with_unit_turn(const Pose& pose) noexcept {
  Pose unit = pose;
  double square = 0.0;
  for (const double q : pose.orientation) square += q * q;
  const double factor = 1.0 / std::sqrt(square);
  for (double& q : unit.orientation) q *= factor;
  return unit;
}

}  // namespace winnow
