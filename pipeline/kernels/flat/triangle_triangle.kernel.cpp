// The kernels of triangle-triangle. SAT axes: 0 is the normal of a, 1 the normal of b, 2 + 3 i + j
// is the cross product of edge i of a and edge j of b.
//
// Closest and deepest points: if they are on a vertex and a face, or on two edges that cross, the
// best axis is the normal. In all other cases the closest points are a vertex of one triangle and a
// point of an edge of the other. The steps that this kernel shares with box-triangle are in
// flat.wide.h.

#include "pipeline/kernels/flat/flat.wide.h"
#include "pipeline/kernels/kernels.h"

namespace winnow {
namespace WINNOW_ISA_NAME::flat {
namespace {

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
    scale = a.scale + b.scale + norm_l1(offset);
    b.move(offset);
  }

  [[gnu::always_inline]] Lanes<T> rounding_a() const { return a.rounding; }
  [[gnu::always_inline]] Lanes<T> rounding_b() const { return b.rounding; }
  [[gnu::always_inline]] Vec3<T> to_world(const Vec3<T>& v) const { return v; }

  /// Separation along the normal of one triangle, times the normal's length.
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

/// Calls body(i, j, axis, separation, size) for the nine cross products of edges. `separation` is
/// multiplied by the length of the axis; `size` is an upper bound of that length. Two vertices of
/// each triangle are ends of its edge and have the same height along the axis. The third vertex is
/// higher by the dot product of the triangle's normal and the other triangle's edge, up to sign.
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

/// The axis with the largest separation.
template <typename T>
struct TriangleAxis {
  /// Unit, from a to b.
  Vec3<T> normal;
  Lanes<T> separation;
  /// Upper bound of the separations along all axes; if the cores overlap, along any unit vector.
  Lanes<T> most;
  /// -1 if all edges are parallel: there is no axis then, and `normal` is meaningless.
  Lanes<T> index;
  /// Square of the length of the axis before it was normalized. For cross products also the edges
  /// and their starts.
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
  const Lanes<T> slack = pair.scale * Lanes<T>(kFlatSlack<T>);
  // Less than the separation along any axis. If all edges are parallel, `best` keeps this value and
  // index -1, and the normal is not a unit vector.
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
  r.separation = select(any, select(ahead, low_b - high_a, low_a - high_b), none);
  r.normal = select(ahead, n, -n);
  return r;
}

/// Returns the closest of eighteen pairs of a vertex and an edge: 3 i + j for edge i of a and
/// vertex j of b, 9 + 3 j + i for edge j of b and vertex i of a. Compares expanded squares, which
/// are inexact; the distance is computed from the points afterwards.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> nearest_vertex_and_edge(const TrianglePair<T>& pair) {
  const Lanes<T> two(T(2));
  Lanes<T> square = Lanes<T>(T(kBeyondSquares));
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
  const Lanes<T> near = pair.scale * Lanes<T>(T(4) * kFlatSlack<T>);
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
  const LaneMask<T> apart = may_be_apart(axis, pair.scale);
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
  const LaneMask<T> crossing = apart | (norm_l1(edges.b - edges.a - step) <= near);

  AxisPoints<T> p;
  p.points.a = select(of_face, select(of_a, vertex_b - step, vertex_a), edges.a);
  p.points.b = select(of_face, select(of_a, vertex_b, vertex_a + step), edges.b);
  const LaneMask<T> has_axis = axis.index > Lanes<T>(T(-0.5));
  p.projections_overlap = ((of_face & over) | (crossing & !of_face)) & has_axis;
  p.doubt = select(of_face, face.area / sqrt(axis.length2), Lanes<T>(T(1)));
  return p;
}

/// Rows of the values of a staged pair.
enum TrianglePlace {
  kA = 0,
  kB = 9,
  kNormal = 18,
  kOffset = 21,
  kRoundingA = 24,
  kRoundingB,
  kCount
};

[[gnu::noinline]] void project_triangles(const Stage<double, kCount>& rows, ProjectedPairs& seen) {
  seen.set_projection(rows.vector(kNormal));
  for (int side = 0; side < 2; ++side) {
    const int at = side == 0 ? kA : kB;
    seen.see(face_of_triangle(rows.vector(at), rows.vector(at + 3), rows.vector(at + 6)), side);
  }
}

// The vertices, offsets, roundings and normals of the pairs of a block, in memory.
template <typename T>
struct TriangleStage {
  Stage<T, kCount> stage;

  [[gnu::always_inline]] TriangleStage(const TrianglePair<T>& pair, const Vec3<T>& normal) {
    for (int i = 0; i < 3; ++i) {
      stage.put(kA + 3 * i, pair.a.vertex[i]);
      stage.put(kB + 3 * i, pair.b.vertex[i]);
    }
    stage.put(kNormal, normal);
    stage.put(kOffset, pair.offset);
    stage.put(kRoundingA, pair.a.rounding);
    stage.put(kRoundingB, pair.b.rounding);
  }
  [[nodiscard]] auto offset() const { return stage.value + kOffset; }
  [[nodiscard]] double rounding(int side, unsigned lane) const {
    return stage.value[kRoundingA + side][lane];
  }
  void see(ProjectedPairs& seen) const { project_triangles(stage, seen); }
  void features(unsigned lane, FlatFeature& a, FlatFeature& b, double (&normal)[3]) const {
    TriangleFrame frame_a;
    TriangleFrame frame_b;
    stage.get(kA, 9, lane, &frame_a.vertex[0][0]);
    stage.get(kB, 9, lane, &frame_b.vertex[0][0]);
    stage.get(kNormal, 3, lane, normal);
    stage.get(kRoundingA, 1, lane, &frame_a.rounding);
    stage.get(kRoundingB, 1, lane, &frame_b.rounding);
    a = flat_triangle_feature(frame_a);
    b = flat_triangle_feature(frame_b);
  }
};

struct TriangleTriangle {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& given) {
    if constexpr (L == kBoolean) {
      return overlap<T>(job, given);
    } else {
      const OrderedBlock<T> ordered(job, given);
      const TrianglePair<T> pair(job, ordered.block);
      return answer_flat<L, TriangleStage<T>>(job, given, pair, ordered.sign);
    }
  }

  template <typename T>
  [[gnu::always_inline]] static Mask16 overlap(NarrowJob& job, const PairBlock<T>& block) {
    const TrianglePair<T> pair(job, block);
    const Lanes<T> slack = overlap_slack(pair.scale);
    const Mask16 valid = bits(in_overlap_range(pair.scale));
    // The axes are not normalized. The length of an axis is at most the product of the lengths of
    // its edges: if a value exceeds the slack and roundings times that product, the triangles are
    // apart.
    const Lanes<T> reach = slack + pair.a.rounding + pair.b.rounding;
    const Lanes<T> over_a = pair.over_a();
    const Lanes<T> over_b = pair.over_b();
    LaneMask<T> apart = (over_a > reach * pair.a.area) | (over_b > reach * pair.b.area);
    LaneMask<T> over = (over_a < -(slack * pair.a.area)) & (over_b < -(slack * pair.b.area));
    if ((bits(apart) & valid) != kAllLanes<T>) {
      for_products(
          pair, [&](int, int, const Vec3<T>&, const Lanes<T>& s, const Lanes<T>& size)
                    __attribute__((always_inline)) {
                      apart = apart | (s > reach * size);
                      over = over & (s < -(slack * size));
                    });
    }
    return answer_overlaps<TriangleStage<T>>(job, block, pair, apart, over);
  }
};

}  // namespace

}  // namespace WINNOW_ISA_NAME::flat

extern const NarrowKernels WINNOW_KERNEL_TABLE(triangle_triangle_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::flat::TriangleTriangle,
                                            WINNOW_ISA_NAME::kDistance>();

}  // namespace winnow
