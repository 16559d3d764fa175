#pragma once

// Simplices of up to four points and their features nearest to the origin, one per lane, for GJK
// (gjk_lanes.wide.h).

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

/// Finds whether the origin is in a tetrahedron, given by the edges from one of its corners and by
/// the three faces at this corner: their normals, the normals' squared lengths, and the heights of
/// the corner over the planes through the origin.
template <typename T>
[[gnu::always_inline]] static inline void find_inside(const Vec3<T> (&edge)[kSlots],
                                                      const Vec3<T> (&normal)[kSlots],
                                                      const Lanes<T> (&area)[kSlots],
                                                      const Lanes<T> (&height)[kSlots],
                                                      SimplexNearest<T>& r) {
  const Lanes<T> zero(T(0));
  // The heights of the origin over the three faces, and over the opposite face, have the volume's
  // sign if the origin is inside.
  const Lanes<T> volume = dot(cross(edge[1], edge[2]), edge[0]);
  const Lanes<T> side = sign_or_one(volume);
  const Vec3<T> across = normal[0] + normal[1] + normal[2];
  const Lanes<T> opposite = (volume + height[0] + height[1] + height[2]) * side;
  const Lanes<T> doubt(kNoiseSquare<T>);
  r.inside = (abs(volume) > zero) & (opposite > zero);
  r.deep = opposite * opposite > doubt * dot(across, across);
  for (int s = 0; s < kSlots; ++s) {
    const Lanes<T> h = -height[s] * side;
    r.inside = r.inside & (h > zero);
    r.deep = r.deep & (h * h > doubt * area[s]);
  }
}

/// Finds the nearest feature after adding w to a simplex. Along the direction of the old nearest
/// point, w is nearer to the origin than all points of the simplex. So the new nearest feature
/// contains w, and only eight of the tetrahedron's fifteen features are tested. Lengths are about
/// 1. Only the first `Slots` slots may be in use.
template <int Slots = kSlots, typename T>
static inline SimplexNearest<T> nearest_of(const Simplex<T>& simplex, const Vec3<T>& w) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const Vec3<T> none{zero, zero, zero};
  SimplexNearest<T> r;
  Vec3<T> edge[kSlots];
  Vec3<T> arm[kSlots];
  Lanes<T> length[kSlots];
  r.repeated = zero > one;
  for (LaneMask<T>& keep : r.keep) keep = zero > one;
  Lanes<T> best = dot(w, w);
  r.point = w;
  for (int s = 0; s < Slots; ++s) {
    edge[s] = select(simplex.present[s], simplex.point[s] - w, none);
    length[s] = dot(edge[s], edge[s]);
    r.repeated = r.repeated | (simplex.present[s] & (length[s] <= zero));
    // Distance from the edge's line to the origin, as a vector times the edge's length.
    arm[s] = cross(edge[s], w);
  }
  for (int s = 0; s < Slots; ++s) {
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
  for (int s = 0; s < kSlots; ++s) {
    const int i = (s + 1) % kSlots;
    const int k = (s + 2) % kSlots;
    if (i >= Slots || k >= Slots) continue;
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
  if constexpr (Slots == kSlots) {
    find_inside(edge, normal, area, height, r);
  } else {
    r.inside = r.deep = zero > one;
  }
  return r;
}

/// As nearest_of, but computes only as many points as the largest simplex in `lanes` has.
template <typename T>
static inline SimplexNearest<T> nearest_of_few(const Simplex<T>& simplex, const Vec3<T>& w,
                                               const LaneMask<T>& lanes) {
  if (bits(lanes & simplex.present[2]) != 0) return nearest_of(simplex, w);
  if (bits(lanes & simplex.present[1]) != 0) return nearest_of<2>(simplex, w);
  if (bits(lanes & simplex.present[0]) != 0) return nearest_of<1>(simplex, w);
  const LaneMask<T> none = lanes & !lanes;
  return {w, {none, none, none}, none, none, none};
}

}  // namespace winnow::WINNOW_ISA_NAME::hull
