#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/matrix.h>
#include <winnow/core/rounding.h>
#include <winnow/core/vec3.h>

#include <cmath>

namespace winnow {

/// All points center + axes * s with |s_i| <= half_i; closed. The columns of `axes` should be
/// orthogonal unit vectors. Other finite columns are accepted; the box is then a parallelepiped.
struct OrientedBox {
  /// Centre of the box.
  Vec3f center;
  /// Half extent along each column of `axes`.
  Vec3f half;
  /// Directions of the edges, as columns.
  Mat3f axes = Mat3f::identity();

  /// Returns true if a query accepts this box: all finite, half >= 0.
  [[nodiscard]] bool is_valid() const noexcept {
    return center.all_finite() && half.all_finite() && axes.all_finite() && half.x() >= 0.0F &&
           half.y() >= 0.0F && half.z() >= 0.0F;
  }

  /// Returns a float box that contains this box and is at most two ulp larger than the smallest
  /// one.
  [[nodiscard]] Aabb bounds() const noexcept {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
      double reach = 0.0;
      for (int i = 0; i < 3; ++i) {
        reach += std::abs(to_double(axes(axis, i))) * to_double(half[i]);
      }
      reach *= 1.0 + 1e-15;
      const double c = to_double(center[axis]);
      box.min[axis] = round_down(add_down(c, -reach));
      box.max[axis] = round_up(add_up(c, reach));
    }
    return box;
  }
};

static_assert(sizeof(OrientedBox) == 60 && alignof(OrientedBox) == 4,
              "layout must not depend on build flags");

}  // namespace winnow
