#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/rounding.h>

#include <Eigen/Core>
#include <cmath>

namespace winnow {

/// The points center + axes * s with |s_i| <= half_i; closed. The columns of `axes` are meant to be
/// orthogonal unit vectors; any finite ones are taken, and then make a parallelepiped.
struct OrientedBox {
  /// The middle.
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  /// Extent from the middle along each column of `axes`.
  Eigen::Vector3f half = Eigen::Vector3f::Zero();
  /// Directions as columns.
  Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();

  /// True if a query takes this box: all finite, half >= 0.
  [[nodiscard]] bool is_valid() const noexcept {
    return center.allFinite() && half.allFinite() && axes.allFinite() &&
           (half.array() >= 0.0F).all();
  }

  /// A float box around it, at most two ulp larger than the smallest.
  [[nodiscard]] Aabb bounds() const noexcept {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
      double reach = 0.0;
      for (int i = 0; i < 3; ++i) {
        reach += std::abs(static_cast<double>(axes(axis, i))) * static_cast<double>(half[i]);
      }
      reach *= 1.0 + 1e-15;
      const auto c = static_cast<double>(center[axis]);
      box.min[axis] = round_down(add_down(c, -reach));
      box.max[axis] = round_up(add_up(c, reach));
    }
    return box;
  }
};

static_assert(sizeof(OrientedBox) == 60 && alignof(OrientedBox) == 4,
              "layout must not depend on build flags");

}  // namespace winnow
