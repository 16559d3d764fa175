#pragma once

// Pairs of moving cores, one per lane, what is known of them on their way, and where their answers
// go.

#include "pipeline/motion/closed_forms.wide.h"
#include "pipeline/motion/smooth_guess.wide.h"

namespace winnow::WINNOW_ISA_NAME::impact {

/// Shapes that stay so long within the tolerance as they near each other have met.
inline constexpr double kMostLooksWithin = 64.0;
/// What takes more looks takes the search that has one pair alone.
inline constexpr double kMostLaneLooks = 256.0;
/// Of the tolerance: pairs that do not turn are not brought nearer.
inline constexpr double kNearEnough = 0.375;
/// Gaps are not seen to be smaller than some noise.
inline constexpr double kClosedNoise = 6.0;
/// Of the noise: what distances need not be better than.
inline constexpr double kEnough = 0.125;

/// Two moving shapes and what is known of them. All members are lanes.
struct PairLanes {
  MovingCore a;
  MovingCore b;
  /// From body a to body b at time 0, and how that changes.
  Vector start;
  Vector travel;
  Doubles roundings;
  Doubles sizes;
  /// What rounding does to any gap but for that of the place.
  Doubles still_noise;
  Doubles tolerance;
  Doubles last;
  Doubles until;
  /// They are apart before; and the axis of the last look, or of the next one of a pair that does
  /// not turn.
  Doubles time;
  Vector axis;
  /// Whether the next look is to prove that they are apart until then; of a pair that does not
  /// turn, that its axis is as good as can be, or, if that has a closed form, that it is looked at
  /// ahead of what is proved, below 0 that it shall not be any more.
  Doubles proves;
  /// Until when that is proved.
  Doubles free;
  /// As in ImpactSearch.
  Doubles within;
  /// So far.
  Doubles looks;
  /// 1 while there is more to do.
  Doubles active;
  WitnessLanes witness;
  /// Of pairs that do not turn and have guesses.
  TriedLanes tried;
  /// Of pairs that do not turn and look back, the direction that shows the largest gap, unit, once
  /// there is a simplex; and from the point of a that is farthest along it to that of b, without
  /// the way between the middles.
  Vector best;
  Vector best_way;
  /// Of pairs that turn: how fast they travel; what else is known by the last look, when to look
  /// next, and as in ImpactSearch.
  Doubles speed;
  Doubles gap;
  Doubles slope;
  /// How fast the slope seems to grow.
  Doubles curve;
  Doubles bend;
  Doubles next;
  Doubles touching;
  Doubles aim;
};

struct PairBlockTables {
  CoreTable a;
  CoreTable b;
  /// Index of the query in each lane.
  std::uint32_t query[kWidth];
};

struct ImpactBlock {
  PairLanes lanes;
  PairBlockTables tables;
};

/// Whether earlier directions are of use: the way between points that nearly touch is short, and
/// rounding turns it by much. Rims are hit so at any tolerance, other shapes at small ones.
[[nodiscard]] inline bool looks_back(const ImpactJob& job, ShapeKind a, ShapeKind b) {
  constexpr double kSmall = 2e-7;
  const auto has_rim = [](ShapeKind kind) {
    return kind == ShapeKind::cylinder || kind == ShapeKind::cone || kind == ShapeKind::support;
  };
  return job.tolerance < kSmall || has_rim(a) || has_rim(b);
}

/// What the lanes show where they are placed.
struct LookLanes {
  ClosestLanes closest;
  Vector between;
  Doubles noise;
  Doubles gap;
  Doubles most;
  Doubles slope;
  Truth parted;
};

/// Until when pairs that do not turn are apart along an axis.
[[nodiscard]] inline Doubles free_along(const PairLanes& p, const LookLanes& look) {
  const Doubles target = min(p.tolerance * Doubles(0.25), look.gap * Doubles(0.5));
  const Truth closes = look.slope < Doubles(0.0);
  const Doubles step = (look.gap - target) / select(closes, -look.slope, Doubles(1.0));
  const Doubles until = p.time + step * Doubles(1.0 - 8.0 * kPlace);
  return select(closes & (until < p.last), until, p.last);
}

/// Writes answers of some lanes.
class Answers {
 public:
  Answers(const ImpactJob& job, const PairBlockTables& tables) : job_(job), tables_(tables) {}

  /// They are apart before.
  void put_unsure(Mask16 lanes, const Doubles& time) {
    if (lanes == 0) return;
    alignas(64) double times[kWidth];
    time.store(times);
    for (; lanes != 0; lanes &= lanes - 1) {
      const unsigned lane = first(lanes);
      job_.verdicts[tables_.query[lane]] = ImpactVerdict::unsure;
      job_.found[tables_.query[lane]].time = times[lane];
    }
  }

  void put_apart(Mask16 lanes) {
    for (; lanes != 0; lanes &= lanes - 1) {
      const std::uint32_t query = tables_.query[first(lanes)];
      job_.verdicts[query] = ImpactVerdict::known;
      job_.found[query] = kNone;
    }
  }

  void put_meeting(Mask16 lanes, const PairLanes& p, const LookLanes& look) {
    if (lanes == 0) return;
    const Doubles distance = look.closest.upper;
    const Doubles gap = distance - p.roundings;
    const Vector normal = has_closed_form(tables_.a.kind, tables_.b.kind)
                              ? look.closest.axis
                              : look.closest.between * (Doubles(1.0) / distance);
    const Vector point = look.closest.on_a + normal * p.a.rounding;
    const Doubles error = max(look.most - gap, gap - look.gap);
    const Doubles columns[] = {
        p.time, positive_part(gap), error, normal.x, normal.y, normal.z, point.x, point.y, point.z};
    alignas(64) double stage[9][kWidth];
    for (int k = 0; k < 9; ++k) columns[k].store(stage[k]);
    for (; lanes != 0; lanes &= lanes - 1) {
      const unsigned lane = first(lanes);
      const std::uint32_t query = tables_.query[lane];
      job_.verdicts[query] = ImpactVerdict::known;
      job_.found[query] = {true,
                           stage[0][lane],
                           stage[1][lane],
                           stage[2][lane],
                           {stage[3][lane], stage[4][lane], stage[5][lane]},
                           {stage[6][lane], stage[7][lane], stage[8][lane]},
                           0};
    }
  }

 private:
  /// In memory: what is made on the stack and copied at once is waited for.
  static constexpr winnow::impact::Impact kNone{};

  const ImpactJob& job_;
  const PairBlockTables& tables_;
};

/// A step of all lanes of a block that are active: what it looks at, and how lanes end.
class BlockStep {
 protected:
  BlockStep(const ImpactJob& job, ImpactBlock& block)
      : p_(block.lanes),
        tables_(block.tables),
        answers_(job, block.tables),
        active_(p_.active > Doubles(0.0)) {}

  /// Gaps that may be as large have been closed.
  [[nodiscard]] Doubles closed() const {
    return max(p_.tolerance, look_.noise * Doubles(kClosedNoise));
  }
  /// Of gaps where they are `between` from each other.
  [[nodiscard]] Doubles noise_at(const Vector& between) const {
    return p_.still_noise + Doubles(32.0 * kPlace) * (taxicab(between) + p_.sizes);
  }
  void end_unsure(const Truth& lanes) {
    answers_.put_unsure(bits(active_ & lanes), p_.time);
    active_ = active_ & !lanes;
  }
  void end_apart(const Truth& lanes) {
    answers_.put_apart(bits(active_ & lanes));
    active_ = active_ & !lanes;
  }
  /// Notes which lanes go on, and returns them.
  [[nodiscard]] Mask16 go_on() {
    p_.looks += Doubles(1.0);
    end_unsure(p_.looks >= Doubles(kMostLaneLooks));
    p_.active = one_where(active_);
    return bits(active_);
  }

  PairLanes& p_;
  const PairBlockTables& tables_;
  Answers answers_;
  Truth active_;
  LookLanes look_;
};

}  // namespace winnow::WINNOW_ISA_NAME::impact
