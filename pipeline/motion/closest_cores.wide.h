#pragma once

// Closest points of two cores in each lane: GJK (Gilbert, Johnson and Keerthi 1988) in double,
// started from the simplex with which the lane's last search ended (warm start).

#include "pipeline/kernels/cores/gjk_lanes.wide.h"
#include "pipeline/motion/moving_cores.wide.h"

namespace winnow::WINNOW_ISA_NAME::impact {

inline constexpr int kSlots = hull::kSlots;

/// The support points of both cores that form the simplex, each in its core's frame (LinearToiGjk
/// stores them differently). If any slot is in use, slot 0 is.
struct SimplexLanes {
  Vector a[kSlots];
  Vector b[kSlots];
  /// 1 where the slot is in use, else 0.
  Doubles present[kSlots];
};

/// Two placed cores.
struct CorePair {
  const CoreTable& table_a;
  const CoreTable& table_b;
  const MovingCore& a;
  const MovingCore& b;
  /// From the centre of a to the centre of b.
  const Vector& between;

  [[gnu::always_inline]] Vector to_world(const CoreTable& table, const MovingCore& core,
                                         const Vector& v) const {
    return table.in_world ? v : core.axes.to_world(v);
  }
  [[gnu::always_inline]] Vector on_a(const Vector& own) const { return to_world(table_a, a, own); }
  /// Relative to the centre of b.
  [[gnu::always_inline]] Vector on_b(const Vector& own) const { return to_world(table_b, b, own); }
  [[gnu::always_inline]] Vector own_facing(const CoreTable& table, const MovingCore& core,
                                           const Vector& direction, Mask16 lanes) const {
    const Vector own = table.in_world ? direction : core.axes.to_local(direction);
    return farthest(table, core, own, lanes);
  }
  /// Computes the support point of a along a direction and the support point of b along the
  /// opposite direction, each in the frame of its core.
  [[gnu::always_inline]] void facing(const Vector& direction, Mask16 lanes, Vector& own_a,
                                     Vector& own_b) const {
    own_a = own_facing(table_a, a, direction, lanes);
    own_b = own_facing(table_b, b, -direction, lanes);
  }
  /// Support of a core along a direction, from its centre.
  [[gnu::always_inline]] Doubles height(const CoreTable& table, const MovingCore& core,
                                        const Vector& direction, Mask16 lanes) const {
    return with_core(
        table.kind, [&](auto kind) __attribute__((always_inline))->Doubles {
          if constexpr (requires { kind.height(core, direction); }) {
            return kind.height(core, direction);
          } else {
            const Vector own = table.in_world ? direction : core.axes.to_local(direction);
            return dot(own, kind.farthest(table, core, own, lanes));
          }
        });
  }
};

/// Bounds on the distance of the placed cores of each lane.
struct ClosestLanes {
  /// A unit direction from a to b along which the cores are separated by `lower`. `high_a` is the
  /// support of a along it, `high_b` the support of b along the opposite, from their centres.
  Vector axis;
  Doubles lower;
  Doubles high_a;
  Doubles high_b;
  /// The vector from a point of a to a point of b, and its length: an upper bound on the distance.
  Vector between;
  Doubles upper;
  /// The points that `between` connects, each relative to the centre of its core.
  Vector on_a;
  Vector on_b;
};

/// Required accuracy of a distance.
struct ClosestOptions {
  /// The gap of a pair is the distance of its cores minus `roundings`, the sum of the rounding
  /// radii. If the gap is greater than `precise`, the search ends when the bounds of the distance
  /// differ by at most share * gap.
  double share;
  const Doubles& roundings;
  const Doubles& precise;
  /// For any gap, the search ends when the bounds of the distance differ by at most this.
  const Doubles& noise;
};

/// If the new support point is already in the simplex, a difference of the bounds of the distance
/// by at most this fraction of the distance minus `roundings` is attributed to rounding, and the
/// search ends.
inline constexpr double kRounding = 1e-2;

/// Removes the points equal to `w` from a simplex, so that no point is in it twice after `w` is
/// added. Returns the lanes that had such a point.
[[nodiscard]] static inline DoubleMask drop_repeated(const Vector (&point)[kSlots], const Vector& w,
                                                     DoubleMask (&present)[kSlots]) {
  DoubleMask dropped = w.x < w.x;
  for (int s = 0; s < kSlots; ++s) {
    const Vector& p = point[s];
    const DoubleMask same = (p.x == w.x) & (p.y == w.y) & (p.z == w.z);
    dropped = dropped | (present[s] & same);
    present[s] = present[s] & !same;
  }
  return dropped;
}

/// A point of a simplex, given by the weights of the points in slots 1 and 2 of the simplex.
struct Shares {
  Doubles s;
  Doubles t;

  [[nodiscard]] [[gnu::always_inline]] Vector of(const Vector (&point)[kSlots]) const {
    return point[0] + (point[1] - point[0]) * s + (point[2] - point[0]) * t;
  }
};

/// Returns the weights of the point `gap` of a simplex.
[[nodiscard]] static inline Shares shares_of(const hull::Simplex<double>& simplex,
                                             const Vector& gap) {
  const Doubles zero(0.0);
  const Doubles one(1.0);
  Vector edge[2];
  Doubles square[2];
  Doubles along[2];
  const Vector from = gap - simplex.point[0];
  for (int i = 0; i < 2; ++i) {
    const DoubleMask present = simplex.present[i + 1];
    edge[i] = select(present, simplex.point[i + 1] - simplex.point[0], zero_vector());
    square[i] = select(present, dot(edge[i], edge[i]), one);
    along[i] = dot(edge[i], from);
  }
  const Doubles mixed = dot(edge[0], edge[1]);
  const Doubles area = square[0] * square[1] - mixed * mixed;
  const DoubleMask wide = area > square[0] * square[1] * Doubles(1e-14);
  const Doubles over = one / select(wide, area, one);
  return {select(wide, (along[0] * square[1] - along[1] * mixed) * over, along[0] / square[0]),
          select(wide, (along[1] * square[0] - along[0] * mixed) * over, zero)};
}

class ClosestSearch {
 public:
  ClosestSearch(const CorePair& pair, const ClosestOptions& options, SimplexLanes& witness)
      : pair_(pair), options_(options), witness_(witness) {}

  /// Runs at most `most_steps` steps; the bounds are valid in any case.
  [[nodiscard]] ClosestLanes run(const DoubleMask& lanes, int most_steps) {
    begin();
    open_ = lanes;
    for (int step = 0; bits(open_) != 0 && step < most_steps; ++step) advance();
    finish();
    return found_;
  }

 private:
  /// A search that stalls is restarted once, with an empty simplex, if the bounds of the distance
  /// differ by more than this many times the accepted difference.
  static constexpr double kLost = 4.0;

  /// Starts from the old simplex, with its points at their new positions, reduced to the nearest
  /// feature that contains the point in slot 0. Without an old simplex, starts along the vector
  /// between the centres.
  void begin() {
    const Doubles zero(0.0);
    const Vector from = select(dot(pair_.between, pair_.between) > zero, pair_.between,
                               Vector{Doubles(1.0), zero, zero});
    found_.lower = Doubles(-__builtin_inf());
    found_.axis = zero_vector();
    found_.high_a = found_.high_b = zero;
    for (int s = 0; s < kSlots; ++s) simplex_.present[s] = witness_.present[s] > zero;
    const DoubleMask kept = simplex_.present[0];
    fresh_ = !kept;
    begun_anew_ = zero > zero;
    gap_ = from;
    if (bits(kept) == 0) return;
    for (int s = 0; s < kSlots; ++s) {
      simplex_.point[s] = pair_.between + pair_.on_b(witness_.b[s]) - pair_.on_a(witness_.a[s]);
    }
    hull::Simplex<double> others = simplex_;
    others.present[0] = zero > Doubles(1.0);
    const auto nearest = hull::nearest_of_few(others, simplex_.point[0], kept);
    gap_ = select(kept, nearest.point, from);
    for (int s = 1; s < kSlots; ++s) {
      simplex_.present[s] = simplex_.present[s] & nearest.keep[s];
    }
  }

  void advance() {
    const Doubles square = dot(gap_, gap_);
    const Doubles distance = sqrt(square);
    Vector own_a;
    Vector own_b;
    pair_.facing(gap_, bits(open_), own_a, own_b);
    const Vector on_a = pair_.on_a(own_a);
    const Vector on_b = pair_.on_b(own_b);
    const Vector w = pair_.between + on_b - on_a;
    const Doubles reach = dot(gap_, w);
    note(distance, reach, on_a, on_b);

    const Doubles gain = square - reach;
    const Doubles left = distance - options_.roundings;
    const Doubles share = select(left > options_.precise, Doubles(options_.share), Doubles(0.0));
    const Doubles known = max(options_.noise, share * left) * distance;
    hull::Simplex<double> others = simplex_;
    const DoubleMask repeated = drop_repeated(others.point, w, others.present);
    const DoubleMask ends = (gain <= Doubles(kRounding) * distance * left) & repeated;
    const DoubleMask close = (!fresh_) & ((gain <= known) | ends);
    if (bits(open_ & !close) == 0) {
      open_ = fresh_ & !fresh_;
      return;
    }
    const auto put = [&](int s, const DoubleMask& take, const DoubleMask& used) {
      simplex_.point[s] = select(take, w, simplex_.point[s]);
      simplex_.present[s] = used;
      witness_.a[s] = select(take, own_a, witness_.a[s]);
      witness_.b[s] = select(take, own_b, witness_.b[s]);
    };
    const auto step = hull::take_step(simplex_.present, hull::nearest_of_few(others, w, open_),
                                      square, fresh_, close | !open_, open_ & !open_, gap_, put);
    fresh_ = fresh_ & !step.moves;
    const DoubleMask lost = step.stuck & (gain > known * Doubles(kLost)) & !begun_anew_;
    open_ = step.moves | lost;
    if (bits(lost) != 0) begin_anew(lost);
  }

  /// Keeps the axis with the largest lower bound.
  void note(const Doubles& distance, const Doubles& reach, const Vector& on_a, const Vector& on_b) {
    const DoubleMask better = open_ & (reach > found_.lower * distance);
    const Doubles over = Doubles(1.0) / distance;
    const Vector axis = gap_ * over;
    found_.lower = select(better, reach * over, found_.lower);
    found_.axis = select(better, axis, found_.axis);
    found_.high_a = select(better, dot(axis, on_a), found_.high_a);
    found_.high_b = select(better, -dot(axis, on_b), found_.high_b);
  }

  void begin_anew(const DoubleMask& lanes) {
    begun_anew_ = begun_anew_ | lanes;
    fresh_ = fresh_ | lanes;
    for (DoubleMask& present : simplex_.present) present = present & !lanes;
  }

  void finish() {
    found_.between = gap_;
    found_.upper = length(gap_);
    const Shares shares = shares_of(simplex_, gap_);
    found_.on_a = pair_.on_a(shares.of(witness_.a));
    found_.on_b = pair_.on_b(shares.of(witness_.b));
    for (int i = 0; i < kSlots; ++i) witness_.present[i] = one_where(simplex_.present[i]);
  }

  const CorePair& pair_;
  const ClosestOptions& options_;
  SimplexLanes& witness_;
  ClosestLanes found_;
  hull::Simplex<double> simplex_;
  /// The vector between the closest points found. While there is no simplex, the first search
  /// direction.
  Vector gap_;
  /// There is no simplex yet.
  DoubleMask fresh_;
  DoubleMask open_;
  DoubleMask begun_anew_;
};

}  // namespace winnow::WINNOW_ISA_NAME::impact
