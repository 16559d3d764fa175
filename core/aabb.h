#pragma once

#include <winnow/core/export.h>
#include <winnow/core/rounding.h>
#include <winnow/core/vec3.h>

#include <limits>

namespace winnow {

/// Axis-aligned box [min, max], closed: boxes that touch overlap, a box of zero extent is legal,
/// and an axis may reach to infinity. Default-constructed it is empty and overlaps nothing.
struct Aabb {
  /// Least corner; +infinity if empty.
  Vec3f min = Vec3f::constant(std::numeric_limits<float>::infinity());
  /// Greatest corner; -infinity if empty.
  Vec3f max = Vec3f::constant(-std::numeric_limits<float>::infinity());

  /// The smallest float box that contains the double box [min, max].
  [[nodiscard]] static Aabb outward(const Vec3d& min, const Vec3d& max) {
    return {round_down(min), round_up(max)};
  }

  /// The smallest float box that contains the double box [min, max], measured from `origin`. Far
  /// from 0 floats are coarse (8 apart at 1e8): boxes that are measured from a point among the
  /// objects are as tight there, and as cheap to prune by, as those of objects around 0. The
  /// difference of two doubles is rounded outward, too, so nothing sticks out.
  [[nodiscard]] WINNOW_API static Aabb outward(const Vec3d& min, const Vec3d& max,
                                               const Vec3d& origin) noexcept;

  /// True if a partition takes this box: no NaN, min <= max, and not wholly at infinity.
  [[nodiscard]] bool is_valid() const noexcept {
    constexpr float inf = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (!(min[axis] <= max[axis] && min[axis] < inf && max[axis] > -inf)) return false;
    }
    return true;
  }

  /// Closed overlap test; false if either box has a NaN.
  [[nodiscard]] bool overlaps(const Aabb& other) const noexcept {
    return min.x() <= other.max.x() && other.min.x() <= max.x() && min.y() <= other.max.y() &&
           other.min.y() <= max.y() && min.z() <= other.max.z() && other.min.z() <= max.z();
  }

  /// Grows to contain `other`.
  void merge(const Aabb& other) noexcept {
    const auto lesser = [](const Vec3f& a, const Vec3f& b) {
      return Vec3f(detail::lesser(a.x(), b.x()), detail::lesser(a.y(), b.y()),
                   detail::lesser(a.z(), b.z()));
    };
    min = lesser(min, other.min);
    max = -lesser(-max, -other.max);
  }

  /// The same corners, float by float.
  friend bool operator==(const Aabb& a, const Aabb& b) noexcept {
    return a.min == b.min && a.max == b.max;
  }
};

static_assert(sizeof(Aabb) == 24 && alignof(Aabb) == 4, "layout must not depend on build flags");

}  // namespace winnow
