#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/point_view.h>
#include <winnow/core/rounding.h>

#include <array>
#include <cstddef>
#include <limits>

namespace winnow {

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

/// Discrete oriented polytope: K/2 slabs [min, max] along `kdop_directions<K>()`; closed. A
/// default-constructed k-DOP is empty. Overlap of all slabs is necessary, but not sufficient, for
/// the polytopes to intersect.
template <int K>
struct Kdop {
  /// Number of slabs, which are pairs of opposite faces.
  static constexpr std::size_t kSlabs = K / 2;

  /// Lower ends of the slabs; +infinity if the k-DOP is empty.
  std::array<float, kSlabs> min = filled(std::numeric_limits<float>::infinity());
  /// Upper ends of the slabs; -infinity if the k-DOP is empty.
  std::array<float, kSlabs> max = filled(-std::numeric_limits<float>::infinity());

  /// Returns the tightest k-DOP of a box, rounded outward.
  [[nodiscard]] static Kdop around(const Aabb& box) noexcept {
    Kdop result;
    const auto directions = kdop_directions<K>();
    double low[3];
    double high[3];
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = to_double(box.min[axis]);
      high[axis] = to_double(box.max[axis]);
    }
    for (std::size_t s = 0; s < kSlabs; ++s) {
      double lo = 0.0;
      double hi = 0.0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int weight = directions[s][axis];
        if (weight == 0) continue;
        lo = add_down(lo, weight > 0 ? low[axis] : -high[axis]);
        hi = add_up(hi, weight > 0 ? high[axis] : -low[axis]);
      }
      result.min[s] = round_down(lo);
      result.max[s] = round_up(hi);
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

 private:
  static constexpr std::array<float, kSlabs> filled(float value) noexcept {
    std::array<float, kSlabs> result{};
    for (float& f : result) f = value;
    return result;
  }
};

static_assert(sizeof(Kdop<14>) == 56 && sizeof(Kdop<18>) == 72 && sizeof(Kdop<26>) == 104);

}  // namespace winnow
