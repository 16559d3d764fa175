// The kernels of box-triangle, in the frame of the box. SAT axes (Akenine-Moller, "Fast 3D
// triangle-box overlap testing", 2001): 0 to 2 are the faces of the box, 3 is the triangle's
// normal, 4 + 3 i + j is the cross product of axis i of the box and edge j of the triangle.
//
// Deepest points are those that the best axis determines. Closest points are the closest of three
// candidates: these points, a vertex of the triangle and the nearest point of the box, and a vertex
// of the box and the nearest point of an edge. The steps that this kernel shares with
// triangle-triangle are in flat.wide.h.

#include "pipeline/kernels/flat/flat.wide.h"
#include "pipeline/kernels/kernels.h"

namespace winnow {
namespace WINNOW_ISA_NAME::flat {
namespace {

/// The components of a vector by index.
template <typename T>
struct BoxTriangleNumbers {
  Lanes<T> at[3];

  [[gnu::always_inline]] explicit BoxTriangleNumbers(const Vec3<T>& v) : at{v.x, v.y, v.z} {}
};

template <typename T>
struct BoxTrianglePair {
  Vec3<T> half;
  PlacedTriangle<T> b;
  Rotation<T> frame;
  /// In world axes.
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
    scale = norm_l1(offset) + b.scale + norm_l1(half) + box_rounding;
    b.move(frame.to_local(offset));
  }

  [[gnu::always_inline]] Lanes<T> rounding_a() const { return box_rounding; }
  [[gnu::always_inline]] Lanes<T> rounding_b() const { return b.rounding; }
  [[gnu::always_inline]] Vec3<T> to_world(const Vec3<T>& v) const { return frame.to_world(v); }
  /// Half extent of the box along a vector.
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
    const BoxTriangleNumbers<T> v[3] = {BoxTriangleNumbers<T>(b.vertex[0]),
                                        BoxTriangleNumbers<T>(b.vertex[1]),
                                        BoxTriangleNumbers<T>(b.vertex[2])};
    const Lanes<T> low = min(v[0].at[i], min(v[1].at[i], v[2].at[i]));
    const Lanes<T> high = max(v[0].at[i], max(v[1].at[i], v[2].at[i]));
    return max(low, -high) - BoxTriangleNumbers<T>(half).at[i];
  }
  [[gnu::always_inline]] Lanes<T> over_triangle() const {
    return abs(dot(b.normal, b.vertex[0])) - reach(b.normal);
  }
};

/// Calls body(i, j, length2, separation) for the nine cross products. `separation` is multiplied by
/// the length of the axis, which is at most the length of edge j; `length2` is the square of the
/// axis' length. Two vertices of the triangle have the same height along the axis; the height of
/// the third differs by component i of the triangle's normal.
template <typename T, typename Body>
[[gnu::always_inline]] inline void for_products(const BoxTrianglePair<T>& pair, Body&& body) {
  const Lanes<T> zero(T(0));
  const BoxTriangleNumbers<T> normal(pair.b.normal);
  const BoxTriangleNumbers<T> h(pair.half);
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3;
    const int l = (i + 2) % 3;
    const Lanes<T> low = min(normal.at[i], zero);
    const Lanes<T> high = max(normal.at[i], zero);
    for (int j = 0; j < 3; ++j) {
      const BoxTriangleNumbers<T> f(pair.b.edge[j]);
      const BoxTriangleNumbers<T> q(pair.b.vertex[j]);
      const Lanes<T> t = f.at[k] * q.at[l] - f.at[l] * q.at[k];
      const Lanes<T> s =
          max(t + low, -t - high) - (h.at[k] * abs(f.at[l]) + h.at[l] * abs(f.at[k]));
      body(i, j, f.at[k] * f.at[k] + f.at[l] * f.at[l], s);
    }
  }
}

/// The axis with the largest separation.
template <typename T>
struct BoxTriangleAxis {
  /// Unit, from the box to the triangle.
  Vec3<T> normal;
  Lanes<T> separation;
  /// Upper bound of the separations along all axes; if the cores overlap, along any unit vector.
  Lanes<T> most;
  Lanes<T> index;
  /// Square of the length of the axis before it was normalized. For cross products also the unit
  /// axis of the box, the edge of the triangle and its start; for faces of the box also `axis`.
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
  const Lanes<T> slack = pair.scale * Lanes<T>(kFlatSlack<T>);
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

/// Returns the index of the closest pair of a vertex and the other shape: i for vertex i of the
/// triangle and the box, 3 + 8 j + v for vertex v of the box (one bit per positive coordinate) and
/// edge j.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> nearest_vertex(const BoxTrianglePair<T>& pair) {
  const Lanes<T> two(T(2));
  Lanes<T> square = Lanes<T>(T(kBeyondSquares));
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
  const Lanes<T> near = pair.scale * Lanes<T>(T(4) * kFlatSlack<T>);
  const Lanes<T> zero(T(0));
  const Vec3<T>& n = axis.normal;
  const Vec3<T> step = n * axis.separation;
  const LaneMask<T> of_box = axis.index < Lanes<T>(T(2.5));
  const LaneMask<T> of_face = axis.index < Lanes<T>(T(3.5));
  const LaneMask<T> apart = may_be_apart(axis, pair.scale);
  const Vec3<T> vertex = pair.b.lowest(n);
  const Vec3<T> foot = vertex - step;
  const Vec3<T> corner{sign_or_one(n.x) * pair.half.x, sign_or_one(n.y) * pair.half.y,
                       sign_or_one(n.z) * pair.half.z};
  const LaneMask<T> on_box = norm_l1(foot - clamp_to(foot, pair.half)) <= near;
  const LaneMask<T> on_triangle = pair.b.is_over(corner, select(apart, zero, near));

  // The edge of the box that is parallel to axis.axis and has the corner as an end.
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
  const LaneMask<T> crossing = apart | (norm_l1(edges.b - edges.a - step) <= near);

  AxisPoints<T> p;
  p.points.a = select(of_box, foot, select(of_face, corner, edges.a));
  p.points.b = select(of_box, vertex, select(of_face, corner + step, edges.b));
  p.projections_overlap =
      (of_box & on_box) | (of_face & on_triangle & !of_box) | (crossing & !of_face);
  p.doubt = select(of_face & !of_box, pair.b.area / sqrt(axis.length2), Lanes<T>(T(1)));
  return p;
}

/// Rows of the values of a staged pair.
enum BoxTrianglePlace {
  kAxes = 0,
  kHalf = 9,
  kVertices = 12,
  kNormal = 21,
  kOffset = 24,
  kBoxRounding = 27,
  kTriangleRounding,
  kCount
};

[[gnu::noinline]] void project_box_and_triangle(const Stage<double, kCount>& rows,
                                                ProjectedPairs& seen) {
  const Lanes<double> zero(0.0);
  const Doubles3 normal = rows.vector(kNormal);
  const Doubles3 axis[3] = {rows.vector(kAxes), rows.vector(kAxes + 3), rows.vector(kAxes + 6)};
  seen.set_projection(normal);
  seen.see(face_of_box(axis, rows.vector(kHalf), {zero, zero, zero}, normal), 0);
  seen.see(face_of_triangle(rows.vector(kVertices), rows.vector(kVertices + 3),
                            rows.vector(kVertices + 6)),
           1);
}

// The poses, sizes and normals of the pairs of a block, in memory.
template <typename T>
struct BoxTriangleStage {
  Stage<T, kCount> stage;

  [[gnu::always_inline]] BoxTriangleStage(const BoxTrianglePair<T>& pair, const Vec3<T>& normal) {
    stage.put(kAxes, pair.frame);
    stage.put(kHalf, pair.half);
    for (int i = 0; i < 3; ++i) stage.put(kVertices + 3 * i, pair.to_world(pair.b.vertex[i]));
    stage.put(kNormal, normal);
    stage.put(kOffset, pair.offset);
    stage.put(kBoxRounding, pair.box_rounding);
    stage.put(kTriangleRounding, pair.b.rounding);
  }
  [[nodiscard]] auto offset() const { return stage.value + kOffset; }
  [[nodiscard]] double rounding(int side, unsigned lane) const {
    return stage.value[kBoxRounding + side][lane];
  }
  void see(ProjectedPairs& seen) const { project_box_and_triangle(stage, seen); }
  void features(unsigned lane, FlatFeature& a, FlatFeature& b, double (&normal)[3]) const {
    BoxFrame box;
    TriangleFrame triangle;
    stage.get(kAxes, 9, lane, &box.axis[0][0]);
    stage.get(kHalf, 3, lane, box.half);
    stage.get(kVertices, 9, lane, &triangle.vertex[0][0]);
    stage.get(kNormal, 3, lane, normal);
    stage.get(kBoxRounding, 1, lane, &box.rounding);
    stage.get(kTriangleRounding, 1, lane, &triangle.rounding);
    for (double& c : box.center) c = 0.0;
    a = flat_box_feature(box, normal);
    b = flat_triangle_feature(triangle);
  }
};

struct BoxTriangle {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& given) {
    if constexpr (L == kBoolean) {
      return overlap<T>(job, given);
    } else {
      alignas(64) T sign[Lanes<T>::kCount];
      Lanes<T>(T(1)).store(sign);
      const BoxTrianglePair<T> pair(job, given);
      return answer_flat<L, BoxTriangleStage<T>>(job, given, pair, sign);
    }
  }

  // Returns the lanes of shapes that overlap according to the axes other than cross products of
  // parallel edges. These have no reliable sign; the separation along them exceeds that along the
  // other axes by at most the bound at `offer_product`, by which all other axes must overlap here.
  // Not inlined: only blocks in which a lane is not decided need it.
  template <typename T>
  [[gnu::noinline]] static LaneMask<T> overlap_of_parallel(const BoxTrianglePair<T>& pair,
                                                           const Lanes<T>& slack) {
    const Lanes<T> zero(T(0));
    Lanes<T> least = slack;
    const auto is_parallel = [&](int j, const Lanes<T>& length2) __attribute__((always_inline)) {
      return length2 <= pair.b.length[j] * pair.b.length[j] * Lanes<T>(kParallelSquare<T>);
    };
    for_products(
        pair, [&](int, int j, const Lanes<T>& length2, const Lanes<T>&)
                  __attribute__((always_inline)) {
                    least += select(is_parallel(j, length2), Lanes<T>(T(2)) * sqrt(length2), zero);
                  });
    const Lanes<T> face = max(pair.face(0), max(pair.face(1), pair.face(2)));
    LaneMask<T> over = (face < -least) & (pair.over_triangle() < -(least * pair.b.area));
    for_products(
        pair, [&](int, int j, const Lanes<T>& length2, const Lanes<T>& s)
                  __attribute__((always_inline)) {
                    over = over & (is_parallel(j, length2) | (s < -(least * pair.b.length[j])));
                  });
    return over;
  }

  template <typename T>
  [[gnu::always_inline]] static Mask16 overlap(NarrowJob& job, const PairBlock<T>& block) {
    const BoxTrianglePair<T> pair(job, block);
    const Lanes<T> slack = overlap_slack(pair.scale);
    const Mask16 valid = bits(in_overlap_range(pair.scale));
    const Lanes<T> reach = slack + pair.box_rounding + pair.b.rounding;
    const Lanes<T> face = max(pair.face(0), max(pair.face(1), pair.face(2)));
    const Lanes<T> above = pair.over_triangle();
    LaneMask<T> apart = (face > reach) | (above > reach * pair.b.area);
    LaneMask<T> over = (face < -slack) & (above < -(slack * pair.b.area));
    if ((bits(apart) & valid) != kAllLanes<T>) {
      for_products(
          pair, [&](int, int j, const Lanes<T>&, const Lanes<T>& s) __attribute__((always_inline)) {
            apart = apart | (s > reach * pair.b.length[j]);
            over = over & (s < -(slack * pair.b.length[j]));
          });
      if ((bits(apart | over) & valid) != valid) {
        over = over | (overlap_of_parallel(pair, slack) & !apart);
      }
    }
    return answer_overlaps<BoxTriangleStage<T>>(job, block, pair, apart, over);
  }
};

}  // namespace

}  // namespace WINNOW_ISA_NAME::flat

extern const NarrowKernels WINNOW_KERNEL_TABLE(box_triangle_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::flat::BoxTriangle,
                                            WINNOW_ISA_NAME::kDistance>();

}  // namespace winnow
