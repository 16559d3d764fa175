#pragma once

// Shared by the kernels of boxes and triangles: the search for the best of many separating axes,
// triangles in world axes, and the steps from the best axis of a pair of cores to certified
// distances and contacts.
//
// The separation of two convex cores along a unit vector n is the height of b's lowest point along
// n above a's highest. Its maximum over all n is the distance, or minus the penetration depth. One
// of the SAT axes (Gottschalk 1996) attains it, except if the closest features are a vertex and a
// vertex or a vertex and an edge.
//
// answer_flat and answer_overlaps are for the two kinds of pairs with a triangle. Their pair types
// provide scale, offset, along, to_world, rounding_a and rounding_b, and overloads of best_axis,
// axis_points and closest_by_vertices. A Staged type stores the lanes of a pair type in memory.

#include "pipeline/kernels/flat/projected_faces.wide.h"
#include "pipeline/kernels/one_pair.wide.h"
#include "pipeline/manifold/contact_patch.h"

namespace winnow::WINNOW_ISA_NAME::flat {

/// Error bound of separations along axes of length at most 1, relative to the pair's scale (the sum
/// of all its lengths). The errors in units of roundoff (epsilon / 2) of the scale are 10 for an
/// entry of a rotation, 38 for an entry of the product of two rotations, and 82 for the offset
/// along a cross product; the bound is 96 of these units.
template <typename T>
inline constexpr T kFlatSlack = T(48) * kEpsilon<T>;

/// If an error bound is larger than this, relative to the scale, the pair goes to the solver.
inline constexpr double kWidestBound = 1e-12;

/// Edges count as parallel if the square of the sine of their angle is smaller. The separation
/// along their cross product would have an error of slack / sine. If this axis is left out, at most
/// the shorter edge times the sine is missing from the largest separation.
template <typename T>
inline constexpr T kParallelSquare = sizeof(T) == sizeof(double) ? T(1e-26) : T(1e-6F);

/// Larger than the square of any distance.
inline constexpr double kBeyondSquares = 1e300;

/// The axis with the largest separation so far. Compared without square roots: by s|s| over the
/// square of the axis' length.
template <typename T>
struct BestAxis {
  Lanes<T> square;
  Lanes<T> length2;
  Lanes<T> index;

  [[gnu::always_inline]] void offer(const Lanes<T>& separation, const Lanes<T>& axis_length2,
                                    int axis_index) {
    const Lanes<T> s = separation * abs(separation);
    const LaneMask<T> better = s * length2 > square * axis_length2;
    square = select(better, s, square);
    length2 = select(better, axis_length2, length2);
    index = select(better, Lanes<T>(T(axis_index)), index);
  }
  [[gnu::always_inline]] Lanes<T> separation() const {
    return sign_or_one(square) * sqrt(abs(square) / length2);
  }
};

/// The largest separation along unit vectors, and its axis.
template <typename T>
struct BestFace {
  Lanes<T> separation;
  Lanes<T> index;

  [[gnu::always_inline]] void offer(const Lanes<T>& s, int axis_index) {
    const LaneMask<T> better = s > separation;
    separation = select(better, s, separation);
    index = select(better, Lanes<T>(T(axis_index)), index);
  }
  [[gnu::always_inline]] BestAxis<T> as_axis() const {
    return {separation * abs(separation), Lanes<T>(T(1)), index};
  }
};

/// Offers a cross product, unless its factors are parallel; `size` is at least the product of the
/// factors' lengths. If the cross product is left out, the separation that is lost is at most its
/// length over the length of the longer factor: seen along the longer factor, the other factor has
/// that length. `longer` may be up to twice the length of the longer factor.
template <typename T>
[[gnu::always_inline]] inline void offer_product(BestAxis<T>& best, Lanes<T>& left_out,
                                                 const Lanes<T>& length2,
                                                 const Lanes<T>& separation, const Lanes<T>& size,
                                                 const Lanes<T>& slack, const Lanes<T>& longer,
                                                 int index) {
  const LaneMask<T> crossed = length2 > size * size * Lanes<T>(kParallelSquare<T>);
  if (bits(crossed) == kAllLanes<T>) {
    best.offer(separation + size * slack, length2, index);
    return;
  }
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const Lanes<T> lost = select(longer > zero, Lanes<T>(T(2)) * sqrt(length2) / longer, zero);
  left_out += select(crossed, zero, lost);
  // Minus three times the scale, which is less than any separation.
  const Lanes<T> worst = slack * Lanes<T>(T(-3) / kFlatSlack<T>);
  best.offer(select(crossed, separation + size * slack, worst), select(crossed, length2, one),
             index);
}

/// Orders bodies at the same position by their shape ids, then by their orientations. Returns true
/// if b is first.
inline bool swap_concentric(const NarrowJob& job, const BodyPair& pair) {
  const std::uint32_t shape_a = job.shapes[pair.a].bits;
  const std::uint32_t shape_b = job.shapes[pair.b].bits;
  if (shape_a != shape_b) return shape_b < shape_a;
  const double* a = job.poses[pair.a].orientation.data();
  const double* b = job.poses[pair.b].orientation.data();
  int i = 0;
  while (i < 3 && a[i] == b[i]) ++i;
  return b[i] < a[i];
}

/// Orders each pair independently of which body is called a: the first nonzero component of the
/// offset is positive; swap_concentric orders bodies at the same position. turned_back() swaps the
/// results back.
template <typename T>
struct OrderedBlock {
  BodyPair pairs[Lanes<T>::kCount];
  /// -1 for pairs that were swapped, else 1.
  alignas(64) T sign[Lanes<T>::kCount];
  PairBlock<T> block;

  [[gnu::always_inline]] OrderedBlock(const NarrowJob& job, const PairBlock<T>& given)
      : block{pairs, given.first, given.count} {
    for (int lane = 0; lane < Lanes<T>::kCount; ++lane) {
      const BodyPair pair = given.pairs[lane];
      const double* a = job.poses[pair.a].position.data();
      const double* b = job.poses[pair.b].position.data();
      int i = 0;
      while (i < 2 && a[i] == b[i]) ++i;
      const bool turn = a[i] == b[i] ? swap_concentric(job, pair) : b[i] < a[i];
      pairs[lane] = turn ? BodyPair{pair.b, pair.a} : pair;
      sign[lane] = turn ? T(-1) : T(1);
    }
  }
  OrderedBlock(const OrderedBlock&) = delete;
};

/// The lanes in which axes are compared without overflow or underflow: BestAxis multiplies up to
/// ten lengths. Lengths on which the result depends are at least 1e-14 of the scale, and squared
/// sines at least kParallelSquare.
template <typename T>
[[gnu::always_inline]] inline LaneMask<T> in_axis_range(const Lanes<T>& scale) {
  return (scale > Lanes<T>(T(1e-11))) & (scale < Lanes<T>(T(1e28)));
}

/// Results about the cores, in world axes.
template <typename T>
struct CoreAnswer {
  Lanes<T> distance;
  Lanes<T> error_bound;
  Vec3<T> normal;
  /// On the core of a, relative to its position. Level distance only.
  Vec3<T> point;
};

/// Turns results about the cores into results about the rounded shapes; returns the certified
/// lanes.
template <typename T>
[[gnu::always_inline]] inline Mask16 with_rounding(CoreAnswer<T>& answer,
                                                   const Lanes<T>& rounding_a,
                                                   const Lanes<T>& rounding_b,
                                                   const Lanes<T>& scale) {
  answer.distance -= rounding_a + rounding_b;
  answer.point = answer.point + answer.normal * rounding_a;
  const LaneMask<T> narrow = answer.error_bound <= scale * Lanes<T>(T(kWidestBound));
  return bits(in_axis_range(scale) & narrow & (abs(answer.distance) > answer.error_bound));
}

/// Swaps results back to the caller's order. `offset` is from a to b in the kernel's order.
template <typename T>
[[gnu::always_inline]] inline AnswerLanes<T> turned_back(const CoreAnswer<T>& answer,
                                                         const Vec3<T>& offset,
                                                         const Lanes<T>& sign) {
  const Vec3<T> on_b = answer.point + answer.normal * answer.distance - offset;
  return {answer.distance, answer.error_bound, answer.normal * sign,
          select(sign < Lanes<T>(T(0)), on_b, answer.point)};
}

/// Selects v[0] if is_0, else v[1] if is_1, else v[2].
template <typename T>
[[gnu::always_inline]] inline Vec3<T> pick(const LaneMask<T>& is_0, const LaneMask<T>& is_1,
                                           const Vec3<T> (&v)[3]) {
  return select(is_0, v[0], select(is_1, v[1], v[2]));
}

/// A triangle in the axes of the kernel, relative to the position of a.
template <typename T>
struct PlacedTriangle {
  Vec3<T> vertex[3];
  /// From vertex i to the next. Subtracted in the frame of the triangle, then rotated: the
  /// difference of two rotated vertices far from the origin would have their rounding errors.
  Vec3<T> edge[3];
  /// Upper bounds of the edges' lengths.
  Lanes<T> length[3];
  /// The cross product of the two shorter edges, and the product of their `length`s.
  Vec3<T> normal;
  Lanes<T> area;
  Lanes<T> rounding;
  /// The sum of the absolute coordinates of the vertices, before `move`, and the rounding.
  Lanes<T> scale;

  [[gnu::always_inline]] void place(const TriangleLanes<T>& shape, const Rotation<T>& turn) {
    for (int i = 0; i < 3; ++i) {
      edge[i] = turn.to_world(shape.vertex[(i + 1) % 3] - shape.vertex[i]);
      length[i] = norm_l1(edge[i]);
    }
    vertex[0] = turn.to_world(shape.vertex[0]);
    vertex[1] = turn.to_world(shape.vertex[1]);
    vertex[2] = turn.to_world(shape.vertex[2]);
    rounding = shape.rounding;
    scale = norm_l1(vertex[0]) + norm_l1(vertex[1]) + norm_l1(vertex[2]) + rounding;
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
  /// The smallest and largest coordinate along a vector.
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
  /// True if a point projects into the triangle, or outside an edge by at most about slack * area /
  /// |normal|.
  [[gnu::always_inline]] LaneMask<T> is_over(const Vec3<T>& p, const Lanes<T>& slack) const {
    LaneMask<T> in = slack == slack;
    for (int i = 0; i < 3; ++i) {
      in = in & (dot(cross(normal, edge[i]), p - vertex[i]) >= -(slack * area * length[i]));
    }
    return in;
  }
};

/// Writes the contacts of the `touching` lanes, computed by `find_contacts(lane, points)`, in the
/// caller's order; writes empty ranges for all other lanes of the block. `offset` of a lane is from
/// a to b in the kernel's order; `sign` is -1 if the caller's order is the opposite.
template <typename FindContacts>
inline void write_patch_contacts(NarrowJob& job, const PairBlock<double>& block, Mask16 touching,
                                 const double (*offset)[Doubles::kCount], const double* sign,
                                 FindContacts&& find_contacts) {
  ContactWriter& out = job.contacts;
  for (unsigned lane = 0; lane < block.count; ++lane) {
    job.contact_first[block.first + lane] = out.size;
    std::uint32_t count = 0;
    if ((touching >> lane & 1U) != 0) {
      ContactPoint points[kManifoldPoints];
      count = find_contacts(lane, points);
      const bool turned = sign[lane] < 0.0;
      for (std::uint32_t k = 0; k < count; ++k, ++out.size) {
        const ContactPoint& p = points[k];
        for (int r = 0; r < 3; ++r) {
          const double from_b = static_cast<double>(p.position[r]) - offset[r][lane];
          out.position[r][out.size] = turned ? static_cast<float>(from_b) : p.position[r];
        }
        out.depth[out.size] = p.depth;
        out.feature[out.size] = turned ? p.feature << 32U | p.feature >> 32U : p.feature;
      }
    }
    job.contact_count[block.first + lane] = count;
  }
}

/// A point of each shape, relative to the position of a.
template <typename T>
struct PointPair {
  Vec3<T> a;
  Vec3<T> b;

  [[gnu::always_inline]] Lanes<T> square() const {
    const Vec3<T> d = b - a;
    return dot(d, d);
  }
};

/// The largest difference between the depths of the first contact and of the pair, relative to the
/// scale, with which contacts are accepted.
inline constexpr double kDeepest = 1e-6;

template <typename T>
[[gnu::always_inline]] inline Lanes<T> clamp_to(const Lanes<T>& v, const Lanes<T>& reach) {
  return max(min(v, reach), -reach);
}
template <typename T>
[[gnu::always_inline]] inline Vec3<T> clamp_to(const Vec3<T>& v, const Vec3<T>& half) {
  return {clamp_to(v.x, half.x), clamp_to(v.y, half.y), clamp_to(v.z, half.z)};
}
template <typename T>
[[gnu::always_inline]] inline Lanes<T> clamp_unit(const Lanes<T>& t) {
  return max(min(t, Lanes<T>(T(1))), Lanes<T>(T(0)));
}

/// 1 / v if v > 0, else 0.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> inverse(const Lanes<T>& v) {
  return select(v > Lanes<T>(T(0)), Lanes<T>(T(1)) / v, Lanes<T>(T(0)));
}

// The steps of the search, as types that select the overload for a pair type.
struct ToBestAxis {
  template <typename Pair>
  [[gnu::always_inline]] static auto of(const Pair& pair) {
    return best_axis(pair);
  }
};
struct ToPointsOfAxis {
  template <typename Pair, typename Axis>
  [[gnu::always_inline]] static auto of(const Pair& pair, const Axis& axis) {
    return axis_points(pair, axis);
  }
};
struct ToClosestByVertices {
  template <typename Pair>
  [[gnu::always_inline]] static auto of(const Pair& pair) {
    return closest_by_vertices(pair);
  }
};

template <typename Step, typename... From>
[[gnu::noinline]] inline auto by_a_function(const From&... from) {
  return Step::of(from...);
}

/// Runs a step. On instruction sets on which Lanes<T> takes four registers, the step is not inlined
/// but a function that all levels share: values would not stay in registers anyway, and compiling
/// is faster.
template <typename Step, typename T, typename... From>
[[gnu::always_inline]] inline auto step(const From&... from) {
  if constexpr (kPartsOf<T> == 4) {
    return by_a_function<Step>(from...);
  } else {
    return Step::of(from...);
  }
}

/// The points that the best axis determines: if it is a face normal, a vertex and its foot on the
/// face; if it is a cross product, a point of each of the two edges.
template <typename T>
struct AxisPoints {
  PointPair<T> points;
  /// The lanes whose points can be the closest or deepest ones: the foot is inside the face, up to
  /// rounding; or the axis is a cross product, and the edges cross or the cores may be apart.
  LaneMask<T> projections_overlap;
  /// Error of the foot, as a multiple of the slack.
  Lanes<T> doubt;
};

/// The lanes whose cores may be apart: the best axis separates them, or they overlap along it by at
/// most the slack. In the latter case the axes do not determine the distance: for two coplanar
/// triangles, all axes are the normal of their plane, along which the separation is 0.
template <typename Axis, typename T>
[[gnu::always_inline]] inline LaneMask<T> may_be_apart(const Axis& axis, const Lanes<T>& scale) {
  return axis.most > -(scale * Lanes<T>(kFlatSlack<T>));
}

/// Replaces the points in `lanes`, which are not on both cores, by the deepest points of the
/// supporting features.
template <typename Staged, typename Pair, typename T>
inline void correct_points(const Pair& pair, CoreAnswer<T>& answer, Mask16 lanes) {
  const Staged stage(pair, answer.normal);
  Stage<T, 3> point;
  point.put(0, answer.point);
  for (; lanes != 0; lanes &= lanes - 1) {
    const unsigned lane = first(lanes);
    FlatFeature a;
    FlatFeature b;
    double normal[3];
    double p[3];
    stage.features(lane, a, b, normal);
    deepest_point(a, b, normal, p);
    for (int r = 0; r < 3; ++r) point.value[r][lane] = p[r];
  }
  answer.point = {Lanes<T>::load(point.value[0]), Lanes<T>::load(point.value[1]),
                  Lanes<T>::load(point.value[2])};
}

/// Computes the distance of the cores of a block. Lanes that are apart get their distance if
/// `needed`, else a lower bound. A distance is at most that of the points found, and at least the
/// larger of the separations along the line of these points and along the best axis.
template <int L, typename Staged, typename Pair, typename Axis, typename T>
[[gnu::always_inline]] inline CoreAnswer<T> measure(const Pair& pair, const Axis& axis,
                                                    const LaneMask<T>& needed) {
  const Lanes<T> slack = pair.scale * Lanes<T>(kFlatSlack<T>);
  const LaneMask<T> apart = may_be_apart(axis, pair.scale);
  CoreAnswer<T> answer;
  answer.distance = select(apart & !needed, axis.separation - slack, axis.separation);
  answer.error_bound = abs(axis.most - axis.separation) + slack;
  answer.normal = axis.normal;
  answer.point = axis.normal;
  const LaneMask<T> measured = apart & needed;
  const bool any_measured = bits(measured) != 0;
  if (L == kDistance || any_measured) {
    const AxisPoints<T> by_axis = step<ToPointsOfAxis, T>(pair, axis);
    answer.point = by_axis.points.a;
    if (any_measured) {
      PointPair<T> points = step<ToClosestByVertices, T>(pair);
      const LaneMask<T> axis_is_closer =
          by_axis.projections_overlap & (by_axis.points.square() <= points.square());
      points.a = select(axis_is_closer, by_axis.points.a, points.a);
      points.b = select(axis_is_closer, by_axis.points.b, points.b);
      const Vec3<T> d = points.b - points.a;
      const Lanes<T> length = sqrt(dot(d, d));
      const Vec3<T> n = d * (Lanes<T>(T(1)) / length);
      const Lanes<T> lower = pair.along(n);
      const LaneMask<T> better = lower > axis.separation;
      const Lanes<T> gap = abs(length - select(better, lower, axis.separation));
      answer.distance = select(measured, length, answer.distance);
      const Lanes<T> doubt = slack + slack * select(axis_is_closer, by_axis.doubt, Lanes<T>(T(1)));
      answer.error_bound = select(measured, gap + doubt, answer.error_bound);
      answer.normal = select(measured & better, n, answer.normal);
      answer.point = select(measured, points.a, answer.point);
    }
    answer.point = pair.to_world(answer.point);
    answer.normal = pair.to_world(answer.normal);
    if constexpr (L == kDistance) {
      const Mask16 off = ~bits(apart | by_axis.projections_overlap) & kAllLanes<T>;
      if (off != 0) correct_points<Staged>(pair, answer, off);
    }
    return answer;
  }
  answer.normal = pair.to_world(answer.normal);
  return answer;
}

/// Writes the contacts of a pair, or, if its faces do not overlap along the normal, the one point
/// where they are closest. Returns the number of contacts.
template <typename Staged>
inline std::uint32_t contacts_of(const Staged& stage, const ProjectedPairs& seen, unsigned lane,
                                 double margin, ContactPoint* points) {
  if (seen.is_plain(lane)) {
    return projected_contacts(seen.faces(lane, stage.rounding(0, lane), stage.rounding(1, lane)),
                              margin, points);
  }
  FlatFeature a;
  FlatFeature b;
  double normal[3];
  stage.features(lane, a, b, normal);
  return flat_contacts(a, b, normal, margin, points);
}

/// Writes the contacts between the features of `stage` in the `touching` lanes. Returns the lanes
/// whose first contact, which is the deepest, does not have the depth of the pair up to kDeepest,
/// or that have no contact. No contacts are written for these lanes.
template <typename Staged>
[[gnu::always_inline]] inline Mask16 write_true_contacts(NarrowJob& job,
                                                         const PairBlock<double>& given,
                                                         const CoreAnswer<double>& core,
                                                         const Doubles& scale, Mask16 touching,
                                                         const Staged& stage, const double* sign) {
  Stage<double, 2> expected;
  expected.put(0, core.distance);
  expected.put(1, core.error_bound + scale * Doubles(kDeepest));
  ProjectedPairs seen;
  if (touching != 0) stage.see(seen);
  Mask16 missed = 0;
  write_patch_contacts(job, given, touching, stage.offset(), sign,
                       [&](unsigned lane, ContactPoint* points) -> std::uint32_t {
                         const std::uint32_t count = contacts_of(
                             stage, seen, lane, job.margin_of(given.first + lane), points);
                         if (count > 0) {
                           const double off =
                               static_cast<double>(points[0].depth) + expected.value[0][lane];
                           const double most = expected.value[1][lane];
                           if (off <= most && off >= -most) return count;
                         }
                         missed |= 1U << lane;
                         return 0;
                       });
  return missed;
}

/// Answers a block at levels distance and manifold; `sign` is as in OrderedBlock. Returns the
/// uncertified lanes.
template <int L, typename Staged, typename T, typename Pair>
[[gnu::always_inline]] inline Mask16 answer_flat(NarrowJob& job, const PairBlock<T>& given,
                                                 const Pair& pair, const T* sign) {
  const auto axis = step<ToBestAxis, T>(pair);
  const Lanes<T> margin = margins_of(job, given);
  LaneMask<T> needed = pair.scale == pair.scale;
  if constexpr (L == kManifold) {
    needed = axis.separation <= margin + pair.rounding_a() + pair.rounding_b() +
                                    pair.scale * Lanes<T>(T(2) * kFlatSlack<T>);
  }
  CoreAnswer<T> core = measure<L, Staged>(pair, axis, needed);
  const Mask16 certified = with_rounding(core, pair.rounding_a(), pair.rounding_b(), pair.scale);
  write_answer<L>(job, given, turned_back(core, pair.offset, Lanes<T>::load(sign)));
  if constexpr (L == kManifold) {
    const Mask16 touching = certified & bits(core.distance <= margin);
    const Staged stage(pair, core.normal);
    return ~certified | write_true_contacts(job, given, core, pair.scale, touching, stage, sign);
  }
  return ~certified;
}

/// Measures all lanes of a block. Not inlined, because few blocks need it. Takes a copy of the
/// pair: a reference would force the caller to store its pair in memory.
template <typename Staged, typename T, typename Pair>
[[gnu::noinline]] inline CoreAnswer<T> measured(Pair pair) {
  const auto axis = step<ToBestAxis, T>(pair);
  return measure<kManifold, Staged>(pair, axis, pair.scale == pair.scale);
}

/// The error bound of level boolean. The float pass rounds its inputs to float, which doubles the
/// bound.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> overlap_slack(const Lanes<T>& scale) {
  return scale * Lanes<T>(kFirstPass<T> ? T(T(2) * kFlatSlack<T>) : kFlatSlack<T>);
}

/// The lanes in which level boolean can compare products of three lengths without overflow or
/// underflow.
template <typename T>
[[gnu::always_inline]] inline LaneMask<T> in_overlap_range(const Lanes<T>& scale) {
  if constexpr (!kFirstPass<T>) return in_range(scale * scale);
  return (scale > Lanes<T>(T(1e-8F))) & (scale < Lanes<T>(T(1e8F)));
}

/// Answers a block at level boolean. In double, pairs that are in neither `apart` nor `over` are
/// measured; in float they remain uncertified.
template <typename Staged, typename T, typename Pair>
[[gnu::always_inline]] inline Mask16 answer_overlaps(NarrowJob& job, const PairBlock<T>& block,
                                                     const Pair& pair, const LaneMask<T>& apart,
                                                     const LaneMask<T>& over) {
  const Mask16 valid = bits(in_overlap_range(pair.scale));
  Mask16 hit = bits(over);
  Mask16 known = hit | bits(apart);
  if constexpr (!kFirstPass<T>) {
    const Mask16 unknown = ~known & valid & block.lanes();
    if (unknown != 0) {
      CoreAnswer<T> core = measured<Staged, T>(pair);
      known |= with_rounding(core, pair.rounding_a(), pair.rounding_b(), pair.scale) & unknown;
      hit |= bits(core.distance <= Lanes<T>(T(0))) & unknown;
    }
  }
  write_overlap(job, block, hit);
  return ~(known & valid);
}

}  // namespace winnow::WINNOW_ISA_NAME::flat
