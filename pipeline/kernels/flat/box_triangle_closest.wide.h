#pragma once

// Closest and deepest points of a box and a triangle: those that the best axis tells, or a vertex
// of the triangle and the point of the box next to it, or a vertex of the box and a point of an
// edge.

#include "pipeline/kernels/flat/box_triangle_axes.wide.h"

namespace winnow::WINNOW_ISA_NAME {

template <typename T>
[[gnu::always_inline]] inline Lanes<T> clamp_to(const Lanes<T>& v, const Lanes<T>& reach) {
  return max(min(v, reach), -reach);
}
template <typename T>
[[gnu::always_inline]] inline Vec3<T> clamp_to(const Vec3<T>& v, const Vec3<T>& half) {
  return {clamp_to(v.x, half.x), clamp_to(v.y, half.y), clamp_to(v.z, half.z)};
}

/// The closest of the vertices: i for vertex i of the triangle and the box, 3 + 8 j + v for vertex
/// v of the box (a bit for each positive coordinate) and edge j.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> nearest_vertex(const BoxTrianglePair<T>& pair) {
  const Lanes<T> two(T(2));
  Lanes<T> square(sizeof(T) == sizeof(double) ? T(1e300) : T(1e38F));
  Lanes<T> index(T(0));
  const auto offer = [&](const Lanes<T>& d, int number) __attribute__((always_inline)) {
    const LaneMask<T> nearer = d < square;
    square = select(nearer, d, square);
    index = select(nearer, Lanes<T>(T(number)), index);
  };
  for (int i = 0; i < 3; ++i) {
    const Vec3<T> out = pair.b.vertex[i] - clamp_to(pair.b.vertex[i], pair.half);
    offer(dot(out, out), i);
  }
  const Vec3<T>& h = pair.half;
  const Lanes<T> hh = dot(h, h);
  for (int j = 0; j < 3; ++j) {
    const Vec3<T>& q = pair.b.vertex[j];
    const Vec3<T>& f = pair.b.edge[j];
    const Lanes<T> ff = dot(f, f);
    const Lanes<T> per_ff = inverse(ff);
    const Lanes<T> qf = dot(q, f);
    const Lanes<T> ww = hh + dot(q, q);
    const Vec3<T> hq{h.x * q.x, h.y * q.y, h.z * q.z};
    const Vec3<T> hf{h.x * f.x, h.y * f.y, h.z * f.z};
    for (int v = 0; v < 8; ++v) {
      const auto sum = [&](const Vec3<T>& p) __attribute__((always_inline)) {
        const Lanes<T> xy = ((v & 2) != 0 ? p.y : -p.y) + ((v & 1) != 0 ? p.x : -p.x);
        return (v & 4) != 0 ? xy + p.z : xy - p.z;
      };
      const Lanes<T> along = sum(hf) - qf;
      const Lanes<T> t = clamp_unit(along * per_ff);
      offer(ww - two * sum(hq) - t * (two * along - t * ff), 3 + 8 * j + v);
    }
  }
  return index;
}

template <typename T>
[[gnu::always_inline]] inline PointPair<T> closest_by_vertices(const BoxTrianglePair<T>& pair) {
  const Lanes<T> index = nearest_vertex(pair);
  const LaneMask<T> of_triangle = index < Lanes<T>(T(2.5));
  const Vec3<T> vertex = pick(index < Lanes<T>(T(0.5)), index < Lanes<T>(T(1.5)), pair.b.vertex);
  const Lanes<T> k = index - Lanes<T>(T(3));
  const LaneMask<T> j0 = k < Lanes<T>(T(7.5));
  const LaneMask<T> j1 = k < Lanes<T>(T(15.5));
  Lanes<T> v = k - select(j0, Lanes<T>(T(0)), select(j1, Lanes<T>(T(8)), Lanes<T>(T(16))));
  const LaneMask<T> up_z = v > Lanes<T>(T(3.5));
  v = select(up_z, v - Lanes<T>(T(4)), v);
  const LaneMask<T> up_y = v > Lanes<T>(T(1.5));
  v = select(up_y, v - Lanes<T>(T(2)), v);
  const LaneMask<T> up_x = v > Lanes<T>(T(0.5));
  const Vec3<T> corner{select(up_x, pair.half.x, -pair.half.x),
                       select(up_y, pair.half.y, -pair.half.y),
                       select(up_z, pair.half.z, -pair.half.z)};
  const Vec3<T> edge = pick(j0, j1, pair.b.edge);
  const Vec3<T> start = pick(j0, j1, pair.b.vertex);
  const Lanes<T> t = clamp_unit(dot(corner - start, edge) * inverse(dot(edge, edge)));
  return {select(of_triangle, clamp_to(vertex, pair.half), corner),
          select(of_triangle, vertex, start + edge * t)};
}

template <typename T>
[[gnu::always_inline]] inline AxisPoints<T> axis_points(const BoxTrianglePair<T>& pair,
                                                        const BoxTriangleAxis<T>& axis) {
  const Lanes<T> near = pair.scale * Lanes<T>(T(4) * kSlack<T>);
  const Lanes<T> zero(T(0));
  const Vec3<T>& n = axis.normal;
  const Vec3<T> step = n * axis.separation;
  const LaneMask<T> of_box = axis.index < Lanes<T>(T(2.5));
  const LaneMask<T> of_face = axis.index < Lanes<T>(T(3.5));
  const LaneMask<T> apart = axis.separation > zero;
  const Vec3<T> vertex = pair.b.lowest(n);
  const Vec3<T> foot = vertex - step;
  const Vec3<T> corner{sign_or_one(n.x) * pair.half.x, sign_or_one(n.y) * pair.half.y,
                       sign_or_one(n.z) * pair.half.z};
  const LaneMask<T> on_box = taxicab_of(foot - clamp_to(foot, pair.half)) <= near;
  const LaneMask<T> on_triangle = pair.b.is_over(corner, select(apart, zero, near));

  // The edge of the box along its axis, through the corner.
  const Vec3<T>& e = axis.axis;
  const Vec3<T>& f = axis.edge;
  const Vec3<T> middle{corner.x - corner.x * e.x, corner.y - corner.y * e.y,
                       corner.z - corner.z * e.z};
  const Vec3<T> r = axis.start - middle;
  const Lanes<T> ef = dot(e, f);
  const Lanes<T> re = dot(r, e);
  const Lanes<T> rf = dot(r, f);
  const Lanes<T> s = clamp_to((dot(f, f) * re - ef * rf) / axis.length2, dot(pair.half, e));
  const Lanes<T> t = clamp_unit((ef * re - rf) / axis.length2);
  const PointPair<T> edges{middle + e * s, axis.start + f * t};
  const LaneMask<T> crossing = apart | (taxicab_of(edges.b - edges.a - step) <= near);

  AxisPoints<T> p;
  p.points.a = select(of_box, foot, select(of_face, corner, edges.a));
  p.points.b = select(of_box, vertex, select(of_face, corner + step, edges.b));
  p.meets = (of_box & on_box) | (of_face & on_triangle & !of_box) | (crossing & !of_face);
  p.doubt = select(of_face & !of_box, pair.b.area / sqrt(axis.length2), Lanes<T>(T(1)));
  return p;
}

}  // namespace winnow::WINNOW_ISA_NAME
