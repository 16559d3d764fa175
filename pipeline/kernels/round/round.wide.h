#pragma once

// Shared by the kernels of this folder: closest points of segments and triangles, and the step from
// the closest points of two cores to certified answers and contacts.

#include "pipeline/kernels/one_pair.wide.h"

namespace winnow::WINNOW_ISA_NAME::round {

/// Error bound of the closed forms, in units of epsilon times the pair's scale: about three times
/// the sum of the rounding errors of their operations.
inline constexpr int kRoundings = 16;

/// If the distance of the cores is shorter than this times the pair's scale, the line between their
/// closest points is not used as normal. Otherwise the error of the normal is at most kRoundings *
/// epsilon / kShortest, which is 4e-6.
inline constexpr double kShortest = 1e-9;

/// The smallest sine for which the cross product of two directions counts as the normal of
/// overlapping cores, and the error bound of the depth along such a normal relative to the pair's
/// scale: 8 epsilon divided by the sine.
template <typename T>
inline constexpr T kMinSine = T(1) / T(128);
template <typename T>
inline constexpr T kRoundSlack = T(8) * kEpsilon<T> / kMinSine<T>;

/// If the squared sine of the angle between two directions is smaller, their cross product consists
/// of rounding errors.
template <typename T>
inline constexpr T kNoSineSquare = T(16) * kEpsilon<T>* kEpsilon<T>;

/// The vector between the closest points of two cores.
template <typename T>
struct CoreGapLanes {
  /// From the point on core a to the point on core b; its error is at most kRoundings * epsilon *
  /// scale.
  Vec3<T> w;
  /// The sum of both roundings.
  Lanes<T> radius;
  /// At least the sum of all lengths from which w was computed, and of the radius; NaN for an
  /// invalid pose.
  Lanes<T> scale;
};

/// The lanes in which the error bound proves the sign, the scale is in range, and `normal` is set.
template <typename T>
[[gnu::always_inline]] inline Mask16 certified_lanes(const Lanes<T>& distance,
                                                     const Lanes<T>& bound, const Lanes<T>& scale,
                                                     const LaneMask<T>& normal) {
  return bits(in_range(scale * scale) & normal & (abs(distance) > bound));
}

/// Level boolean, from squares; returns the uncertified lanes. If w has the error e, its square has
/// the error 2 |w| e <= 2 scale e. The bound is twice that.
template <typename T>
[[gnu::always_inline]] inline Mask16 answer_overlap(const NarrowJob& job, const PairBlock<T>& block,
                                                    const CoreGapLanes<T>& witness) {
  const Lanes<T> square = witness.scale * witness.scale;
  const Lanes<T> excess = dot(witness.w, witness.w) - witness.radius * witness.radius;
  const Lanes<T> error = square * Lanes<T>(T(4 * kRoundings) * kEpsilon<T>);
  write_overlap(job, block, bits(excess <= Lanes<T>(T(0))));
  return ~certified_lanes(excess, error, witness.scale, square > Lanes<T>(T(0)));
}

/// A distance along a normal, and the lanes in which it is certified.
template <typename T>
struct CertifiedLanes {
  Lanes<T> distance;
  Lanes<T> error_bound;
  Vec3<T> normal;
  Mask16 certified;
};

/// Level boolean for kernels that have computed the distance.
template <typename T>
[[gnu::always_inline]] inline Mask16 answer_sign(const NarrowJob& job, const PairBlock<T>& block,
                                                 const Lanes<T>& distance, const Lanes<T>& bound,
                                                 const Lanes<T>& scale) {
  write_overlap(job, block, bits(distance <= Lanes<T>(T(0))));
  return ~certified_lanes(distance, bound, scale, scale > Lanes<T>(T(0)));
}

/// Levels distance and manifold. Lanes in which |w| is at most `shortest` are not certified,
/// because w is then too short for a normal.
template <typename T>
[[gnu::always_inline]] inline CertifiedLanes<T> answer_distance(const CoreGapLanes<T>& witness,
                                                                const Lanes<T>& shortest) {
  const Lanes<T> length = sqrt(dot(witness.w, witness.w));
  const Lanes<T> distance = length - witness.radius;
  const Lanes<T> bound = witness.scale * Lanes<T>(T(kRoundings) * kEpsilon<T>);
  return {distance, bound, witness.w * (Lanes<T>(T(1)) / length),
          certified_lanes(distance, bound, witness.scale, length > shortest)};
}

/// As answer_distance, for pairs whose normal is known.
template <typename T>
[[gnu::always_inline]] inline CertifiedLanes<T> answer_along(const Vec3<T>& normal,
                                                             const Lanes<T>& distance,
                                                             const Lanes<T>& bound,
                                                             const Lanes<T>& scale) {
  return {distance, bound, normal, certified_lanes(distance, bound, scale, scale > Lanes<T>(T(0)))};
}

/// Returns a unit vector perpendicular to a unit vector (Duff et al., "Building an orthonormal
/// basis, revisited", JCGT 2017).
template <typename T>
[[gnu::always_inline]] inline Vec3<T> any_across(const Vec3<T>& u) {
  const Lanes<T> one(T(1));
  const Lanes<T> sign = sign_or_one(u.z);
  const Lanes<T> a = -one / (sign + u.z);
  return {one + sign * u.x * u.x * a, sign * u.x * u.y * a, -(sign * u.x)};
}

/// For cores that are points or segments, and a direction `across` perpendicular to both, in the
/// `known` lanes. If the cores share a point, up to rounding, a translation along `across` by the
/// sum of the roundings separates the shapes, and no shorter one does: `across` becomes the normal.
template <typename T>
[[gnu::always_inline]] inline void separate_across(CertifiedLanes<T>& answer,
                                                   const CoreGapLanes<T>& witness,
                                                   const Vec3<T>& across,
                                                   const LaneMask<T>& known) {
  const Lanes<T> rounding = answer.error_bound;
  const LaneMask<T> touch = known & (dot(witness.w, witness.w) <= rounding * rounding);
  answer.normal = select(touch, across, answer.normal);
  answer.error_bound = select(touch, rounding + rounding, rounding);
  answer.certified |= certified_lanes(answer.distance, answer.error_bound, witness.scale, touch);
}

/// Writes the columns of levels distance and manifold. `foot` is the point on core a, `radius` the
/// rounding of a.
template <int L, typename T>
[[gnu::always_inline]] inline void write_certified(const NarrowJob& job, const PairBlock<T>& block,
                                                   const CertifiedLanes<T>& c, const Vec3<T>& foot,
                                                   const Lanes<T>& radius) {
  AnswerLanes<T> answer{c.distance, c.error_bound, c.normal, {}};
  if constexpr (L == kDistance) answer.point = foot + c.normal * radius;
  write_answer<L>(job, block, answer);
}

/// A contact halfway between the surfaces, for certified pairs within the margin.
template <typename T>
[[gnu::always_inline]] inline ContactLanes<T> witness_contact(
    const NarrowJob& job, const PairBlock<T>& block, const CertifiedLanes<T>& c,
    const Vec3<T>& foot, const Lanes<T>& radius, const Lanes<T>& feature_a,
    const Lanes<T>& feature_b) {
  const Lanes<T> half(T(0.5));
  const LaneMask<T> near = c.distance <= margins_of(job, block);
  return {foot + c.normal * (radius + c.distance * half), -c.distance, feature_a, feature_b,
          bits(near) & c.certified & block.lanes()};
}

/// Levels distance and manifold for pairs that touch in one point; its feature on body a is 0.
/// Returns the uncertified lanes.
template <int L, typename T>
[[gnu::always_inline]] inline Mask16 write_touch(NarrowJob& job, const PairBlock<T>& block,
                                                 const CertifiedLanes<T>& c, const Vec3<T>& foot,
                                                 const Lanes<T>& radius,
                                                 const Lanes<T>& feature_b) {
  write_certified<L>(job, block, c, foot, radius);
  if constexpr (L == kManifold) {
    const Lanes<T> zero(T(0));
    write_contacts(job, block, {witness_contact(job, block, c, foot, radius, zero, feature_b)});
  }
  return ~c.certified;
}

/// As write_touch, with a sphere as body a; its core is its position.
template <int L, typename T>
[[gnu::always_inline]] inline Mask16 write_ball(NarrowJob& job, const PairBlock<T>& block,
                                                const CertifiedLanes<T>& c, const Lanes<T>& radius,
                                                const Lanes<T>& feature_b) {
  const Lanes<T> zero(T(0));
  return write_touch<L>(job, block, c, Vec3<T>{zero, zero, zero}, radius, feature_b);
}

/// A sphere as body a, and a shape whose distance from a point has a closed form.
template <typename T>
struct BallSolution {
  Lanes<T> distance;
  Lanes<T> bound;
  Lanes<T> scale;
  /// In world axes; valid where `unique` is set.
  Vec3<T> normal;
  LaneMask<T> unique;
  Lanes<T> radius;
  /// The feature of body b.
  Lanes<T> feature;
};

/// Answers a sphere pair at any level; returns the uncertified lanes.
template <int L, typename T>
[[gnu::always_inline]] inline Mask16 answer_ball(NarrowJob& job, const PairBlock<T>& block,
                                                 const BallSolution<T>& r) {
  if constexpr (L == kBoolean) {
    return answer_sign(job, block, r.distance, r.bound, r.scale);
  } else {
    const CertifiedLanes<T> answer{r.distance, r.bound, r.normal,
                                   certified_lanes(r.distance, r.bound, r.scale, r.unique)};
    return write_ball<L>(job, block, answer, r.radius, r.feature);
  }
}

/// Bounds of a signed distance, up to an error of kRoundings * epsilon * scale.
template <typename T>
struct ProofLanes {
  /// The separation along some direction.
  Lanes<T> low;
  /// The distance of two points of the shapes, or minus the depth along some direction.
  Lanes<T> high;
  /// As in CoreGapLanes.
  Lanes<T> scale;
  /// The lanes in which the direction is well defined.
  LaneMask<T> unique;
};

/// The lanes in which the fourth power of the scale is in T's range.
template <typename T>
[[gnu::always_inline]] inline LaneMask<T> in_narrow_range(const Lanes<T>& scale) {
  constexpr bool is_double = sizeof(T) == sizeof(double);
  return (scale > Lanes<T>(is_double ? T(1e-50) : T(1e-6F))) &
         (scale < Lanes<T>(is_double ? T(1e50) : T(1e6F)));
}

/// Level boolean.
template <typename T>
[[gnu::always_inline]] inline Mask16 answer_proven_sign(const NarrowJob& job,
                                                        const PairBlock<T>& block,
                                                        const ProofLanes<T>& proof) {
  write_overlap(job, block, bits(proof.high <= Lanes<T>(T(0))));
  const Lanes<T> error = proof.scale * Lanes<T>(T(kRoundings) * kEpsilon<T>);
  const LaneMask<T> valid = in_narrow_range(proof.scale);
  return ~bits(valid & ((proof.high < -error) | (proof.low > error)));
}

/// Levels distance and manifold. Error bounds are at most 1e-12 of sizes plus distance; `scale` is
/// at most twice that sum.
template <typename T>
[[gnu::always_inline]] inline CertifiedLanes<T> answer_proven(const ProofLanes<T>& proof,
                                                              const Vec3<T>& normal) {
  const Lanes<T> widest(T(4e-13));
  const Lanes<T> bound =
      abs(proof.high - proof.low) + proof.scale * Lanes<T>(T(kRoundings) * kEpsilon<T>);
  const LaneMask<T> valid =
      proof.unique & in_narrow_range(proof.scale) & (bound < proof.scale * widest);
  return {proof.high, bound, normal, certified_lanes(proof.high, bound, proof.scale, valid)};
}

template <typename T>
[[gnu::always_inline]] inline Lanes<T> clamp(const Lanes<T>& v, const Lanes<T>& low,
                                             const Lanes<T>& high) {
  return min(max(v, low), high);
}

/// 0, or NaN if the orientation is not usable.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> doubt(const ScaledQuaternion<T>& turn) {
  return turn.scale - turn.scale;
}

/// The feature of a contact at t on a capsule's segment: 1 and 2 for the ends, 0 between them.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> segment_feature(const Lanes<T>& t,
                                                       const Lanes<T>& half_length) {
  const Lanes<T> zero(T(0));
  const Lanes<T> low = select(t <= -half_length, Lanes<T>(T(2)), zero);
  return select(t >= half_length, Lanes<T>(T(1)), low);
}

/// The parameters of the closest points s u and c + t e of two segments.
template <typename T>
struct SegmentFeet {
  Lanes<T> s;
  Lanes<T> t;
};

/// The second segment: c + t e, low <= t <= high. `square` is |e|^2, which may be 0.
template <typename T>
struct SegmentLanes {
  Vec3<T> c;
  Vec3<T> e;
  Lanes<T> square;
  Lanes<T> low;
  Lanes<T> high;
};

/// Returns the closest points of the segment s u, |u| = 1, |s| <= h, and segment b. As in Ericson,
/// Real-Time Collision Detection (2005), 5.1.9, but s is computed from the cross product k = u x e
/// and over = 1 / |k|^2. By Lagrange's identity these are the same numbers, without the
/// cancellation for nearly parallel segments. The error of s is then eps |c| / sin. An error of s
/// changes the distance by that error times sin, so the distance has an error of eps |c| at any
/// angle. If u x e vanishes, the segments are parallel and any s can be the start: the last two
/// steps compute the t closest to it, and the s closest to that t.
template <typename T>
[[gnu::always_inline]] inline SegmentFeet<T> closest_feet(const Vec3<T>& u, const Lanes<T>& h,
                                                          const SegmentLanes<T>& b,
                                                          const Vec3<T>& k, const Lanes<T>& over) {
  const Lanes<T> zero(T(0));
  const Lanes<T> along = dot(u, b.e);
  const Lanes<T> place_on_line = dot(k, cross(b.c, b.e)) * over;
  // 0 if the segments are parallel, where the parameter is infinite or NaN.
  const Lanes<T> line = select(place_on_line - place_on_line == zero, place_on_line, zero);
  const Lanes<T> first = clamp(line, -h, h);
  const Lanes<T> place = (along * first - dot(b.e, b.c)) / b.square;
  const Lanes<T> t = clamp(select(b.square > zero, place, b.low), b.low, b.high);
  return {clamp(dot(u, b.c) + along * t, -h, h), t};
}

/// A triangle relative to a query point: vertices, edge i from vertex i to the next one, squares of
/// the edges' lengths, and the normal e0 x e1, which is not normalized.
template <typename T>
struct TriangleView {
  Vec3<T> vertex[3];
  Vec3<T> edge[3];
  Lanes<T> square[3];
  Vec3<T> normal;
  Lanes<T> normal_square;
};

/// Adds `offset` to the vertices.
template <typename T>
[[gnu::always_inline]] inline TriangleView<T> view_triangle(const TriangleLanes<T>& triangle,
                                                            const Vec3<T>& offset) {
  TriangleView<T> r;
  for (int i = 0; i < 3; ++i) {
    r.vertex[i] = triangle.vertex[i] + offset;
    r.edge[i] = triangle.vertex[i == 2 ? 0 : i + 1] - triangle.vertex[i];
    r.square[i] = dot(r.edge[i], r.edge[i]);
  }
  r.normal = cross(r.edge[0], r.edge[1]);
  r.normal_square = dot(r.normal, r.normal);
  return r;
}

/// The lanes in which the normal is more than rounding error.
template <typename T>
[[gnu::always_inline]] inline LaneMask<T> has_normal(const TriangleView<T>& b) {
  const Lanes<T> least(kNoSineSquare<T>);
  return b.normal_square > b.square[0] * b.square[1] * least;
}

/// The largest sum of a vertex' absolute coordinates.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> largest(const TriangleLanes<T>& triangle) {
  return max(norm_l1(triangle.vertex[0]),
             max(norm_l1(triangle.vertex[1]), norm_l1(triangle.vertex[2])));
}

/// The direction with the largest separation of two cores so far.
template <typename T>
struct AxisGap {
  /// The separation, negative if the cores overlap.
  Lanes<T> distance;
  /// Unit, from a to b.
  Vec3<T> normal;
};

/// Keeps the direction with the larger separation.
template <typename T>
[[gnu::always_inline]] inline void widen(AxisGap<T>& gap, const LaneMask<T>& valid,
                                         const Lanes<T>& distance, const Vec3<T>& normal) {
  const LaneMask<T> better = valid & (distance > gap.distance);
  gap.distance = select(better, distance, gap.distance);
  gap.normal = select(better, normal, gap.normal);
}

/// The separation of a triangle from a segment along a unit direction or its opposite, whichever is
/// larger. The middle of the segment is the origin; `reach` is half the extent of the segment along
/// the direction.
template <typename T>
[[gnu::always_inline]] inline AxisGap<T> gap_along(const TriangleView<T>& b, const Vec3<T>& n,
                                                   const Lanes<T>& reach) {
  const Lanes<T> x = dot(b.vertex[0], n);
  const Lanes<T> y = dot(b.vertex[1], n);
  const Lanes<T> z = dot(b.vertex[2], n);
  const Lanes<T> ahead = min(min(x, y), z) - reach;
  const Lanes<T> behind = -max(max(x, y), z) - reach;
  return {max(ahead, behind), select(ahead >= behind, n, -n)};
}

/// The best candidate so far for the closest points.
template <typename T>
struct NearestCandidate {
  /// From a to b.
  Vec3<T> w;
  Lanes<T> square;
  /// The parameter of the point on the segment of a.
  Lanes<T> s;
  /// 1, 2, 3 for the vertices of the triangle, 4, 5, 6 for its edges, 7 for its face.
  Lanes<T> feature;
};

template <typename T>
[[gnu::always_inline]] inline void nearer(NearestCandidate<T>& nearest, const LaneMask<T>& valid,
                                          const Vec3<T>& w, const Lanes<T>& s,
                                          const Lanes<T>& feature) {
  const Lanes<T> square = dot(w, w);
  const LaneMask<T> better = valid & (square < nearest.square);
  nearest.w = select(better, w, nearest.w);
  nearest.square = select(better, square, nearest.square);
  nearest.s = select(better, s, nearest.s);
  nearest.feature = select(better, feature, nearest.feature);
}

/// Tries the foot of `point` on the plane of the triangle, if the foot is inside. It is computed as
/// a convex combination of the vertices, so it is on the triangle even if the triangle is thin.
template <typename T>
[[gnu::always_inline]] inline void nearer_in_face(NearestCandidate<T>& nearest,
                                                  const TriangleView<T>& b, const Vec3<T>& point,
                                                  const Lanes<T>& s) {
  const Lanes<T> zero(T(0));
  const Vec3<T> v[3] = {b.vertex[0] - point, b.vertex[1] - point, b.vertex[2] - point};
  const Lanes<T> weight[3] = {dot(cross(v[1], b.edge[1]), b.normal),
                              dot(cross(v[2], b.edge[2]), b.normal),
                              dot(cross(v[0], b.edge[0]), b.normal)};
  const Lanes<T> sum = weight[0] + weight[1] + weight[2];
  const LaneMask<T> over =
      (weight[0] >= zero) & (weight[1] >= zero) & (weight[2] >= zero) & (sum > zero);
  const Vec3<T> w =
      (v[0] * weight[0] + v[1] * weight[1] + v[2] * weight[2]) * (Lanes<T>(T(1)) / sum);
  nearer(nearest, over, w, s, Lanes<T>(T(7)));
}

/// The feature of an edge's point at t.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> edge_feature(const Lanes<T>& t, int edge) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const Lanes<T> next(T(edge == 2 ? 1 : edge + 2));
  return select(t <= zero, Lanes<T>(T(edge + 1)), select(t >= one, next, Lanes<T>(T(edge + 4))));
}

/// Returns -1, 0 or 1.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> sign(const Lanes<T>& v) {
  const Lanes<T> zero(T(0));
  return select(v > zero, Lanes<T>(T(1)), select(v < zero, Lanes<T>(T(-1)), zero));
}

/// The feature of the closest point of a box, from the signs of the direction towards the box: a
/// number with three ternary digits.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> box_feature(const Vec3<T>& towards) {
  const Lanes<T> three(T(3));
  return Lanes<T>(T(13)) - (sign(towards.x) + three * (sign(towards.y) + three * sign(towards.z)));
}

/// Relative to the pair's scale. Contacts closer than kOnePlace are one contact. The end of a
/// range counts as the deepest point if its depth differs by at most kSameDepth from the depth of
/// the pair.
inline constexpr double kOnePlace = 1e-9;
inline constexpr double kSameDepth = 4e-7;
/// The smallest square of the sine of the angle between a segment and the projection direction.
inline constexpr double kSteepSquare = 1e-12;

/// The part of a segment that is over a face, seen along the normal: the parameters of its two
/// ends, the distances of the shapes there, and the features of contacts there.
template <typename T>
struct ContactRange {
  Lanes<T> at[2];
  Lanes<T> distance[2];
  Lanes<T> feature[2];
  /// The lanes in which the range exists and two_ends is true.
  LaneMask<T> has_two_contacts;
};

/// True if the ends of the range can be the contacts of the pair: they are distinct, and one of
/// them has the depth of the pair. `u` is the segment's direction, `normal` the projection
/// direction.
template <typename T>
[[gnu::always_inline]] inline LaneMask<T> two_ends(const ContactRange<T>& range,
                                                   const ProofLanes<T>& proof, const Vec3<T>& u,
                                                   const Vec3<T>& normal) {
  const Vec3<T> across = u - normal * dot(u, normal);
  const Lanes<T> square = dot(across, across);
  const Lanes<T> length = range.at[1] - range.at[0];
  const Lanes<T> place = proof.scale * Lanes<T>(T(kOnePlace));
  const Lanes<T> deepest = min(range.distance[0], range.distance[1]);
  return (square > Lanes<T>(T(kSteepSquare))) & (length > Lanes<T>(T(0))) &
         (length * length * square > place * place) &
         (abs(deepest - proof.high) <= proof.scale * Lanes<T>(T(kSameDepth)));
}

/// Writes the contacts of the certified pairs within the margin: those at the ends of the range
/// that are within the margin; if there is no range or neither end is within the margin, one at `s`
/// with `feature`. `contact(s, distance, feature)` returns a contact.
template <typename T, typename Contact>
[[gnu::always_inline]] inline void write_range(NarrowJob& job, const PairBlock<T>& block,
                                               const CertifiedLanes<T>& answer,
                                               const ContactRange<T>& range, const Lanes<T>& s,
                                               const Lanes<T>& feature, Contact&& contact) {
  const Lanes<T> margin = margins_of(job, block);
  const LaneMask<T> near_low = range.has_two_contacts & (range.distance[0] <= margin);
  const LaneMask<T> near_high = range.has_two_contacts & (range.distance[1] <= margin);
  const auto nearer_end = [&](const Lanes<T>(&ends)[2], const Lanes<T>& neither)
      __attribute__((always_inline)) {
    return select(near_low, ends[0], select(near_high, ends[1], neither));
  };
  ContactLanes<T> contacts[2] = {
      contact(nearer_end(range.at, s), nearer_end(range.distance, answer.distance),
              nearer_end(range.feature, feature)),
      contact(range.at[1], range.distance[1], range.feature[1])};
  contacts[0].lanes = bits(answer.distance <= margin) & answer.certified & block.lanes();
  contacts[1].lanes = bits(near_low & near_high) & contacts[0].lanes;
  write_contacts(job, block, contacts);
}

}  // namespace winnow::WINNOW_ISA_NAME::round
