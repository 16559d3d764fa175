#pragma once

// Bounding volumes that a partition stores: boxes, spheres and k-DOPs, and their margins; and views
// of boxes in the caller's memory.

#include <winnow/core/export.h>
#include <winnow/core/point_view.h>
#include <winnow/core/vectors.h>

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace winnow {

/// Rounding outward, for volumes that a program computes in double: round_down(x) is the largest
/// float that is not above x, round_up(x) the smallest that is not below it. NaN stays NaN; beyond
/// the range of float the result is infinite. A Vec3d is rounded coordinate by coordinate.
/// @{
using detail::round_down;
using detail::round_up;
/// @}

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
    return {detail::round_down(min), detail::round_up(max)};
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

/// Non-owning view of boxes in the caller's memory: six float pointers, one stride in bytes and a
/// count. It copies nothing and must not outlive that memory.
struct BoxView {
  std::array<const float*, 3> min{};   ///< lower corner of the first box: x, y, z
  std::array<const float*, 3> max{};   ///< upper corner of the first box: x, y, z
  std::size_t stride = sizeof(float);  ///< bytes from one box to the next
  std::size_t count = 0;               ///< number of boxes

  BoxView() = default;

  /// Views any contiguous container of boxes.
  template <std::convertible_to<std::span<const Aabb>> Boxes>
  BoxView(const Boxes& container) noexcept {  // NOLINT(google-explicit-constructor)
    const std::span<const Aabb> boxes = container;
    if (boxes.empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      min[axis] = boxes.data()->min.data() + axis;
      max[axis] = boxes.data()->max.data() + axis;
    }
    stride = sizeof(Aabb);
    count = boxes.size();
  }

  /// Views columns, or members of any struct: `stride_bytes` is the distance between two boxes.
  BoxView(std::array<const float*, 3> mins, std::array<const float*, 3> maxs, std::size_t boxes,
          std::size_t stride_bytes = sizeof(float)) noexcept
      : min(mins), max(maxs), stride(stride_bytes), count(boxes) {}

  /// Returns a copy of box i; i must be below `count`.
  [[nodiscard]] Aabb operator[](std::size_t i) const noexcept {
    return {{detail::strided(min[0], i, stride), detail::strided(min[1], i, stride),
             detail::strided(min[2], i, stride)},
            {detail::strided(max[0], i, stride), detail::strided(max[1], i, stride),
             detail::strided(max[2], i, stride)}};
  }
};

/// A subset of the entries of per-object arrays, for calls that process only this subset: the
/// caller need not copy these entries into smaller arrays. It copies nothing and must not outlive
/// the spans that it was made from.
struct IndexSubset {
  std::span<const std::uint32_t>
      indices;  ///< the selected entries, in any order, without `is_mask`
  /// With `is_mask`, one bit per entry: entry i is selected if bit i % 64 of words[i / 64] is set.
  /// Bits behind the last entry are ignored.
  std::span<const std::uint64_t> words;
  bool is_mask = false;  ///< true if `words` selects the entries, false if `indices` does

  /// Selects entries by index, in any order.
  [[nodiscard]] static IndexSubset listed(std::span<const std::uint32_t> indices) noexcept {
    return {indices, {}, false};
  }
  /// Selects entries by a bit mask; see `words`.
  [[nodiscard]] static IndexSubset masked(std::span<const std::uint64_t> words) noexcept {
    return {{}, words, true};
  }
};

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
    const double reach = detail::to_double(radius) + detail::to_double(other.radius);
    double square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double gap = detail::to_double(center[axis]) - detail::to_double(other.center[axis]);
      square += gap * gap;
    }
    return square <= reach * reach;
  }

  /// Returns the smallest float box that contains the ball.
  [[nodiscard]] Aabb bounds() const noexcept {
    Aabb box;
    const double r = detail::to_double(radius);
    for (int axis = 0; axis < 3; ++axis) {
      const double c = detail::to_double(center[axis]);
      box.min[axis] = detail::round_down(detail::add_down(c, -r));
      box.max[axis] = detail::round_up(detail::add_up(c, r));
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
      const double lo = detail::to_double(box.min[axis]);
      const double hi = detail::to_double(box.max[axis]);
      const auto c = static_cast<float>(0.5 * (lo + hi));
      const double up = hi - detail::to_double(c);
      const double down = detail::to_double(c) - lo;
      const double reach = up < down ? down : up;
      sphere.center[axis] = c;
      square += reach * reach;
    }
    sphere.radius = detail::round_up(std::sqrt(square) * (1.0 + 2e-15));
    return sphere;
  }
};

static_assert(sizeof(Sphere) == 16 && alignof(Sphere) == 4,
              "layout must not depend on build flags");

/// Returns the slab directions of a k-DOP, not normalised: the three axes, then the four cube
/// diagonals (K = 14 and 26), then the six edge diagonals (K = 18 and 26). See Klosowski et al.,
/// "Efficient collision detection using bounding volume hierarchies of k-DOPs", IEEE TVCG 4(1),
/// 1998.
template <int K>
[[nodiscard]] constexpr auto kdop_directions() noexcept {
  static_assert(K == 14 || K == 18 || K == 26, "a k-DOP has 14, 18 or 26 faces");
  using Direction = std::array<int, 3>;
  constexpr std::array<Direction, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  constexpr std::array<Direction, 4> corners{{{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}}};
  constexpr std::array<Direction, 6> edges{
      {{1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, -1, 0}, {1, 0, -1}, {0, 1, -1}}};
  std::array<Direction, K / 2> result{};
  std::size_t n = 0;
  for (const Direction& d : axes) result[n++] = d;
  if constexpr (K != 18) {
    for (const Direction& d : corners) result[n++] = d;
  }
  if constexpr (K != 14) {
    for (const Direction& d : edges) result[n++] = d;
  }
  return result;
}

namespace detail {

template <std::size_t Size>
[[nodiscard]] constexpr std::array<float, Size> filled(float value) noexcept {
  std::array<float, Size> result{};
  for (float& f : result) f = value;
  return result;
}

}  // namespace detail

/// Discrete oriented polytope: K/2 slabs [min, max] along `kdop_directions<K>()`; closed. A
/// default-constructed k-DOP is empty. Overlap of all slabs is necessary, but not sufficient, for
/// the polytopes to intersect.
template <int K>
struct Kdop {
  /// Number of slabs, which are pairs of opposite faces.
  static constexpr std::size_t kSlabs = K / 2;

  /// Lower ends of the slabs; +infinity if the k-DOP is empty.
  std::array<float, kSlabs> min = detail::filled<kSlabs>(std::numeric_limits<float>::infinity());
  /// Upper ends of the slabs; -infinity if the k-DOP is empty.
  std::array<float, kSlabs> max = detail::filled<kSlabs>(-std::numeric_limits<float>::infinity());

  /// Returns the tightest k-DOP of a box, rounded outward.
  [[nodiscard]] static Kdop around(const Aabb& box) noexcept {
    Kdop result;
    const auto directions = kdop_directions<K>();
    double low[3];
    double high[3];
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = detail::to_double(box.min[axis]);
      high[axis] = detail::to_double(box.max[axis]);
    }
    for (std::size_t s = 0; s < kSlabs; ++s) {
      double lo = 0.0;
      double hi = 0.0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int weight = directions[s][axis];
        if (weight == 0) continue;
        lo = detail::add_down(lo, weight > 0 ? low[axis] : -high[axis]);
        hi = detail::add_up(hi, weight > 0 ? high[axis] : -low[axis]);
      }
      result.min[s] = detail::round_down(lo);
      result.max[s] = detail::round_up(hi);
    }
    return result;
  }

  /// Returns a k-DOP of a point set; empty for an empty set. Each point is rounded outward to a box
  /// of floats, and the k-DOP contains the tightest k-DOPs of these boxes. O(points * K).
  [[nodiscard]] static Kdop around(const PointView& points) noexcept {
    Kdop result;
    for (std::size_t i = 0; i < points.count; ++i) {
      const Vec3d p = points[i];
      const Kdop one = around(Aabb::outward(p, p));
      for (std::size_t s = 0; s < kSlabs; ++s) {
        result.min[s] = detail::lesser(result.min[s], one.min[s]);
        result.max[s] = -detail::lesser(-result.max[s], -one.max[s]);
      }
    }
    return result;
  }

  /// Returns true if a partition accepts this k-DOP: each slab has no NaN, min <= max, and is not
  /// entirely at infinity.
  [[nodiscard]] bool is_valid() const noexcept {
    constexpr float inf = std::numeric_limits<float>::infinity();
    for (std::size_t s = 0; s < kSlabs; ++s) {
      if (!(min[s] <= max[s] && min[s] < inf && max[s] > -inf)) return false;
    }
    return true;
  }

  /// Returns the box of the first three slabs.
  [[nodiscard]] Aabb bounds() const noexcept {
    return {{min[0], min[1], min[2]}, {max[0], max[1], max[2]}};
  }

  /// Returns true if all slabs overlap; closed.
  [[nodiscard]] bool overlaps(const Kdop& other) const noexcept {
    for (std::size_t s = 0; s < kSlabs; ++s) {
      if (!(min[s] <= other.max[s] && other.min[s] <= max[s])) return false;
    }
    return true;
  }
};

static_assert(sizeof(Kdop<14>) == 56 && sizeof(Kdop<18>) == 72 && sizeof(Kdop<26>) == 104);

/// Kind of bounding volume that a partition stores and tests.
enum class Volume : std::uint8_t {
  aabb,    ///< axis-aligned box: Aabb
  sphere,  ///< ball: Sphere
  kdop14,  ///< Kdop<14>: a box with cut corners
  kdop18,  ///< Kdop<18>: a box with cut edges
  kdop26,  ///< Kdop<26>: a box with cut corners and edges
};

/// Amount by which a partition enlarges its stored volumes on every side (a fat AABB): `distance` +
/// `share` * the longest finite edge of the object's box. While an object moves by less than its
/// margin, its stored volume does not change and costs no update. In return, pairs are reported
/// whose given volumes are apart by up to the sum of their margins. `distance` corresponds to the
/// margins of PhysX and Bullet, `share` to the margin of Box2D. Negative values and NaN count as 0.
struct FatMargin {
  float distance = 0.0F;  ///< in units of length
  float share = 0.0F;     ///< 0.05 is a twentieth of the longest edge
};

}  // namespace winnow
