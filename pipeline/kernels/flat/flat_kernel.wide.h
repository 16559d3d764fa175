#pragma once

// From the best axis of a pair of cores to its answers. A kind of pair has scale, offset, along,
// to_world and its roundings, and the functions best_axis, axis_points and closest_by_vertices; a
// Staged holds its lanes in memory.

#include "pipeline/kernels/flat/flat_contacts.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// A point of each, relative to the position of a.
template <typename T>
struct PointPair {
  Vec3<T> a;
  Vec3<T> b;

  [[gnu::always_inline]] Lanes<T> square() const {
    const Vec3<T> d = b - a;
    return dot(d, d);
  }
};

/// How far the deepest contact may be from the depth of the pair, as a share of the scale.
template <typename T>
inline constexpr T kDeepest = sizeof(T) == sizeof(double) ? T(1e-6) : T(1e-4F);

template <typename T>
[[gnu::always_inline]] inline Lanes<T> clamp_unit(const Lanes<T>& t) {
  return max(min(t, Lanes<T>(T(1))), Lanes<T>(T(0)));
}

/// 1 / v; 0 for 0.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> inverse(const Lanes<T>& v) {
  return select(v > Lanes<T>(T(0)), Lanes<T>(T(1)) / v, Lanes<T>(T(0)));
}

/// What the best axis says: a vertex and its foot on a face, or a point of each of two edges.
template <typename T>
struct AxisPoints {
  PointPair<T> points;
  /// The foot is inside of the face, or little outside where the triangles overlap; the edges
  /// cross.
  LaneMask<T> meets;
  /// How far off the foot may be, as a multiple of the slack.
  Lanes<T> doubt;
};

/// Puts the points of some lanes to where both shapes are.
template <typename Staged, typename Pair, typename T>
inline void correct_points(const Pair& pair, CoreAnswer<T>& answer, Mask16 lanes) {
  const Staged stage(pair, answer.normal);
  Stage<T, 3> point;
  point.put(0, answer.point);
  for (; lanes != 0; lanes &= lanes - 1) {
    const unsigned lane = first(lanes);
    FlatPatch a;
    FlatPatch b;
    double normal[3];
    double p[3];
    stage.patches(lane, a, b, normal);
    deepest_point(a, b, normal, p);
    for (int r = 0; r < 3; ++r) point.value[r][lane] = static_cast<T>(p[r]);
  }
  answer.point = {Lanes<T>::load(point.value[0]), Lanes<T>::load(point.value[1]),
                  Lanes<T>::load(point.value[2])};
}

/// Answers about the cores of a block. Lanes that are apart get their distance if it is `wanted`,
/// else a lower bound. Below the true distance is what the better of two directions separates,
/// above it the way between two points.
template <int L, typename Staged, typename Pair, typename Axis, typename T>
[[gnu::always_inline]] inline CoreAnswer<T> measure(const Pair& pair, const Axis& axis,
                                                    const LaneMask<T>& wanted) {
  const Lanes<T> slack = pair.scale * Lanes<T>(kSlack<T>);
  const LaneMask<T> apart = axis.separation > Lanes<T>(T(0));
  CoreAnswer<T> answer;
  answer.distance = select(apart & !wanted, axis.separation - slack, axis.separation);
  answer.error_bound = abs(axis.most - axis.separation) + slack;
  answer.normal = axis.normal;
  answer.point = axis.normal;
  const LaneMask<T> measured = apart & wanted;
  const bool any_measured = bits(measured) != 0;
  if (L == kDistance || any_measured) {
    const AxisPoints<T> by_axis = axis_points(pair, axis);
    answer.point = by_axis.points.a;
    if (any_measured) {
      PointPair<T> points = closest_by_vertices(pair);
      const LaneMask<T> axis_is_closer =
          by_axis.meets & (by_axis.points.square() <= points.square());
      points.a = select(axis_is_closer, by_axis.points.a, points.a);
      points.b = select(axis_is_closer, by_axis.points.b, points.b);
      const Vec3<T> d = points.b - points.a;
      const Lanes<T> length = sqrt(dot(d, d));
      const Vec3<T> n = d * (Lanes<T>(T(1)) / length);
      const Lanes<T> lower = pair.along(n);
      const LaneMask<T> better = lower > axis.separation;
      const Lanes<T> least = select(better, lower, axis.separation);
      const Lanes<T> gap = abs(length - least);
      // Points far from the closest ones, which float lanes answer with all the same: no contact
      // is lost.
      const Lanes<T> distance = select(gap <= pair.scale * Lanes<T>(kWidestGap<T>), length, least);
      answer.distance = select(measured, distance, answer.distance);
      const Lanes<T> doubt = slack + slack * select(axis_is_closer, by_axis.doubt, Lanes<T>(T(1)));
      answer.error_bound = select(measured, gap + doubt, answer.error_bound);
      answer.normal = select(measured & better, n, answer.normal);
      answer.point = select(measured, points.a, answer.point);
    }
    answer.point = pair.to_world(answer.point);
    answer.normal = pair.to_world(answer.normal);
    if constexpr (L == kDistance) {
      const Mask16 off = ~bits(apart | by_axis.meets) & kAllLanes<T>;
      if (off != 0) correct_points<Staged>(pair, answer, off);
    }
    return answer;
  }
  answer.normal = pair.to_world(answer.normal);
  return answer;
}

/// Levels distance and manifold of a block; `sign` as OrderedBlock has it. Returns the uncertified
/// lanes.
template <int L, typename Staged, typename T, typename Pair>
[[gnu::always_inline]] inline Mask16 answer_flat(NarrowJob& job, const PairBlock<T>& given,
                                                 const Pair& pair, const T* sign) {
  const auto axis = best_axis(pair);
  const Lanes<T> margin(static_cast<T>(job.margin));
  LaneMask<T> wanted = pair.scale == pair.scale;
  if constexpr (L == kManifold) {
    wanted = axis.separation <= margin + pair.rounding_a() + pair.rounding_b() +
                                    pair.scale * Lanes<T>(T(2) * kSlack<T>);
  }
  CoreAnswer<T> core = measure<L, Staged>(pair, axis, wanted);
  const Mask16 certified = with_rounding(core, pair.rounding_a(), pair.rounding_b(), pair.scale);
  write_answer<L>(job, given, turned_back(core, pair.offset, Lanes<T>::load(sign)));
  if constexpr (L == kManifold) {
    const Mask16 touching = certified & bits(core.distance <= margin);
    const Staged stage(pair, core.normal);
    // A patch that leaves out where the shapes are closest is no manifold.
    Stage<T, 2> expected;
    expected.put(0, core.distance);
    expected.put(1, core.error_bound + pair.scale * Lanes<T>(kDeepest<T>));
    Mask16 missed = 0;
    write_patch_contacts<T>(job, given, touching, stage.offset(), sign,
                            [&](unsigned lane, ContactPoint* points) -> std::uint32_t {
                              FlatPatch a;
                              FlatPatch b;
                              double normal[3];
                              stage.patches(lane, a, b, normal);
                              const auto count = flat_contacts(a, b, normal, job.margin, points);
                              const T off =
                                  static_cast<T>(points[0].depth) + expected.value[0][lane];
                              const T most = expected.value[1][lane];
                              if (count > 0 && off <= most && off >= -most) return count;
                              missed |= 1U << lane;
                              return 0;
                            });
    return ~certified | missed;
  }
  return ~certified;
}

/// Level boolean: the pairs that `apart` and `over` leave open are measured.
template <typename Staged, typename T, typename Pair>
[[gnu::always_inline]] inline Mask16 answer_overlaps(NarrowJob& job, const PairBlock<T>& block,
                                                     const Pair& pair, const LaneMask<T>& apart,
                                                     const LaneMask<T>& over) {
  const Mask16 valid = bits(in_range(pair.scale * pair.scale));
  Mask16 hit = bits(over);
  Mask16 known = hit | bits(apart);
  const Mask16 unknown = ~known & valid & block.lanes();
  if (unknown != 0) {
    const LaneMask<T> all = pair.scale == pair.scale;
    CoreAnswer<T> core = measure<kManifold, Staged>(pair, best_axis(pair), all);
    known |= with_rounding(core, pair.rounding_a(), pair.rounding_b(), pair.scale) & unknown;
    hit |= bits(core.distance <= Lanes<T>(T(0))) & unknown;
  }
  write_overlap(job, block, hit);
  return ~(known & valid);
}

}  // namespace winnow::WINNOW_ISA_NAME
