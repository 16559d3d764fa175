#pragma once

// Rotations of the library: `Quaternion::normalized` and `Quaternion::matrix` in steps, so that a
// step is not repeated.

#include <winnow/core/pose.h>

#include <cmath>

namespace winnow {

using detail::scale_to_unit_max;

/// Returns a quaternion of length 1, up to rounding, with the same rotation. `q` is a result of
/// `scale_to_unit_max`.
[[nodiscard]] inline Quaternion normalized(const Quaternion& q) noexcept {
  const double length = std::sqrt(detail::squared_length(q));
  return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

/// Returns the rotation matrix of a quaternion that `scale_to_unit_max` returned. Exact for the
/// identity and for half and quarter turns about the axes.
[[nodiscard]] inline Mat3d rotation_of(const Quaternion& q) noexcept {
  return detail::scaled_rotation(q, 2.0 / detail::squared_length(q));
}

/// Returns the rotation matrix of a quaternion of length 1.
[[nodiscard]] inline Mat3d rotation_of_unit(const Quaternion& q) noexcept {
  return detail::scaled_rotation(q, 2.0);
}

}  // namespace winnow
