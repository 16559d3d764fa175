#pragma once

// The end of every kernel of half-spaces: from the points of a shape that are lowest over the plane
// to answers. A half-space reaches to infinity, so the direction is always that of its plane.

#include "pipeline/kernels/round/round.wide.h"

namespace winnow::WINNOW_ISA_NAME::round {

/// The half-space's plane, relative to the position of body a: the outward normal, and the height
/// of that position over it.
template <typename T>
struct Plane {
  Vec3<T> normal;
  Lanes<T> height;
  /// The sum of the magnitudes of what height was made of; NaN for a bad pose.
  Lanes<T> scale;
};

template <typename T>
[[gnu::always_inline]] inline Plane<T> load_plane(const NarrowJob& job, const PairBlock<T>& block) {
  const Vec3<T> c = load_offset(job, block);
  const Turn<T> turn = load_turn<SideB>(job, block);
  const HalfSpaceLanes<T> b = load_half_space<SideB>(job, block);
  const Vec3<T> normal = rotation(turn).to_world(b.normal);
  return {normal, -dot(normal, c) - b.offset, taxicab(c) + abs(b.offset) + doubt(turn)};
}

/// Points of a shape's core over a plane, relative to body a, in the axes of the world.
template <typename T, int Count>
struct Feet {
  Vec3<T> foot[Count];
  Lanes<T> height[Count];
  Lanes<T> feature[Count];
  /// Foot 0 is the lowest. The rounding is that of all.
  Lanes<T> rounding;
  Vec3<T> normal;
  Lanes<T> scale;
};

/// Exchanges two feet if the second is lower.
template <typename T, int Count>
[[gnu::always_inline]] inline void sort_two(Feet<T, Count>& f, int first, int second) {
  const LaneMask<T> wrong = f.height[second] < f.height[first];
  const auto exchange = [&](auto& a, auto& b) {
    const auto t = select(wrong, b, a);
    b = select(wrong, a, b);
    a = t;
  };
  exchange(f.foot[first], f.foot[second]);
  exchange(f.height[first], f.height[second]);
  exchange(f.feature[first], f.feature[second]);
}

/// From feet to answers with up to so many contacts; returns the uncertified lanes.
template <int Contacts>
struct FeetAnswers {
  template <int L, typename T, int Count>
  [[gnu::always_inline]] static Mask16 write(NarrowJob& job, const PairBlock<T>& block,
                                             const Feet<T, Count>& feet) {
    const Lanes<T> distance = feet.height[0] - feet.rounding;
    const Lanes<T> bound = feet.scale * Lanes<T>(T(kRoundings) * kEpsilon<T>);
    if constexpr (L == kBoolean) {
      return answer_sign(job, block, distance, bound, feet.scale);
    } else {
      const Mask16 known =
          certified_lanes(distance, bound, feet.scale, feet.scale > Lanes<T>(T(0)));
      const CertifiedLanes<T> answer{distance, bound, -feet.normal, known};
      write_certified<L>(job, block, answer, feet.foot[0], feet.rounding);
      if constexpr (L == kManifold) write_touches(job, block, feet, known);
      return ~known;
    }
  }

  template <typename T, int Count>
  [[gnu::always_inline]] static void write_touches(NarrowJob& job, const PairBlock<T>& block,
                                                   const Feet<T, Count>& feet, Mask16 known) {
    ContactLanes<T> contacts[Contacts];
    Mask16 lanes = known & block.lanes();
    for (int i = 0; i < Contacts; ++i) {
      const int k = i < Count ? i : 0;
      const Lanes<T> d = feet.height[k] - feet.rounding;
      lanes &= i < Count ? bits(d <= Lanes<T>(static_cast<T>(job.margin))) : 0U;
      contacts[i] = {feet.foot[k] - feet.normal * (feet.rounding + d * Lanes<T>(T(0.5))), -d,
                     feet.feature[k], Lanes<T>(T(0)), lanes};
    }
    write_contacts(job, block, contacts);
  }
};

/// The kernels of a class that finds the feet; all levels share that part, not inlined, as it takes
/// long to compile.
template <typename Source, int Contacts>
struct OverPlane {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    return FeetAnswers<Contacts>::template write<L>(job, block,
                                                    Source::template feet<T>(job, block));
  }
};

}  // namespace winnow::WINNOW_ISA_NAME::round
