#pragma once

// The end of every kernel of spheres and capsules: from the cores' witness to certified answers.

#include "pipeline/kernels/answers.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// How often the unit roundoff of a pair's scale the closed forms may be wrong: about three times
/// the sum over their operations.
inline constexpr int kRoundings = 16;

/// Shortest distance of the cores, relative to the pair's scale, that still gives a normal: its
/// error is a few roundings over this.
template <typename T>
inline constexpr T kShortest = sizeof(T) == sizeof(double) ? T(1e-9) : T(1e-6F);

/// The smallest sine of which a product of directions is taken for a normal of overlapping cores,
/// and how far, relative to the pair's scale, their depth along it may be wrong: a few roundings
/// over the sine.
template <typename T>
inline constexpr T kLeastSine = T(1) / T(128);
template <typename T>
inline constexpr T kSlack = T(8) * kEpsilon<T> / kLeastSine<T>;

/// Where the cores of a pair are closest.
template <typename T>
struct WitnessLanes {
  /// From the point of core a to that of core b, at most kRoundings * epsilon * scale wrong.
  Vec3<T> w;
  /// Both roundings.
  Lanes<T> radius;
  /// At least the sum of all lengths that w was made of, and of the radius; NaN for a bad pose.
  Lanes<T> scale;
};

/// The sum of the magnitudes.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> taxicab(const Vec3<T>& v) {
  return abs(v.x) + abs(v.y) + abs(v.z);
}

/// Tier fast answers whatever is a number: its bound says how sure the sign is.
template <typename T>
[[gnu::always_inline]] inline Mask16 certified_lanes(const Lanes<T>& distance,
                                                     const Lanes<T>& bound, const Lanes<T>& scale,
                                                     const LaneMask<T>& normal) {
  const LaneMask<T> valid = in_range(scale * scale) & normal;
  if constexpr (sizeof(T) == sizeof(double)) return bits(valid & (abs(distance) > bound));
  return bits(valid & (abs(distance) < Lanes<T>(T(1e30F))));
}

/// Level boolean, by squares; returns the uncertified lanes. With w wrong by e, its square is by
/// 2 |w| e, and |w| <= scale.
template <typename T>
[[gnu::always_inline]] inline Mask16 answer_overlap(const NarrowJob& job, const PairBlock<T>& block,
                                                    const WitnessLanes<T>& witness) {
  const Lanes<T> square = witness.scale * witness.scale;
  const Lanes<T> excess = dot(witness.w, witness.w) - witness.radius * witness.radius;
  const Lanes<T> error = square * Lanes<T>(T(4 * kRoundings) * kEpsilon<T>);
  write_overlap(job, block, bits(excess <= Lanes<T>(T(0))));
  return ~certified_lanes(excess, error, witness.scale, square > Lanes<T>(T(0)));
}

/// A distance along a normal, and whether it may be written.
template <typename T>
struct CertifiedLanes {
  Lanes<T> distance;
  Lanes<T> error_bound;
  Vec3<T> normal;
  Mask16 certified;
};

/// Level boolean of kernels that have the distance.
template <typename T>
[[gnu::always_inline]] inline Mask16 answer_sign(const NarrowJob& job, const PairBlock<T>& block,
                                                 const Lanes<T>& distance, const Lanes<T>& bound,
                                                 const Lanes<T>& scale) {
  write_overlap(job, block, bits(distance <= Lanes<T>(T(0))));
  return ~certified_lanes(distance, bound, scale, scale > Lanes<T>(T(0)));
}

/// Levels distance and manifold. `shortest` is the least |w| that has a direction.
template <typename T>
[[gnu::always_inline]] inline CertifiedLanes<T> answer_distance(const WitnessLanes<T>& witness,
                                                                const Lanes<T>& shortest) {
  const Lanes<T> length = sqrt(dot(witness.w, witness.w));
  const Lanes<T> distance = length - witness.radius;
  const Lanes<T> bound = witness.scale * Lanes<T>(T(kRoundings) * kEpsilon<T>);
  return {distance, bound, witness.w * (Lanes<T>(T(1)) / length),
          certified_lanes(distance, bound, witness.scale, length > shortest)};
}

/// Writes the columns of levels distance and manifold. `foot` is the point of core a, `radius` its
/// rounding.
template <int L, typename T>
[[gnu::always_inline]] inline void write_certified(const NarrowJob& job, const PairBlock<T>& block,
                                                   const CertifiedLanes<T>& c, const Vec3<T>& foot,
                                                   const Lanes<T>& radius) {
  AnswerLanes<T> answer{c.distance, c.error_bound, c.normal, {}};
  if constexpr (L == kDistance) answer.point = foot + c.normal * radius;
  write_answer<L>(job, block, answer);
}

/// The point halfway between the surfaces, for certified pairs within the margin.
template <typename T>
[[gnu::always_inline]] inline ContactLanes<T> witness_contact(
    const NarrowJob& job, const PairBlock<T>& block, const CertifiedLanes<T>& c,
    const Vec3<T>& foot, const Lanes<T>& radius, const Lanes<T>& feature_a,
    const Lanes<T>& feature_b) {
  const Lanes<T> half(T(0.5));
  const LaneMask<T> near = c.distance <= Lanes<T>(static_cast<T>(job.margin));
  return {foot + c.normal * (radius + c.distance * half), -c.distance, feature_a, feature_b,
          bits(near) & c.certified & block.lanes()};
}

/// A signed distance that lies between the two numbers, but for kRoundings * epsilon * scale.
template <typename T>
struct ProofLanes {
  /// How far the shapes are along some direction.
  Lanes<T> low;
  /// How far two of their points are, or how deep they are along a direction.
  Lanes<T> high;
  /// As in WitnessLanes.
  Lanes<T> scale;
  /// Where the direction is well defined.
  LaneMask<T> unique;
};

/// Scales of which the fourth power is in T's range.
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
  if constexpr (sizeof(T) == sizeof(double)) {
    return ~bits(valid & ((proof.high < -error) | (proof.low > error)));
  }
  return ~bits(valid & (abs(proof.high) < Lanes<T>(T(1e30F))));
}

/// Levels distance and manifold. Tier robust promises bounds of 1e-12 of sizes and distance, of
/// which scale is at most twice as much; wide bounds of tier fast are those of slivers, which are
/// better solved.
template <typename T>
[[gnu::always_inline]] inline CertifiedLanes<T> answer_proven(const ProofLanes<T>& proof,
                                                              const Vec3<T>& normal) {
  const Lanes<T> widest(sizeof(T) == sizeof(double) ? T(4e-13) : T(1e-2F));
  const Lanes<T> bound =
      abs(proof.high - proof.low) + proof.scale * Lanes<T>(T(kRoundings) * kEpsilon<T>);
  const LaneMask<T> valid =
      proof.unique & in_narrow_range(proof.scale) & (bound < proof.scale * widest);
  return {proof.high, bound, normal, certified_lanes(proof.high, bound, proof.scale, valid)};
}

}  // namespace winnow::WINNOW_ISA_NAME
