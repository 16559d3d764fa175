#pragma once

// Steps of GJK (Gilbert, Johnson, Keerthi 1988), one search per lane. The height of the last
// support point bounds the distance from below; the nearest point of the simplex bounds it from
// above. Used by overlap_test.wide.h and by the curved kernels (curved_search.wide.h).

#include "pipeline/kernels/cores/core_lanes.wide.h"
#include "pipeline/kernels/cores/simplex.wide.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// The lanes whose search ended, by outcome.
struct SearchEnds {
  Mask16 far;
  Mask16 apart;
  Mask16 inside;
  Mask16 close;

  [[nodiscard]] Mask16 all() const { return far | apart | inside | close; }
};

/// The state of the searches in the lanes; lengths are about 1. `Points`: also stores the points of
/// the first core from which the differences were computed.
template <typename T, bool Points>
class SearchLanes {
 public:
  static constexpr int kWidth = Lanes<T>::kCount;
  using Column = T[kWidth];

  static constexpr bool kIsDouble = sizeof(T) == sizeof(double);
  static constexpr std::uint32_t kMaxSteps = kIsDouble ? 60 : 20;
  /// The search ends if the bounds of the distance differ by at most kNoGain, and relative to the
  /// distance by at most kNoTurn. The relative difference is about the square of the angle by which
  /// the direction may be wrong.
  static constexpr T kNoGain = kIsDouble ? T(2e-15) : T(4e-7F);
  static constexpr T kNoTurn = kIsDouble ? T(1e-13) : T(1e-5F);
  /// User shapes: relative difference of the bounds at which the search ends. The direction is then
  /// wrong by less than 0.003 degrees.
  static constexpr T kUserGain = T(1e-9);
  /// If its nearest point is closer, the simplex counts as touching the origin.
  static constexpr T kTouching = kIsDouble ? T(1e-13) : T(2e-6F);

  explicit SearchLanes(bool own) : enough_(own ? kUserGain : T(0)) {}

  /// Starts without a simplex; the caller sets the first direction.
  void start(int lane) {
    for (int s = 0; s < kSlots; ++s) present[s][lane] = T(0);
    fresh[lane] = T(1);
    steps[lane] = 0;
  }

  /// Starts from `point`, which a first step has found; `point_square` is its squared length.
  void start_from(unsigned lane, const T* point, T point_square) {
    for (int s = 0; s < kSlots; ++s) present[s][lane] = T(s == 0);
    for (int k = 0; k < 3; ++k) {
      slot[0][k][lane] = point[k];
      gap[k][lane] = point[k];
    }
    square[lane] = point_square;
    fresh[lane] = T(0);
    steps[lane] = 1;
  }

  /// Advances the `active` lanes by one step; supports(side, d) returns the support points of the
  /// cores.
  template <typename Supports>
  [[gnu::always_inline]] SearchEnds step(Mask16 active, Supports&& supports) {
    const Lanes<T> zero(T(0));
    Lanes<T> m[9];
    for (int i = 0; i < 9; ++i) m[i] = Lanes<T>::load(turn[i]);
    Simplex<T> simplex;
    for (int s = 0; s < kSlots; ++s) {
      simplex.point[s] = load3(slot[s]);
      simplex.present[s] = Lanes<T>::load(present[s]) > zero;
    }
    const Vec3<T> nearest_yet = load3(gap);
    const Lanes<T> square_yet = Lanes<T>::load(square);
    const LaneMask<T> is_fresh = Lanes<T>::load(fresh) > zero;
    const Vec3<T> mine = supports(0, -nearest_yet);
    const Vec3<T> theirs = turned(m, supports(1, turned_back(m, nearest_yet)));
    const Vec3<T> w = mine - (theirs + load3(shift));
    const Lanes<T> height = dot(nearest_yet, w);
    height.store(height_along);
    const LaneMask<T> is_far =
        (height > zero) & (height * height > Lanes<T>::load(far) * square_yet);

    const Lanes<T> gain = square_yet - height;
    const LaneMask<T> no_gain = (gain <= Lanes<T>(enough_) * square_yet) |
                                ((gain * gain <= Lanes<T>(kNoGain * kNoGain) * square_yet) &
                                 (gain <= Lanes<T>(kNoTurn) * square_yet));
    const SimplexNearest<T> nearest = nearest_of(simplex, w);
    const Lanes<T> next_square = dot(nearest.point, nearest.point);
    const LaneMask<T> stuck = (!is_fresh) &
                              (no_gain | nearest.repeated | (next_square >= square_yet)) &
                              (!(nearest.inside | is_far));
    const LaneMask<T> inside = nearest.inside & !is_far;
    const LaneMask<T> moves = !(is_far | stuck | inside);
    const Mask16 inside_bits = bits(inside) & active;
    if (Points && inside_bits != 0) {
      store3(w, latest);
      store3(mine, latest_mine);
    }
    keep(simplex, nearest, moves, w, mine, nearest_yet, next_square);
    const Mask16 move = bits(moves) & active;
    const Mask16 near_bits = bits(next_square <= Lanes<T>::load(near)) & move;
    const Mask16 touch_bits =
        bits(next_square <= Lanes<T>(kTouching * kTouching)) & move & ~near_bits;
    const Mask16 deep = bits(nearest.deep);
    SearchEnds ends{bits(is_far) & active, bits(stuck) & active, (inside_bits & deep) | near_bits,
                    (inside_bits & ~deep) | touch_bits};
    ends.close |= late(active & ~ends.all());
    return ends;
  }

  static Vec3<T> load3(const Column* v) {
    return {Lanes<T>::load(v[0]), Lanes<T>::load(v[1]), Lanes<T>::load(v[2])};
  }
  static void store3(const Vec3<T>& v, Column* to) {
    v.x.store(to[0]);
    v.y.store(to[1]);
    v.z.store(to[2]);
  }

  /// From the second's frame to the first's.
  alignas(64) Column turn[9] = {};
  alignas(64) Column shift[3] = {};
  /// Squares of distances of the cores: the shapes are apart above `far` and overlap up to `near`.
  alignas(64) Column far = {};
  alignas(64) Column near = {};
  /// 1 before the first step.
  alignas(64) Column fresh = {};
  /// The nearest point of the simplex, and its square.
  alignas(64) Column gap[3] = {};
  alignas(64) Column square = {};
  alignas(64) Column height_along = {};
  /// The simplex; `present` is 1 where there is a point.
  alignas(64) Column slot[kSlots][3] = {};
  alignas(64) Column slot_mine[Points ? kSlots : 1][3] = {};
  alignas(64) Column present[kSlots] = {};
  /// The last point of a search that ended inside.
  alignas(64) Column latest[3] = {};
  alignas(64) Column latest_mine[3] = {};
  std::uint32_t steps[kWidth] = {};

 private:
  Mask16 late(Mask16 lanes) {
    Mask16 r = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
      const unsigned lane = first(lanes);
      if (++steps[lane] >= kMaxSteps) r |= 1U << lane;
    }
    return r;
  }

  /// In the lanes `moves`, the nearest feature becomes the simplex.
  [[gnu::always_inline]] void keep(const Simplex<T>& simplex, const SimplexNearest<T>& nearest,
                                   const LaneMask<T>& moves, const Vec3<T>& w, const Vec3<T>& mine,
                                   const Vec3<T>& nearest_yet, const Lanes<T>& next_square) {
    const Lanes<T> zero(T(0));
    const Lanes<T> one(T(1));
    LaneMask<T> placed = !moves;
    for (int s = 0; s < kSlots; ++s) {
      const LaneMask<T> take = (!placed) & (!nearest.keep[s]);
      placed = placed | take;
      store3(select(take, w, simplex.point[s]), slot[s]);
      if constexpr (Points) store3(select(take, mine, load3(slot_mine[s])), slot_mine[s]);
      const Lanes<T> filled = select(take | nearest.keep[s], one, zero);
      select(moves, filled, Lanes<T>::load(present[s])).store(present[s]);
    }
    store3(select(moves, nearest.point, nearest_yet), gap);
    select(moves, next_square, Lanes<T>::load(square)).store(square);
    zero.store(fresh);
  }

  T enough_;
};

}  // namespace winnow::WINNOW_ISA_NAME::hull
