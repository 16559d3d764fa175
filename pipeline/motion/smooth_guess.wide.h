#pragma once

// Guesses along which direction a pair with a smooth surface is the farthest apart. On such a
// surface the steps of Gilbert, Johnson and Keerthi near the closest points by a share at a time;
// the normal changes evenly between points that are near each other, so that where it is that of
// the closest points is found as by the secant method. A guess may be bad: it is one more direction
// that was tried, and what it shows is true.

#include "pipeline/motion/closest_cores.wide.h"

namespace winnow::WINNOW_ISA_NAME::impact {

/// Pairs of kinds for which guesses save more than they cost. Beside flat faces ellipsoids are
/// nearest along the face's normal, which a simplex finds.
[[nodiscard]] constexpr bool has_guesses(ShapeKind a, ShapeKind b) {
  if (a == ShapeKind::support || b == ShapeKind::support) return true;
  return (a == ShapeKind::ellipsoid || b == ShapeKind::ellipsoid) && !has_faces(a) && !has_faces(b);
}

/// A guess is as good as is expected if it leaves no more of the doubt about the distance.
inline constexpr double kGoodGuess = 0.1;
/// The most looks that are waited after one that is not.
inline constexpr double kLongestPause = 3.0;

/// The three directions of those that were tried which show the largest gaps, and what is to be
/// tried next. All members are lanes: a block may move lanes as numbers.
struct TriedLanes {
  /// Unit.
  Vector axis[kSlots];
  /// From the point of a that is farthest along the axis to that of b, without the way between the
  /// middles.
  Vector way[kSlots];
  /// 1 where the slot is in use, else 0.
  Doubles present[kSlots];
  Vector guess;
  /// Looks until the guess is tried, and how many follow one that was not good.
  Doubles wait;
  Doubles pause;
  /// By how much the distance may be larger than the largest gap.
  Doubles doubt;

  void clear() {
    const Doubles zero(0.0);
    for (int s = 0; s < kSlots; ++s) {
      axis[s] = way[s] = zero_vector();
      present[s] = zero;
    }
    guess = zero_vector();
    wait = pause = zero;
    doubt = Doubles(__builtin_inf());
  }
  [[nodiscard]] Truth is_next() const {
    return (present[1] > Doubles(0.0)) & (wait <= Doubles(0.0));
  }
};

/// What directions that were tried show where a pair is now.
struct TriedGaps {
  Doubles of[kSlots];

  [[nodiscard]] Doubles least() const { return min(min(of[0], of[1]), of[2]); }
  [[nodiscard]] Doubles largest() const { return max(max(of[0], of[1]), of[2]); }
};

/// A direction that was tried.
struct TriedAxis {
  const Vector& axis;
  const Vector& way;
  /// Where it was a guess.
  const Truth& guessed;
};

/// Notes in some lanes what was tried and, with directions that show less, guesses anew.
class SmoothGuess {
 public:
  /// They are `between` from each other, and `simplex` is the nearest point of the simplex.
  SmoothGuess(const Vector& between, const Vector& simplex, TriedLanes& tried)
      : between_(between), simplex_(simplex), tried_(tried) {
    for (int s = 0; s < kSlots; ++s) {
      const Doubles gap = dot(tried.axis[s], between + tried.way[s]);
      gaps_.of[s] = select(tried.present[s] > Doubles(0.0), gap, Doubles(-__builtin_inf()));
    }
  }

  void note(const TriedAxis& last, const Truth& lanes) {
    const Doubles before = gaps_.largest();
    const Doubles here = dot(last.axis, between_ + last.way);
    keep(last, here, lanes);
    pace(last.guessed, here > before);
    guess();
  }

 private:
  /// Instead of what shows the least.
  void keep(const TriedAxis& last, const Doubles& here, const Truth& lanes) {
    const Doubles least = gaps_.least();
    Truth open = lanes & (here > least);
    for (int s = 0; s < kSlots; ++s) {
      const Truth take = open & (gaps_.of[s] <= least);
      open = open & !take;
      tried_.axis[s] = select(take, last.axis, tried_.axis[s]);
      tried_.way[s] = select(take, last.way, tried_.way[s]);
      tried_.present[s] = select(take, Doubles(1.0), tried_.present[s]);
      gaps_.of[s] = select(take, here, gaps_.of[s]);
    }
  }

  /// After a guess that was not good others wait, the longer the more there were.
  void pace(const Truth& guessed, const Truth& is_larger) {
    const Doubles zero(0.0);
    const Doubles one(1.0);
    const Doubles doubt = length(simplex_) - gaps_.largest();
    const Truth good = is_larger & (doubt <= tried_.doubt * Doubles(kGoodGuess));
    const Doubles longer = min(tried_.pause + tried_.pause + one, Doubles(kLongestPause));
    tried_.doubt = doubt;
    tried_.pause = select(guessed, select(good, zero, longer), tried_.pause);
    tried_.wait = select(guessed, tried_.pause, max(tried_.wait - one, zero));
  }

  /// At the closest points the normal leads from one to the other: the point that is farthest along
  /// it is the normal times the distance, which is the nearest of the simplex along it.
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
    const Truth ahead =
        (along > zero) & (along * along >= Doubles(0.5) * dot(tried_.guess, tried_.guess));
    tried_.wait = select(ahead, tried_.wait, max(tried_.wait, Doubles(1.0)));
  }

  const Vector& between_;
  const Vector& simplex_;
  TriedLanes& tried_;
  TriedGaps gaps_;
};

}  // namespace winnow::WINNOW_ISA_NAME::impact
