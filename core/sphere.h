#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/rounding.h>
#include <winnow/core/vec3.h>

#include <cmath>

namespace winnow {

/// A closed ball; a ball of radius zero is a point.
struct Sphere {
  /// Centre; finite.
  Vec3f center;
  float radius = 0.0F;  ///< finite, >= 0

  /// Returns true if a partition accepts this sphere: finite centre, finite radius >= 0.
  [[nodiscard]] bool is_valid() const noexcept {
    return center.all_finite() && std::isfinite(radius) && radius >= 0.0F;
  }

  /// Returns true if the closed balls overlap. Computed in double; exact for centres and radii of
  /// similar size.
  [[nodiscard]] bool overlaps(const Sphere& other) const noexcept {
    const double reach = to_double(radius) + to_double(other.radius);
    double square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double gap = to_double(center[axis]) - to_double(other.center[axis]);
      square += gap * gap;
    }
    return square <= reach * reach;
  }

  /// Returns the smallest float box that contains the ball.
  [[nodiscard]] Aabb bounds() const noexcept {
    Aabb box;
    const double r = to_double(radius);
    for (int axis = 0; axis < 3; ++axis) {
      const double c = to_double(center[axis]);
      box.min[axis] = round_down(add_down(c, -r));
      box.max[axis] = round_up(add_up(c, r));
    }
    return box;
  }

  /// Returns a ball that contains a box of finite extents, rounded outward: at most 2 ulp larger
  /// than the smallest ball around the box's rounded centre.
  [[nodiscard]] static Sphere around(const Aabb& box) noexcept {
    // Scalar code: with whole vectors, g++ 12 -O2 vectorises centre and radius together and loses
    // the outward rounding of the radius.
    Sphere sphere;
    double square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double lo = to_double(box.min[axis]);
      const double hi = to_double(box.max[axis]);
      const auto c = static_cast<float>(0.5 * (lo + hi));
      const double up = hi - to_double(c);
      const double down = to_double(c) - lo;
      const double reach = up < down ? down : up;
      sphere.center[axis] = c;
      square += reach * reach;
    }
    sphere.radius = round_up(std::sqrt(square) * (1.0 + 2e-15));
    return sphere;
  }
};

static_assert(sizeof(Sphere) == 16 && alignof(Sphere) == 4,
              "layout must not depend on build flags");

}  // namespace winnow
