#pragma once

// The point of a simplex that is nearest to the origin, a simplex a lane.

#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME {

inline constexpr int kSlots = 3;

/// Up to three points; with the support that comes next at most a tetrahedron.
struct Simplex {
  Vec3<float> point[kSlots];
  LaneMask<float> present[kSlots];
};

struct Nearest {
  Vec3<float> point;
  /// Which points of the simplex span the nearest feature together with the new one.
  LaneMask<float> keep[kSlots];
  /// The origin is in the tetrahedron; `deep` where that is beyond doubt.
  LaneMask<float> inside;
  LaneMask<float> deep;
  /// The new point was there before.
  LaneMask<float> repeated;
};

/// Of a simplex whose nearest point is known and `w`, which is nearer along the line to it: the
/// nearest feature holds w, so of the tetrahedron's fifteen features eight are left. Lengths are
/// about 1.
static inline Nearest nearest_of(const Simplex& simplex, const Vec3<float>& w) {
  const Floats zero(0.0F);
  const Floats one(1.0F);
  const Vec3<float> none{zero, zero, zero};
  Nearest r;
  Vec3<float> edge[kSlots];
  Vec3<float> arm[kSlots];
  Floats length[kSlots];
  r.repeated = zero > one;
  Floats best = dot(w, w);
  r.point = w;
  for (int s = 0; s < kSlots; ++s) {
    r.keep[s] = zero > one;
    edge[s] = select(simplex.present[s], simplex.point[s] - w, none);
    length[s] = dot(edge[s], edge[s]);
    r.repeated = r.repeated | (simplex.present[s] & (length[s] <= zero));
    // From w to the origin, across the edge.
    arm[s] = cross(edge[s], w);
  }
  for (int s = 0; s < kSlots; ++s) {
    const Floats reach = -dot(edge[s], w);
    const Floats t = min(reach / max(length[s], Floats(1e-30F)), one);
    const Vec3<float> x = w + edge[s] * t;
    const Floats square = dot(x, x);
    const LaneMask<float> nearer = (reach > zero) & (square < best);
    best = select(nearer, square, best);
    r.point = select(nearer, x, r.point);
    for (int k = 0; k < s; ++k) r.keep[k] = r.keep[k] & !nearer;
    r.keep[s] = nearer;
  }
  Vec3<float> normal[kSlots];
  Floats area[kSlots];
  Floats height[kSlots];
  const Floats volume = dot(cross(edge[1], edge[2]), edge[0]);
  for (int s = 0; s < kSlots; ++s) {
    const int i = (s + 1) % kSlots;
    const int k = (s + 2) % kSlots;
    normal[s] = cross(edge[i], edge[k]);
    area[s] = dot(normal[s], normal[s]);
    height[s] = dot(normal[s], w);
    // Barycentric coordinates of i and k, times the area.
    const Floats u = dot(normal[s], arm[k]);
    const Floats v = -dot(normal[s], arm[i]);
    const Floats t = height[s] / max(area[s], Floats(1e-30F));
    const Vec3<float> x = normal[s] * t;
    const Floats square = height[s] * t;
    const LaneMask<float> wide = area[s] > Floats(1e-12F) * length[i] * length[k];
    const LaneMask<float> nearer =
        wide & (u > zero) & (v > zero) & (u + v < area[s]) & (square < best);
    best = select(nearer, square, best);
    r.point = select(nearer, x, r.point);
    r.keep[s] = r.keep[s] & !nearer;
    r.keep[i] = r.keep[i] | nearer;
    r.keep[k] = r.keep[k] | nearer;
  }
  // Heights of the origin over the faces at w, and over the face across, have the volume's sign.
  const Floats side = sign_or_one(volume);
  const Vec3<float> across = normal[0] + normal[1] + normal[2];
  const Floats opposite = (volume + height[0] + height[1] + height[2]) * side;
  const Floats doubt(1e-10F);
  r.inside = abs(volume) > zero;
  r.inside = r.inside & (opposite > zero);
  r.deep = opposite * opposite > doubt * dot(across, across);
  for (int s = 0; s < kSlots; ++s) {
    const Floats h = -height[s] * side;
    r.inside = r.inside & (h > zero);
    r.deep = r.deep & (h * h > doubt * area[s]);
  }
  return r;
}

}  // namespace winnow::WINNOW_ISA_NAME
