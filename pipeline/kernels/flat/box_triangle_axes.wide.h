#pragma once

// A box and a triangle in the frame of the box, and what separates them (Akenine-Moller, "Fast 3D
// triangle-box overlap testing", 2001): axes 0 to 2 the faces of the box, 3 the triangle's normal,
// 4 + 3 i + j the product of axis i of the box and edge j of the triangle.

#include "pipeline/kernels/flat/flat_kernel.wide.h"
#include "pipeline/kernels/flat/triangle_lanes.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// The numbers of a vector in a loop.
template <typename T>
struct Numbers {
  Lanes<T> at[3];

  [[gnu::always_inline]] explicit Numbers(const Vec3<T>& v) : at{v.x, v.y, v.z} {}
};

template <typename T>
struct BoxTrianglePair {
  Vec3<T> half;
  PlacedTriangle<T> b;
  Rotation<T> frame;
  /// In the axes of the world.
  Vec3<T> offset;
  Lanes<T> box_rounding;
  Lanes<T> scale;

  [[gnu::always_inline]] BoxTrianglePair(const NarrowJob& job, const PairBlock<T>& block) {
    offset = load_offset(job, block);
    frame = rotation(load_turn<SideA>(job, block));
    const Rotation<T> turn = rotation(load_turn<SideB>(job, block));
    b.place(load_triangle<SideB>(job, block),
            {frame.to_local(turn.x), frame.to_local(turn.y), frame.to_local(turn.z)});
    const BoxLanes<T> box = load_box<SideA>(job, block);
    half = box.half;
    box_rounding = box.rounding;
    scale = taxicab_of(offset) + b.scale + taxicab_of(half) + box_rounding;
    b.move(frame.to_local(offset));
  }

  [[gnu::always_inline]] Lanes<T> rounding_a() const { return box_rounding; }
  [[gnu::always_inline]] Lanes<T> rounding_b() const { return b.rounding; }
  [[gnu::always_inline]] Vec3<T> to_world(const Vec3<T>& v) const { return frame.to_world(v); }
  /// How far the box reaches along a vector.
  [[gnu::always_inline]] Lanes<T> reach(const Vec3<T>& n) const {
    return abs(n.x) * half.x + abs(n.y) * half.y + abs(n.z) * half.z;
  }
  /// Separation along a unit vector from the box to the triangle.
  [[gnu::always_inline]] Lanes<T> along(const Vec3<T>& n) const {
    Lanes<T> low;
    Lanes<T> high;
    b.span(n, low, high);
    return low - reach(n);
  }
  [[gnu::always_inline]] Lanes<T> face(int i) const {
    const Numbers<T> v[3] = {Numbers<T>(b.vertex[0]), Numbers<T>(b.vertex[1]),
                             Numbers<T>(b.vertex[2])};
    const Lanes<T> low = min(v[0].at[i], min(v[1].at[i], v[2].at[i]));
    const Lanes<T> high = max(v[0].at[i], max(v[1].at[i], v[2].at[i]));
    return max(low, -high) - Numbers<T>(half).at[i];
  }
  [[gnu::always_inline]] Lanes<T> over_triangle() const {
    return abs(dot(b.normal, b.vertex[0])) - reach(b.normal);
  }
};

/// Calls body(i, j, length2, separation) for the nine products: the separation along an axis whose
/// length has the square length2 and is at most that of edge j. Two vertices are on the edge, the
/// third is off it by a number of the normal.
template <typename T, typename Body>
[[gnu::always_inline]] inline void for_products(const BoxTrianglePair<T>& pair, Body&& body) {
  const Lanes<T> zero(T(0));
  const Numbers<T> normal(pair.b.normal);
  const Numbers<T> h(pair.half);
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3;
    const int l = (i + 2) % 3;
    const Lanes<T> low = min(normal.at[i], zero);
    const Lanes<T> high = max(normal.at[i], zero);
    for (int j = 0; j < 3; ++j) {
      const Numbers<T> f(pair.b.edge[j]);
      const Numbers<T> q(pair.b.vertex[j]);
      const Lanes<T> t = f.at[k] * q.at[l] - f.at[l] * q.at[k];
      const Lanes<T> s =
          max(t + low, -t - high) - (h.at[k] * abs(f.at[l]) + h.at[l] * abs(f.at[k]));
      body(i, j, f.at[k] * f.at[k] + f.at[l] * f.at[l], s);
    }
  }
}

/// The axis of the largest separation.
template <typename T>
struct BoxTriangleAxis {
  /// Unit, from the box to the triangle.
  Vec3<T> normal;
  Lanes<T> separation;
  /// No unit vector separates more.
  Lanes<T> most;
  Lanes<T> index;
  /// Square of the length of the axis; for products the axis of the box, and the edge and where it
  /// begins.
  Lanes<T> length2;
  Vec3<T> axis;
  Vec3<T> edge;
  Vec3<T> start;
};

template <typename T>
[[gnu::always_inline]] inline void find_edges(const BoxTrianglePair<T>& pair,
                                              BoxTriangleAxis<T>& r) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const LaneMask<T> face = r.index < Lanes<T>(T(2.5));
  const Lanes<T> k = select(face, r.index * Lanes<T>(T(3)), r.index - Lanes<T>(T(4)));
  const LaneMask<T> i0 = k < Lanes<T>(T(2.5));
  const LaneMask<T> i1 = k < Lanes<T>(T(5.5));
  const Lanes<T> j = k - select(i0, zero, select(i1, Lanes<T>(T(3)), Lanes<T>(T(6))));
  const LaneMask<T> j0 = j < Lanes<T>(T(0.5));
  const LaneMask<T> j1 = j < Lanes<T>(T(1.5));
  r.axis = {select(i0, one, zero), select(i0, zero, select(i1, one, zero)), select(i1, zero, one)};
  r.edge = pick(j0, j1, pair.b.edge);
  r.start = pick(j0, j1, pair.b.vertex);
}

template <typename T>
[[gnu::always_inline]] inline BoxTriangleAxis<T> best_axis(const BoxTrianglePair<T>& pair) {
  const Lanes<T> slack = pair.scale * Lanes<T>(kSlack<T>);
  const Lanes<T> one(T(1));
  BestFace<T> face{pair.face(0), Lanes<T>(T(0))};
  face.offer(pair.face(1), 1);
  face.offer(pair.face(2), 2);
  face.separation += slack;
  BestAxis<T> best = face.as_axis();
  Lanes<T> left_out(T(0));
  offer_product(best, left_out, dot(pair.b.normal, pair.b.normal), pair.over_triangle(),
                pair.b.area, slack, pair.b.longest(), 3);
  for_products(
      pair, [&](int i, int j, const Lanes<T>& length2,
                const Lanes<T>& s) __attribute__((always_inline)) {
        offer_product(best, left_out, length2, s, pair.b.length[j], slack, one, 4 + 3 * i + j);
      });
  BoxTriangleAxis<T> r;
  r.index = best.index;
  r.length2 = best.length2;
  r.most = best.separation() + left_out;
  find_edges(pair, r);
  const LaneMask<T> of_triangle = (r.index > Lanes<T>(T(2.5))) & (r.index < Lanes<T>(T(3.5)));
  const Vec3<T> axis = select(r.index < Lanes<T>(T(2.5)), r.axis,
                              select(of_triangle, pair.b.normal, cross(r.axis, r.edge)));
  const Vec3<T> n = axis * (one / sqrt(best.length2));
  Lanes<T> low;
  Lanes<T> high;
  pair.b.span(n, low, high);
  const Lanes<T> reach = pair.reach(n);
  const LaneMask<T> ahead = low >= -high;
  r.separation = select(ahead, low, -high) - reach;
  r.normal = select(ahead, n, -n);
  return r;
}

}  // namespace winnow::WINNOW_ISA_NAME
