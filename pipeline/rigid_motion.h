#pragma once

#include <winnow/core/export.h>
#include <winnow/core/pose.h>
#include <winnow/core/vectors.h>

namespace winnow {

/// Motion of a body during the time from 0 to 1: constant velocity along a line, and rotation at a
/// constant rate about a fixed axis. At time t the position is start.position + t * travel, and the
/// orientation is start.orientation, rotated about the direction of `turn` by t * |turn|.
struct RigidMotion {
  /// Largest rotation in radians: about 160,000 turns.
  static constexpr double kMaxTurn = 1e6;

  Pose start;      ///< pose at time 0
  Vec3d travel{};  ///< displacement from time 0 to time 1
  Vec3d turn{};    ///< rotation axis times angle in radians, in world axes

  /// Returns the motion of a body at rest.
  [[nodiscard]] static constexpr RigidMotion stationary(const Pose& pose) noexcept {
    return {pose, {}, {}};
  }
  /// Returns the motion from one pose to another by the shorter rotation, at most half a turn. For
  /// exactly half a turn, the axis is the vector part of end * conjugate(start). The motion is
  /// invalid if a pose is invalid, or if the difference of the positions is not finite.
  [[nodiscard]] WINNOW_API static RigidMotion between(const Pose& start, const Pose& end) noexcept;
  /// Returns the motion at constant velocities for a duration, in world axes. Velocities are in
  /// lengths and radians per unit of `duration`. The rotation may exceed a full turn.
  [[nodiscard]] WINNOW_API static RigidMotion by_velocities(const Pose& start, const Vec3d& linear,
                                                            const Vec3d& angular,
                                                            double duration) noexcept;

  /// True if the start is valid, all numbers and the last position are finite, and the rotation is
  /// at most kMaxTurn.
  [[nodiscard]] WINNOW_API bool is_valid() const noexcept;

  /// Returns the pose at a time in [0, 1]; the motion must be valid. If the body rotates, the
  /// quaternion is a unit quaternion to rounding; if not, it is the quaternion of the start. Angles
  /// are exact to a few 1e-16 of 1 + |turn|, and the same on every machine.
  [[nodiscard]] WINNOW_API Pose at(double time) const noexcept;
};

}  // namespace winnow
