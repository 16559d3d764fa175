#pragma once

// Closest points of pairs of cores: the algorithm of Gilbert, Johnson and Keerthi (1988) in double,
// one pair per lane, a lane that is done taking the next pair. The last support along the direction
// found bounds the distance from below, the point of the difference found bounds it from above.

#include "pipeline/kernels/curved/farthest_points.wide.h"
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

/// In double, or in float, whose states far and inside are sure too.
template <typename T>
class CurvedSearch {
 public:
  /// Of at least one pair; all are of the same kinds.
  CurvedSearch(CurvedPair* pairs, std::uint32_t count, const CurvedLimits& limits)
      : next_(pairs),
        end_(pairs + count),
        limits_(limits),
        kind_{pairs->first.kind, pairs->second.kind},
        enough_(has_own(*pairs) ? kOwnGain : T(0)) {}

  void run() {
    for (int lane = 0; lane < Lanes<T>::kCount; ++lane) refill(lane);
    while (active_ != 0) {
      Mask16 done = step();
      for (; done != 0; done &= done - 1) {
        const int lane = static_cast<int>(first(done));
        if (goes_again(lane)) {
          start(lane, kAskew);
          begin_beside(lane);
        } else {
          hand_back(lane);
          refill(lane);
        }
      }
    }
  }

 private:
  static constexpr bool kIsDouble = sizeof(T) == sizeof(double);
  static constexpr int kWidth = Lanes<T>::kCount;
  static constexpr std::uint32_t kMostSteps = kIsDouble ? 60 : 20;
  /// A difference of the bounds that is as good as none; squares of angles likewise.
  static constexpr T kNoGain = kIsDouble ? T(2e-15) : T(4e-7F);
  static constexpr T kNoTurn = kIsDouble ? T(1e-13) : T(1e-5F);
  /// Over the distance, what bounds of that of a program's own sets may differ by: their directions
  /// then by less than 0.003 degrees.
  static constexpr T kOwnGain = T(1e-9);
  /// Below this the origin counts as on the simplex.
  static constexpr T kTouching = kIsDouble ? T(1e-13) : T(2e-6F);
  static constexpr double kDoubt = kIsDouble ? 1e-14 : 8e-6;

  static constexpr double kAskew[3] = {0.3125, -0.234375, 0.171875};
  static constexpr double kBeside[3] = {-0.21875, 0.15625, 0.40625};

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
      for (int i = 0; i < Form::kNumbers; ++i) {
        number_[side][i][lane] = static_cast<T>(forms[side]->number[i]);
      }
    }
    for (int i = 0; i < 9; ++i) turn_[i][lane] = static_cast<T>(pair.turn[i]);
    for (int i = 0; i < 3; ++i) shift_[i][lane] = static_cast<T>(pair.shift[i]);
    const double far = limits_.far * pair.scale + pair.rounding + kDoubt;
    far_[lane] = static_cast<T>(far * far);
    const double near = pair.rounding - kDoubt;
    near_[lane] = limits_.verdict && near > 0.0 ? static_cast<T>(near * near) : T(-1);
    is_askew_[lane] = false;
    constexpr double straight[3] = {0.0, 0.0, 0.0};
    start(lane, straight);
  }

  /// Where shapes are aligned the origin may lie on an edge or a face of the simplex though the
  /// cores overlap. From elsewhere it does not.
  bool goes_again(int lane) {
    if (pair_[lane]->state != CurvedState::close || is_askew_[lane]) return false;
    is_askew_[lane] = true;
    return true;
  }

  /// From a point of the difference, moved by `aside` times the sizes.
  void start(int lane, const double* aside) {
    const CurvedPair& pair = *pair_[lane];
    for (int s = 0; s < kSlots; ++s) present_[s][lane] = T(0);
    fresh_[lane] = T(1);
    steps_[lane] = 0;
    double middle[3];
    turn3(pair.turn, pair.second.center, middle);
    double square = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double x = pair.first.center[i] - (middle[i] + pair.shift[i]) + aside[i] * pair.size;
      gap_[i][lane] = static_cast<T>(x);
      square += x * x;
    }
    if (!(square > static_cast<double>(kTouching * kTouching))) {
      gap_[0][lane] = T(1);
      square += 1.0;
    }
    square_[lane] = static_cast<T>(square);
  }

  /// Takes a point of the difference that is farthest along a direction of its own: of two balls
  /// all points that are found from one direction on are in one plane with the origin.
  void begin_beside(int lane) {
    double w[3];
    double mine[3];
    difference_point(*pair_[lane], kBeside, w, mine);
    for (int k = 0; k < 3; ++k) {
      slot_[0][k][lane] = static_cast<T>(w[k]);
      slot_mine_[0][k][lane] = static_cast<T>(mine[k]);
    }
    present_[0][lane] = T(1);
  }

  static Vec3<T> load3(const T (*v)[kWidth]) {
    return {Lanes<T>::load(v[0]), Lanes<T>::load(v[1]), Lanes<T>::load(v[2])};
  }
  static void store3(const Vec3<T>& v, T (*to)[kWidth]) {
    v.x.store(to[0]);
    v.y.store(to[1]);
    v.z.store(to[2]);
  }

  /// The farthest point of the cores of one side along d.
  [[gnu::always_inline]] Vec3<T> support_of(int side, const Vec3<T>& d) {
    FormLanes<T> form;
    form.kind = kind_[side];
    for (int i = 0; i < Form::kNumbers; ++i) form.number[i] = Lanes<T>::load(number_[side][i]);
    return support(form, d, [&](const Vec3<T>& along) { return one_by_one(side, along); });
  }

  [[gnu::noinline]] Vec3<T> one_by_one(int side, const Vec3<T>& along) {
    alignas(64) T d[3][kWidth];
    alignas(64) T x[3][kWidth] = {};
    store3(along, d);
    for (Mask16 rest = active_; rest != 0; rest &= rest - 1) {
      const unsigned lane = first(rest);
      const T direction[3] = {d[0][lane], d[1][lane], d[2][lane]};
      T point[3];
      const CurvedPair& pair = *pair_[lane];
      single_support(side == 0 ? pair.first : pair.second, direction, static_cast<T>(pair.scale),
                     point);
      for (int k = 0; k < 3; ++k) x[k][lane] = point[k];
    }
    return load3(x);
  }

  /// One step of all lanes; returns those that are done.
  Mask16 step() {
    const Lanes<T> zero(T(0));
    Lanes<T> turn[9];
    for (int i = 0; i < 9; ++i) turn[i] = Lanes<T>::load(turn_[i]);
    hull::Simplex<T> simplex;
    for (int s = 0; s < kSlots; ++s) {
      simplex.point[s] = load3(slot_[s]);
      simplex.present[s] = Lanes<T>::load(present_[s]) > zero;
    }
    const Vec3<T> gap = load3(gap_);
    const Lanes<T> square = Lanes<T>::load(square_);
    const LaneMask<T> fresh = Lanes<T>::load(fresh_) > zero;
    const Vec3<T> mine = support_of(0, -gap);
    const Vec3<T> theirs = turned(turn, support_of(1, turned_back(turn, gap)));
    const Vec3<T> w = mine - (theirs + load3(shift_));
    const Lanes<T> height = dot(gap, w);
    height.store(height_along_);
    const LaneMask<T> far = (height > zero) & (height * height > Lanes<T>::load(far_) * square);

    const Lanes<T> gain = square - height;
    const LaneMask<T> no_gain = (gain <= Lanes<T>(enough_) * square) |
                                ((gain * gain <= Lanes<T>(kNoGain * kNoGain) * square) &
                                 (gain <= Lanes<T>(kNoTurn) * square));
    const hull::SimplexNearest<T> nearest = hull::nearest_of(simplex, w);
    const Lanes<T> next_square = dot(nearest.point, nearest.point);
    const LaneMask<T> stuck = (!fresh) & (no_gain | nearest.repeated | (next_square >= square)) &
                              (!(nearest.inside | far));
    const LaneMask<T> inside = nearest.inside & !far;
    const LaneMask<T> moves = !(far | stuck | inside);
    const Mask16 inside_bits = bits(inside) & active_;
    if (inside_bits != 0) keep_tetrahedra(inside_bits, w, mine);
    keep(simplex, nearest, moves, w, mine, gap, next_square);
    const Mask16 far_bits = bits(far) & active_;
    const Mask16 stuck_bits = bits(stuck) & active_;
    const Mask16 move = bits(moves) & active_;
    const Mask16 near_bits = bits(next_square <= Lanes<T>::load(near_)) & move;
    const Mask16 touch_bits =
        bits(next_square <= Lanes<T>(kTouching * kTouching)) & move & ~near_bits;
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
  void keep(const hull::Simplex<T>& simplex, const hull::SimplexNearest<T>& nearest,
            const LaneMask<T>& moves, const Vec3<T>& w, const Vec3<T>& mine, const Vec3<T>& gap,
            const Lanes<T>& next_square) {
    const Lanes<T> zero(T(0));
    const Lanes<T> one(T(1));
    LaneMask<T> placed = !moves;
    for (int s = 0; s < kSlots; ++s) {
      const LaneMask<T> take = (!placed) & (!nearest.keep[s]);
      placed = placed | take;
      store3(select(take, w, simplex.point[s]), slot_[s]);
      store3(select(take, mine, load3(slot_mine_[s])), slot_mine_[s]);
      const Lanes<T> held = select(take | nearest.keep[s], one, zero);
      select(moves, held, Lanes<T>::load(present_[s])).store(present_[s]);
    }
    store3(select(moves, nearest.point, gap), gap_);
    select(moves, next_square, Lanes<T>::load(square_)).store(square_);
    zero.store(fresh_);
  }

  void keep_tetrahedra(Mask16 lanes, const Vec3<T>& w, const Vec3<T>& mine) {
    alignas(64) T at[3][kWidth];
    alignas(64) T on[3][kWidth];
    store3(w, at);
    store3(mine, on);
    for (; lanes != 0; lanes &= lanes - 1) {
      const unsigned lane = first(lanes);
      for (int k = 0; k < 3; ++k) {
        pair_[lane]->difference[3][k] = static_cast<double>(at[k][lane]);
        pair_[lane]->on_first[3][k] = static_cast<double>(on[k][lane]);
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
      if (!(present_[s][lane] > T(0))) continue;
      for (int k = 0; k < 3; ++k) {
        pair.difference[pair.count][k] = static_cast<double>(slot_[s][k][lane]);
        pair.on_first[pair.count][k] = static_cast<double>(slot_mine_[s][k][lane]);
      }
      ++pair.count;
    }
    pair.upper = __builtin_sqrt(static_cast<double>(square_[lane]));
    pair.lower = static_cast<double>(height_along_[lane]) / pair.upper;
    for (int k = 0; k < 3; ++k) pair.gap[k] = static_cast<double>(gap_[k][lane]);
  }

  CurvedPair* next_;
  CurvedPair* end_;
  CurvedLimits limits_;
  Mask16 active_ = 0;
  ShapeKind kind_[2];
  T enough_;
  CurvedPair* pair_[kWidth] = {};
  std::uint32_t steps_[kWidth] = {};
  bool is_askew_[kWidth] = {};
  alignas(64) T number_[2][Form::kNumbers][kWidth] = {};
  alignas(64) T turn_[9][kWidth] = {};
  alignas(64) T shift_[3][kWidth] = {};
  alignas(64) T far_[kWidth] = {};
  alignas(64) T near_[kWidth] = {};
  alignas(64) T fresh_[kWidth] = {};
  alignas(64) T gap_[3][kWidth] = {};
  alignas(64) T square_[kWidth] = {};
  alignas(64) T height_along_[kWidth] = {};
  alignas(64) T slot_[kSlots][3][kWidth] = {};
  alignas(64) T slot_mine_[kSlots][3][kWidth] = {};
  alignas(64) T present_[kSlots][kWidth] = {};
};

}  // namespace winnow::WINNOW_ISA_NAME::curved
