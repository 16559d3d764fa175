#pragma once

#include <winnow/core/aabb.h>

#include <Eigen/Core>
#include <cmath>

namespace winnow {

/// Closed ball. A radius of zero is a point.
struct Sphere {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  float radius = 0.0F;

  /// True if a partition takes this sphere: finite centre, finite radius >= 0.
  [[nodiscard]] bool is_valid() const noexcept {
    return center.allFinite() && std::isfinite(radius) && radius >= 0.0F;
  }

  /// Closed overlap test, computed in double; exact for centres and radii of similar size.
  [[nodiscard]] bool overlaps(const Sphere& other) const noexcept {
    const double reach = static_cast<double>(radius) + static_cast<double>(other.radius);
    return (center.cast<double>() - other.center.cast<double>()).squaredNorm() <= reach * reach;
  }

  /// The smallest float box that contains the ball.
  [[nodiscard]] Aabb bounds() const noexcept {
    const Eigen::Vector3d c = center.cast<double>();
    const Eigen::Vector3d r = Eigen::Vector3d::Constant(static_cast<double>(radius));
    return Aabb::outward(c - r, c + r);
  }

  /// A ball that contains a box of finite extents, rounded outward: at most 2 ulp larger than the
  /// smallest one about the box's rounded centre.
  [[nodiscard]] static Sphere around(const Aabb& box) noexcept {
    const Eigen::Vector3d lo = box.min.cast<double>();
    const Eigen::Vector3d hi = box.max.cast<double>();
    const Eigen::Vector3f center = (0.5 * (lo + hi)).cast<float>();
    const Eigen::Vector3d c = center.cast<double>();
    const double reach = (hi - c).cwiseMax(c - lo).norm();
    return {center, round_up(reach * (1.0 + 1e-15))};
  }
};

static_assert(sizeof(Sphere) == 16 && alignof(Sphere) == 4,
              "layout must not depend on build flags");

}  // namespace winnow
