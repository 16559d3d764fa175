#pragma once

// A triangle where it stands, and what separates two of them: axis 0 the normal of a, 1 that of b,
// 2 + 3 i + j the product of edge i of a and edge j of b.

#include "pipeline/kernels/flat/flat.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// Of three vectors the one whose mask holds, the last if none.
template <typename T>
[[gnu::always_inline]] inline Vec3<T> pick(const LaneMask<T>& is_0, const LaneMask<T>& is_1,
                                           const Vec3<T> (&v)[3]) {
  return select(is_0, v[0], select(is_1, v[1], v[2]));
}

/// In the axes of the world, relative to the position of a.
template <typename T>
struct PlacedTriangle {
  Vec3<T> vertex[3];
  /// From vertex i to the next, turned from the shape's own numbers, so that it does not carry the
  /// rounding of vertices far from the origin.
  Vec3<T> edge[3];
  /// Not less than the edges' lengths.
  Lanes<T> length[3];
  /// The product of the two shorter edges, and that of their lengths.
  Vec3<T> normal;
  Lanes<T> area;
  Lanes<T> rounding;
  /// The sum of all numbers.
  Lanes<T> scale;

  [[gnu::always_inline]] void place(const TriangleLanes<T>& shape, const Rotation<T>& turn) {
    for (int i = 0; i < 3; ++i) {
      edge[i] = turn.to_world(shape.vertex[(i + 1) % 3] - shape.vertex[i]);
      length[i] = taxicab_of(edge[i]);
    }
    vertex[0] = turn.to_world(shape.vertex[0]);
    vertex[1] = turn.to_world(shape.vertex[1]);
    vertex[2] = turn.to_world(shape.vertex[2]);
    rounding = shape.rounding;
    scale = taxicab_of(vertex[0]) + taxicab_of(vertex[1]) + taxicab_of(vertex[2]) + rounding;
    const LaneMask<T> longest_0 = (length[0] >= length[1]) & (length[0] >= length[2]);
    const LaneMask<T> longest_1 = length[1] >= length[2];
    const Vec3<T> after[3] = {edge[1], edge[2], edge[0]};
    const Vec3<T> before[3] = {edge[2], edge[0], edge[1]};
    normal = cross(pick(longest_0, longest_1, after), pick(longest_0, longest_1, before));
    area = select(longest_0, length[1] * length[2],
                  select(longest_1, length[2] * length[0], length[0] * length[1]));
  }
  [[gnu::always_inline]] Lanes<T> longest() const {
    return max(length[0], max(length[1], length[2]));
  }
  [[gnu::always_inline]] void move(const Vec3<T>& offset) {
    for (Vec3<T>& v : vertex) v = v + offset;
  }
  /// Smallest and largest along a vector.
  [[gnu::always_inline]] void span(const Vec3<T>& n, Lanes<T>& low, Lanes<T>& high) const {
    const Lanes<T> d[3] = {dot(n, vertex[0]), dot(n, vertex[1]), dot(n, vertex[2])};
    low = min(d[0], min(d[1], d[2]));
    high = max(d[0], max(d[1], d[2]));
  }
  /// The vertex that is lowest along a vector.
  [[gnu::always_inline]] Vec3<T> lowest(const Vec3<T>& n) const {
    const Lanes<T> d[3] = {dot(n, vertex[0]), dot(n, vertex[1]), dot(n, vertex[2])};
    return pick((d[0] <= d[1]) & (d[0] <= d[2]), d[1] <= d[2], vertex);
  }
  /// Whether a point projects into the triangle, or beside it by no more than a share of its edge.
  [[gnu::always_inline]] LaneMask<T> is_over(const Vec3<T>& p, const Lanes<T>& slack) const {
    LaneMask<T> in = slack == slack;
    for (int i = 0; i < 3; ++i) {
      in = in & (dot(cross(normal, edge[i]), p - vertex[i]) >= -(slack * area * length[i]));
    }
    return in;
  }
};

template <typename T>
struct TrianglePair {
  PlacedTriangle<T> a;
  PlacedTriangle<T> b;
  Vec3<T> offset;
  Lanes<T> scale;

  [[gnu::always_inline]] TrianglePair(const NarrowJob& job, const PairBlock<T>& block) {
    offset = load_offset(job, block);
    a.place(load_triangle<SideA>(job, block), rotation(load_turn<SideA>(job, block)));
    b.place(load_triangle<SideB>(job, block), rotation(load_turn<SideB>(job, block)));
    scale = a.scale + b.scale + taxicab_of(offset);
    b.move(offset);
  }

  [[gnu::always_inline]] Lanes<T> rounding_a() const { return a.rounding; }
  [[gnu::always_inline]] Lanes<T> rounding_b() const { return b.rounding; }
  [[gnu::always_inline]] Vec3<T> to_world(const Vec3<T>& v) const { return v; }

  /// Heights of the vertices of one over the plane of the other, as a separation.
  [[gnu::always_inline]] Lanes<T> over_a() const { return over(a.normal, a.vertex[0], b); }
  [[gnu::always_inline]] Lanes<T> over_b() const { return over(b.normal, b.vertex[0], a); }
  [[gnu::always_inline]] static Lanes<T> over(const Vec3<T>& normal, const Vec3<T>& foot,
                                              const PlacedTriangle<T>& other) {
    const Lanes<T> d[3] = {dot(normal, other.vertex[0] - foot), dot(normal, other.vertex[1] - foot),
                           dot(normal, other.vertex[2] - foot)};
    return max(min(d[0], min(d[1], d[2])), -max(d[0], max(d[1], d[2])));
  }
  /// Separation along a unit vector from a to b.
  [[gnu::always_inline]] Lanes<T> along(const Vec3<T>& n) const {
    Lanes<T> low;
    Lanes<T> high;
    Lanes<T> low_b;
    Lanes<T> high_b;
    a.span(n, low, high);
    b.span(n, low_b, high_b);
    return low_b - high;
  }
};

/// Calls body(i, j, axis, separation, size) for the nine products of edges: the separation along
/// the axis, unscaled, and at least the product of the edges' lengths. All of a triangle's vertices
/// but one are on the edge; how far that one is off is the other edge times the normal.
template <typename T, typename Body>
[[gnu::always_inline]] inline void for_products(const TrianglePair<T>& pair, Body&& body) {
  const Lanes<T> zero(T(0));
  Lanes<T> low_b[3];
  Lanes<T> high_b[3];
  for (int i = 0; i < 3; ++i) {
    const Lanes<T> off = dot(pair.a.edge[i], pair.b.normal);
    low_b[i] = min(off, zero);
    high_b[i] = max(off, zero);
  }
  for (int j = 0; j < 3; ++j) {
    const Lanes<T> off = -dot(pair.b.edge[j], pair.a.normal);
    const Lanes<T> low_a = min(off, zero);
    const Lanes<T> high_a = max(off, zero);
    for (int i = 0; i < 3; ++i) {
      const Vec3<T> axis = cross(pair.a.edge[i], pair.b.edge[j]);
      const Lanes<T> t = dot(axis, pair.b.vertex[j] - pair.a.vertex[i]);
      const Lanes<T> s = max(t + low_b[i] - high_a, low_a - (t + high_b[i]));
      body(i, j, axis, s, pair.a.length[i] * pair.b.length[j]);
    }
  }
}

/// The axis of the largest separation.
template <typename T>
struct TriangleAxis {
  /// Unit, from a to b.
  Vec3<T> normal;
  Lanes<T> separation;
  /// No unit vector separates more.
  Lanes<T> most;
  Lanes<T> index;
  /// Square of the length of the axis, and for products the edges and where they begin.
  Lanes<T> length2;
  Vec3<T> edge_a;
  Vec3<T> edge_b;
  Vec3<T> start_a;
  Vec3<T> start_b;
};

template <typename T>
[[gnu::always_inline]] inline void find_edges(const TrianglePair<T>& pair, TriangleAxis<T>& r) {
  const Lanes<T> k = r.index - Lanes<T>(T(2));
  const LaneMask<T> i0 = k < Lanes<T>(T(2.5));
  const LaneMask<T> i1 = k < Lanes<T>(T(5.5));
  const Lanes<T> j = k - select(i0, Lanes<T>(T(0)), select(i1, Lanes<T>(T(3)), Lanes<T>(T(6))));
  const LaneMask<T> j0 = j < Lanes<T>(T(0.5));
  const LaneMask<T> j1 = j < Lanes<T>(T(1.5));
  r.edge_a = pick(i0, i1, pair.a.edge);
  r.start_a = pick(i0, i1, pair.a.vertex);
  r.edge_b = pick(j0, j1, pair.b.edge);
  r.start_b = pick(j0, j1, pair.b.vertex);
}

template <typename T>
[[gnu::always_inline]] inline TriangleAxis<T> best_axis(const TrianglePair<T>& pair) {
  const Lanes<T> slack = pair.scale * Lanes<T>(kSlack<T>);
  // Worse than any axis; left as it is if there is none.
  const Lanes<T> none = -pair.scale * Lanes<T>(T(2));
  BestAxis<T> best{none * abs(none), Lanes<T>(T(1)), Lanes<T>(T(-1))};
  Lanes<T> left_out(T(0));
  offer_product(best, left_out, dot(pair.a.normal, pair.a.normal), pair.over_a(), pair.a.area,
                slack, pair.a.longest(), 0);
  offer_product(best, left_out, dot(pair.b.normal, pair.b.normal), pair.over_b(), pair.b.area,
                slack, pair.b.longest(), 1);
  for_products(
      pair, [&](int i, int j, const Vec3<T>& axis, const Lanes<T>& s, const Lanes<T>& size)
                __attribute__((always_inline)) {
                  offer_product(best, left_out, dot(axis, axis), s, size, slack,
                                max(pair.a.length[i], pair.b.length[j]), 2 + 3 * i + j);
                });

  TriangleAxis<T> r;
  r.index = best.index;
  r.length2 = best.length2;
  const LaneMask<T> any = best.index > Lanes<T>(T(-0.5));
  r.most = select(any, best.separation() + left_out, pair.scale);
  find_edges(pair, r);
  const Vec3<T> axis =
      select(r.index < Lanes<T>(T(0.5)), pair.a.normal,
             select(r.index < Lanes<T>(T(1.5)), pair.b.normal, cross(r.edge_a, r.edge_b)));
  const Vec3<T> n = axis * (Lanes<T>(T(1)) / sqrt(best.length2));
  Lanes<T> low_a;
  Lanes<T> high_a;
  Lanes<T> low_b;
  Lanes<T> high_b;
  pair.a.span(n, low_a, high_a);
  pair.b.span(n, low_b, high_b);
  const LaneMask<T> ahead = low_b - high_a >= low_a - high_b;
  r.separation = select(ahead, low_b - high_a, low_a - high_b);
  r.normal = select(ahead, n, -n);
  return r;
}

}  // namespace winnow::WINNOW_ISA_NAME
