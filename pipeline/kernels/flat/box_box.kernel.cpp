// The kernels of box-box: level boolean by SAT; levels distance and manifold by the best of the
// fifteen axes (box_pair.wide.h), closest points, and contacts from the faces across the normal
// (flat.wide.h).

#include "pipeline/kernels/flat/box_pair.wide.h"
#include "pipeline/kernels/kernels.h"

namespace winnow {
namespace WINNOW_ISA_NAME::flat {
namespace {

/// Rows of the values of a staged pair.
enum BoxPlace {
  kAxesA = 0,
  kAxesB = 9,
  kHalfA = 18,
  kHalfB = 21,
  kOffset = 24,
  kNormal = 27,
  kRoundingA = 30,
  kRoundingB,
  kCount
};

// The two sides are computed in a loop: with narrow lanes, unrolled code would be most of the
// kernel.
[[gnu::noinline]] void project_boxes(const Stage<double, kCount>& rows, ProjectedPairs& seen) {
  const Lanes<double> zero(0.0);
  const Doubles3 normal = rows.vector(kNormal);
  seen.set_projection(normal);
  for (int side = 0; side < 2; ++side) {
    const bool is_b = side == 1;
    const int axes = is_b ? kAxesB : kAxesA;
    const Doubles3 axis[3] = {rows.vector(axes), rows.vector(axes + 3), rows.vector(axes + 6)};
    const Doubles3 half = rows.vector(is_b ? kHalfB : kHalfA);
    const Doubles3 center = is_b ? rows.vector(kOffset) : Doubles3{zero, zero, zero};
    seen.see(face_of_box(axis, half, center, is_b ? -normal : normal), side);
  }
}

// The poses, sizes and normals of the pairs of a block, in memory.
template <typename T>
struct BoxStage {
  Stage<T, kCount> stage;

  [[gnu::always_inline]] BoxStage(const BoxPair<T>& pair, const Vec3<T>& normal) {
    stage.put(kAxesA, pair.frame_a);
    stage.put(kAxesB, pair.frame_b);
    stage.put(kHalfA, Vec3<T>{pair.half_a[0], pair.half_a[1], pair.half_a[2]});
    stage.put(kHalfB, Vec3<T>{pair.half_b[0], pair.half_b[1], pair.half_b[2]});
    stage.put(kOffset, pair.offset);
    stage.put(kNormal, normal);
    stage.put(kRoundingA, pair.rounding_a);
    stage.put(kRoundingB, pair.rounding_b);
  }
  [[nodiscard]] auto offset() const { return stage.value + kOffset; }
  [[nodiscard]] double rounding(int side, unsigned lane) const {
    return stage.value[kRoundingA + side][lane];
  }
  void see(ProjectedPairs& seen) const { project_boxes(stage, seen); }
  void features(unsigned lane, FlatFeature& a, FlatFeature& b, double (&normal)[3]) const {
    BoxFrame box_a;
    BoxFrame box_b;
    stage.get(kAxesA, 9, lane, &box_a.axis[0][0]);
    stage.get(kAxesB, 9, lane, &box_b.axis[0][0]);
    stage.get(kHalfA, 3, lane, box_a.half);
    stage.get(kHalfB, 3, lane, box_b.half);
    stage.get(kOffset, 3, lane, box_b.center);
    stage.get(kNormal, 3, lane, normal);
    stage.get(kRoundingA, 1, lane, &box_a.rounding);
    stage.get(kRoundingB, 1, lane, &box_b.rounding);
    for (double& c : box_a.center) c = 0.0;
    const double back[3] = {-normal[0], -normal[1], -normal[2]};
    a = flat_box_feature(box_a, normal);
    b = flat_box_feature(box_b, back);
  }
};

// Distances of boxes that are apart. The distance of the two points is an upper bound; the larger
// of the separations along their line and along the best axis is a lower bound.
template <typename T>
[[gnu::always_inline]] inline void measure_apart(const BoxPair<T>& pair, const BoxAxis<T>& axis,
                                                 const BoxPoints<T>& points, Lanes<T> (&normal)[3],
                                                 Lanes<T>& distance, Lanes<T>& gap) {
  Lanes<T> d[3];
  for (int r = 0; r < 3; ++r) d[r] = points.b[r] - points.a[r];
  distance = sqrt(square_of(d));
  const Lanes<T> shrink = Lanes<T>(T(1)) / distance;
  for (int r = 0; r < 3; ++r) d[r] = d[r] * shrink;
  const Lanes<T> lower = pair.along(d);
  const LaneMask<T> better = lower > axis.separation;
  for (int r = 0; r < 3; ++r) normal[r] = select(better, d[r], axis.normal[r]);
  gap = abs(distance - select(better, lower, axis.separation));
}

// The point of a that touches b after b is moved out of a along the axis. `off` receives the lanes
// in which this point is not on a, or the touching point of b is not on b: the deepest feature is
// then an edge or a face, not a vertex.
template <typename T>
[[gnu::always_inline]] inline void touching_point(const BoxPair<T>& pair, const BoxAxis<T>& axis,
                                                  const BoxReach<T>& reach, Lanes<T> (&point)[3],
                                                  Mask16& off) {
  Lanes<T> b[3];
  from_b(pair, reach.b, b);
  const LaneMask<T> face_of_a = axis.index < Lanes<T>(T(2.5));
  Lanes<T> other[3];
  for (int r = 0; r < 3; ++r) {
    const Lanes<T> step = axis.normal[r] * axis.separation;
    point[r] = select(face_of_a, b[r] - step, reach.a[r]);
    other[r] = select(face_of_a, b[r], reach.a[r] + step);
  }
  Lanes<T> q[3];
  to_b(pair, other, q);
  const Lanes<T> near = pair.scale * Lanes<T>(T(4) * kFlatSlack<T>);
  Lanes<T> out = abs(point[0]) - pair.half_a[0];
  for (int r = 1; r < 3; ++r) out = max(out, abs(point[r]) - pair.half_a[r]);
  for (int r = 0; r < 3; ++r) out = max(out, abs(q[r]) - pair.half_b[r]);
  off = bits(out > near);
}

template <typename T>
WINNOW_SHARED_BY_LEVELS BoxPair<T> box_pair(const NarrowJob& job, const PairBlock<T>& block) {
  return BoxPair<T>(job, block);
}

// Computes the distance of the cores of a block, with points if `with_points`. Lanes that are apart
// get their distance if `needed`, else a lower bound from the best axis.
template <typename T>
WINNOW_SHARED_BY_LEVELS CoreAnswer<T> measure(const BoxPair<T>& pair, const BoxAxis<T>& axis,
                                              const LaneMask<T>& needed, bool with_points) {
  const Lanes<T> slack = pair.scale * Lanes<T>(kFlatSlack<T>);
  const LaneMask<T> apart = axis.separation > Lanes<T>(T(0));
  CoreAnswer<T> answer;
  // Lower bound for the lanes that are not measured.
  answer.distance = select(apart & !needed, axis.separation - slack, axis.separation);
  Lanes<T> gap = abs(axis.most - axis.separation);
  Lanes<T> normal[3] = {axis.normal[0], axis.normal[1], axis.normal[2]};
  Lanes<T> point[3] = {normal[0], normal[1], normal[2]};
  Mask16 off = 0;
  const LaneMask<T> measured = apart & needed;
  const bool any_measured = bits(measured) != 0;
  if (with_points || any_measured) {
    BoxReach<T> reach = reach_along(pair, axis);
    move_along_edges(pair, axis, reach);
    if (with_points) touching_point(pair, axis, reach, point, off);
    if (any_measured) {
      const BoxPoints<T> points = closest_points(pair, axis, reach);
      Lanes<T> away[3];
      Lanes<T> distance;
      Lanes<T> away_gap;
      measure_apart(pair, axis, points, away, distance, away_gap);
      answer.distance = select(measured, distance, answer.distance);
      gap = select(measured, away_gap, gap);
      for (int r = 0; r < 3; ++r) {
        normal[r] = select(measured, away[r], normal[r]);
        if (with_points) point[r] = select(measured, points.a[r], point[r]);
      }
    }
  }
  answer.error_bound = gap + slack;
  answer.normal = pair.to_world(normal);
  answer.point = answer.normal;
  if (with_points) {
    answer.point = pair.to_world(point);
    off &= ~bits(apart);
    if (off != 0) correct_points<BoxStage<T>>(pair, answer, off);
  }
  return answer;
}

struct BoxBox {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& given) {
    if constexpr (L == kBoolean) {
      return overlap<T>(job, given);
    } else {
      return answer<T, L>(job, given);
    }
  }

  // Levels distance and manifold.
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 answer(NarrowJob& job, const PairBlock<T>& given) {
    const OrderedBlock<T> ordered(job, given);
    const BoxPair<T> pair = box_pair(job, ordered.block);
    const BoxAxis<T> axis = best_axis(pair);
    const Lanes<T> reach = pair.rounding_a + pair.rounding_b;
    LaneMask<T> needed = pair.scale == pair.scale;
    if constexpr (L == kManifold) {
      const Lanes<T> margin = margins_of(job, given);
      needed = axis.separation <= margin + reach + pair.scale * Lanes<T>(T(2) * kFlatSlack<T>);
    }
    CoreAnswer<T> core = measure(pair, axis, needed, L == kDistance);
    const Mask16 certified = with_rounding(core, pair.rounding_a, pair.rounding_b, pair.scale);
    const Lanes<T> sign = Lanes<T>::load(ordered.sign);
    write_answer<L>(job, given, turned_back(core, pair.offset, sign));
    if constexpr (L == kManifold) {
      const Lanes<T> margin = margins_of(job, given);
      const Mask16 touching = certified & bits(core.distance <= margin);
      const BoxStage<T> stage(pair, core.normal);
      return ~certified |
             write_true_contacts(job, given, core, pair.scale, touching, stage, ordered.sign);
    }
    return ~certified;
  }

  // Returns the lanes of boxes that overlap according to the axes other than cross products of
  // parallel edges, which have no reliable sign. Not inlined: only blocks in which a lane is not
  // decided need it.
  template <typename T>
  [[gnu::noinline]] static Mask16 overlap_of_parallel(const BoxPair<T>& pair, const Lanes<T>& face,
                                                      const Lanes<T>& slack) {
    Lanes<T> left_out;
    const Lanes<T> s = max(face, largest_crossed_separation(pair, left_out));
    return bits(s + left_out < -slack);
  }

  // Decides by the distance. Returns the lanes that are decided; `over` receives the lanes that
  // overlap. For blocks in which the axes do not decide a lane: the separation of the cores is 0 up
  // to rounding, or is positive but not larger than the sum of the roundings.
  template <typename T>
  [[gnu::noinline, gnu::cold]] static Mask16 settle(const BoxPair<T>& pair, Mask16& over) {
    CoreAnswer<T> core = measure(pair, best_axis(pair), pair.scale == pair.scale, false);
    const Mask16 certified = with_rounding(core, pair.rounding_a, pair.rounding_b, pair.scale);
    over = bits(core.distance <= Lanes<T>(T(0)));
    return certified;
  }

  template <typename T>
  [[gnu::always_inline]] static Mask16 overlap(NarrowJob& job, const PairBlock<T>& block) {
    const BoxPair<T> pair = box_pair(job, block);
    const Lanes<T> slack = overlap_slack(pair.scale);
    const Lanes<T> reach = slack + pair.rounding_a + pair.rounding_b;
    const Mask16 valid = bits(in_overlap_range(pair.scale));
    const Lanes<T> face = largest_face_separation(pair);
    Mask16 known = bits(face > reach);
    Mask16 over = 0;
    if ((known & valid) != kAllLanes<T>) {
      const Lanes<T> s = max(face, largest_edge_separation(pair));
      over = bits(s < -slack);
      known = over | bits(s > reach);
    }
    Mask16 unknown = ~known & valid & block.lanes();
    if (unknown != 0) {
      const Mask16 inside = overlap_of_parallel(pair, face, slack) & unknown;
      known |= inside;
      over |= inside;
      unknown &= ~inside;
    }
    if constexpr (!kFirstPass<T>) {
      if (unknown != 0) {
        Mask16 settled_over = 0;
        known |= settle(pair, settled_over) & unknown;
        over |= settled_over & unknown;
      }
    }
    write_overlap(job, block, over);
    return ~(known & valid);
  }
};

}  // namespace

}  // namespace WINNOW_ISA_NAME::flat

extern const NarrowKernels WINNOW_KERNEL_TABLE(box_box_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::flat::BoxBox,
                                            WINNOW_ISA_NAME::kDistance>();

}  // namespace winnow
