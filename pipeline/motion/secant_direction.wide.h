#pragma once

// Guesses of the direction along which a pair with a smooth surface has the largest gap. Near the
// closest points of such a surface GJK converges only linearly. The normal changes almost linearly
// over a short distance. So the normal at the closest points is extrapolated from tested
// directions, as in the secant method. A bad guess does no harm: it is one more direction to test,
// and the gap along it is valid.

#include "pipeline/motion/closest_cores.wide.h"

namespace winnow::WINNOW_ISA_NAME::impact {

/// Pairs of kinds for which guesses save time. Against a flat face the closest direction is the
/// face's normal, which the simplex finds.
[[nodiscard]] constexpr bool has_guesses(ShapeKind a, ShapeKind b) {
  if (a == ShapeKind::support || b == ShapeKind::support) return true;
  return (a == ShapeKind::ellipsoid || b == ShapeKind::ellipsoid) && !has_faces(a) && !has_faces(b);
}

/// A guess counts as good if it reduces the uncertainty of the distance to this fraction.
inline constexpr double kGoodGuess = 0.1;
/// The largest number of samples without a guess after a bad one.
inline constexpr double kLongestPause = 3.0;

/// The three tested directions with the largest gaps, and the next guess. All members are lanes
/// of double, so that a block can copy a lane as an array of numbers.
struct TriedLanes {
  /// Unit vectors.
  Vector axis[kSlots];
  /// From a's support point along the axis to b's, without the vector between the centres.
  Vector way[kSlots];
  /// 1 where the slot is in use, else 0.
  Doubles present[kSlots];
  Vector guess;
  /// Samples until the guess is tested, and the pause after a bad guess.
  Doubles wait;
  Doubles pause;
  /// The amount by which the distance may exceed the largest gap.
  Doubles uncertainty;

  void clear() {
    const Doubles zero(0.0);
    for (int s = 0; s < kSlots; ++s) {
      axis[s] = way[s] = zero_vector();
      present[s] = zero;
    }
    guess = zero_vector();
    wait = pause = zero;
    uncertainty = Doubles(__builtin_inf());
  }
  [[nodiscard]] DoubleMask is_next() const {
    return (present[1] > Doubles(0.0)) & (wait <= Doubles(0.0));
  }
};

/// The gaps along the tested directions at the current position.
struct TriedGaps {
  Doubles of[kSlots];

  [[nodiscard]] Doubles least() const { return min(min(of[0], of[1]), of[2]); }
  [[nodiscard]] Doubles largest() const { return max(max(of[0], of[1]), of[2]); }
};

/// A direction that was tested.
struct TriedAxis {
  const Vector& axis;
  const Vector& way;
  /// The lanes in which it was a guess.
  const DoubleMask& guessed;
};

/// In some lanes, replaces the direction with the smallest gap by the one just tested, and computes
/// the next guess.
class SecantDirection {
 public:
  /// `between` is the vector between the centres, `simplex` the nearest point of the simplex.
  SecantDirection(const Vector& between, const Vector& simplex, TriedLanes& tried)
      : between_(between), simplex_(simplex), tried_(tried) {
    for (int s = 0; s < kSlots; ++s) {
      const Doubles gap = dot(tried.axis[s], between + tried.way[s]);
      gaps_.of[s] = select(tried.present[s] > Doubles(0.0), gap, Doubles(-__builtin_inf()));
    }
  }

  void note(const TriedAxis& last, const DoubleMask& lanes) {
    const Doubles before = gaps_.largest();
    const Doubles here = dot(last.axis, between_ + last.way);
    keep(last, here, lanes);
    pace(last.guessed, here > before);
    guess();
  }

 private:
  /// Replaces the direction with the smallest gap.
  void keep(const TriedAxis& last, const Doubles& here, const DoubleMask& lanes) {
    const Doubles least = gaps_.least();
    DoubleMask open = lanes & (here > least);
    for (int s = 0; s < kSlots; ++s) {
      const DoubleMask take = open & (gaps_.of[s] <= least);
      open = open & !take;
      tried_.axis[s] = select(take, last.axis, tried_.axis[s]);
      tried_.way[s] = select(take, last.way, tried_.way[s]);
      tried_.present[s] = select(take, Doubles(1.0), tried_.present[s]);
      gaps_.of[s] = select(take, here, gaps_.of[s]);
    }
  }

  /// After a bad guess, the next guess is delayed. Each further bad guess increases the delay, up
  /// to kLongestPause samples.
  void pace(const DoubleMask& guessed, const DoubleMask& is_larger) {
    const Doubles zero(0.0);
    const Doubles one(1.0);
    const Doubles uncertainty = length(simplex_) - gaps_.largest();
    const DoubleMask good = is_larger & (uncertainty <= tried_.uncertainty * Doubles(kGoodGuess));
    const Doubles longer = min(tried_.pause + tried_.pause + one, Doubles(kLongestPause));
    tried_.uncertainty = uncertainty;
    tried_.pause = select(guessed, select(good, zero, longer), tried_.pause);
    tried_.wait = select(guessed, tried_.pause, max(tried_.wait - one, zero));
  }

  /// At the closest points, the normal is the direction from one point to the other. So the support
  /// point of the Minkowski difference along the normal equals the normal times the distance. The
  /// distance is estimated from the nearest point of the simplex.
  void guess() {
    const Doubles zero(0.0);
    const Doubles largest = gaps_.largest();
    Vector normal = tried_.axis[0];
    for (int s = 1; s < kSlots; ++s) {
      normal = select(gaps_.of[s] >= largest, tried_.axis[s], normal);
    }
    const Doubles distance = dot(normal, simplex_);
    hull::Simplex<double> aside;
    for (int s = 0; s < kSlots; ++s) {
      const Vector off = between_ + tried_.way[s] - tried_.axis[s] * distance;
      aside.present[s] = tried_.present[s] > zero;
      aside.point[s] = off - normal * dot(normal, off);
    }
    tried_.guess = shares_of(aside, zero_vector()).of(tried_.axis);
    const Doubles along = dot(tried_.guess, normal);
    const DoubleMask ahead =
        (along > zero) & (along * along >= Doubles(0.5) * dot(tried_.guess, tried_.guess));
    tried_.wait = select(ahead, tried_.wait, max(tried_.wait, Doubles(1.0)));
  }

  const Vector& between_;
  const Vector& simplex_;
  TriedLanes& tried_;
  TriedGaps gaps_;
};

}  // namespace winnow::WINNOW_ISA_NAME::impact
