#pragma once

// Steps of pairs that do not rotate: the Minkowski difference is fixed and the origin moves along a
// line, so that the gap along a direction is determined for all times. Each step is a GJK step that
// at once advances the pair to the time at which the tested direction no longer shows a gap (van
// den Bergen, "Ray casting against general convex objects with application to continuous collision
// detection", 2004). Any direction may be tested; for smooth surfaces guesses alternate with GJK.

#include "pipeline/motion/impact_block.wide.h"

namespace winnow::WINNOW_ISA_NAME::impact {

/// One step of all lanes of a block. For lanes without a closed form, `axis` is the nearest point
/// of the simplex, or any direction while there is none; the witness contains, in world axes, the
/// simplex's points of a and the vectors from them to the points of b. `Elsewhere`: the pairs have
/// no closed form, and use guesses or earlier directions; a template parameter, because the others
/// would be slowed down.
template <bool Elsewhere>
class StraightStep : BlockStep {
 public:
  StraightStep(const ImpactJob& job, ImpactBlock& block)
      : BlockStep(job, block),
        guesses_(has_guesses(tables_.a.kind, tables_.b.kind)),
        looks_back_(looks_back(job, tables_.a.kind, tables_.b.kind)) {}

  /// Returns the lanes that continue.
  [[nodiscard]] Mask16 run() {
    look_.between = p_.start + p_.travel * p_.time;
    look_.noise = noise_at(look_.between);
    const CorePair pair{tables_.a, tables_.b, p_.a, p_.b, look_.between};
    if (!Elsewhere && has_closed_form(tables_.a.kind, tables_.b.kind)) {
      look_.closest = closest_by_form(pair, bits(active_));
      settled_ = active_;
      judge();
      const Doubles here = p_.time;
      const Truth lost = lost_trials();
      active_ = active_ & !lost;
      decide();
      if (has_closing_square(tables_.a.kind, tables_.b.kind)) try_ahead(pair, here);
      active_ = active_ | lost;
    } else {
      const Doubles before = p_.time;
      look_along(pair);
      judge();
      decide();
      if (bits(active_) != 0) move_on(before);
    }
    return go_on();
  }

 private:
  /// Computes which slots of the simplex are in use, and which of these differ from the new point.
  void compare_with(const Vector& way) {
    for (int s = 0; s < kSlots; ++s) {
      const Vector& old = p_.witness.b[s];
      used_[s] = p_.witness.present[s] > Doubles(0.0);
      differs_[s] = used_[s] & !((old.x == way.x) & (old.y == way.y) & (old.z == way.z));
    }
  }
  [[nodiscard]] Truth is_there_already() const {
    Truth is = used_[0] & !differs_[0];
    for (int s = 1; s < kSlots; ++s) is = is | (used_[s] & !differs_[s]);
    return is;
  }
  /// The simplex at the lanes' current positions.
  [[nodiscard]] hull::Simplex<double> placed(const Truth (&present)[kSlots]) const {
    hull::Simplex<double> simplex;
    for (int s = 0; s < kSlots; ++s) {
      simplex.present[s] = present[s];
      simplex.point[s] = look_.between + p_.witness.b[s];
    }
    return simplex;
  }

  /// Samples the gap along the direction.
  void look_along(const CorePair& pair) {
    const Vector& v = p_.axis;
    ClosestLanes& closest = look_.closest;
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
    compare_with(way_);
    const Vector w = look_.between + way_;
    const Doubles reach = dot(direction, w);
    const Doubles over = Doubles(1.0) / size;
    closest.axis = direction * over;
    closest.lower = reach * over;
    Doubles gain = square_ - reach;
    if (Elsewhere) {
      tried_ = closest.axis;
      const Truth known = looks_back_ ? take_best() : guessed_;
      gain = select(guessed_ | known, square_ - closest.lower * closest.upper, gain);
    }
    const Doubles left = closest.upper - p_.roundings;
    const Truth ends =
        (gain <= Doubles(kRounding) * closest.upper * left) & is_there_already() & !guessed_;
    // Rounding perturbs the direction, by more the shorter it is, and thereby the support point.
    settled_ = used_[0] & ((gain <= look_.noise * Doubles(kEnough) * (closest.upper + p_.sizes)) |
                           ends | (p_.proves > Doubles(0.0)));
  }

  /// Uses an earlier direction where it shows a larger gap. Returns those lanes.
  [[nodiscard]] Truth take_best() {
    ClosestLanes& closest = look_.closest;
    const Doubles shown = dot(p_.best, look_.between + p_.best_way);
    const Truth known = used_[0] & (shown > closest.lower);
    closest.lower = select(known, shown, closest.lower);
    closest.axis = p_.best = select(known, p_.best, closest.axis);
    p_.best_way = select(known, p_.best_way, way_);
    return known;
  }

  /// Computes the gap, its slope and the bounds from the closest points.
  void judge() {
    const ClosestLanes& closest = look_.closest;
    look_.gap = closest.lower - p_.roundings - look_.noise;
    look_.most = closest.upper - p_.roundings + look_.noise;
    look_.slope = dot(closest.axis, p_.travel);
    look_.parted = look_.gap > Doubles(0.0);
  }

  /// Detects impacts, or advances the time.
  void decide() {
    const Truth within = look_.parted & (look_.most <= closed());
    const Truth near = within & settled_;
    const Truth meets = look_.gap + look_.slope * (p_.last - p_.time) <= Doubles(0.0);
    p_.within = select(near & !meets, p_.within + Doubles(1.0), p_.within);
    const Truth met = active_ & near & (meets | (p_.within > Doubles(kMostLooksWithin)));
    if (bits(met) != 0) meet(met);
    if (bits(active_) == 0) return;
    const Doubles free = free_along(p_, look_);
    end_apart(look_.parted & ((free >= p_.last) | (free > p_.until)));
    // Touching, too close for double to decide, or no double left between.
    end_unsure(settled_ & ((!look_.parted) | (free <= p_.time)));
    // A pair within the tolerance, or near enough to it, is first sampled as accurately as
    // possible.
    const Truth far = (!within) & (look_.gap > p_.tolerance * Doubles(kNearEnough));
    p_.time = select(active_ & look_.parted & (far | settled_), free, p_.time);
  }

  /// A lane that was sampled ahead of its proved time is disjoint up to there if the gap still
  /// closes along the axis. Other lanes are returned; they go back and take only proved steps.
  [[nodiscard]] Truth lost_trials() {
    const Doubles zero(0.0);
    const Truth trial = active_ & (p_.proves > zero);
    // Covers the rounding of the slope.
    const Doubles flat = taxicab(p_.travel) * Doubles(-64.0 * kPlace);
    const Truth lost = trial & !(look_.parted & (look_.slope < flat));
    p_.time = select(lost, p_.free, p_.time);
    p_.proves = select(lost, Doubles(-1.0), select(trial, zero, p_.proves));
    return lost;
  }

  /// Moves lanes to the time at which they seem to touch, if that is ahead of the proved time.
  void try_ahead(const CorePair& pair, const Doubles& here) {
    const ClosestLanes& closest = look_.closest;
    const Doubles reach = p_.roundings + closed() * Doubles(0.5);
    const Doubles closing = -look_.slope * closest.upper;
    const Doubles left = (closest.upper - reach) * (closest.upper + reach);
    const Doubles square = closing * closing - closing_square(pair, closest, p_.travel) * left;
    const Doubles step = left / (closing + sqrt(positive_part(square)));
    const Doubles ahead = here + step;
    const Truth tries = active_ & (p_.proves >= Doubles(0.0)) & (square >= Doubles(0.0)) &
                        (closing > Doubles(0.0)) & (ahead > p_.time) & (ahead < p_.last);
    p_.free = p_.time;
    p_.time = select(tries, ahead, p_.time);
    p_.proves = select(tries, Doubles(1.0), p_.proves);
  }

  void meet(const Truth& met) {
    if (!has_closed_form(tables_.a.kind, tables_.b.kind)) {
      const Vector on_a = shares_of(placed(used_), p_.axis).of(p_.witness.a);
      LookLanes look = look_;
      look.closest.on_a = on_a;
      answers_.put_meeting(bits(met), p_, look);
    } else {
      answers_.put_meeting(bits(met), p_, look_);
    }
    active_ = active_ & !met;
  }

  /// Chooses the next direction at the lanes' current time; `before` is the time of the last
  /// sample.
  void move_on(const Doubles& before) {
    look_.between = p_.start + p_.travel * p_.time;
    const Vector w = look_.between + way_;
    const auto nearest = nearest_feature(placed(differs_), w, active_);
    const Doubles square = dot(nearest.point, nearest.point);
    const Truth stands = used_[0] & (p_.time <= before);
    const Truth stuck = stands & (square >= square_);
    end_unsure(nearest.inside | !(square > Doubles(0.0)));
    p_.proves = one_where(stuck & !guessed_);
    const Truth moves = active_ & !stuck;
    keep(nearest, moves);
    p_.axis = select(moves, nearest.point, p_.axis);
    if (Elsewhere && guesses_) {
      SmoothGuess(look_.between, p_.axis, p_.tried).note({tried_, way_, guessed_}, active_);
    }
  }

  /// In lanes in `moves`, replaces the simplex by its nearest feature.
  void keep(const hull::SimplexNearest<double>& nearest, const Truth& moves) {
    Truth placed = !moves;
    for (int s = 0; s < kSlots; ++s) {
      const Truth take = (!placed) & (!nearest.keep[s]);
      placed = placed | take;
      p_.witness.a[s] = select(take, look_.closest.on_a, p_.witness.a[s]);
      p_.witness.b[s] = select(take, way_, p_.witness.b[s]);
      p_.witness.present[s] =
          select(moves, one_where(take | nearest.keep[s]), p_.witness.present[s]);
    }
  }

  bool guesses_;
  bool looks_back_;
  /// The lanes in which the tested direction was a guess; and that direction, a unit vector.
  Truth guessed_;
  Vector tried_;
  /// No direction shows a larger gap than the tested one.
  Truth settled_;
  /// Squared distance to the simplex.
  Doubles square_;
  /// From a's support point to b's, without the vector between the centres.
  Vector way_;
  Truth used_[kSlots];
  Truth differs_[kSlots];
};

}  // namespace winnow::WINNOW_ISA_NAME::impact
