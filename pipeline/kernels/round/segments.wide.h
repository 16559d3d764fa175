#pragma once

// Segments in lanes: the cores of capsules and the edges of triangles.

#include "pipeline/kernels/round/round.wide.h"

namespace winnow::WINNOW_ISA_NAME {

template <typename T>
[[gnu::always_inline]] inline Lanes<T> clamp(const Lanes<T>& v, const Lanes<T>& low,
                                             const Lanes<T>& high) {
  return min(max(v, low), high);
}

/// 0, or NaN where the orientation is not usable.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> doubt(const Turn<T>& turn) {
  return turn.scale - turn.scale;
}

/// What a contact at t of a capsule's segment is called: 1 and 2 the ends, 0 between them.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> segment_feature(const Lanes<T>& t,
                                                       const Lanes<T>& half_length) {
  const Lanes<T> zero(T(0));
  const Lanes<T> low = select(t <= -half_length, Lanes<T>(T(2)), zero);
  return select(t >= half_length, Lanes<T>(T(1)), low);
}

/// Points s u and c + t e.
template <typename T>
struct SegmentFeet {
  Lanes<T> s;
  Lanes<T> t;
};

/// The second segment: c + t e, low <= t <= high; `square` is |e|^2, which may be 0.
template <typename T>
struct SegmentLanes {
  Vec3<T> c;
  Vec3<T> e;
  Lanes<T> square;
  Lanes<T> low;
  Lanes<T> high;
};

/// The closest points of the segment s u, |u| = 1, |s| <= h, and another. After Ericson, Real-Time
/// Collision Detection (2005), 5.1.9, but s comes from products of cross products, `k` = u x e,
/// `over` = 1 / |k|^2: by Lagrange's identity the same numbers without the cancellation of parallel
/// segments. An error of s is then eps |c| / sin, of the distance in which it enters times sin eps
/// |c|, whatever the angle; where u x e vanishes any s will do, as the last two steps find the
/// closest points then.
template <typename T>
[[gnu::always_inline]] inline SegmentFeet<T> closest_feet(const Vec3<T>& u, const Lanes<T>& h,
                                                          const SegmentLanes<T>& b,
                                                          const Vec3<T>& k, const Lanes<T>& over) {
  const Lanes<T> zero(T(0));
  const Lanes<T> along = dot(u, b.e);
  const Lanes<T> place_on_line = dot(k, cross(b.c, b.e)) * over;
  // Neither infinite nor NaN.
  const Lanes<T> line = select(place_on_line - place_on_line == zero, place_on_line, zero);
  const Lanes<T> first = clamp(line, -h, h);
  const Lanes<T> place = (along * first - dot(b.e, b.c)) / b.square;
  const Lanes<T> t = clamp(select(b.square > zero, place, b.low), b.low, b.high);
  return {clamp(dot(u, b.c) + along * t, -h, h), t};
}

}  // namespace winnow::WINNOW_ISA_NAME
