// The kernels of capsule-capsule: the closest points of two segments (closest_feet in
// round.wide.h), and two contacts if the capsules lie side by side.

#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/round.wide.h"
#include "pipeline/manifold/feature_rules.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

/// Two capsules, the first at the origin. They are ordered by the signs of the offset, so that (a,
/// b) and (b, a) are the same problem, except if the offset is 0.
template <typename T>
struct Couple {
  LaneMask<T> swapped;
  Vec3<T> c;
  Vec3<T> axis[2];
  Lanes<T> radius[2];
  Lanes<T> half[2];
  SegmentFeet<T> feet;
  CoreGapLanes<T> witness;
  /// axis[0] x axis[1]
  Vec3<T> across;
};

template <typename T>
[[gnu::always_inline]] inline LaneMask<T> points_back(const Vec3<T>& c) {
  const Lanes<T> zero(T(0));
  return (c.x < zero) | ((c.x == zero) & ((c.y < zero) | ((c.y == zero) & (c.z < zero))));
}

template <typename T>
[[gnu::always_inline]] inline Couple<T> load_couple(const NarrowJob& job,
                                                    const PairBlock<T>& block) {
  const Vec3<T> offset = load_offset(job, block);
  const ScaledQuaternion<T> turn_a = load_turn<SideA>(job, block);
  const ScaledQuaternion<T> turn_b = load_turn<SideB>(job, block);
  const CapsuleLanes<T> a = load_capsule<SideA>(job, block);
  const CapsuleLanes<T> b = load_capsule<SideB>(job, block);
  const Vec3<T> axis_a = axis_z(turn_a);
  const Vec3<T> axis_b = axis_z(turn_b);

  Couple<T> r;
  r.swapped = points_back(offset);
  r.c = select(r.swapped, -offset, offset);
  r.axis[0] = select(r.swapped, axis_b, axis_a);
  r.axis[1] = select(r.swapped, axis_a, axis_b);
  r.half[0] = select(r.swapped, b.half_length, a.half_length);
  r.half[1] = select(r.swapped, a.half_length, b.half_length);
  r.radius[0] = select(r.swapped, b.radius, a.radius);
  r.radius[1] = select(r.swapped, a.radius, b.radius);
  r.across = cross(r.axis[0], r.axis[1]);
  r.feet =
      closest_feet(r.axis[0], r.half[0], {r.c, r.axis[1], Lanes<T>(T(1)), -r.half[1], r.half[1]},
                   r.across, Lanes<T>(T(1)) / dot(r.across, r.across));
  const Lanes<T> radius = r.radius[0] + r.radius[1];
  r.witness = {r.c + r.axis[1] * r.feet.t - r.axis[0] * r.feet.s, radius,
               norm_l1(r.c) + r.half[0] + r.half[1] + radius + doubt(turn_a) + doubt(turn_b)};
  return r;
}

/// A contact, in the order of the couple.
template <typename T>
struct Touch {
  SegmentFeet<T> feet;
  Lanes<T> distance;
};

template <typename T>
[[gnu::always_inline]] inline ContactLanes<T> contact_of(const Couple<T>& p, const Vec3<T>& normal,
                                                         const Touch<T>& touch) {
  const Vec3<T> on_first = p.axis[0] * touch.feet.s + normal * p.radius[0];
  const Vec3<T> on_second = p.c + p.axis[1] * touch.feet.t - normal * p.radius[1];
  const Vec3<T> middle = (on_first + on_second) * Lanes<T>(T(0.5));
  const Lanes<T> feature_first = segment_feature(touch.feet.s, p.half[0]);
  const Lanes<T> feature_second = segment_feature(touch.feet.t, p.half[1]);
  return {select(p.swapped, middle - p.c, middle), -touch.distance,
          select(p.swapped, feature_second, feature_first),
          select(p.swapped, feature_first, feature_second), 0};
}

template <typename T>
[[gnu::always_inline]] inline Touch<T> touch_at(const Couple<T>& p, const Lanes<T>& s) {
  const Lanes<T> place = dot(p.axis[0], p.axis[1]) * s - dot(p.axis[1], p.c);
  const Lanes<T> t = clamp(place, -p.half[1], p.half[1]);
  const Vec3<T> w = p.c + p.axis[1] * t - p.axis[0] * s;
  return {{s, t}, sqrt(dot(w, w)) - p.witness.radius};
}

template <typename T>
[[gnu::always_inline]] inline ContactLanes<T> choose(const LaneMask<T>& mask,
                                                     const ContactLanes<T>& a,
                                                     const ContactLanes<T>& b) {
  return {select(mask, a.position, b.position), select(mask, a.depth, b.depth),
          select(mask, a.feature_a, b.feature_a), select(mask, a.feature_b, b.feature_b), b.lanes};
}

template <typename T>
[[gnu::always_inline]] inline LaneMask<T> are_parallel(const Couple<T>& p) {
  return dot(p.across, p.across) < Lanes<T>(static_cast<T>(kBesideSquare));
}

/// Writes the contacts of a block with parallel capsules (sine at most 0.1). Parallel capsules get
/// contacts at those ends of the range in which they are side by side that are within the margin.
/// If neither end is, and for all other pairs, the contact is `closest`. Parameters are by value
/// and the function is not inlined: few blocks need it, and its caller can keep lanes in registers.
template <typename T>
[[gnu::noinline]] void write_ends(NarrowJob& job, PairBlock<T> block, Couple<T> p,
                                  CertifiedLanes<T> answer, ContactLanes<T> closest) {
  const Lanes<T> margin = margins_of(job, block);
  const Lanes<T> middle = dot(p.axis[0], p.c);
  const Lanes<T> reach = p.half[1] * abs(dot(p.axis[0], p.axis[1]));
  const Lanes<T> low = max(middle - reach, -p.half[0]);
  const Lanes<T> high = min(middle + reach, p.half[0]);
  Touch<T> ends[2] = {touch_at(p, low), touch_at(p, high)};
  // The ends replace the closest point if it is deeper than both by at most kEndDepthTolerance
  // times the sum of the radii; the deeper end then gets the depth of the pair. Otherwise the
  // capsules cross and have one contact.
  constexpr T tolerance = static_cast<T>(kEndDepthTolerance);
  const Lanes<T> behind = min(ends[0].distance, ends[1].distance) - answer.distance;
  const LaneMask<T> side_by_side =
      are_parallel(p) &
      (high - low > (p.half[0] + p.half[1]) * Lanes<T>(static_cast<T>(kMinOverlapLength))) &
      (behind <= p.witness.radius * Lanes<T>(tolerance));
  ends[0].distance -= behind;
  ends[1].distance -= behind;
  const LaneMask<T> near_low = side_by_side & (ends[0].distance <= margin);
  const LaneMask<T> near_high = side_by_side & (ends[1].distance <= margin);
  // The normal in the order of the couple.
  const Vec3<T> normal = select(p.swapped, -answer.normal, answer.normal);
  ContactLanes<T> contacts[2] = {closest, contact_of(p, normal, ends[1])};
  contacts[0] = choose(near_high, contacts[1], contacts[0]);
  contacts[0] = choose(near_low, contact_of(p, normal, ends[0]), contacts[0]);
  contacts[1].lanes = bits(near_low & near_high) & closest.lanes;
  write_contacts(job, block, contacts);
}

/// For segments that touch: if they cross or are collinear, the normal is perpendicular to both.
/// Parallel segments with the same center keep their answer, because their order in the couple is
/// undefined.
template <typename T>
[[gnu::noinline]] CertifiedLanes<T> separate_couple(Couple<T> p, CertifiedLanes<T> answer) {
  const Lanes<T> square = dot(p.across, p.across);
  const LaneMask<T> crosses = square > Lanes<T>(kMinSine<T> * kMinSine<T>);
  const LaneMask<T> in_line =
      (square <= Lanes<T>(kNoSineSquare<T>)) & (dot(p.c, p.c) > Lanes<T>(T(0)));
  const Vec3<T> across =
      select(crosses, p.across * (Lanes<T>(T(1)) / sqrt(square)), any_across(p.axis[0]));
  separate_across(answer, p.witness, across, crosses | in_line);
  return answer;
}

struct CapsuleCapsule {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    const Couple<T> p = load_couple(job, block);
    if constexpr (L == kBoolean) {
      return answer_overlap(job, block, p.witness);
    } else {
      CertifiedLanes<T> answer =
          answer_distance(p.witness, p.witness.scale * Lanes<T>(T(kShortest)));
      if ((~answer.certified & block.lanes()) != 0) [[unlikely]] {
        answer = separate_couple(p, answer);
      }
      answer.normal = select(p.swapped, -answer.normal, answer.normal);
      const Lanes<T> radius = select(p.swapped, p.radius[1], p.radius[0]);
      const Vec3<T> foot = select(p.swapped, p.axis[1] * p.feet.t, p.axis[0] * p.feet.s);
      write_certified<L>(job, block, answer, foot, radius);
      if constexpr (L == kManifold) {
        const Lanes<T> first = segment_feature(p.feet.s, p.half[0]);
        const Lanes<T> second = segment_feature(p.feet.t, p.half[1]);
        const ContactLanes<T> closest =
            witness_contact(job, block, answer, foot, radius, select(p.swapped, second, first),
                            select(p.swapped, first, second));
        if (bits(are_parallel(p)) == 0) {
          write_contacts(job, block, {closest});
        } else {
          write_ends(job, block, p, answer, closest);
        }
      }
      return ~answer.certified;
    }
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(capsule_capsule_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::CapsuleCapsule>();

}  // namespace winnow
