#pragma once

// Simplices of up to four points and their features nearest to the origin, one per lane: the step
// of GJK (Gilbert, Johnson, Keerthi 1988). Searches that keep their simplices in memory add points
// by SimplexColumns::add: SearchLanes (search_lanes.wide.h) and HullSearch (hull_gjk.wide.h).

#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::hull {

inline constexpr int kSlots = 3;

/// For lengths about 1. kVanishing: squares up to this count as zero. kThin: the smallest squared
/// sine of a triangle that has a normal. kNoiseSquare: squared heights up to this may be rounding
/// errors.
template <typename T>
inline constexpr T kVanishing = sizeof(T) == sizeof(double) ? T(1e-200) : T(1e-30F);
template <typename T>
inline constexpr T kThin = sizeof(T) == sizeof(double) ? T(1e-26) : T(1e-12F);
template <typename T>
inline constexpr T kNoiseSquare = sizeof(T) == sizeof(double) ? T(1e-24) : T(1e-10F);

/// kExact: the computed nearest points are used as upper bounds of the distance, so they must be on
/// the simplex. kNarrow: the smallest squared height of a triangle in that case.
template <typename T>
inline constexpr bool kExact = sizeof(T) == sizeof(double);
template <typename T>
inline constexpr T kNarrow = T(1e-18);

/// Up to three points; with the next support at most a tetrahedron.
template <typename T>
struct Simplex {
  Vec3<T> point[kSlots];
  LaneMask<T> present[kSlots];
};

template <typename T>
struct SimplexNearest {
  Vec3<T> point;
  /// The points of the simplex that span the nearest feature together with the new one.
  LaneMask<T> keep[kSlots];
  /// The origin is in the tetrahedron; `deep` if that is certain.
  LaneMask<T> inside;
  LaneMask<T> deep;
  /// The new point was there before.
  LaneMask<T> repeated;
};

/// Finds the nearest feature after adding w to a simplex. Along the direction of the old nearest
/// point, w is nearer to the origin than all points of the simplex. So the new nearest feature
/// contains w, and only eight of the tetrahedron's fifteen features are tested. Lengths are about
/// 1.
template <typename T>
static inline SimplexNearest<T> nearest_of(const Simplex<T>& simplex, const Vec3<T>& w) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const Vec3<T> none{zero, zero, zero};
  SimplexNearest<T> r;
  Vec3<T> edge[kSlots];
  Vec3<T> arm[kSlots];
  Lanes<T> length[kSlots];
  r.repeated = zero > one;
  Lanes<T> best = dot(w, w);
  r.point = w;
  for (int s = 0; s < kSlots; ++s) {
    r.keep[s] = zero > one;
    edge[s] = select(simplex.present[s], simplex.point[s] - w, none);
    length[s] = dot(edge[s], edge[s]);
    r.repeated = r.repeated | (simplex.present[s] & (length[s] <= zero));
    // Distance from the edge's line to the origin, as a vector times the edge's length.
    arm[s] = cross(edge[s], w);
  }
  for (int s = 0; s < kSlots; ++s) {
    const Lanes<T> reach = -dot(edge[s], w);
    const Lanes<T> t = min(reach / max(length[s], Lanes<T>(kVanishing<T>)), one);
    const Vec3<T> x = w + edge[s] * t;
    const Lanes<T> square = dot(x, x);
    const LaneMask<T> nearer = (reach > zero) & (square < best);
    best = select(nearer, square, best);
    r.point = select(nearer, x, r.point);
    for (int k = 0; k < s; ++k) r.keep[k] = r.keep[k] & !nearer;
    r.keep[s] = nearer;
  }
  Vec3<T> normal[kSlots];
  Lanes<T> area[kSlots];
  Lanes<T> height[kSlots];
  const Lanes<T> volume = dot(cross(edge[1], edge[2]), edge[0]);
  for (int s = 0; s < kSlots; ++s) {
    const int i = (s + 1) % kSlots;
    const int k = (s + 2) % kSlots;
    normal[s] = cross(edge[i], edge[k]);
    area[s] = dot(normal[s], normal[s]);
    height[s] = dot(normal[s], w);
    // Barycentric coordinates of i and k, times the area.
    const Lanes<T> u = dot(normal[s], arm[k]);
    const Lanes<T> v = -dot(normal[s], arm[i]);
    const Lanes<T> t = height[s] / max(area[s], Lanes<T>(kVanishing<T>));
    Vec3<T> x = normal[s] * t;
    Lanes<T> square = height[s] * t;
    LaneMask<T> wide = area[s] > Lanes<T>(kThin<T>) * length[i] * length[k];
    if constexpr (kExact<T>) {
      // Interpolates the points, so that rounding of the normal does not move the result off the
      // triangle.
      const Lanes<T> over = one / max(area[s], Lanes<T>(kVanishing<T>));
      x = w + edge[i] * (u * over) + edge[k] * (v * over);
      square = dot(x, x);
      wide = wide & (area[s] > Lanes<T>(kNarrow<T>) * (length[i] + length[k]));
    }
    const LaneMask<T> nearer = wide & (u > zero) & (v > zero) & (u + v < area[s]) & (square < best);
    best = select(nearer, square, best);
    r.point = select(nearer, x, r.point);
    r.keep[s] = r.keep[s] & !nearer;
    r.keep[i] = r.keep[i] | nearer;
    r.keep[k] = r.keep[k] | nearer;
  }
  // The heights of the origin over the three faces at w, and over the opposite face, have the
  // volume's sign if the origin is inside.
  const Lanes<T> side = sign_or_one(volume);
  const Vec3<T> across = normal[0] + normal[1] + normal[2];
  const Lanes<T> opposite = (volume + height[0] + height[1] + height[2]) * side;
  const Lanes<T> doubt(kNoiseSquare<T>);
  r.inside = abs(volume) > zero;
  r.inside = r.inside & (opposite > zero);
  r.deep = opposite * opposite > doubt * dot(across, across);
  for (int s = 0; s < kSlots; ++s) {
    const Lanes<T> h = -height[s] * side;
    r.inside = r.inside & (h > zero);
    r.deep = r.deep & (h * h > doubt * area[s]);
  }
  return r;
}

/// The simplices of searches, one per lane, in memory: a lane that is done takes the next pair.
template <typename T>
struct SimplexColumns {
  static constexpr int kWidth = Lanes<T>::kCount;
  using Column = T[kWidth];

  /// The outcome of adding a support point, by lane.
  struct Step {
    /// The search makes no progress; the origin is in the simplex (`deep` if that is certain); the
    /// nearest feature has become the simplex.
    LaneMask<T> stuck;
    LaneMask<T> inside;
    LaneMask<T> deep;
    LaneMask<T> moves;
    /// Squared distance of the nearest feature.
    Lanes<T> square;
  };

  void clear(unsigned lane) {
    for (int s = 0; s < kSlots; ++s) present[s][lane] = T(0);
    fresh[lane] = T(1);
  }

  [[nodiscard]] [[gnu::always_inline]] Simplex<T> load() const {
    Simplex<T> simplex;
    for (int s = 0; s < kSlots; ++s) {
      simplex.point[s] = load3(slot[s]);
      simplex.present[s] = Lanes<T>::load(present[s]) > Lanes<T>(T(0));
    }
    return simplex;
  }

  /// Adds the support point w to `simplex`, unless the lane `is_far`. `nearest_yet` is the nearest
  /// point before, `square_yet` its square. `no_gain`: w is hardly nearer to the origin than this
  /// point. In the lanes that move, the nearest feature becomes the simplex; for each slot,
  /// keep_more(slot, lanes that take w) stores more data about w.
  template <typename KeepMore>
  [[gnu::always_inline]] Step add(const Simplex<T>& simplex, const Vec3<T>& w,
                                  const Vec3<T>& nearest_yet, const Lanes<T>& square_yet,
                                  const LaneMask<T>& is_far, const LaneMask<T>& no_gain,
                                  KeepMore&& keep_more) {
    const Lanes<T> zero(T(0));
    const Lanes<T> one(T(1));
    const LaneMask<T> is_fresh = Lanes<T>::load(fresh) > zero;
    const SimplexNearest<T> nearest = nearest_of(simplex, w);
    const Lanes<T> next_square = dot(nearest.point, nearest.point);
    const LaneMask<T> stuck = (!is_fresh) &
                              (no_gain | nearest.repeated | (next_square >= square_yet)) &
                              (!(nearest.inside | is_far));
    const LaneMask<T> inside = nearest.inside & !is_far;
    const LaneMask<T> moves = !(is_far | stuck | inside);
    LaneMask<T> placed = !moves;
    for (int s = 0; s < kSlots; ++s) {
      const LaneMask<T> take = (!placed) & (!nearest.keep[s]);
      placed = placed | take;
      store3(select(take, w, simplex.point[s]), slot[s]);
      keep_more(s, take);
      const Lanes<T> filled = select(take | nearest.keep[s], one, zero);
      select(moves, filled, Lanes<T>::load(present[s])).store(present[s]);
    }
    store3(select(moves, nearest.point, nearest_yet), gap);
    select(moves, next_square, square_yet).store(square);
    zero.store(fresh);
    return {stuck, inside, nearest.deep, moves, next_square};
  }

  static Vec3<T> load3(const Column* v) {
    return {Lanes<T>::load(v[0]), Lanes<T>::load(v[1]), Lanes<T>::load(v[2])};
  }
  static void store3(const Vec3<T>& v, Column* to) {
    v.x.store(to[0]);
    v.y.store(to[1]);
    v.z.store(to[2]);
  }

  /// The simplex; `present` is 1 where there is a point.
  alignas(64) Column slot[kSlots][3] = {};
  alignas(64) Column present[kSlots] = {};
  /// 1 before the first step.
  alignas(64) Column fresh = {};
  /// The nearest point of the simplex, and its square.
  alignas(64) Column gap[3] = {};
  alignas(64) Column square = {};
};

}  // namespace winnow::WINNOW_ISA_NAME::hull
