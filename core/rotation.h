#pragma once

#include <winnow/core/export.h>
#include <winnow/core/matrix.h>

#include <array>
#include <cmath>

namespace winnow {

/// Quaternion w, x, y, z, as in Pose.
using Quaternion = std::array<double, 4>;

namespace detail {

/// Returns the rotation matrix of `q`; `scale` must be 2 / |q|^2.
[[nodiscard]] inline Mat3d scaled_rotation(const Quaternion& q, double scale) noexcept {
  const auto [w, x, y, z] = q;
  return {
      1.0 - scale * (y * y + z * z), scale * (x * y - w * z),       scale * (x * z + w * y),  //
      scale * (x * y + w * z),       1.0 - scale * (x * x + z * z), scale * (y * z - w * x),  //
      scale * (x * z - w * y),       scale * (y * z + w * x),       1.0 - scale * (x * x + y * y)};
}

[[nodiscard]] inline double squared_length(const Quaternion& q) noexcept {
  return (q[0] * q[0] + q[2] * q[2]) + (q[1] * q[1] + q[3] * q[3]);
}

}  // namespace detail

/// Returns the orientation of a valid pose divided by its largest component, so that products of
/// two components stay in the range of double. Exact for the identity.
[[nodiscard]] inline Quaternion scale_to_unit_max(const double (&orientation)[4]) noexcept {
  double largest = 0.0;
  for (const double q : orientation) largest = std::fabs(q) > largest ? std::fabs(q) : largest;
  return {orientation[0] / largest, orientation[1] / largest, orientation[2] / largest,
          orientation[3] / largest};
}

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

/// Returns the rotation that applies `inner` first, then `outer`.
[[nodiscard]] inline Quaternion multiply(const Quaternion& outer,
                                         const Quaternion& inner) noexcept {
  const auto [w, x, y, z] = outer;
  return {w * inner[0] - x * inner[1] - y * inner[2] - z * inner[3],
          w * inner[1] + x * inner[0] + y * inner[3] - z * inner[2],
          w * inner[2] - x * inner[3] + y * inner[0] + z * inner[1],
          w * inner[3] + x * inner[2] - y * inner[1] + z * inner[0]};
}

}  // namespace winnow
