#include <winnow/core/pose.h>
#include <winnow/pipeline/rigid_motion.h>
#include "core/numbers/rotation.h"
#include "core/threads/float_environment.h"
#include "pipeline/motion/deterministic_trig.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

/// The angle in [0, pi / 2] with sine s and cosine c (both >= 0, not both 0), up to rounding. Each
/// step adds the sine of the remaining angle; the error after the step is about a sixth of the cube
/// of that angle.
double angle_of(double s, double c) noexcept {
  double angle = 1.5 * s / (s + c);
  for (int i = 0; i < 5; ++i) {
    const impact::SineCosine at = impact::sine_cosine(angle);
    angle += s * at.cosine - c * at.sine;
  }
  return angle;
}

}  // namespace

RigidMotion RigidMotion::between(const Pose& start, const Pose& end) noexcept {
  const DefaultFloatEnvironment environment;
  RigidMotion motion = stationary(start);
  for (int i = 0; i < 3; ++i) motion.travel[i] = end.position[i] - start.position[i];
  if (!start.is_valid() || !end.is_valid()) {
    // Make an invalid end visible: the motion becomes invalid.
    if (!end.is_valid()) motion.turn[0] = std::numeric_limits<double>::quiet_NaN();
    return motion;
  }
  const Quaternion from = normalized(scale_to_unit_max(start.orientation));
  const Quaternion to = normalized(scale_to_unit_max(end.orientation));
  Quaternion way = to * from.inverse();
  if (way[0] < 0.0) {
    for (double& x : way) x = -x;
  }
  const double sine = std::sqrt(way[1] * way[1] + way[2] * way[2] + way[3] * way[3]);
  if (sine == 0.0) return motion;
  const double length = std::sqrt(sine * sine + way[0] * way[0]);
  const double angle = 2.0 * angle_of(sine / length, way[0] / length);
  for (std::size_t i = 0; i < 3; ++i) motion.turn[i] = way[i + 1] / sine * angle;
  return motion;
}

RigidMotion RigidMotion::by_velocities(const Pose& start, const Vec3d& linear, const Vec3d& angular,
                                       double duration) noexcept {
  const DefaultFloatEnvironment environment;
  RigidMotion motion = stationary(start);
  for (int i = 0; i < 3; ++i) {
    motion.travel[i] = linear[i] * duration;
    motion.turn[i] = angular[i] * duration;
  }
  return motion;
}

bool RigidMotion::is_valid() const noexcept {
  const DefaultFloatEnvironment environment;
  // Remains 0 for finite numbers, becomes NaN otherwise.
  double sum = 0.0;
  double square = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double end = start.position[i] + travel[i];
    sum += (travel[i] - travel[i]) + (end - end);
    square += turn[i] * turn[i];
  }
  return start.is_valid() && sum == 0.0 && square <= kMaxTurn * kMaxTurn;
}

Pose RigidMotion::at(double time) const noexcept {
  const DefaultFloatEnvironment environment;
  Pose pose = start;
  for (int i = 0; i < 3; ++i) pose.position[i] += time * travel[i];
  const double angle = turn.norm();
  if (angle == 0.0) return pose;
  const double axis[3] = {turn[0] / angle, turn[1] / angle, turn[2] / angle};
  const Quaternion q =
      impact::turned(normalized(scale_to_unit_max(start.orientation)), axis, time * angle);
  pose.orientation = q;
  return pose;
}

}  // namespace winnow
