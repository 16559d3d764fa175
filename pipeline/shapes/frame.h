#pragma once

#include <winnow/core/eigen.h>
#include <winnow/core/pose.h>
#include <winnow/core/volumes.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace winnow::mid {

using Vec = Eigen::Vector3d;
using Mat = Eigen::Matrix3d;

/// Relative error bound for a few sums and rotations of a length.
inline constexpr double kSlack = 1e-14;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An axis-aligned box in double; infinite bounds are legal.
struct Box3 {
  Vec min = Vec::Constant(kInfinity);
  Vec max = Vec::Constant(-kInfinity);

  [[nodiscard]] static Box3 of(const Aabb& box) noexcept {
    return {box.min.cast<double>(), box.max.cast<double>()};
  }
  [[nodiscard]] bool is_finite() const noexcept { return min.allFinite() && max.allFinite(); }
  /// Returns whether the closed boxes overlap; true if a bound is NaN, so that no pair is missed.
  [[nodiscard]] bool overlaps(const Box3& other) const noexcept {
    for (int i = 0; i < 3; ++i) {
      if (min[i] > other.max[i] || other.min[i] > max[i]) return false;
    }
    return true;
  }
  /// Returns the box enlarged by `by` on every side.
  [[nodiscard]] Box3 grown(double by) const noexcept {
    return {min.array() - by, max.array() + by};
  }
  [[nodiscard]] Box3 moved(const Vec& by) const noexcept { return {min + by, max + by}; }
  /// The largest coordinate, without its sign.
  [[nodiscard]] double largest() const noexcept {
    return std::max(min.cwiseAbs().maxCoeff(), max.cwiseAbs().maxCoeff());
  }
  void merge(const Box3& other) noexcept {
    min = min.cwiseMin(other.min);
    max = max.cwiseMax(other.max);
  }
  /// Sums of opposite infinities are NaN; such bounds become infinite.
  void replace_nan_bounds() noexcept {
    for (int i = 0; i < 3; ++i) {
      if (!(min[i] <= kInfinity)) min[i] = -kInfinity;
      if (!(max[i] >= -kInfinity)) max[i] = kInfinity;
    }
  }
};

/// Clamps each coordinate to the finite doubles.
[[nodiscard]] inline Vec finite(const Vec& v) noexcept {
  constexpr double kMaxDouble = std::numeric_limits<double>::max();
  return v.cwiseMin(kMaxDouble).cwiseMax(-kMaxDouble);
}

[[nodiscard]] inline Pose pose_of(const Vec& position, const Quaternion& orientation) noexcept {
  const Vec p = finite(position);
  return {{p.x(), p.y(), p.z()}, {orientation[0], orientation[1], orientation[2], orientation[3]}};
}

}  // namespace winnow::mid
