// Capsules against boxes, many pairs at a time. If the segment and the box are apart, finds their
// closest points; if they overlap, the least overlap over all face normals of their Minkowski sum.
// Contacts are at the ends of the range of the segment over a face, or else at the closest or
// deepest point.

#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/round.wide.h"
#include "pipeline/manifold/feature_rules.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

/// The segment middle + s axis, |s| <= half, of a capsule, in the frame of the box |x_i| <= size_i.
template <typename T>
struct CapsuleAndBox {
  Lanes<T> middle[3];
  Lanes<T> axis[3];
  Lanes<T> half;
  Lanes<T> size[3];
};

template <typename T>
[[gnu::always_inline]] inline Vec3<T> towards_box(const CapsuleAndBox<T>& p, const Lanes<T>& s) {
  Lanes<T> w[3];
  for (int i = 0; i < 3; ++i) {
    const Lanes<T> x = p.middle[i] + p.axis[i] * s;
    w[i] = clamp(x, -p.size[i], p.size[i]) - x;
  }
  return {w[0], w[1], w[2]};
}

/// Half the derivative, with respect to s, of the squared distance to the box: piecewise linear and
/// nondecreasing.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> slope_at(const CapsuleAndBox<T>& p, const Lanes<T>& s) {
  const Vec3<T> w = towards_box(p, s);
  return -(w.x * p.axis[0] + w.y * p.axis[1] + w.z * p.axis[2]);
}

/// Returns the s at which the segment is closest to the box: the root of the slope, between its
/// last breakpoint (where the segment crosses the plane of a face) with a negative slope and its
/// first one with a nonnegative slope. Let a be the length of the component of the axis along the
/// normals of those slabs of the box outside of which the point at s is. Per unit of s, the slope
/// rises by a^2. An error eps |c| a of the slope is thus an error eps |c| / a of the root, and
/// changes the distance by at most a times that, eps |c|: the distance is as accurate as the poses,
/// at any angle.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> closest_place(const CapsuleAndBox<T>& p) {
  const Lanes<T> zero(T(0));
  Lanes<T> low = -p.half;
  Lanes<T> high = p.half;
  Lanes<T> slope_low = slope_at(p, low);
  Lanes<T> slope_high = slope_at(p, high);
  const Lanes<T> ends[2] = {slope_low, slope_high};
  for (int i = 0; i < 3; ++i) {
    const Lanes<T> over = select(p.axis[i] == zero, zero, Lanes<T>(T(1)) / p.axis[i]);
    for (int side = 0; side < 2; ++side) {
      const Lanes<T> face = side == 0 ? -p.size[i] : p.size[i];
      const Lanes<T> s = clamp((face - p.middle[i]) * over, -p.half, p.half);
      const Lanes<T> slope = slope_at(p, s);
      const LaneMask<T> below = (slope < zero) & (s > low);
      const LaneMask<T> above = (slope >= zero) & (s < high);
      low = select(below, s, low);
      slope_low = select(below, slope, slope_low);
      high = select(above, s, high);
      slope_high = select(above, slope, slope_high);
    }
  }
  const Lanes<T> root = low - slope_low * ((high - low) / (slope_high - slope_low));
  const Lanes<T> inner = clamp(select(slope_high > slope_low, root, low), low, high);
  return select(ends[0] >= zero, -p.half, select(ends[1] <= zero, p.half, inner));
}

/// The direction in which segment and box overlap least, among the face normals of their Minkowski
/// sum: the axes of the box, and cross products of the segment's axis with them.
template <typename T>
struct Overlap {
  /// Negative if they overlap.
  Lanes<T> distance;
  /// Unit, from the segment to the box, in the frame of the box.
  Lanes<T> normal[3];
  /// True if each sine between the axis and an edge of the box is 0 up to rounding, or above
  /// kMinSine.
  LaneMask<T> sharp;
};

template <typename T>
[[gnu::always_inline]] inline Overlap<T> least_overlap(const CapsuleAndBox<T>& p) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  Overlap<T> r{Lanes<T>(T(-__builtin_inff())), {zero, zero, zero}, zero < one};
  for (int i = 0; i < 3; ++i) {
    const Lanes<T> distance = abs(p.middle[i]) - p.size[i] - p.half * abs(p.axis[i]);
    const LaneMask<T> better = distance > r.distance;
    r.distance = select(better, distance, r.distance);
    for (int k = 0; k < 3; ++k) {
      const Lanes<T> towards = k == i ? -sign_or_one(p.middle[i]) : zero;
      r.normal[k] = select(better, towards, r.normal[k]);
    }
  }
  const Lanes<T> parallel(T(64) * kEpsilon<T> * kEpsilon<T>);
  const Lanes<T> least(kMinSine<T> * kMinSine<T>);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    const Lanes<T> square = p.axis[j] * p.axis[j] + p.axis[k] * p.axis[k];
    const LaneMask<T> valid = square > parallel;
    const Lanes<T> over = one / sqrt(square);
    // e_i x axis
    const Lanes<T> nj = -p.axis[k] * over;
    const Lanes<T> nk = p.axis[j] * over;
    const Lanes<T> place = p.middle[j] * nj + p.middle[k] * nk;
    const Lanes<T> distance = abs(place) - p.size[j] * abs(nj) - p.size[k] * abs(nk);
    const LaneMask<T> better = valid & (distance > r.distance);
    const Lanes<T> side = -sign_or_one(place);
    r.distance = select(better, distance, r.distance);
    r.normal[i] = select(better, zero, r.normal[i]);
    r.normal[j] = select(better, nj * side, r.normal[j]);
    r.normal[k] = select(better, nk * side, r.normal[k]);
    r.sharp = r.sharp & ((!valid) | (square > least));
  }
  return r;
}

/// Returns the s at which the cores touch if they are moved apart along the normal. If the axis is
/// not perpendicular to the normal, this is an end of the segment. Otherwise the segment is
/// parallel to the face or edge that it touches: s is the point nearest to the edge, in the axes of
/// the box along which the normal has a component, clamped to the range over the box in the other
/// axes.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> deepest_place(const CapsuleAndBox<T>& p, const Vec3<T>& n) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const Lanes<T> level(T(64) * kEpsilon<T>);
  const Lanes<T> normal[3] = {n.x, n.y, n.z};
  const Lanes<T> along = n.x * p.axis[0] + n.y * p.axis[1] + n.z * p.axis[2];
  Lanes<T> over = zero;
  Lanes<T> weight = zero;
  Lanes<T> low = -p.half;
  Lanes<T> high = p.half;
  for (int i = 0; i < 3; ++i) {
    const Lanes<T> corner = select(normal[i] > zero, -p.size[i], p.size[i]);
    const LaneMask<T> counts = abs(normal[i]) > level;
    over += select(counts, (corner - p.middle[i]) * p.axis[i], zero);
    weight += select(counts, p.axis[i] * p.axis[i], zero);
    const LaneMask<T> slab = (!counts) & (abs(p.axis[i]) > level);
    const Lanes<T> from = (-p.size[i] - p.middle[i]) * (one / p.axis[i]);
    const Lanes<T> to = (p.size[i] - p.middle[i]) * (one / p.axis[i]);
    low = select(slab, max(low, min(from, to)), low);
    high = select(slab, min(high, max(from, to)), high);
  }
  const Lanes<T> crossing = select(weight > level * level, over / weight, zero);
  const Lanes<T> end = select(along < zero, -p.half, p.half);
  return clamp(select(abs(along) > level, end, clamp(crossing, low, high)), -p.half, p.half);
}

template <typename T>
struct CapsuleBoxSolution {
  CapsuleAndBox<T> scene;
  Rotation<T> axes;
  ProofLanes<T> proof;
  /// In the frame of the box, from the capsule to the box.
  Vec3<T> normal;
  Lanes<T> s;
  Lanes<T> radius;
  Lanes<T> radius_b;
};

/// Not inlined: shared by all levels, and slow to compile.
template <typename T>
[[gnu::noinline]] CapsuleBoxSolution<T> solve(const NarrowJob& job, const PairBlock<T>& block) {
  const Vec3<T> c = load_offset(job, block);
  const ScaledQuaternion<T> turn_a = load_turn<SideA>(job, block);
  const ScaledQuaternion<T> turn_b = load_turn<SideB>(job, block);
  const CapsuleLanes<T> capsule = load_capsule<SideA>(job, block);
  const BoxLanes<T> box = load_box<SideB>(job, block);
  CapsuleBoxSolution<T> r;
  r.axes = rotation(turn_b);
  const Vec3<T> u = r.axes.to_local(axis_z(turn_a));
  const Vec3<T> m = -r.axes.to_local(c);
  r.scene = {
      {m.x, m.y, m.z}, {u.x, u.y, u.z}, capsule.half_length, {box.half.x, box.half.y, box.half.z}};
  r.radius = capsule.radius;
  r.radius_b = box.rounding;

  const Lanes<T> both = capsule.radius + box.rounding;
  const Lanes<T> scale =
      norm_l1(c) + norm_l1(box.half) + capsule.half_length + both + doubt(turn_a) + doubt(turn_b);
  const Overlap<T> overlap = least_overlap(r.scene);
  const Lanes<T> s = closest_place(r.scene);
  const Vec3<T> w = towards_box(r.scene, s);
  const Lanes<T> length = sqrt(dot(w, w));
  // The error of a depth along a cross product is proportional to 1 / its sine. A depth of at most
  // this error may be the rounding error of a flat Minkowski sum.
  const Lanes<T> slack = scale * Lanes<T>(kRoundSlack<T>);
  const LaneMask<T> inside = overlap.sharp & (overlap.distance < -slack);
  r.proof = {select(inside, overlap.distance - slack, length) - both,
             select(inside, overlap.distance, length) - both, scale,
             inside | (length > scale * Lanes<T>(T(kShortest)))};
  const Vec3<T> flat{overlap.normal[0], overlap.normal[1], overlap.normal[2]};
  r.normal = select(inside, flat, w * (Lanes<T>(T(1)) / length));
  r.s = select(inside, deepest_place(r.scene, flat), s);
  return r;
}

/// The face of the box that faces against the normal most.
template <typename T>
struct FacingBox {
  LaneMask<T> is_axis[3];
  /// Components of a vector: perpendicular to the face, and the two (i = 0, 1) in its plane.
  [[gnu::always_inline]] Lanes<T> across(const Lanes<T> (&v)[3]) const {
    return select(is_axis[2], v[2], select(is_axis[1], v[1], v[0]));
  }
  [[gnu::always_inline]] Lanes<T> along(int i, const Lanes<T> (&v)[3]) const {
    return i == 0 ? select(is_axis[0], v[1], v[0]) : select(is_axis[2], v[1], v[2]);
  }

  [[gnu::always_inline]] explicit FacingBox(const Lanes<T> (&normal)[3]) {
    const Lanes<T> size[3] = {abs(normal[0]), abs(normal[1]), abs(normal[2])};
    const LaneMask<T> second = size[1] > size[0];
    is_axis[2] = size[2] > max(size[0], size[1]);
    is_axis[1] = second & !is_axis[2];
    is_axis[0] = !(second | is_axis[2]);
  }
};

/// The range of the segment that is over the face of the box, projected along the normal. The
/// contacts at its ends equal the contacts that contact_patch finds for the segment and the face.
template <typename T>
[[gnu::always_inline]] inline ContactRange<T> range_over(const CapsuleBoxSolution<T>& r,
                                                         const FacingBox<T>& face) {
  const CapsuleAndBox<T>& p = r.scene;
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const Lanes<T> normal[3] = {r.normal.x, r.normal.y, r.normal.z};
  const Lanes<T> facing = face.across(normal);
  const Lanes<T> over = one / facing;
  // Distance along the normal to the plane of the face at s: base + rise s.
  const Lanes<T> base = -(sign_or_one(facing) * face.across(p.size) + face.across(p.middle)) * over;
  const Lanes<T> rise = -face.across(p.axis) * over;
  const Lanes<T> slack = r.proof.scale * Lanes<T>(T(kOnePlace));
  const Lanes<T> widest = max(face.along(0, p.size), face.along(1, p.size));
  const Lanes<T> near = min(widest, p.half) * Lanes<T>(T(2.0 * kAlongSide));
  Lanes<T> low = -p.half;
  Lanes<T> high = p.half;
  for (int i = 0; i < 2; ++i) {
    const Lanes<T> n = face.along(i, normal);
    const Lanes<T> size = face.along(i, p.size);
    const Lanes<T> place = face.along(i, p.middle) + base * n;
    const Lanes<T> slope = face.along(i, p.axis) + rise * n;
    const Lanes<T> one_over = one / slope;
    const Lanes<T> from = (-size - place) * one_over;
    const Lanes<T> to = (size - place) * one_over;
    // Do not cut if the whole segment is inside, up to rounding, or lies along a side.
    const Lanes<T> lean = p.half * abs(slope);
    const LaneMask<T> is_beside =
        (abs(place) + lean <= size + near) & (abs(place) - lean >= size - near);
    const LaneMask<T> cuts = (abs(place) + lean > size + slack) & !is_beside;
    low = select(cuts, max(low, min(from, to)), low);
    high = select(cuts, min(high, max(from, to)), high);
    high = select(cuts & (slope == zero), -p.half - p.half, high);
  }
  // Ends of the range that are not ends of the segment have the feature numbers 3 and 4.
  const auto name = [&](const Lanes<T>& s, const Lanes<T>& cut) {
    return select(abs(s) >= p.half, segment_feature(s, p.half), cut);
  };
  const Lanes<T> both = r.radius + r.radius_b;
  ContactRange<T> range{{low, high},
                        {base + rise * low - both, base + rise * high - both},
                        {name(low, Lanes<T>(T(3))), name(high, Lanes<T>(T(4)))},
                        zero > one};
  range.has_two_contacts =
      two_ends(range, r.proof, Vec3<T>{p.axis[0], p.axis[1], p.axis[2]}, r.normal);
  return range;
}

template <typename T>
[[gnu::always_inline]] inline void write_point_contacts(NarrowJob& job, const PairBlock<T>& block,
                                                        const CapsuleBoxSolution<T>& r,
                                                        const CertifiedLanes<T>& answer) {
  const Lanes<T> zero(T(0));
  const CapsuleAndBox<T>& p = r.scene;
  const Vec3<T> axis = r.axes.to_world(Vec3<T>{p.axis[0], p.axis[1], p.axis[2]});
  const FacingBox<T> face({r.normal.x, r.normal.y, r.normal.z});
  const ContactRange<T> range = range_over(r, face);
  const Vec3<T> towards{select(face.is_axis[0], r.normal.x, zero),
                        select(face.is_axis[1], r.normal.y, zero),
                        select(face.is_axis[2], r.normal.z, zero)};
  const Lanes<T> name = select(range.has_two_contacts, box_feature(towards), box_feature(r.normal));
  const auto contact = [&](const Lanes<T>& s, const Lanes<T>& d, const Lanes<T>& feature) {
    return ContactLanes<T>{axis * s + answer.normal * (r.radius + d * Lanes<T>(T(0.5))), -d,
                           feature, name, 0};
  };
  write_range(job, block, answer, range, r.s, segment_feature(r.s, p.half), contact);
}

struct CapsuleBox {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    const CapsuleBoxSolution<T> r = solve(job, block);
    if constexpr (L == kBoolean) {
      return answer_proven_sign(job, block, r.proof);
    } else {
      const CertifiedLanes<T> answer = answer_proven(r.proof, r.axes.to_world(r.normal));
      const CapsuleAndBox<T>& p = r.scene;
      const Vec3<T> foot =
          r.axes.to_world(Vec3<T>{p.axis[0] * r.s, p.axis[1] * r.s, p.axis[2] * r.s});
      write_certified<L>(job, block, answer, foot, r.radius);
      if constexpr (L == kManifold) write_point_contacts(job, block, r, answer);
      return ~answer.certified;
    }
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(capsule_box_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::CapsuleBox>();

}  // namespace winnow
