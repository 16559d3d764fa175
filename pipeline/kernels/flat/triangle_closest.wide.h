#pragma once

// Closest and deepest points of two triangles. Where a vertex meets a face, or two edges cross, the
// best axis is the normal; what else there is has a vertex of one and an edge of the other.

#include "pipeline/kernels/flat/flat_kernel.wide.h"
#include "pipeline/kernels/flat/triangle_lanes.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// Of eighteen pairs of a vertex and an edge the closest: 3 i + j for edge i of a and vertex j of
/// b, 9 + 3 j + i for edge j of b and vertex i of a. Compared by expanded squares; the distance is
/// measured between points afterwards.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> nearest_vertex_and_edge(const TrianglePair<T>& pair) {
  const Lanes<T> two(T(2));
  Lanes<T> square(sizeof(T) == sizeof(double) ? T(1e300) : T(1e38F));
  Lanes<T> index(T(0));
  Lanes<T> ee[3];
  Lanes<T> ff[3];
  Lanes<T> per_ee[3];
  Lanes<T> per_ff[3];
  for (int i = 0; i < 3; ++i) {
    ee[i] = dot(pair.a.edge[i], pair.a.edge[i]);
    ff[i] = dot(pair.b.edge[i], pair.b.edge[i]);
    per_ee[i] = inverse(ee[i]);
    per_ff[i] = inverse(ff[i]);
  }
  const auto offer = [&](const Lanes<T>& ww, const Lanes<T>& along, const Lanes<T>& length2,
                         const Lanes<T>& per_length2, int number) __attribute__((always_inline)) {
    const Lanes<T> t = clamp_unit(along * per_length2);
    const Lanes<T> d = ww - t * (two * along - t * length2);
    const LaneMask<T> nearer = d < square;
    square = select(nearer, d, square);
    index = select(nearer, Lanes<T>(T(number)), index);
  };
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vec3<T> w = pair.b.vertex[j] - pair.a.vertex[i];
      const Lanes<T> ww = dot(w, w);
      offer(ww, dot(w, pair.a.edge[i]), ee[i], per_ee[i], 3 * i + j);
      offer(ww, -dot(w, pair.b.edge[j]), ff[j], per_ff[j], 9 + 3 * j + i);
    }
  }
  return index;
}

template <typename T>
[[gnu::always_inline]] inline PointPair<T> closest_by_vertices(const TrianglePair<T>& pair) {
  const Lanes<T> index = nearest_vertex_and_edge(pair);
  const LaneMask<T> edge_of_b = index > Lanes<T>(T(8.5));
  const Lanes<T> k = index - select(edge_of_b, Lanes<T>(T(9)), Lanes<T>(T(0)));
  const LaneMask<T> e0 = k < Lanes<T>(T(2.5));
  const LaneMask<T> e1 = k < Lanes<T>(T(5.5));
  const Lanes<T> v = k - select(e0, Lanes<T>(T(0)), select(e1, Lanes<T>(T(3)), Lanes<T>(T(6))));
  const LaneMask<T> v0 = v < Lanes<T>(T(0.5));
  const LaneMask<T> v1 = v < Lanes<T>(T(1.5));
  const Vec3<T> edge = select(edge_of_b, pick(e0, e1, pair.b.edge), pick(e0, e1, pair.a.edge));
  const Vec3<T> start = select(edge_of_b, pick(e0, e1, pair.b.vertex), pick(e0, e1, pair.a.vertex));
  const Vec3<T> vertex =
      select(edge_of_b, pick(v0, v1, pair.a.vertex), pick(v0, v1, pair.b.vertex));
  const Lanes<T> t = clamp_unit(dot(vertex - start, edge) * inverse(dot(edge, edge)));
  const Vec3<T> foot = start + edge * t;
  return {select(edge_of_b, vertex, foot), select(edge_of_b, foot, vertex)};
}

template <typename T>
[[gnu::always_inline]] inline AxisPoints<T> axis_points(const TrianglePair<T>& pair,
                                                        const TriangleAxis<T>& axis) {
  const Lanes<T> near = pair.scale * Lanes<T>(T(4) * kSlack<T>);
  const Lanes<T> zero(T(0));
  const Vec3<T>& n = axis.normal;
  const Vec3<T> step = n * axis.separation;
  const LaneMask<T> of_a = axis.index < Lanes<T>(T(0.5));
  const LaneMask<T> of_face = axis.index < Lanes<T>(T(1.5));
  const Vec3<T> vertex_a = pair.a.lowest(-n);
  const Vec3<T> vertex_b = pair.b.lowest(n);

  PlacedTriangle<T> face;
  for (int i = 0; i < 3; ++i) {
    face.vertex[i] = select(of_a, pair.a.vertex[i], pair.b.vertex[i]);
    face.edge[i] = select(of_a, pair.a.edge[i], pair.b.edge[i]);
    face.length[i] = select(of_a, pair.a.length[i], pair.b.length[i]);
  }
  face.normal = select(of_a, pair.a.normal, pair.b.normal);
  face.area = select(of_a, pair.a.area, pair.b.area);
  const LaneMask<T> apart = axis.separation > zero;
  const LaneMask<T> over =
      face.is_over(select(of_a, vertex_b, vertex_a), select(apart, zero, near));

  const Vec3<T>& e = axis.edge_a;
  const Vec3<T>& f = axis.edge_b;
  const Vec3<T> r = axis.start_b - axis.start_a;
  const Lanes<T> ef = dot(e, f);
  const Lanes<T> re = dot(r, e);
  const Lanes<T> rf = dot(r, f);
  const Lanes<T> s = clamp_unit((dot(f, f) * re - ef * rf) / axis.length2);
  const Lanes<T> t = clamp_unit((ef * re - dot(e, e) * rf) / axis.length2);
  const PointPair<T> edges{axis.start_a + e * s, axis.start_b + f * t};
  const LaneMask<T> crossing = apart | (taxicab_of(edges.b - edges.a - step) <= near);

  AxisPoints<T> p;
  p.points.a = select(of_face, select(of_a, vertex_b - step, vertex_a), edges.a);
  p.points.b = select(of_face, select(of_a, vertex_b, vertex_a + step), edges.b);
  p.meets = (of_face & over) | (crossing & !of_face);
  p.doubt = select(of_face, face.area / sqrt(axis.length2), Lanes<T>(T(1)));
  return p;
}

}  // namespace winnow::WINNOW_ISA_NAME
