// Capsules against triangles, many pairs at a time. If the segment and the triangle are apart,
// finds their closest points; if they intersect, the least depth over all face normals of their
// Minkowski difference. Contacts are at the ends of the range of the segment over the triangle, or
// else at the closest or deepest point.

#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/round.wide.h"
#include "pipeline/manifold/feature_rules.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

/// The segment of a capsule, centered at the origin, and a triangle, in the frame of the triangle.
template <typename T>
struct CapsuleAndTriangle {
  Vec3<T> axis;
  Lanes<T> half;
  TriangleView<T> triangle;
  /// axis x edge, its squared length, and 1 / its length
  Vec3<T> across[3];
  Lanes<T> across_square[3];
  Lanes<T> across_over[3];
};

/// The face normal along which the cores are farthest apart or least deep. The Minkowski difference
/// of a segment and a triangle is a prism, whose face normals are the normal of the triangle and
/// the cross products of the segment with the edges. If the cores are apart, `prove` also tries the
/// direction between their closest points, which may be none of these normals.
template <typename T>
struct BestPrismAxis {
  AxisGap<T> gap;
  /// Position on the segment where the cores touch if they are moved apart along the normal of the
  /// prism.
  Lanes<T> s;
  Lanes<T> feature;
  /// True if no normal of the prism was computed from a sine below kMinSine.
  LaneMask<T> sharp;
};

template <typename T>
[[gnu::always_inline]] inline void try_axis(BestPrismAxis<T>& v, const LaneMask<T>& valid,
                                            const AxisGap<T>& gap, const Lanes<T>& s,
                                            const Lanes<T>& feature) {
  const LaneMask<T> better = valid & (gap.distance > v.gap.distance);
  v.gap.distance = select(better, gap.distance, v.gap.distance);
  v.gap.normal = select(better, gap.normal, v.gap.normal);
  v.s = select(better, s, v.s);
  v.feature = select(better, feature, v.feature);
}

template <typename T>
[[gnu::always_inline]] inline BestPrismAxis<T> best_prism_axis(const CapsuleAndTriangle<T>& p,
                                                               const SegmentFeet<T> (&feet)[3]) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const TriangleView<T>& b = p.triangle;
  const Lanes<T> least(kMinSine<T> * kMinSine<T>);
  BestPrismAxis<T> v{{Lanes<T>(T(-__builtin_inff())), {zero, zero, zero}}, zero, zero, zero < one};
  const Vec3<T> n = b.normal * (one / sqrt(b.normal_square));
  const Lanes<T> rise = dot(n, p.axis);
  const AxisGap<T> flat = gap_along(b, n, p.half * abs(rise));
  // The deepest end.
  const Lanes<T> end = select(dot(flat.normal, p.axis) < zero, -p.half, p.half);
  try_axis(v, has_normal(b), flat, end, Lanes<T>(T(7)));
  v.sharp = b.normal_square > b.square[0] * b.square[1] * least;
  for (int i = 0; i < 3; ++i) {
    const LaneMask<T> valid = p.across_square[i] > b.square[i] * Lanes<T>(kNoSineSquare<T>);
    const Vec3<T> k = p.across[i] * p.across_over[i];
    try_axis(v, valid, gap_along(b, k, zero), feet[i].s, Lanes<T>(T(4 + i)));
    v.sharp = v.sharp & (p.across_square[i] > b.square[i] * least);
  }
  return v;
}

template <typename T>
[[gnu::always_inline]] inline NearestCandidate<T> nearest_points(const CapsuleAndTriangle<T>& p,
                                                                 const SegmentFeet<T> (&feet)[3]) {
  const Lanes<T> zero(T(0));
  const TriangleView<T>& b = p.triangle;
  NearestCandidate<T> nearest{{zero, zero, zero}, Lanes<T>(T(__builtin_inff())), zero, zero};
  for (int i = 0; i < 3; ++i) {
    const Vec3<T> w = b.vertex[i] + b.edge[i] * feet[i].t - p.axis * feet[i].s;
    nearer(nearest, w.x == w.x, w, feet[i].s, edge_feature(feet[i].t, i));
  }
  // Only the end that is nearer to the plane can be closest to the inside of the face.
  const Lanes<T> side = dot(b.normal, b.vertex[0]) * dot(b.normal, p.axis);
  const Lanes<T> end = select(side < zero, -p.half, p.half);
  nearer_in_face(nearest, b, p.axis * end, end);
  return nearest;
}

/// Result that all levels use.
template <typename T>
struct CapsuleTriangleSolution {
  CapsuleAndTriangle<T> scene;
  Rotation<T> axes;
  ProofLanes<T> proof;
  Vec3<T> normal;
  Lanes<T> s;
  Lanes<T> feature;
  Lanes<T> radius;
  Lanes<T> radius_b;
};

template <typename T>
[[gnu::always_inline]] inline void prove(CapsuleTriangleSolution<T>& r, const Lanes<T>& scale) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const CapsuleAndTriangle<T>& p = r.scene;
  const TriangleView<T>& b = p.triangle;
  SegmentFeet<T> feet[3];
  for (int i = 0; i < 3; ++i) {
    feet[i] = closest_feet(p.axis, p.half, {b.vertex[i], b.edge[i], b.square[i], zero, one},
                           p.across[i], p.across_over[i] * p.across_over[i]);
  }
  BestPrismAxis<T> v = best_prism_axis(p, feet);
  const NearestCandidate<T> nearest = nearest_points(p, feet);
  const Lanes<T> length = sqrt(nearest.square);
  const Vec3<T> n = nearest.w * (one / length);
  const Lanes<T> along = min(min(dot(b.vertex[0], n), dot(b.vertex[1], n)), dot(b.vertex[2], n)) -
                         p.half * abs(dot(p.axis, n));
  // The error of a depth along a cross product is proportional to 1 / its sine. A depth of at most
  // this error may be the rounding error of a flat prism.
  const Lanes<T> slack = scale * Lanes<T>(kRoundSlack<T>);
  const LaneMask<T> pierced = v.sharp & (v.gap.distance < -slack);
  const Lanes<T> depth = v.gap.distance;
  widen(v.gap, !pierced, along, n);
  r.proof = {select(pierced, depth - slack, v.gap.distance) - r.radius - r.radius_b,
             select(pierced, depth, length) - r.radius - r.radius_b, scale,
             pierced | (length > scale * Lanes<T>(T(kShortest)))};
  r.normal = v.gap.normal;
  r.s = select(pierced, v.s, nearest.s);
  r.feature = select(pierced, v.feature, nearest.feature);
}

/// Not inlined: shared by all levels, and slow to compile.
template <typename T>
[[gnu::noinline]] CapsuleTriangleSolution<T> solve(const NarrowJob& job,
                                                   const PairBlock<T>& block) {
  const Vec3<T> c = load_offset(job, block);
  const ScaledQuaternion<T> turn_a = load_turn<SideA>(job, block);
  const ScaledQuaternion<T> turn_b = load_turn<SideB>(job, block);
  const CapsuleLanes<T> capsule = load_capsule<SideA>(job, block);
  const TriangleLanes<T> triangle = load_triangle<SideB>(job, block);
  CapsuleTriangleSolution<T> r;
  r.axes = rotation(turn_b);
  r.radius = capsule.radius;
  r.radius_b = triangle.rounding;
  CapsuleAndTriangle<T>& p = r.scene;
  p.axis = r.axes.to_local(axis_z(turn_a));
  p.half = capsule.half_length;
  p.triangle = view_triangle(triangle, r.axes.to_local(c));
  for (int i = 0; i < 3; ++i) {
    p.across[i] = cross(p.axis, p.triangle.edge[i]);
    p.across_square[i] = dot(p.across[i], p.across[i]);
    p.across_over[i] = Lanes<T>(T(1)) / sqrt(p.across_square[i]);
  }
  prove(r, norm_l1(c) + largest(triangle) + capsule.half_length + capsule.radius +
               triangle.rounding + doubt(turn_a) + doubt(turn_b));
  return r;
}

/// The range of the segment that is over the triangle, projected along the normal. The contacts at
/// its ends equal the contacts that contact_patch finds for the segment and the triangle.
template <typename T>
[[gnu::always_inline]] inline ContactRange<T> range_over(const CapsuleTriangleSolution<T>& r) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const CapsuleAndTriangle<T>& p = r.scene;
  const TriangleView<T>& b = p.triangle;
  const Lanes<T> facing = dot(b.normal, r.normal);
  const Lanes<T> side = sign_or_one(facing);
  const Lanes<T> slack = r.proof.scale * Lanes<T>(T(kOnePlace));
  const Lanes<T> longest = sqrt(max(b.square[0], max(b.square[1], b.square[2])));
  const Lanes<T> near = min(longest, p.half * Lanes<T>(T(2))) * Lanes<T>(T(kAlongSide));
  Lanes<T> low = -p.half;
  Lanes<T> high = p.half;
  // Feature of the triangle at each end of the range: an edge, or the face if the segment ends
  // first.
  Lanes<T> feature[2] = {Lanes<T>(T(7)), Lanes<T>(T(7))};
  for (int i = 0; i < 3; ++i) {
    const Vec3<T> inward = cross(r.normal, b.edge[i]) * side;
    // inward . (s axis - vertex) >= 0
    const Lanes<T> slope = dot(inward, p.axis);
    const Lanes<T> offset = dot(inward, b.vertex[i]);
    const Lanes<T> at = offset / slope;
    const Lanes<T> edge(T(4 + i));
    // Do not cut if the whole segment is inside, up to rounding, or lies along the edge.
    const Lanes<T> lean = p.half * abs(slope);
    const Lanes<T> length = sqrt(b.square[i]);
    const LaneMask<T> is_beside =
        (offset + lean <= near * length) & (offset - lean >= -(near * length));
    const LaneMask<T> cuts = (offset + lean > slack * length) & !is_beside;
    const LaneMask<T> begins = cuts & (slope > zero) & (at > low);
    const LaneMask<T> ends = cuts & (slope < zero) & (at < high);
    low = select(begins, at, low);
    feature[0] = select(begins, edge, feature[0]);
    high = select(ends, at, high);
    feature[1] = select(ends, edge, feature[1]);
    const LaneMask<T> never = cuts & (slope == zero);
    high = select(never, -p.half - p.half, high);
  }
  // Distance along the normal to the plane of the triangle at s: base + rise s.
  const Lanes<T> over = one / facing;
  const Lanes<T> base = dot(b.normal, b.vertex[0]) * over - r.radius - r.radius_b;
  const Lanes<T> rise = -dot(b.normal, p.axis) * over;
  ContactRange<T> range{{low, high},
                        {base + rise * low, base + rise * high},
                        {feature[0], feature[1]},
                        facing * facing > b.normal_square * Lanes<T>(T(kSteepSquare))};
  range.has_two_contacts = range.has_two_contacts & two_ends(range, r.proof, p.axis, r.normal);
  return range;
}

template <typename T>
[[gnu::always_inline]] inline void write_point_contacts(NarrowJob& job, const PairBlock<T>& block,
                                                        const CapsuleTriangleSolution<T>& r,
                                                        const CertifiedLanes<T>& answer) {
  const CapsuleAndTriangle<T>& p = r.scene;
  const Vec3<T> axis = r.axes.to_world(p.axis);
  const auto contact = [&](const Lanes<T>& s, const Lanes<T>& d, const Lanes<T>& feature) {
    const Vec3<T> position = axis * s + answer.normal * (r.radius + d * Lanes<T>(T(0.5)));
    return ContactLanes<T>{position, -d, segment_feature(s, p.half), feature, 0};
  };
  write_range(job, block, answer, range_over(r), r.s, r.feature, contact);
}

struct CapsuleTriangle {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    const CapsuleTriangleSolution<T> r = solve(job, block);
    if constexpr (L == kBoolean) {
      return answer_proven_sign(job, block, r.proof);
    } else {
      const CertifiedLanes<T> answer = answer_proven(r.proof, r.axes.to_world(r.normal));
      const Vec3<T> foot = r.axes.to_world(r.scene.axis * r.s);
      write_certified<L>(job, block, answer, foot, r.radius);
      if constexpr (L == kManifold) write_point_contacts(job, block, r, answer);
      return ~answer.certified;
    }
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(capsule_triangle_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::CapsuleTriangle>();

}  // namespace winnow
