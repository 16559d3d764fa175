#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/pose.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace winnow::mid {

using Vec = Eigen::Vector3d;
using Mat = Eigen::Matrix3d;

/// Of a length, for the roundings of a few sums and rotations.
inline constexpr double kSlack = 1e-14;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An axis-aligned box in double; infinite bounds are legal.
struct Box {
  Vec min = Vec::Constant(kInfinity);
  Vec max = Vec::Constant(-kInfinity);

  [[nodiscard]] static Box of(const Aabb& box) noexcept {
    return {box.min.cast<double>(), box.max.cast<double>()};
  }
  [[nodiscard]] bool is_finite() const noexcept { return min.allFinite() && max.allFinite(); }
  /// Closed; true where a bound is NaN, so that nothing is missed.
  [[nodiscard]] bool meets(const Box& other) const noexcept {
    for (int i = 0; i < 3; ++i) {
      if (min[i] > other.max[i] || other.min[i] > max[i]) return false;
    }
    return true;
  }
  void merge(const Box& other) noexcept {
    min = min.cwiseMin(other.min);
    max = max.cwiseMax(other.max);
  }
  /// Sums of infinities have no value: bounds without one reach to infinity.
  void settle() noexcept {
    for (int i = 0; i < 3; ++i) {
      if (!(min[i] <= kInfinity)) min[i] = -kInfinity;
      if (!(max[i] >= -kInfinity)) max[i] = kInfinity;
    }
  }
};

/// A difference of positions, at most the largest double.
[[nodiscard]] inline Vec finite(const Vec& v) noexcept {
  constexpr double kMost = std::numeric_limits<double>::max();
  return v.cwiseMin(kMost).cwiseMax(-kMost);
}

/// w, x, y, z divided by the largest, so that no product overflows. Exact for the identity.
[[nodiscard]] inline Eigen::Vector4d tame(const double q[4]) noexcept {
  const Eigen::Map<const Eigen::Vector4d> given(q);
  return given / given.cwiseAbs().maxCoeff();
}

/// Of a tame quaternion. Exact for the identity and for half and quarter turns about the axes.
[[nodiscard]] inline Mat rotation_of(const Eigen::Vector4d& q) noexcept {
  const double s = 2.0 / q.squaredNorm();
  const double w = q[0];
  const double x = q[1];
  const double y = q[2];
  const double z = q[3];
  Mat r;
  r << 1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),  //
      s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x),   //
      s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y);
  return r;
}

/// First `inner`, then `outer`.
[[nodiscard]] inline Eigen::Vector4d product(const Eigen::Vector4d& outer,
                                             const Eigen::Vector4d& inner) noexcept {
  const double w = outer[0];
  const double x = outer[1];
  const double y = outer[2];
  const double z = outer[3];
  return {w * inner[0] - x * inner[1] - y * inner[2] - z * inner[3],
          w * inner[1] + x * inner[0] + y * inner[3] - z * inner[2],
          w * inner[2] - x * inner[3] + y * inner[0] + z * inner[1],
          w * inner[3] + x * inner[2] - y * inner[1] + z * inner[0]};
}

[[nodiscard]] inline Pose pose_of(const Vec& position,
                                  const Eigen::Vector4d& orientation) noexcept {
  const Vec p = finite(position);
  return {{p.x(), p.y(), p.z()}, {orientation[0], orientation[1], orientation[2], orientation[3]}};
}

}  // namespace winnow::mid
