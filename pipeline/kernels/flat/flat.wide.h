#pragma once

// What the kernels of boxes and triangles share: the search for the best of many separating axes,
// and the way from a distance of the cores to certified answers.
//
// The separation of two convex cores along a unit vector n is how far b's lowest point along n is
// above a's highest. Its maximum over all n is the distance, or minus the penetration depth, and is
// found at one of few axes (Gottschalk, 1996), but for distances between vertices and edges.

#include "pipeline/kernels/answers.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// The sum of the magnitudes.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> taxicab_of(const Vec3<T>& v) {
  return abs(v.x) + abs(v.y) + abs(v.z);
}

/// Separations along an axis of length 1 at most are so often the unit roundoff of the pair's scale
/// (all lengths in it) wrong, or less: 10 for an entry of a rotation, 38 for one of the product of
/// two, 82 for the offset along a product of axes.
template <typename T>
inline constexpr T kSlack = T(48) * kEpsilon<T>;

/// Bounds are at most this share of the scale, or the pair goes to the solver.
template <typename T>
inline constexpr T kWidestBound = sizeof(T) == sizeof(double) ? T(1e-12) : T(1e-4F);

/// Two points are the closest if they are farther apart than the cores certainly are by no more
/// than this share of the scale.
template <typename T>
inline constexpr T kWidestGap = sizeof(T) == sizeof(double) ? T(1e-12) : T(1e-4F);

/// Edges whose sine has a smaller square are parallel: a separation along their product would be
/// wrong by the slack over the sine, leaving it out is wrong by the shorter edge times the sine.
template <typename T>
inline constexpr T kParallelSquare = sizeof(T) == sizeof(double) ? T(1e-26) : T(1e-6F);

/// The axis of the largest separation so far, compared without roots: by s|s| over the square of
/// the axis' length.
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

/// The largest of separations along unit vectors, and which.
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

/// Offers a product of vectors, of which `size` is at least the factors' lengths multiplied. Left
/// out if they are parallel; what that costs is no more than the product over the longer factor:
/// seen along it, the other is as short as that.
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
  // Worse than anything.
  const Lanes<T> worst = slack * Lanes<T>(T(-3) / kSlack<T>);
  best.offer(select(crossed, separation + size * slack, worst), select(crossed, length2, one),
             index);
}

/// Whether bodies at one position are to be turned: by their shapes, then by their orientations.
inline bool turn_concentric(const NarrowJob& job, const BodyPair& pair) {
  const std::uint32_t shape_a = job.shapes[pair.a].bits;
  const std::uint32_t shape_b = job.shapes[pair.b].bits;
  if (shape_a != shape_b) return shape_b < shape_a;
  const double* a = job.poses[pair.a].orientation;
  const double* b = job.poses[pair.b].orientation;
  int i = 0;
  while (i < 3 && a[i] == b[i]) ++i;
  return b[i] < a[i];
}

/// Pairs of one kind in an order that does not depend on which is called a: the first component of
/// the offset that is not zero is positive. Answers are turned back.
template <typename T>
struct OrderedBlock {
  BodyPair pairs[Lanes<T>::kCount];
  /// -1 for pairs that were turned, else 1.
  alignas(64) T sign[Lanes<T>::kCount];
  PairBlock<T> block;

  [[gnu::always_inline]] OrderedBlock(const NarrowJob& job, const PairBlock<T>& given)
      : block{pairs, given.first, given.count} {
    for (int lane = 0; lane < Lanes<T>::kCount; ++lane) {
      const BodyPair pair = given.pairs[lane];
      const double* a = job.poses[pair.a].position;
      const double* b = job.poses[pair.b].position;
      int i = 0;
      while (i < 2 && a[i] == b[i]) ++i;
      const bool turn = a[i] == b[i] ? turn_concentric(job, pair) : b[i] < a[i];
      pairs[lane] = turn ? BodyPair{pair.b, pair.a} : pair;
      sign[lane] = turn ? T(-1) : T(1);
    }
  }
  OrderedBlock(const OrderedBlock&) = delete;
};

/// What a kernel has found out about the cores, in the axes of the world.
template <typename T>
struct CoreAnswer {
  Lanes<T> distance;
  Lanes<T> error_bound;
  Vec3<T> normal;
  /// On the core of a, relative to its position. Level distance only.
  Vec3<T> point;
};

/// The answer about the shapes from that about their cores; returns the lanes that are certified.
template <typename T>
[[gnu::always_inline]] inline Mask16 with_rounding(CoreAnswer<T>& answer,
                                                   const Lanes<T>& rounding_a,
                                                   const Lanes<T>& rounding_b,
                                                   const Lanes<T>& scale) {
  answer.distance -= rounding_a + rounding_b;
  answer.point = answer.point + answer.normal * rounding_a;
  const LaneMask<T> narrow = answer.error_bound <= scale * Lanes<T>(kWidestBound<T>);
  const LaneMask<T> valid = in_range(scale * scale) & narrow;
  if constexpr (sizeof(T) == sizeof(double)) {
    return bits(valid & (abs(answer.distance) > answer.error_bound));
  }
  // Squares of products of edges must stay in range, also where one shape is 1e5 times smaller than
  // the other, and a normal that is not unit says nothing.
  const LaneMask<T> moderate = (scale > Lanes<T>(T(4e-3F))) & (scale < Lanes<T>(T(1e4F)));
  const Lanes<T> length2 = dot(answer.normal, answer.normal);
  return bits(valid & moderate & (length2 > Lanes<T>(T(0.99F))) &
              (abs(answer.distance) <= scale * Lanes<T>(T(4))));
}

/// Turns answers back to the caller's order. `offset` is from a to b as the kernel had them.
template <typename T>
[[gnu::always_inline]] inline AnswerLanes<T> turned_back(const CoreAnswer<T>& answer,
                                                         const Vec3<T>& offset,
                                                         const Lanes<T>& sign) {
  const Vec3<T> on_b = answer.point + answer.normal * answer.distance - offset;
  return {answer.distance, answer.error_bound, answer.normal * sign,
          select(sign < Lanes<T>(T(0)), on_b, answer.point)};
}

}  // namespace winnow::WINNOW_ISA_NAME
