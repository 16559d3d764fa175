#pragma once

#include <winnow/core/export.h>
#include <winnow/core/matrix.h>
#include <winnow/core/quaternion.h>

#include <cmath>

namespace winnow {

namespace detail {

/// Returns the rotation matrix of `q`; `scale` must be 2 / |q|^2.
[[nodiscard]] inline Mat3d scaled_rotation(const Quaternion& q, double scale) noexcept {
  const double w = q.w();
  const double x = q.x();
  const double y = q.y();
  const double z = q.z();
  return {
      1.0 - scale * (y * y + z * z), scale * (x * y - w * z),       scale * (x * z + w * y),  //
      scale * (x * y + w * z),       1.0 - scale * (x * x + z * z), scale * (y * z - w * x),  //
      scale * (x * z - w * y),       scale * (y * z + w * x),       1.0 - scale * (x * x + y * y)};
}

[[nodiscard]] inline double squared_length(const Quaternion& q) noexcept {
  return (q[0] * q[0] + q[2] * q[2]) + (q[1] * q[1] + q[3] * q[3]);
}

}  // namespace detail

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
