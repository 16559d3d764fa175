#pragma once

// The end of every kernel of spheres and capsules: from the cores' witness to certified answers.

#include <winnow/pipeline/narrow/answers.wide.h>

namespace winnow::WINNOW_ISA_NAME {

/// How often the unit roundoff of a pair's scale the closed forms may be wrong: about three times
/// the sum over their operations.
inline constexpr int kRoundings = 16;

/// Shortest distance of the cores, relative to the pair's scale, that still gives a normal: its
/// error is a few roundings over this.
template <typename T>
inline constexpr T kShortest = sizeof(T) == sizeof(double) ? T(1e-9) : T(1e-6F);

/// Where the cores of a pair are closest.
template <typename T>
struct WitnessLanes {
  /// From the point of core a to that of core b, at most kRoundings * epsilon * scale wrong.
  Vec3<T> w;
  /// Both roundings.
  Real<T> radius;
  /// At least the sum of all lengths that w was made of, and of the radius; NaN for a bad pose.
  Real<T> scale;
};

/// The sum of the magnitudes.
template <typename T>
[[gnu::always_inline]] inline Real<T> taxicab(const Vec3<T>& v) {
  return abs(v.x) + abs(v.y) + abs(v.z);
}

/// Level boolean, by squares; returns the uncertified lanes. With w wrong by e, its square is by
/// 2 |w| e, and |w| <= scale.
template <typename T>
[[gnu::always_inline]] inline Mask16 answer_overlap(const NarrowJob& job, const PairBlock<T>& block,
                                                    const WitnessLanes<T>& witness) {
  const Real<T> square = witness.scale * witness.scale;
  const Real<T> excess = dot(witness.w, witness.w) - witness.radius * witness.radius;
  const Real<T> error = square * Real<T>(T(4 * kRoundings) * kEpsilon<T>);
  write_overlap(job, block, bits(excess <= Real<T>(T(0))));
  const Truth<T> known = in_range(square) & (abs(excess) > error);
  return ~bits(known);
}

/// A distance along a normal, and whether it may be written.
template <typename T>
struct CertifiedLanes {
  Real<T> distance;
  Real<T> error_bound;
  Vec3<T> normal;
  Mask16 certified;
};

/// Tier fast answers whatever is a number: its bound says how sure the sign is.
template <typename T>
[[gnu::always_inline]] inline Mask16 certified_lanes(const Real<T>& distance, const Real<T>& bound,
                                                     const Real<T>& scale, const Truth<T>& normal) {
  const Truth<T> valid = in_range(scale * scale) & normal;
  if constexpr (sizeof(T) == sizeof(double)) return bits(valid & (abs(distance) > bound));
  return bits(valid & (abs(distance) < Real<T>(T(1e30F))));
}

/// Levels distance and manifold. `shortest` is the least |w| that has a direction.
template <typename T>
[[gnu::always_inline]] inline CertifiedLanes<T> answer_distance(const WitnessLanes<T>& witness,
                                                                const Real<T>& shortest) {
  const Real<T> length = sqrt(dot(witness.w, witness.w));
  const Real<T> distance = length - witness.radius;
  const Real<T> bound = witness.scale * Real<T>(T(kRoundings) * kEpsilon<T>);
  return {distance, bound, witness.w * (Real<T>(T(1)) / length),
          certified_lanes(distance, bound, witness.scale, length > shortest)};
}

/// Writes the columns of levels distance and manifold. `foot` is the point of core a, `radius` its
/// rounding.
template <int L, typename T>
[[gnu::always_inline]] inline void write_certified(const NarrowJob& job, const PairBlock<T>& block,
                                                   const CertifiedLanes<T>& c, const Vec3<T>& foot,
                                                   const Real<T>& radius) {
  AnswerLanes<T> answer{c.distance, c.error_bound, c.normal, {}};
  if constexpr (L == kDistance) answer.point = foot + c.normal * radius;
  write_answer<L>(job, block, answer);
}

/// The point halfway between the surfaces, for certified pairs within the margin.
template <typename T>
[[gnu::always_inline]] inline ContactLanes<T> witness_contact(
    const NarrowJob& job, const PairBlock<T>& block, const CertifiedLanes<T>& c,
    const Vec3<T>& foot, const Real<T>& radius, const Real<T>& feature_a,
    const Real<T>& feature_b) {
  const Real<T> half(T(0.5));
  const Truth<T> near = c.distance <= Real<T>(static_cast<T>(job.margin));
  return {foot + c.normal * (radius + c.distance * half), -c.distance, feature_a, feature_b,
          bits(near) & c.certified & block.lanes()};
}

}  // namespace winnow::WINNOW_ISA_NAME
