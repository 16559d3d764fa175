#pragma once

// Shared by the kernels of half-spaces: the plane in world axes, and the step from the lowest
// points of a shape over the plane to answers. A half-space is unbounded, so the contact normal is
// always the normal of its plane.

#include "pipeline/kernels/round/round.wide.h"

namespace winnow::WINNOW_ISA_NAME::round {

/// The half-space's plane, relative to the position of body a: its outward normal, and the height
/// of the other body's position over it.
template <typename T>
struct PlacedPlane {
  Vec3<T> normal;
  Lanes<T> height;
  /// The sum of the magnitudes of the terms of `height`; NaN for an invalid pose.
  Lanes<T> scale;
  /// The position of body b.
  Vec3<T> to_b;
};

/// Loads the plane of the given side's body.
template <typename Side, typename T>
[[gnu::always_inline]] inline PlacedPlane<T> load_plane(const NarrowJob& job,
                                                        const PairBlock<T>& block) {
  const Vec3<T> c = load_offset(job, block);
  const ScaledQuaternion<T> turn = load_turn<Side>(job, block);
  const HalfSpaceLanes<T> plane = load_half_space<Side>(job, block);
  const Vec3<T> normal = rotation(turn).to_world(plane.normal);
  const Lanes<T> along = dot(normal, c);
  const Lanes<T> other = __is_same(Side, SideA) ? along : -along;
  return {normal, other - plane.offset, norm_l1(c) + abs(plane.offset) + doubt(turn), c};
}

/// The height of the lowest point of a shape's core over a plane.
template <typename T>
struct LowestHeight {
  Lanes<T> height;
  Lanes<T> rounding;
  Lanes<T> scale;

  [[gnu::always_inline]] Lanes<T> distance() const { return height - rounding; }
  [[gnu::always_inline]] Lanes<T> bound() const {
    return scale * Lanes<T>(T(kRoundings) * kEpsilon<T>);
  }
};

/// The points of a shape's core that may touch a plane (feet), relative to body a, in world axes.
template <typename T, int Count>
struct LowestPoints {
  Vec3<T> foot[Count];
  Lanes<T> height[Count];
  Lanes<T> feature[Count];
  /// Foot 0 is the lowest. All feet have the same rounding.
  Lanes<T> rounding;
  Vec3<T> normal;
  Lanes<T> scale;

  [[gnu::always_inline]] LowestHeight<T> least() const { return {height[0], rounding, scale}; }
};

/// Swaps two feet if the second is lower.
template <typename T, int Count>
[[gnu::always_inline]] inline void sort_two(LowestPoints<T, Count>& f, int first, int second) {
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

/// Turns feet into answers with up to `Contacts` contacts; returns the uncertified lanes.
/// `PlaneSide` is the side of the half-space.
template <int Contacts, typename PlaneSide = SideB>
struct LowestPointAnswers {
  static constexpr bool kPlaneFirst = __is_same(PlaneSide, SideA);

  template <int L, typename T, int Count>
  [[gnu::always_inline]] static Mask16 write(NarrowJob& job, const PairBlock<T>& block,
                                             const LowestPoints<T, Count>& feet) {
    const LowestHeight<T> least = feet.least();
    if constexpr (L == kBoolean) {
      return write(job, block, least);
    } else {
      const Vec3<T> normal = kPlaneFirst ? feet.normal : -feet.normal;
      const CertifiedLanes<T> answer =
          answer_along(normal, least.distance(), least.bound(), feet.scale);
      if constexpr (kPlaneFirst) {
        const Vec3<T> under = feet.foot[0] - feet.normal * feet.height[0];
        write_certified<L>(job, block, answer, under, Lanes<T>(T(0)));
      } else {
        write_certified<L>(job, block, answer, feet.foot[0], feet.rounding);
      }
      if constexpr (L == kManifold) write_point_contacts(job, block, feet, answer.certified);
      return ~answer.certified;
    }
  }

  /// Level boolean.
  template <typename T>
  [[gnu::always_inline]] static Mask16 write(NarrowJob& job, const PairBlock<T>& block,
                                             const LowestHeight<T>& least) {
    return answer_sign(job, block, least.distance(), least.bound(), least.scale);
  }

  template <typename T, int Count>
  [[gnu::always_inline]] static void write_point_contacts(NarrowJob& job, const PairBlock<T>& block,
                                                          const LowestPoints<T, Count>& feet,
                                                          Mask16 known) {
    const Lanes<T> zero(T(0));
    const Lanes<T> margin = margins_of(job, block);
    ContactLanes<T> contacts[Contacts];
    Mask16 lanes = known & block.lanes();
    for (int i = 0; i < Contacts; ++i) {
      const int k = i < Count ? i : 0;
      const Lanes<T> d = feet.height[k] - feet.rounding;
      lanes &= i < Count ? bits(d <= margin) : 0U;
      contacts[i] = {feet.foot[k] - feet.normal * (feet.rounding + d * Lanes<T>(T(0.5))), -d,
                     kPlaneFirst ? zero : feet.feature[k], kPlaneFirst ? feet.feature[k] : zero,
                     lanes};
    }
    write_contacts(job, block, contacts);
  }
};

/// The kernels of a class with a function `feet`. The class may also have `lowest`, which computes
/// only the lowest foot and is enough for level distance, and `least`, which computes only the
/// height of the lowest foot and is enough for level boolean. Levels share these functions, which
/// are not inlined because they take long to compile.
template <typename Source, int Contacts>
struct OverPlane {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    using Answers = LowestPointAnswers<Contacts>;
    if constexpr (L == kBoolean && requires { Source::template least<T>(job, block); }) {
      return Answers::write(job, block, Source::template least<T>(job, block));
    } else if constexpr (L != kManifold && requires { Source::template lowest<T>(job, block); }) {
      return Answers::template write<L>(job, block, Source::template lowest<T>(job, block));
    } else {
      return Answers::template write<L>(job, block, Source::template feet<T>(job, block));
    }
  }
};

}  // namespace winnow::WINNOW_ISA_NAME::round
