#pragma once

#include <winnow/core/export.h>
#include <winnow/core/rounding.h>
#include <winnow/core/vec3.h>

#include <limits>

namespace winnow {

/// Axis-aligned box [min, max]. It is closed: boxes that touch overlap. A box of zero extent is
/// valid, and an axis may extend to infinity. A default-constructed box is empty and overlaps
/// nothing.
struct Aabb {
  /// Lower corner; +infinity if the box is empty.
  Vec3f min = Vec3f::constant(std::numeric_limits<float>::infinity());
  /// Upper corner; -infinity if the box is empty.
  Vec3f max = Vec3f::constant(-std::numeric_limits<float>::infinity());

  /// Returns the smallest float box that contains the double box [min, max].
  [[nodiscard]] static Aabb outward(const Vec3d& min, const Vec3d& max) {
    return {round_down(min), round_up(max)};
  }

  /// Returns the smallest float box that contains the double box [min, max], relative to `origin`.
  /// Floats are coarse far from 0 (8 apart at 1e8), so boxes far from 0 are tighter, and prune
  /// better, if they are relative to a point among the objects. The subtraction is rounded outward
  /// too: the result always contains the exact box.
  [[nodiscard]] WINNOW_API static Aabb outward(const Vec3d& min, const Vec3d& max,
                                               const Vec3d& origin) noexcept;

  /// Returns true if a partition accepts this box: no NaN, min <= max, and not entirely at
  /// infinity.
  [[nodiscard]] bool is_valid() const noexcept {
    constexpr float inf = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (!(min[axis] <= max[axis] && min[axis] < inf && max[axis] > -inf)) return false;
    }
    return true;
  }

  /// Returns true if the closed boxes overlap; false if either has a NaN.
  [[nodiscard]] bool overlaps(const Aabb& other) const noexcept {
    return min.x() <= other.max.x() && other.min.x() <= max.x() && min.y() <= other.max.y() &&
           other.min.y() <= max.y() && min.z() <= other.max.z() && other.min.z() <= max.z();
  }

  /// Grows this box to contain `other`.
  void merge(const Aabb& other) noexcept {
    const auto lesser = [](const Vec3f& a, const Vec3f& b) {
      return Vec3f(detail::lesser(a.x(), b.x()), detail::lesser(a.y(), b.y()),
                   detail::lesser(a.z(), b.z()));
    };
    min = lesser(min, other.min);
    max = -lesser(-max, -other.max);
  }

  /// True if all coordinates are equal.
  friend bool operator==(const Aabb& a, const Aabb& b) noexcept {
    return a.min == b.min && a.max == b.max;
  }
};

static_assert(sizeof(Aabb) == 24 && alignof(Aabb) == 4, "layout must not depend on build flags");

}  // namespace winnow
