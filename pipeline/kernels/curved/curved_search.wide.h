#pragma once

// Closest points of pairs of cores: the algorithm of Gilbert, Johnson and Keerthi (1988) in double,
// one pair per lane, a lane that is done taking the next pair. The last support along the direction
// found bounds the distance from below, the point of the difference found bounds it from above.

#include "pipeline/kernels/curved/curved_pair.wide.h"
#include "pipeline/kernels/hull/simplex.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

using hull::kSlots;

/// Where the search may stop before it has found the closest points.
struct CurvedLimits {
  /// Stops with state far beyond this, in the caller's lengths, roundings excluded; infinite:
  /// never.
  double far;
  /// Stops with state inside where roundings surely overlap, for verdicts.
  bool verdict;
};

class CurvedSearch {
 public:
  /// Of at least one pair; all are of the same kinds.
  CurvedSearch(CurvedPair* pairs, std::uint32_t count, const CurvedLimits& limits)
      : next_(pairs),
        end_(pairs + count),
        limits_(limits),
        kind_{pairs->first.kind, pairs->second.kind} {}

  void run() {
    for (int lane = 0; lane < Doubles::kCount; ++lane) refill(lane);
    while (active_ != 0) {
      Mask16 done = step();
      for (; done != 0; done &= done - 1) {
        const int lane = static_cast<int>(first(done));
        hand_back(lane);
        refill(lane);
      }
    }
  }

 private:
  static constexpr int kWidth = Doubles::kCount;
  static constexpr std::uint32_t kMostSteps = 60;
  /// A difference of the bounds that is as good as none; squares of angles likewise.
  static constexpr double kNoGain = 2e-15;
  static constexpr double kNoTurn = 1e-13;
  /// Below this the origin counts as on the simplex.
  static constexpr double kTouching = 1e-13;
  static constexpr double kDoubt = 1e-14;

  void refill(int lane) {
    if (next_ == end_) {
      active_ &= ~(1U << lane);
      return;
    }
    CurvedPair& pair = *next_++;
    active_ |= 1U << lane;
    pair_[lane] = &pair;
    const Form* const forms[2] = {&pair.first, &pair.second};
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < Form::kNumbers; ++i) number_[side][i][lane] = forms[side]->number[i];
      hull_[side][lane] = forms[side]->hull;
    }
    for (int i = 0; i < 9; ++i) turn_[i][lane] = pair.turn[i];
    for (int i = 0; i < 3; ++i) shift_[i][lane] = pair.shift[i];
    const double far = limits_.far * pair.scale + pair.rounding + kDoubt;
    far_[lane] = far * far;
    const double near = pair.rounding - kDoubt;
    near_[lane] = limits_.verdict && near > 0.0 ? near * near : -1.0;
    for (int s = 0; s < kSlots; ++s) present_[s][lane] = 0.0;
    fresh_[lane] = 1.0;
    steps_[lane] = 0;
    // A point of the difference.
    double middle[3];
    turn3(pair.turn, pair.second.center, middle);
    double square = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double x = pair.first.center[i] - (middle[i] + pair.shift[i]);
      gap_[i][lane] = x;
      square += x * x;
    }
    if (!(square > kTouching * kTouching)) {
      gap_[0][lane] = 1.0;
      square += 1.0;
    }
    square_[lane] = square;
  }

  static Vec3<double> load3(const double (*v)[kWidth]) {
    return {Doubles::load(v[0]), Doubles::load(v[1]), Doubles::load(v[2])};
  }
  static void store3(const Vec3<double>& v, double (*to)[kWidth]) {
    v.x.store(to[0]);
    v.y.store(to[1]);
    v.z.store(to[2]);
  }

  /// The farthest point of the cores of one side along d.
  [[gnu::always_inline]] Vec3<double> support_of(int side, const Vec3<double>& d) {
    FormLanes form;
    form.kind = kind_[side];
    for (int i = 0; i < Form::kNumbers; ++i) form.number[i] = Doubles::load(number_[side][i]);
    return support(form, d, [&](const Vec3<double>& along) { return hull_supports(side, along); });
  }

  [[gnu::noinline]] Vec3<double> hull_supports(int side, const Vec3<double>& along) {
    alignas(64) double d[3][kWidth];
    alignas(64) double x[3][kWidth] = {};
    store3(along, d);
    for (Mask16 rest = active_; rest != 0; rest &= rest - 1) {
      const unsigned lane = first(rest);
      const double direction[3] = {d[0][lane], d[1][lane], d[2][lane]};
      double point[3];
      hull_support(*hull_[side][lane], direction, pair_[lane]->scale, point);
      for (int k = 0; k < 3; ++k) x[k][lane] = point[k];
    }
    return load3(x);
  }

  /// One step of all lanes; returns those that are done.
  Mask16 step() {
    const Doubles zero(0.0);
    Doubles turn[9];
    for (int i = 0; i < 9; ++i) turn[i] = Doubles::load(turn_[i]);
    hull::Simplex<double> simplex;
    for (int s = 0; s < kSlots; ++s) {
      simplex.point[s] = load3(slot_[s]);
      simplex.present[s] = Doubles::load(present_[s]) > zero;
    }
    const Vec3<double> gap = load3(gap_);
    const Doubles square = Doubles::load(square_);
    const LaneMask<double> fresh = Doubles::load(fresh_) > zero;
    const Vec3<double> mine = support_of(0, -gap);
    const Vec3<double> theirs = turned(turn, support_of(1, turned_back(turn, gap)));
    const Vec3<double> w = mine - (theirs + load3(shift_));
    const Doubles height = dot(gap, w);
    height.store(height_along_);
    const LaneMask<double> far = (height > zero) & (height * height > Doubles::load(far_) * square);

    const Doubles gain = square - height;
    const LaneMask<double> no_gain =
        (gain <= zero) | ((gain * gain <= Doubles(kNoGain * kNoGain) * square) &
                          (gain <= Doubles(kNoTurn) * square));
    const hull::SimplexNearest<double> nearest = hull::nearest_of(simplex, w);
    const Doubles next_square = dot(nearest.point, nearest.point);
    const LaneMask<double> stuck = (!fresh) &
                                   (no_gain | nearest.repeated | (next_square >= square)) &
                                   (!(nearest.inside | far));
    const LaneMask<double> inside = nearest.inside & !far;
    const LaneMask<double> moves = !(far | stuck | inside);
    const Mask16 inside_bits = bits(inside) & active_;
    if (inside_bits != 0) keep_tetrahedra(inside_bits, w, mine);
    keep(simplex, nearest, moves, w, mine, gap, next_square);
    const Mask16 far_bits = bits(far) & active_;
    const Mask16 stuck_bits = bits(stuck) & active_;
    const Mask16 move = bits(moves) & active_;
    const Mask16 near_bits = bits(next_square <= Doubles::load(near_)) & move;
    const Mask16 touch_bits =
        bits(next_square <= Doubles(kTouching * kTouching)) & move & ~near_bits;
    mark(far_bits, CurvedState::far);
    mark(stuck_bits, CurvedState::apart);
    mark(inside_bits & bits(nearest.deep), CurvedState::inside);
    mark(inside_bits & ~bits(nearest.deep), CurvedState::close);
    mark(near_bits, CurvedState::inside);
    mark(touch_bits, CurvedState::close);
    const Mask16 done = far_bits | stuck_bits | inside_bits | near_bits | touch_bits;
    return done | give_up(active_ & ~done);
  }

  Mask16 give_up(Mask16 lanes) {
    Mask16 late = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
      const unsigned lane = first(lanes);
      if (++steps_[lane] < kMostSteps) continue;
      late |= 1U << lane;
      pair_[lane]->state = CurvedState::close;
    }
    return late;
  }

  /// Where `moves`: the nearest feature becomes the simplex.
  void keep(const hull::Simplex<double>& simplex, const hull::SimplexNearest<double>& nearest,
            const LaneMask<double>& moves, const Vec3<double>& w, const Vec3<double>& mine,
            const Vec3<double>& gap, const Doubles& next_square) {
    const Doubles zero(0.0);
    const Doubles one(1.0);
    LaneMask<double> placed = !moves;
    for (int s = 0; s < kSlots; ++s) {
      const LaneMask<double> take = (!placed) & (!nearest.keep[s]);
      placed = placed | take;
      store3(select(take, w, simplex.point[s]), slot_[s]);
      store3(select(take, mine, load3(slot_mine_[s])), slot_mine_[s]);
      const Doubles held = select(take | nearest.keep[s], one, zero);
      select(moves, held, Doubles::load(present_[s])).store(present_[s]);
    }
    store3(select(moves, nearest.point, gap), gap_);
    select(moves, next_square, Doubles::load(square_)).store(square_);
    zero.store(fresh_);
  }

  void keep_tetrahedra(Mask16 lanes, const Vec3<double>& w, const Vec3<double>& mine) {
    alignas(64) double at[3][kWidth];
    alignas(64) double on[3][kWidth];
    store3(w, at);
    store3(mine, on);
    for (; lanes != 0; lanes &= lanes - 1) {
      const unsigned lane = first(lanes);
      for (int k = 0; k < 3; ++k) {
        pair_[lane]->difference[3][k] = at[k][lane];
        pair_[lane]->on_first[3][k] = on[k][lane];
      }
    }
  }

  void mark(Mask16 lanes, CurvedState state) {
    for (; lanes != 0; lanes &= lanes - 1) pair_[first(lanes)]->state = state;
  }

  void hand_back(int lane) {
    CurvedPair& pair = *pair_[lane];
    pair.count = 0;
    for (int s = 0; s < kSlots; ++s) {
      if (!(present_[s][lane] > 0.0)) continue;
      for (int k = 0; k < 3; ++k) {
        pair.difference[pair.count][k] = slot_[s][k][lane];
        pair.on_first[pair.count][k] = slot_mine_[s][k][lane];
      }
      ++pair.count;
    }
    pair.upper = __builtin_sqrt(square_[lane]);
    pair.lower = height_along_[lane] / pair.upper;
    for (int k = 0; k < 3; ++k) pair.gap[k] = gap_[k][lane];
  }

  CurvedPair* next_;
  CurvedPair* end_;
  CurvedLimits limits_;
  Mask16 active_ = 0;
  ShapeKind kind_[2];
  CurvedPair* pair_[kWidth] = {};
  const HullShape* hull_[2][kWidth] = {};
  std::uint32_t steps_[kWidth] = {};
  alignas(64) double number_[2][Form::kNumbers][kWidth] = {};
  alignas(64) double turn_[9][kWidth] = {};
  alignas(64) double shift_[3][kWidth] = {};
  alignas(64) double far_[kWidth] = {};
  alignas(64) double near_[kWidth] = {};
  alignas(64) double fresh_[kWidth] = {};
  alignas(64) double gap_[3][kWidth] = {};
  alignas(64) double square_[kWidth] = {};
  alignas(64) double height_along_[kWidth] = {};
  alignas(64) double slot_[kSlots][3][kWidth] = {};
  alignas(64) double slot_mine_[kSlots][3][kWidth] = {};
  alignas(64) double present_[kSlots][kWidth] = {};
};

}  // namespace winnow::WINNOW_ISA_NAME::curved
