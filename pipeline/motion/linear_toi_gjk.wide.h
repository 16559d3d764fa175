#pragma once

// Steps of pairs that do not rotate: the Minkowski difference is fixed and the origin moves along a
// line. So the gap along a direction is a linear function of time. Each step is a GJK step that
// also advances the pair to the time at which the tested direction no longer shows a gap (van den
// Bergen, "Ray casting against general convex objects with application to continuous collision
// detection", 2004). Any direction may be tested; for smooth surfaces, guesses (SecantDirection)
// alternate with the directions of GJK.

#include "pipeline/motion/impact_block.wide.h"

namespace winnow::WINNOW_ISA_NAME::impact {

/// One step of all lanes of a block. For lanes without a closed form, `axis` is the nearest point
/// of the simplex, or any direction while there is none; the witness stores, in world axes, the
/// support points of a and the vectors from them to the support points of b, without the vector
/// between the centres. `Elsewhere`: the pairs have no closed form, and use guesses or earlier
/// directions. This is a template parameter because a test at run time would slow down all other
/// pairs.
template <bool Elsewhere>
class LinearToiGjk : BlockStep {
 public:
  LinearToiGjk(const ImpactJob& job, ImpactBlock& block)
      : BlockStep(job, block),
        guesses_(has_guesses(tables_.a.kind, tables_.b.kind)),
        uses_earlier_axes_(uses_earlier_axes(job, tables_.a.kind, tables_.b.kind)) {}

  /// Returns the lanes that continue.
  [[nodiscard]] Mask16 run() {
    sample_.between = p_.start + p_.travel * p_.time;
    sample_.noise = noise_at(sample_.between);
    const CorePair pair{tables_.a, tables_.b, p_.a, p_.b, sample_.between};
    if (!Elsewhere && has_closed_form(tables_.a.kind, tables_.b.kind)) {
      sample_.closest = closest_by_form(pair, bits(active_));
      settled_ = active_;
      judge();
      const Doubles here = p_.time;
      const DoubleMask lost = lost_trials();
      active_ = active_ & !lost;
      decide();
      if (has_closing_square(tables_.a.kind, tables_.b.kind)) try_ahead(pair, here);
      active_ = active_ | lost;
    } else {
      const Doubles before = p_.time;
      sample_along(pair);
      judge();
      decide();
      if (bits(active_) != 0) move_on(before);
    }
    return continuing_lanes();
  }

 private:
  /// The simplex at the lanes' current positions.
  [[nodiscard]] hull::Simplex<double> placed(const DoubleMask (&present)[kSlots]) const {
    hull::Simplex<double> simplex;
    for (int s = 0; s < kSlots; ++s) {
      simplex.present[s] = present[s];
      simplex.point[s] = sample_.between + p_.witness.b[s];
    }
    return simplex;
  }

  /// Samples the gap along the direction.
  void sample_along(const CorePair& pair) {
    const Vector& v = p_.axis;
    ClosestLanes& closest = sample_.closest;
    square_ = dot(v, v);
    closest.between = v;
    closest.upper = sqrt(square_);
    guessed_ = active_ & !active_;
    Vector direction = v;
    Doubles size = closest.upper;
    if (Elsewhere && guesses_) {
      guessed_ = active_ & p_.tried.is_next();
      direction = select(guessed_, p_.tried.guess, v);
      size = select(guessed_, length(direction), size);
    }
    Vector own_a;
    Vector own_b;
    pair.facing(direction, bits(active_), own_a, own_b);
    closest.on_a = pair.on_a(own_a);
    way_ = pair.on_b(own_b) - closest.on_a;
    for (int s = 0; s < kSlots; ++s) used_[s] = differs_[s] = p_.witness.present[s] > Doubles(0.0);
    const DoubleMask repeated = drop_repeated(p_.witness.b, way_, differs_);
    const Vector w = sample_.between + way_;
    const Doubles reach = dot(direction, w);
    const Doubles over = Doubles(1.0) / size;
    closest.axis = direction * over;
    closest.lower = reach * over;
    Doubles gain = square_ - reach;
    if (Elsewhere) {
      tried_ = closest.axis;
      const DoubleMask known = uses_earlier_axes_ ? take_best() : guessed_;
      gain = select(guessed_ | known, square_ - closest.lower * closest.upper, gain);
    }
    const Doubles left = closest.upper - p_.roundings;
    const DoubleMask ends =
        (gain <= Doubles(kRounding) * closest.upper * left) & repeated & !guessed_;
    // Rounding perturbs the direction the more, the shorter the vector is. The support point
    // changes with the direction.
    settled_ = used_[0] & ((gain <= sample_.noise * Doubles(kEnough) * (closest.upper + p_.sizes)) |
                           ends | (p_.proves > Doubles(0.0)));
  }

  /// Uses the best earlier direction in the lanes in which it shows a larger gap. Returns these
  /// lanes.
  [[nodiscard]] DoubleMask take_best() {
    ClosestLanes& closest = sample_.closest;
    const Doubles shown = dot(p_.best, sample_.between + p_.best_support);
    const DoubleMask known = used_[0] & (shown > closest.lower);
    closest.lower = select(known, shown, closest.lower);
    closest.axis = p_.best = select(known, p_.best, closest.axis);
    p_.best_support = select(known, p_.best_support, way_);
    return known;
  }

  /// Computes the gap, its slope and the bounds from the closest points.
  void judge() {
    const ClosestLanes& closest = sample_.closest;
    sample_.gap = closest.lower - p_.roundings - sample_.noise;
    sample_.most = closest.upper - p_.roundings + sample_.noise;
    sample_.slope = dot(closest.axis, p_.travel);
    sample_.parted = sample_.gap > Doubles(0.0);
  }

  /// Detects impacts, or advances the time.
  void decide() {
    const DoubleMask within = sample_.parted & (sample_.most <= closed());
    const DoubleMask near = within & settled_;
    const DoubleMask will_touch = sample_.gap + sample_.slope * (p_.last - p_.time) <= Doubles(0.0);
    p_.within = select(near & !will_touch, p_.within + Doubles(1.0), p_.within);
    const DoubleMask hit =
        active_ & near & (will_touch | (p_.within > Doubles(kMaxLaneSamplesWithin)));
    if (bits(hit) != 0) put_impacts(hit);
    if (bits(active_) == 0) return;
    const Doubles free = free_along(p_, sample_);
    end_apart(sample_.parted & ((free >= p_.last) | (free > p_.until)));
    // These pairs touch or are too close for double precision to decide, or there is no double
    // between the time and `free`.
    end_unsure(settled_ & ((!sample_.parted) | (free <= p_.time)));
    // A pair within the tolerance, or with a gap of at most kNearEnough times the tolerance, is
    // sampled as accurately as possible before it is advanced.
    const DoubleMask far = (!within) & (sample_.gap > p_.tolerance * Doubles(kNearEnough));
    p_.time = select(active_ & sample_.parted & (far | settled_), free, p_.time);
  }

  /// A lane that was sampled ahead of its proved time is disjoint up to the sample if the sample
  /// shows a gap that closes along the axis. Returns the lanes whose sample does not; these lanes
  /// go back to the proved time and take only proved steps from then on.
  [[nodiscard]] DoubleMask lost_trials() {
    const Doubles zero(0.0);
    const DoubleMask trial = active_ & (p_.proves > zero);
    // Covers the rounding of the slope.
    const Doubles flat = norm_l1(p_.travel) * Doubles(-64.0 * kDoubleEpsilon);
    const DoubleMask lost = trial & !(sample_.parted & (sample_.slope < flat));
    p_.time = select(lost, p_.free, p_.time);
    p_.proves = select(lost, Doubles(-1.0), select(trial, zero, p_.proves));
    return lost;
  }

  /// Moves lanes to the time at which they seem to touch, if this time is later than the proved
  /// time.
  void try_ahead(const CorePair& pair, const Doubles& here) {
    const ClosestLanes& closest = sample_.closest;
    const Doubles reach = p_.roundings + closed() * Doubles(0.5);
    const Doubles closing = -sample_.slope * closest.upper;
    const Doubles left = (closest.upper - reach) * (closest.upper + reach);
    const Doubles square = closing * closing - closing_square(pair, closest, p_.travel) * left;
    const Doubles step = left / (closing + sqrt(positive_part(square)));
    const Doubles ahead = here + step;
    const DoubleMask tries = active_ & (p_.proves >= Doubles(0.0)) & (square >= Doubles(0.0)) &
                             (closing > Doubles(0.0)) & (ahead > p_.time) & (ahead < p_.last);
    p_.free = p_.time;
    p_.time = select(tries, ahead, p_.time);
    p_.proves = select(tries, Doubles(1.0), p_.proves);
  }

  void put_impacts(const DoubleMask& hit) {
    if (!has_closed_form(tables_.a.kind, tables_.b.kind)) {
      const Vector on_a = shares_of(placed(used_), p_.axis).of(p_.witness.a);
      SampleLanes sample = sample_;
      sample.closest.on_a = on_a;
      answers_.put_impact(bits(hit), p_, sample);
    } else {
      answers_.put_impact(bits(hit), p_, sample_);
    }
    active_ = active_ & !hit;
  }

  /// Chooses the next direction at the lanes' current time; `before` is the time of the last
  /// sample.
  void move_on(const Doubles& before) {
    sample_.between = p_.start + p_.travel * p_.time;
    const Vector w = sample_.between + way_;
    const DoubleMask moved = !(used_[0] & (p_.time <= before));
    const auto put = [&](int s, const DoubleMask& take, const DoubleMask& used) {
      p_.witness.a[s] = select(take, sample_.closest.on_a, p_.witness.a[s]);
      p_.witness.b[s] = select(take, way_, p_.witness.b[s]);
      p_.witness.present[s] = one_where(used);
    };
    const auto nearest = hull::nearest_of_few(placed(differs_), w, active_);
    const auto step =
        hull::take_step(used_, nearest, square_, moved, !active_, moved & !moved, p_.axis, put);
    end_unsure(nearest.inside | !(step.square > Doubles(0.0)));
    p_.proves = one_where(step.stuck & !guessed_);
    if (Elsewhere && guesses_) {
      SecantDirection(sample_.between, p_.axis, p_.tried).note({tried_, way_, guessed_}, active_);
    }
  }

  bool guesses_;
  bool uses_earlier_axes_;
  /// The lanes in which the tested direction is a guess.
  DoubleMask guessed_;
  /// The tested direction, a unit vector.
  Vector tried_;
  /// No direction shows a larger gap than the tested one.
  DoubleMask settled_;
  /// Squared distance to the simplex.
  Doubles square_;
  /// From a's support point to b's, without the vector between the centres.
  Vector way_;
  DoubleMask used_[kSlots];
  DoubleMask differs_[kSlots];
};

}  // namespace winnow::WINNOW_ISA_NAME::impact
