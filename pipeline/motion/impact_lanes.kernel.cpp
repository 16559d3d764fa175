// Finds the first impact of a pair of moving cores in each SIMD lane, by the method of
// impact_search.cpp. That file also decides the pairs that the lanes leave undecided, for example
// pairs that touch at a sample or are too close for double precision. Each round samples all pairs
// of up to kBlocks blocks once. Then active pairs are moved into the lanes of finished pairs, and
// free blocks are loaded from the queue. So the other lanes of a block do not stay idle while one
// pair needs many samples. The result of a pair does not depend on other pairs.

#include "pipeline/motion/impact_lanes.kernel.h"

#include "pipeline/motion/impact_block.wide.h"
#include "pipeline/motion/linear_toi_gjk.wide.h"
#include "pipeline/motion/linear_toi_sat.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::impact {
namespace {

/// Relative accuracy of distances. Distances below twice the tolerance are computed as accurately
/// as possible.
constexpr double kGoodEnough = 0.3;
/// Initial target for the gap at the next sample, relative to the current gap.
constexpr double kFirstAim = 0.03;
/// Limit on the steps of one GJK search; only rounding could require more.
constexpr int kMaxSteps = 32;
/// Products of six lengths between these stay in the range of double without losing digits.
constexpr double kShortest = 1e-40;
constexpr double kLongest = 1e40;

/// Returns the fraction of an interval, from its start, in which a gap certainly stays above a
/// target. The gap exceeds the target by `above` at the start and by `then` at the end; at fraction
/// s it is at most 4 `sag` s (1 - s) below its chord. The result is needed only in `lanes`.
[[gnu::always_inline]] inline Doubles share_above(const Doubles& above, const Doubles& then,
                                                  const Doubles& sag, const DoubleMask& lanes) {
  const Doubles zero(0.0);
  const Doubles one(1.0);
  const Doubles square = sag * Doubles(4.0);
  const Doubles linear = then - above - square;
  const Doubles discriminant = linear * linear - square * above * Doubles(4.0);
  // NaN proves nothing.
  const DoubleMask known = square < Doubles(kLargest<double>);
  const DoubleMask stays = (then >= zero) & ((linear >= zero) | (discriminant < zero) |
                                             (-linear >= square * Doubles(2.0)));
  if (bits(lanes & !(stays & known)) == 0) return one;
  const Doubles root = above * Doubles(2.0) / (sqrt(positive_part(discriminant)) - linear);
  const Doubles share = select(root >= zero, root * Doubles(1.0 - 1e-12), zero);
  return select(known, select(stays, one, select(share < one, share, one)), zero);
}

[[nodiscard]] bool is_straight(const ImpactJob& job) {
  return job.motion == ImpactMotion::straight;
}

/// Returns the velocity along an axis, due to rotation, of the point at y from the centre of a
/// core.
[[gnu::always_inline]] inline Doubles speed_along(const CoreTable& table, const MovingCore& core,
                                                  const Vector& axis, const Vector& y) {
  if (!table.turns) return Doubles(0.0);
  return core.angle * dot(axis, cross(core.axis, y));
}

/// Bounds on a rotating core's motion along an axis.
struct TurningAlong {
  /// Support along the axis of the volume that the core sweeps.
  Doubles high;
  /// Bound on the acceleration of its points along the axis.
  Doubles acceleration;
};

/// `high` is the support of the core at its current placement.
[[gnu::always_inline]] inline TurningAlong turning_along(const CoreTable& table,
                                                         const MovingCore& core, const Vector& axis,
                                                         const Doubles& high) {
  if (!table.turns) return {high, Doubles(0.0)};
  const Doubles along = dot(axis, core.axis);
  const Doubles across = length(cross(axis, core.axis));
  const Doubles swept = max(along * core.low, along * core.high) + across * core.reach;
  return {select(core.angle > Doubles(0.0), swept, high),
          core.angle * core.angle * (across + Doubles(kAxisError)) * core.reach};
}

/// Returns a bound for the gap along an axis that rotates uniformly from `from` to `to` during a
/// time of `width`, at the end of which the cores are placed with the centres `between` apart. At
/// fraction s of this time, the gap is below its chord by at most half of the bound times s (1 -
/// s). The bound is infinite if |to - from| exceeds 1.
[[gnu::always_inline]] inline Doubles bend_between(const PairLanes& p, const Vector& from,
                                                   const Vector& to, const Doubles& width,
                                                   const Vector& between) {
  const Doubles turned = length(to - from);
  const Doubles rate = turned * (Doubles(1.0) + Doubles(0.05) * turned * turned);
  const Doubles swing_a = p.a.reach * p.a.angle;
  const Doubles swing_b = p.b.reach * p.b.angle;
  const Doubles way = width * p.speed;
  const Doubles speed = way + width * (swing_a + swing_b);
  const Doubles below = rate * (norm_l1(between) + way + p.sizes) + speed;
  const Doubles all = width * width * (swing_a * p.a.angle + swing_b * p.b.angle) +
                      rate * speed * Doubles(2.0) + rate * rate * below;
  return select(turned <= Doubles(1.0), all, Doubles(__builtin_inf()));
}

class ImpactStep : BlockStep {
 public:
  /// `coarse`: this is the first sample of the block. One GJK step is enough if it separates the
  /// cores; lanes that it does not separate are sampled again with the full number of steps.
  ImpactStep(const ImpactJob& job, ImpactBlock& block, bool coarse)
      : BlockStep(job, block),
        is_exact_(has_closed_form(tables_.a.kind, tables_.b.kind)),
        has_plane_(tables_.b.kind == ShapeKind::half_space),
        coarse_(coarse && !is_exact_) {}

  /// Samples all lanes once. Returns the lanes that continue.
  [[nodiscard]] Mask16 run() {
    const Vector axis = p_.axis;
    const Doubles gap = p_.gap;
    sample();
    advance(axis, gap);
    decide();
    return continuing_lanes();
  }

 private:
  /// Samples the lanes at their next time.
  void sample() {
    place(tables_.a, p_.next, p_.a);
    place(tables_.b, p_.next, p_.b);
    sample_.between = p_.start + p_.travel * p_.next;
    sample_.noise = noise_at(sample_.between);
    const CorePair pair{tables_.a, tables_.b, p_.a, p_.b, sample_.between};
    if (!has_plane_) then_ = gap_along(pair);
    sample_.closest = closest_points(pair);
    const ClosestLanes& closest = sample_.closest;
    sample_.gap = closest.lower - p_.roundings - sample_.noise;
    sample_.most = closest.upper - p_.roundings + sample_.noise;
    if (has_plane_) then_ = sample_.gap;
    sample_.slope = dot(closest.axis, p_.travel) +
                    speed_along(tables_.b, p_.b, closest.axis, closest.on_b) -
                    speed_along(tables_.a, p_.a, closest.axis, closest.on_a);
    sample_.parted = sample_.gap > Doubles(0.0);
  }

  [[nodiscard]] ClosestLanes closest_points(const CorePair& pair) {
    if (has_closed_form(tables_.a.kind, tables_.b.kind))
      return closest_by_form(pair, bits(active_));
    const Doubles precise = p_.tolerance * Doubles(2.0);
    const Doubles enough = sample_.noise * Doubles(kEnough);
    const ClosestOptions options{kGoodEnough, p_.roundings, precise, enough};
    return ClosestSearch(pair, options, p_.witness).run(active_, coarse_ ? 1 : kMaxSteps);
  }

  /// The gap at the current placement along the axis of the last sample.
  [[nodiscard]] Doubles gap_along(const CorePair& pair) const {
    const Mask16 proves = bits(active_ & (p_.proves > Doubles(0.0)));
    if (proves == 0) return Doubles(0.0);
    const Doubles high = pair.height(tables_.a, p_.a, p_.axis, proves) +
                         pair.height(tables_.b, p_.b, -p_.axis, proves);
    return dot(p_.axis, sample_.between) - high - p_.roundings - sample_.noise;
  }

  /// Advances the time as far as is proved from the last sample, which had gap `gap` along `axis`.
  /// Lanes that are proved up to the new sample adopt it.
  void advance(const Vector& axis, const Doubles& gap) {
    const DoubleMask proves = p_.proves > Doubles(0.0);
    if (bits(active_ & proves) == 0) {
      fully_proved_ = active_;
      p_.time = p_.next;
      p_.curve = Doubles(0.0);
      // Lanes that the coarse sample does not separate are sampled again.
      if (coarse_) fully_proved_ = fully_proved_ & sample_.parted;
      end_unsure(fully_proved_ & !sample_.parted);
      forget_touching();
      return;
    }
    const Doubles width = p_.next - p_.time;
    const Doubles apart = proved(axis, gap, width);
    const DoubleMask whole = (!proves) | (apart >= p_.next);
    const Doubles left = p_.touching;
    p_.touching =
        select(proves & !sample_.parted, min(left, p_.time + width * Doubles(0.75)), left);
    learn(gap, width, proves & whole);
    // Lanes that are not proved up to the new sample continue from the proved time.
    const Doubles reached = max(apart, p_.free);
    const DoubleMask is_stuck = proves & (!whole) & (reached <= p_.time);
    end_unsure(is_stuck);
    fully_proved_ = whole;
    p_.time = select(whole, p_.next, reached);
    end_apart(((!whole) & (p_.time >= p_.last)) | (p_.time > p_.until));
    // These pairs touch, or are too close for double precision to decide.
    end_unsure(whole & !sample_.parted);
    p_.next = p_.time;
    p_.proves = Doubles(0.0);
    forget_touching();
  }

  /// Adapts the choice of the next sample to the gap found at the end of a step.
  void learn(const Doubles& gap, const Doubles& width, const DoubleMask& lanes) {
    const Doubles half(0.5);
    // One division instead of two.
    const Doubles both = Doubles(1.0) / (gap * width);
    const Doubles over = both * width;
    const Doubles share = sample_.gap * over;
    const Doubles expected = gap + width * (p_.slope + p_.curve * width * half);
    // The error of a linear prediction is proportional to the square of the step, and the step to
    // the gap at its start (see ImpactSearch::advance). With a predicted curvature, the error is
    // proportional to the cube of the step.
    Doubles aim = abs(sample_.gap - expected) * over * share * Doubles(4.0);
    if (is_exact_) {
      aim = aim * share;
      // The second derivative, at the end, of the cubic with the gaps and slopes at both ends.
      const Doubles apiece = both * gap;
      const Doubles mean = (sample_.gap - gap) * apiece;
      const Doubles curve =
          (p_.slope + sample_.slope * Doubles(2.0) - mean * Doubles(3.0)) * Doubles(2.0) * apiece;
      p_.curve = select(lanes, curve, Doubles(0.0));
    }
    const Doubles bounded =
        select(aim > Doubles(1e-9), select(aim < Doubles(0.25), aim, Doubles(0.25)), Doubles(1e-9));
    p_.aim = select(lanes, bounded, p_.aim);
  }

  void forget_touching() {
    p_.touching = select(p_.time >= p_.touching, Doubles(__builtin_inf()), p_.touching);
  }

  /// Returns the time until which the pair is certainly disjoint. The proof uses the axis of the
  /// last sample, or an axis that rotates from the axis of the last sample to the axis of the new
  /// sample.
  [[nodiscard]] Doubles proved(const Vector& axis, const Doubles& gap, const Doubles& way) const {
    const Doubles width = way * Doubles(1.0 + 4.0 * kDoubleEpsilon);
    const Doubles least = select(sample_.parted & (sample_.gap < gap), sample_.gap, gap);
    const Doubles target = min(p_.tolerance * Doubles(0.25), least * Doubles(0.5));
    const Doubles eighth(0.125);
    const Doubles above = gap - target;
    const DoubleMask to_prove = active_ & (p_.proves > Doubles(0.0));
    Doubles share = share_above(above, then_ - target, p_.bend * width * width * eighth, to_prove);
    if (bits(to_prove & !(share >= Doubles(1.0))) == 0) return p_.next;
    if (has_plane_) return reached(share, way);
    const Doubles bent = bend_between(p_, axis, sample_.closest.axis, width, sample_.between);
    const Doubles turning = share_above(above, sample_.gap - target, bent * eighth, to_prove);
    share = select(sample_.parted & (turning > share), turning, share);
    return reached(share, way);
  }
  /// Returns the time at a fraction of the step to the next sample.
  [[nodiscard]] Doubles reached(const Doubles& share, const Doubles& way) const {
    return select(share >= Doubles(1.0), p_.next, min(p_.time + share * way, p_.next));
  }

  /// For lanes with a new sample: detects an impact or chooses the time of the next sample.
  void decide() {
    const DoubleMask sampled = active_ & fully_proved_;
    if (bits(sampled) == 0) return;
    const DoubleMask near = sampled & (sample_.most <= closed());
    const DoubleMask will_touch = sample_.gap + sample_.slope * (p_.last - p_.time) <= Doubles(0.0);
    p_.within = select(near & !will_touch, p_.within + Doubles(1.0), p_.within);
    const DoubleMask hit = near & (will_touch | (p_.within > Doubles(kMaxLaneSamplesWithin)));
    answers_.put_impact(bits(hit), p_, sample_);
    active_ = active_ & !hit;
    if (bits(active_) == 0) return;
    const ClosestLanes& c = sample_.closest;
    const TurningAlong of_a = turning_along(tables_.a, p_.a, c.axis, c.high_a);
    const TurningAlong of_b = has_plane_ ? turning_plane(of_a.acceleration)
                                         : turning_along(tables_.b, p_.b, -c.axis, c.high_b);
    const Doubles free = free_until(of_a.high + of_b.high);
    const Doubles bend = of_a.acceleration + of_b.acceleration;
    end_apart(sampled & ((free >= p_.last) | (free > p_.until)));
    const Doubles next = next_sample_time(bend);
    const DoubleMask freely = next <= free;
    const Doubles moved = select(freely, free, p_.time);
    // There is no double between the time and `free`.
    end_unsure(sampled & freely & (moved <= p_.time));
    p_.axis = select(sampled, c.axis, p_.axis);
    p_.gap = select(sampled, sample_.gap, p_.gap);
    p_.slope = select(sampled, sample_.slope, p_.slope);
    p_.bend = select(sampled, bend, p_.bend);
    p_.free = select(sampled, free, p_.free);
    p_.time = select(sampled, moved, p_.time);
    p_.next = select(sampled, select(freely, free, next), p_.next);
    p_.proves = one_where(sampled & !freely);
  }

  /// Bounds for a half-space along its normal n, which rotates with it; the swept volume is
  /// unbounded. The gap is n . P, with P from the half-space's position to a point of a; its second
  /// derivative is n'' . P + 2 n' . P' + n . P''. `counted` is the part of the last term that is
  /// already included: the acceleration of a along the current n.
  [[nodiscard]] TurningAlong turning_plane(const Doubles& counted) const {
    const Doubles& high = sample_.closest.high_b;
    if (!tables_.b.turns) return {high, Doubles(0.0)};
    const DoubleMask turns = p_.b.angle > Doubles(0.0);
    const Vector end = p_.start + p_.travel * p_.last;
    const Doubles far = max(length(sample_.between), length(end)) + p_.a.size;
    const Doubles fast = p_.speed + p_.a.angle * p_.a.reach;
    const Doubles rate =
        p_.b.angle * (length(cross(sample_.closest.axis, p_.b.axis)) + Doubles(kAxisError));
    const Doubles of_a = p_.a.angle * p_.a.angle * p_.a.reach;
    const Doubles bend =
        rate * (p_.b.angle * far + fast * Doubles(2.0)) + positive_part(of_a - counted);
    return {select(turns, Doubles(__builtin_inf()), high), select(turns, bend, Doubles(0.0))};
  }

  /// Returns the time until which the swept volumes are disjoint; `high` is the sum of their
  /// supports, each from the centre of its core.
  [[nodiscard]] Doubles free_until(const Doubles& high) const {
    const Vector& axis = sample_.closest.axis;
    const Doubles swept = dot(axis, sample_.between) - high - p_.roundings - sample_.noise -
                          min(p_.tolerance * Doubles(0.25), sample_.gap * Doubles(0.5));
    const DoubleMask apart = swept > Doubles(0.0);
    if (bits(active_ & apart) == 0) return p_.time;
    const Doubles closing = -dot(axis, p_.travel);
    const DoubleMask closes = closing > Doubles(0.0);
    const Doubles step = swept / select(closes, closing, Doubles(1.0));
    const Doubles until = p_.time + step * Doubles(1.0 - 8.0 * kDoubleEpsilon);
    return select(apart, select(closes & (until < p_.last), until, p_.last), p_.time);
  }

  /// Returns the time at which the gap is expected to have fallen to a fraction of its value, but
  /// at most the last time up to which a proof of separation is expected to succeed. `bend`: at a
  /// time t between times u and v, the gap along the axis is below its chord by at most
  /// bend / 2 * (t - u) * (v - t).
  [[nodiscard]] Doubles next_sample_time(const Doubles& bend) const {
    const Doubles zero(0.0);
    const Doubles one(1.0);
    const Doubles end = min(p_.last, p_.touching);
    Doubles step = end - p_.time;
    const DoubleMask falls = sample_.slope < zero;
    const Doubles aim = max(p_.tolerance * Doubles(0.5), p_.aim * sample_.gap);
    const Doubles fall = max(sample_.gap - aim, sample_.gap * Doubles(0.25));
    Doubles speed = -sample_.slope;
    if (is_exact_) {
      const Doubles square = speed * speed - p_.curve * fall * Doubles(2.0);
      speed = (speed + sqrt(positive_part(square))) * Doubles(0.5);
    }
    // If the slope is constant, a proof succeeds if half of the bend times the square of the step
    // is less than the square of the sum of the roots of the gaps at both ends. The second gap is
    // `rest` times the first; `root` is a lower bound of the square root of `rest`.
    const DoubleMask bends = bend > zero;
    const Doubles depth = select(bends, sample_.gap * bend, one);
    const Doubles rate = select(falls, speed, one);
    const Doubles both = one / (rate * depth);
    const Doubles reached = fall * depth * both;
    step = select(falls & (reached < step), reached, step);
    const Doubles steep = sqrt(Doubles(2.0) * rate * both);
    const Doubles left = one + sample_.slope * steep;
    const Doubles rest = select(left > zero, select(left < one, left, one), zero);
    const Doubles root = rest * (Doubles(1.5) - rest * Doubles(0.5));
    const Doubles most = sample_.gap * steep * Doubles(0.95) * (one + root);
    step = select(bends & (most < step), most, step);
    return min(p_.time + step, end);
  }

  /// The pairs have a closed form, which computes gaps as accurately as possible. Without it, gaps
  /// have the accuracy kGoodEnough.
  bool is_exact_;
  /// The pair has a half-space, whose normal at each time is the only axis tested.
  bool has_plane_;
  bool coarse_;
  /// The pair is proved disjoint up to the new sample.
  DoubleMask fully_proved_;
  /// The gap at the new sample along the axis of the last one.
  Doubles then_;
};

/// Loads queries into the lanes of a block. Queries that the lanes cannot handle get the verdict
/// unsure.
class ImpactLoad {
 public:
  ImpactLoad(const ImpactJob& job, std::uint32_t first, ImpactBlock& block)
      : job_(job), first_(first), p_(block.lanes), tables_(block.tables) {}

  /// Returns the lanes that are active.
  [[nodiscard]] Mask16 run() {
    for (int lane = 0; lane < kDoubleLanes; ++lane) {
      const std::uint32_t at = first_ + static_cast<std::uint32_t>(lane);
      tables_.query[lane] = job_.order[at < job_.count ? at : job_.count - 1];
      query_[lane] = &job_.queries[tables_.query[lane]];
      for (int side = 0; side < 2; ++side) {
        motion_[side][lane] = numbers(*query_[lane]->motion[side]);
        index_[side][lane] = query_[lane]->shape[side].index();
      }
    }
    DoubleMask usable = load_cores();
    usable = usable & load_positions();
    measure_pair();
    usable = usable & (p_.sizes > Doubles(kShortest)) & (span_ < Doubles(kLongest));
    begin(usable);
    return bits(p_.active > Doubles(0.0));
  }

 private:
  [[nodiscard]] DoubleMask load_cores() {
    DoubleMask usable = Doubles(0.0) < Doubles(1.0);
    for (int side = 0; side < 2; ++side) {
      CoreTable& table = side == 0 ? tables_.a : tables_.b;
      MovingCore& core = side == 0 ? p_.a : p_.b;
      table.kind = query_[0]->shape[side].kind();
      table.in_world = table.kind == ShapeKind::sphere ||
                       (is_straight(job_) && table.kind == ShapeKind::triangle);
      table.turns = turns(table.kind);
      load_core(
          job_.tables, [&](int lane) { return index_[side][lane]; }, table, core);
      measure(table, core);
      usable = usable & load_turn(
                            table, [&](int lane) { return motion_[side][lane]; }, core);
    }
    return usable;
  }

  [[nodiscard]] bool turns(ShapeKind kind) const {
    if (kind == ShapeKind::half_space) return job_.motion == ImpactMotion::plane_turns;
    return kind != ShapeKind::sphere && !is_straight(job_);
  }

  /// Loads positions and travel; returns the lanes in which they are certainly valid.
  [[nodiscard]] DoubleMask load_positions() {
    constexpr double kFarthest = 1e300;
    Vector position[2];
    Vector travel[2];
    Doubles far(0.0);
    for (int side = 0; side < 2; ++side) {
      Doubles row[4];
      load_rows4([&](int lane) { return motion_[side][lane]; }, row);
      position[side] = {row[0], row[1], row[2]};
      load_rows4([&](int lane) { return motion_[side][lane] + kTravelAt; }, row);
      travel[side] = {row[0], row[1], row[2]};
      far += norm_l1(position[side]) + norm_l1(travel[side]);
    }
    p_.start = position[1] - position[0];
    p_.travel = travel[1] - travel[0];
    p_.time = Doubles(0.0);
    p_.last = Doubles(1.0);
    p_.until = load_rows1([&](int lane) { return &query_[lane]->until; });
    return far < Doubles(kFarthest);
  }

  void measure_pair() {
    p_.roundings = p_.a.rounding + p_.b.rounding;
    p_.sizes = p_.a.size + p_.b.size;
    const Doubles way = norm_l1(p_.start) + norm_l1(p_.travel);
    span_ = way + p_.sizes;
    p_.still_noise = Doubles(kDoubleEpsilon) *
                     (way * Doubles(8.0) +
                      (Doubles(64.0) + (p_.a.angle + p_.b.angle) * Doubles(4.0)) * p_.sizes);
    // A half-space's normal is rotated with rounding, which moves points far from its position.
    if (has_half_space()) {
      p_.still_noise += Doubles(kDoubleEpsilon) * (Doubles(64.0) + p_.b.angle * Doubles(4.0)) * way;
    }
    const Doubles least = min(p_.a.extent, p_.b.extent);
    const Doubles most = max(p_.a.extent, p_.b.extent);
    p_.tolerance = select(least > Doubles(0.0), least, most) * Doubles(job_.tolerance);
  }

  [[nodiscard]] bool has_half_space() const { return tables_.b.kind == ShapeKind::half_space; }

  /// Clips the time to the interval in which the bounding balls overlap. Returns the lanes in which
  /// it is not empty.
  [[nodiscard]] DoubleMask cut_to_window() {
    const Doubles zero(0.0);
    if (has_half_space()) return p_.time <= p_.until;
    const Doubles square = dot(p_.travel, p_.travel);
    const Doubles radius = p_.sizes + span_ * Doubles(64.0 * kDoubleEpsilon);
    const DoubleMask moves = square > Doubles(1e-60) * span_ * span_;
    const Doubles over = Doubles(1.0) / select(moves, square, Doubles(1.0));
    const Doubles nearest = select(moves, -dot(p_.start, p_.travel) * over, zero);
    const Vector between = p_.start + p_.travel * nearest;
    const Doubles inside = radius * radius - dot(between, between);
    const Doubles half = sqrt(positive_part(inside) * over);
    p_.time = select(moves, max(p_.time, nearest - half), p_.time);
    p_.last = select(moves, min(p_.last, nearest + half), p_.last);
    return (inside >= zero) & (p_.time <= min(p_.last, p_.until));
  }

  /// Initialises the search for closest points. `axis` is the first direction for pairs that do not
  /// rotate.
  void begin_search() {
    const Doubles zero(0.0);
    for (int i = 0; i < kSlots; ++i) {
      p_.witness.a[i] = p_.witness.b[i] = zero_vector();
      p_.witness.present[i] = zero;
    }
    const Vector between = p_.start + p_.travel * p_.time;
    const DoubleMask there = dot(between, between) > zero;
    p_.axis = select(there, between, Vector{Doubles(1.0), zero, zero});
    p_.best = p_.best_support = zero_vector();
    if (has_guesses(tables_.a.kind, tables_.b.kind)) p_.tried.clear();
  }

  void begin(const DoubleMask& usable) {
    const Doubles zero(0.0);
    const DoubleMask near = cut_to_window();
    p_.proves = p_.within = p_.samples = zero;
    if (!has_closed_form(tables_.a.kind, tables_.b.kind)) begin_search();
    if (!is_straight(job_)) {
      p_.speed = length(p_.travel);
      p_.axis = zero_vector();
      p_.gap = Doubles(1.0);
      p_.slope = p_.curve = p_.free = p_.bend = zero;
      p_.next = p_.time;
      p_.touching = Doubles(__builtin_inf());
      p_.aim = Doubles(kFirstAim);
    }
    ImpactWriter answers(job_, tables_);
    const Mask16 here =
        lanes_below(job_.count - first_ < kDoubleLanes ? job_.count - first_ : kDoubleLanes);
    answers.put_unsure(bits(!usable) & here, zero);
    answers.put_apart(bits(usable & !near) & here);
    const Mask16 continuing_lanes = bits(usable & near) & here;
    alignas(64) double active[kDoubleLanes];
    for (int lane = 0; lane < kDoubleLanes; ++lane) {
      active[lane] = static_cast<double>(continuing_lanes >> lane & 1U);
    }
    p_.active = Doubles::load(active);
  }

  const ImpactJob& job_;
  std::uint32_t first_;
  PairLanes& p_;
  PairBlockTables& tables_;
  const ImpactQuery* query_[kDoubleLanes];
  /// By side and lane: the numbers of the motion, and the index of the shape.
  const double* motion_[2][kDoubleLanes];
  std::uint32_t index_[2][kDoubleLanes];
  Doubles span_;
};

/// Copies one lane of the members between two byte offsets.
template <std::size_t First, std::size_t Last, typename Members>
[[gnu::always_inline]] inline void move_members(const Members& from, unsigned lane_from,
                                                Members& to, unsigned lane_to) {
  const auto* const source = reinterpret_cast<const double*>(&from) + lane_from;
  auto* const target = reinterpret_cast<double*>(&to) + lane_to;
#pragma GCC unroll 64
  for (std::size_t i = First / sizeof(double); i < Last / sizeof(double); i += kDoubleLanes) {
    target[i] = source[i];
  }
}

/// Copies the lengths of a core, and its rotation or, if it does not rotate, its axes.
inline void move_core(const CoreTable& table, const MovingCore& from, unsigned lane_from,
                      MovingCore& to, unsigned lane_to) {
  constexpr std::size_t kAngle = offsetof(MovingCore, angle);
  constexpr std::size_t kCorner = offsetof(MovingCore, corner);
  constexpr std::size_t kAxes = offsetof(MovingCore, axes);
  constexpr std::size_t kExtent = offsetof(MovingCore, extent);
  if (table.turns) move_members<0, kAngle>(from, lane_from, to, lane_to);
  move_members<kAngle, kCorner>(from, lane_from, to, lane_to);
  if (has_corners(table.kind)) move_members<kCorner, kAxes>(from, lane_from, to, lane_to);
  if (!table.turns && !table.in_world) move_members<kAxes, kExtent>(from, lane_from, to, lane_to);
}

/// Sets the hull of a lane. If the target has vertex rows, copies the vertices of the hull to them,
/// or stops using the rows if the hull has more vertices.
inline void move_hull(const CoreTable& from, unsigned lane_from, CoreTable& to, unsigned lane_to) {
  to.hull[lane_to] = from.hull[lane_from];
  if (to.kind != ShapeKind::hull || to.rows == 0) return;
  if (static_cast<int>(to.hull[lane_to]->vertex_count) > to.rows) {
    to.rows = 0;
  } else {
    copy_vertices(to, lane_to);
  }
}

/// Moves a pair to another lane; copies only the members that later samples read before they write
/// them.
inline void move_lane(const ImpactJob& job, const ImpactBlock& from, unsigned lane_from,
                      ImpactBlock& to, unsigned lane_to) {
  const PairBlockTables& tables = from.tables;
  const PairLanes& source = from.lanes;
  PairLanes& target = to.lanes;
  move_core(tables.a, source.a, lane_from, target.a, lane_to);
  move_core(tables.b, source.b, lane_from, target.b, lane_to);
  constexpr std::size_t kStart = offsetof(PairLanes, start);
  constexpr std::size_t kWitness = offsetof(PairLanes, witness);
  constexpr std::size_t kTried = offsetof(PairLanes, tried);
  constexpr std::size_t kBest = offsetof(PairLanes, best);
  constexpr std::size_t kSpeed = offsetof(PairLanes, speed);
  move_members<kStart, kWitness>(source, lane_from, target, lane_to);
  if (!has_closed_form(tables.a.kind, tables.b.kind)) {
    move_members<kWitness, kTried>(source, lane_from, target, lane_to);
    if (is_straight(job)) {
      const bool guesses = has_guesses(tables.a.kind, tables.b.kind);
      if (guesses) move_members<kTried, kBest>(source, lane_from, target, lane_to);
      const bool back = uses_earlier_axes(job, tables.a.kind, tables.b.kind);
      if (back) move_members<kBest, kSpeed>(source, lane_from, target, lane_to);
    }
  }
  if (!is_straight(job))
    move_members<kSpeed, sizeof(PairLanes)>(source, lane_from, target, lane_to);
  move_hull(tables.a, lane_from, to.tables.a, lane_to);
  move_hull(tables.b, lane_from, to.tables.b, lane_to);
  to.tables.a.own[lane_to] = tables.a.own[lane_from];
  to.tables.b.own[lane_to] = tables.b.own[lane_from];
  to.tables.query[lane_to] = tables.query[lane_from];
}

/// Processes all queries of a job.
class ImpactRounds {
 public:
  explicit ImpactRounds(const ImpactJob& job) : job_(job) {
    const ImpactQuery& query = job.queries[job.order[0]];
    const ShapeKind a = query.shape[0].kind();
    const ShapeKind b = query.shape[1].kind();
    searches_ = !has_closed_form(a, b);
    has_start_ = has_start(a, b);
    tries_elsewhere_ = searches_ && (has_guesses(a, b) || uses_earlier_axes(job, a, b));
  }

  void run() {
    for (fill(); count_ > 0;) {
      for (std::uint32_t i = 0; i < count_; ++i) {
        if (active_[i] != 0) sample(i, false);
      }
      compact_lanes();
      if (count_ <= blocks_when_filled()) fill();
    }
  }

 private:
  /// Few enough that their data stay in the cache.
  static constexpr std::uint32_t kBlocks = 6;

  /// The number of active blocks at which free blocks are filled. If many blocks are filled at
  /// once, lanes are moved less often. The cost of a GJK step depends on the largest simplex of all
  /// lanes; pairs that start together have small simplices in their first steps.
  [[nodiscard]] std::uint32_t blocks_when_filled() const {
    if (!searches_) return kBlocks / 2;
    return is_straight(job_) ? 0 : 1;
  }

  /// Loads queries into free blocks, and samples each block once while it is in the cache. For some
  /// kinds, only a few pairs are active after this sample.
  void fill() {
    while (next_ < job_.count && count_ < kBlocks) {
      const std::uint32_t at = next_;
      next_ += kDoubleLanes;
      if (ImpactLoad(job_, at, block_[count_]).run() == 0) continue;
      sample(count_, true);
      if (active_[count_] == 0) continue;
      ++count_;
      compact_lanes();
    }
  }

  void sample(std::uint32_t i, bool first) {
    ImpactBlock& block = block_[i];
    if (!is_straight(job_)) {
      active_[i] = ImpactStep(job_, block, first).run();
    } else if (first && has_start_) {
      active_[i] = LinearToiSat(job_, block).run();
    } else if (tries_elsewhere_) {
      active_[i] = LinearToiGjk<true>(job_, block).run();
    } else {
      active_[i] = LinearToiGjk<false>(job_, block).run();
    }
  }

  /// Moves active lanes from the last blocks to the first ones, so that as few blocks as possible
  /// are in use.
  void compact_lanes() {
    std::uint32_t lanes = 0;
    for (std::uint32_t i = 0; i < count_; ++i) lanes += winnow::WINNOW_ISA_NAME::count(active_[i]);
    const std::uint32_t needed = (lanes + kDoubleLanes - 1) / kDoubleLanes;
    // Moving lanes takes as long as several samples in closed form.
    if (!searches_ && needed * 4 > count_ * 3) return;
    std::uint32_t to = 0;
    for (; count_ > needed; --count_) {
      const std::uint32_t from = count_ - 1;
      for (; active_[from] != 0; active_[from] &= active_[from] - 1) {
        while (active_[to] == kAllLanes<double>) ++to;
        const unsigned lane_to = first(~active_[to]);
        move_lane(job_, block_[from], first(active_[from]), block_[to], lane_to);
        active_[to] |= 1U << lane_to;
      }
    }
  }

  const ImpactJob& job_;
  bool searches_;
  /// For pairs that do not rotate: the first step is LinearToiSat.
  bool has_start_;
  /// For pairs that do not rotate: steps are LinearToiGjk<true>.
  bool tries_elsewhere_;
  /// The first query that is not loaded yet.
  std::uint32_t next_ = 0;
  std::uint32_t count_ = 0;
  Mask16 active_[kBlocks] = {};
  ImpactBlock block_[kBlocks];
};

void run_job(const ImpactJob& job) {
  if (job.count == 0) return;
  const ShapeId(&shape)[2] = job.queries[job.order[0]].shape;
  if (has_lanes(shape[0].kind()) && has_lanes(shape[1].kind())) return ImpactRounds(job).run();
  for (std::uint32_t i = 0; i < job.count; ++i) {
    job.verdicts[job.order[i]] = ImpactVerdict::unsure;
    job.found[job.order[i]].time = 0.0;
  }
}

}  // namespace
}  // namespace WINNOW_ISA_NAME::impact

extern const ImpactLaneKernels WINNOW_KERNEL_TABLE(impact_lane_kernels) = {
    WINNOW_ISA_NAME::impact::run_job};

}  // namespace winnow
