#pragma once

// State of pairs of moving cores, one per lane, and the writing of their results. ImpactStep,
// LinearToiSat and LinearToiGjk derive from BlockStep. A sample is one evaluation of the closest
// points or of the gap along an axis, at one time.

#include "pipeline/motion/closed_forms.wide.h"
#include "pipeline/motion/secant_direction.wide.h"

namespace winnow::WINNOW_ISA_NAME::impact {

/// A pair within the tolerance for more samples than this counts as an impact.
inline constexpr double kMaxLaneSamplesWithin = 64.0;
/// A pair that is not decided after this number of samples goes to the scalar search
/// (ImpactSearch).
inline constexpr double kMaxLaneSamples = 256.0;
/// A fraction of the tolerance. A pair that does not rotate and has at most this gap is sampled as
/// accurately as possible before it is advanced.
inline constexpr double kNearEnough = 0.375;
/// Gaps below this many times the noise count as closed.
inline constexpr double kClosedNoise = 6.0;
/// A fraction of the noise: a search ends if the bounds of the distance differ by at most this.
inline constexpr double kEnough = 0.125;

/// Two moving shapes and the bounds found for them. All members are lanes.
struct PairLanes {
  MovingCore a;
  MovingCore b;
  /// Position of body b relative to body a at time 0, and its total change.
  Vector start;
  Vector travel;
  Doubles roundings;
  Doubles sizes;
  /// Bound on the rounding of any gap, except for the rounding of the position.
  Doubles still_noise;
  Doubles tolerance;
  Doubles last;
  Doubles until;
  /// The pair is disjoint before `time`. `axis` is the axis of the last sample; for pairs that do
  /// not rotate, of the next one.
  Doubles time;
  Vector axis;
  /// A flag whose meaning depends on the method. For pairs that rotate: 1 if the next sample must
  /// prove that the pair is disjoint up to the time of this sample. In LinearToiGjk without a
  /// closed form: 1 if the axis cannot be improved. In LinearToiGjk with a closed form: 1 if the
  /// sample is ahead of the proved time, below 0 if no more such samples are allowed.
  Doubles proves;
  /// The time until which the pair is proved disjoint.
  Doubles free;
  /// Number of samples within the tolerance, as in ImpactSearch.
  Doubles within;
  /// Number of samples.
  Doubles samples;
  /// 1 while the pair is not decided.
  Doubles active;
  SimplexLanes witness;
  /// For pairs that do not rotate and have guesses (has_guesses): see SecantDirection.
  TriedLanes tried;
  /// For pairs that do not rotate and use earlier directions (uses_earlier_axes), once there is a
  /// simplex: `best` is the unit direction with the largest gap, `best_support` the support point
  /// of b along the opposite direction minus the support point of a along `best`, each relative to
  /// the centre of its core.
  Vector best;
  Vector best_support;
  /// The members from here on are for pairs that rotate. `speed` is the relative speed of the
  /// bodies; `gap`, `slope`, `curve` and `bend` belong to the last sample; `next` is the time of
  /// the next sample; `touching` and `aim` are used as in ImpactSearch.
  Doubles speed;
  Doubles gap;
  Doubles slope;
  /// Estimated second derivative of the gap.
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
  std::uint32_t query[kDoubleLanes];
};

struct ImpactBlock {
  PairLanes lanes;
  PairBlockTables tables;
};

/// Returns whether tests of earlier directions reduce the number of samples. The vector between
/// points that nearly touch is short, so rounding changes its direction much. For shapes with a rim
/// and for user shapes this matters at any tolerance, for other shapes only at tolerances below
/// kSmall.
[[nodiscard]] inline bool uses_earlier_axes(const ImpactJob& job, ShapeKind a, ShapeKind b) {
  constexpr double kSmall = 2e-7;
  const auto has_rim = [](ShapeKind kind) {
    return kind == ShapeKind::cylinder || kind == ShapeKind::cone || kind == ShapeKind::support;
  };
  return job.tolerance < kSmall || has_rim(a) || has_rim(b);
}

/// A sample of the pairs.
struct SampleLanes {
  ClosestLanes closest;
  Vector between;
  Doubles noise;
  Doubles gap;
  Doubles most;
  Doubles slope;
  DoubleMask parted;
};

/// The time until which pairs that do not rotate are separated along an axis.
[[nodiscard]] inline Doubles free_along(const PairLanes& p, const SampleLanes& sample) {
  const Doubles target = min(p.tolerance * Doubles(0.25), sample.gap * Doubles(0.5));
  const DoubleMask closes = sample.slope < Doubles(0.0);
  const Doubles step = (sample.gap - target) / select(closes, -sample.slope, Doubles(1.0));
  const Doubles until = p.time + step * Doubles(1.0 - 8.0 * kDoubleEpsilon);
  return select(closes & (until < p.last), until, p.last);
}

/// Writes the results of some lanes.
class ImpactWriter {
 public:
  ImpactWriter(const ImpactJob& job, const PairBlockTables& tables) : job_(job), tables_(tables) {}

  /// Reports pairs as not decided, but disjoint before `time`.
  void put_unsure(Mask16 lanes, const Doubles& time) {
    if (lanes == 0) return;
    alignas(64) double times[kDoubleLanes];
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
      job_.verdicts[query] = ImpactVerdict::decided;
      job_.found[query] = kNone;
    }
  }

  void put_impact(Mask16 lanes, const PairLanes& p, const SampleLanes& sample) {
    if (lanes == 0) return;
    const Doubles distance = sample.closest.upper;
    const Doubles gap = distance - p.roundings;
    const Vector normal = has_closed_form(tables_.a.kind, tables_.b.kind)
                              ? sample.closest.axis
                              : sample.closest.between * (Doubles(1.0) / distance);
    const Vector point = sample.closest.on_a + normal * p.a.rounding;
    const Doubles error = max(sample.most - gap, gap - sample.gap);
    const Doubles columns[] = {
        p.time, positive_part(gap), error, normal.x, normal.y, normal.z, point.x, point.y, point.z};
    alignas(64) double stage[9][kDoubleLanes];
    for (int k = 0; k < 9; ++k) columns[k].store(stage[k]);
    for (; lanes != 0; lanes &= lanes - 1) {
      const unsigned lane = first(lanes);
      const std::uint32_t query = tables_.query[lane];
      job_.verdicts[query] = ImpactVerdict::decided;
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
  /// Static, because copying an object that was just built on the stack would stall.
  static constexpr winnow::impact::Impact kNone{};

  const ImpactJob& job_;
  const PairBlockTables& tables_;
};

/// A step of all active lanes of a block: the sample, and the functions that end lanes.
class BlockStep {
 protected:
  BlockStep(const ImpactJob& job, ImpactBlock& block)
      : p_(block.lanes),
        tables_(block.tables),
        answers_(job, block.tables),
        active_(p_.active > Doubles(0.0)) {}

  /// Gaps up to this size count as closed.
  [[nodiscard]] Doubles closed() const {
    return max(p_.tolerance, sample_.noise * Doubles(kClosedNoise));
  }
  /// Noise of gaps at the relative position `between`.
  [[nodiscard]] Doubles noise_at(const Vector& between) const {
    return p_.still_noise + Doubles(32.0 * kDoubleEpsilon) * (norm_l1(between) + p_.sizes);
  }
  void end_unsure(const DoubleMask& lanes) {
    answers_.put_unsure(bits(active_ & lanes), p_.time);
    active_ = active_ & !lanes;
  }
  void end_apart(const DoubleMask& lanes) {
    answers_.put_apart(bits(active_ & lanes));
    active_ = active_ & !lanes;
  }
  /// Counts the sample; stores and returns the lanes that continue.
  [[nodiscard]] Mask16 continuing_lanes() {
    p_.samples += Doubles(1.0);
    end_unsure(p_.samples >= Doubles(kMaxLaneSamples));
    p_.active = one_where(active_);
    return bits(active_);
  }

  PairLanes& p_;
  const PairBlockTables& tables_;
  ImpactWriter answers_;
  DoubleMask active_;
  SampleLanes sample_;
};

}  // namespace winnow::WINNOW_ISA_NAME::impact
