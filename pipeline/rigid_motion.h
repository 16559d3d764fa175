#pragma once

#include <winnow/core/export.h>
#include <winnow/core/pose.h>

namespace winnow {

/// How a body moves while time runs from 0 to 1: its position along a line, its orientation about
/// an axis that stays, both evenly. At time t it is at start.position + t * travel, turned from its
/// orientation at the start about the direction of `turn` by t * |turn|.
struct RigidMotion {
  /// More cannot be turned: some 160,000 times around.
  static constexpr double kMostTurn = 1e6;

  Pose start;                          ///< where it is at time 0
  double travel[3] = {0.0, 0.0, 0.0};  ///< from the first position to the last
  double turn[3] = {0.0, 0.0, 0.0};    ///< axis times angle in radians, in the axes of the world

  /// A body that does not move.
  [[nodiscard]] static constexpr RigidMotion standing(const Pose& pose) noexcept {
    return {pose, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  }
  /// From one pose to another by the shorter way around, which turns by half a turn at most; of two
  /// that are equally long, that about the vector part of end * conjugate(start). Not valid if one
  /// of the poses is not, or their positions have no finite difference.
  [[nodiscard]] WINNOW_API static RigidMotion between(const Pose& start, const Pose& end) noexcept;
  /// At constant velocities for a duration: length and radians in the unit of time that `duration`
  /// counts, in the axes of the world. As many turns as that makes.
  [[nodiscard]] WINNOW_API static RigidMotion by_velocities(const Pose& start,
                                                            const double (&linear)[3],
                                                            const double (&angular)[3],
                                                            double duration) noexcept;

  /// True if the start is, all numbers are finite, the last position too, and it does not turn by
  /// more than kMostTurn.
  [[nodiscard]] WINNOW_API bool is_valid() const noexcept;

  /// Where it is at a time in [0, 1], of a motion that is valid; its quaternion is of length 1 to
  /// rounding if the body turns, and that of the start if it does not. Angles are right to a few
  /// 1e-16 of 1 + |turn|, the same on every machine.
  [[nodiscard]] WINNOW_API Pose at(double time) const noexcept;
};

}  // namespace winnow
