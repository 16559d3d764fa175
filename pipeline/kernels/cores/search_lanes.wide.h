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
class SearchLanes : public SimplexColumns<T> {
  using Base = SimplexColumns<T>;

 public:
  using Base::fresh;
  using Base::gap;
  using Base::kWidth;
  using Base::load3;
  using Base::present;
  using Base::slot;
  using Base::square;
  using Base::store3;
  using typename Base::Column;

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
  void start(unsigned lane) {
    Base::clear(lane);
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
    const Simplex<T> simplex = Base::load();
    const Vec3<T> nearest_yet = load3(gap);
    const Lanes<T> square_yet = Lanes<T>::load(square);
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
    const auto found = Base::add(simplex, w, nearest_yet, square_yet, is_far, no_gain,
                                 [&](int s, const LaneMask<T>& take) {
                                   if constexpr (Points) {
                                     store3(select(take, mine, load3(slot_mine[s])), slot_mine[s]);
                                   }
                                 });
    const Mask16 inside_bits = bits(found.inside) & active;
    if (Points && inside_bits != 0) {
      store3(w, latest);
      store3(mine, latest_mine);
    }
    const Mask16 move = bits(found.moves) & active;
    const Mask16 near_bits = bits(found.square <= Lanes<T>::load(near)) & move;
    const Mask16 touch_bits =
        bits(found.square <= Lanes<T>(kTouching * kTouching)) & move & ~near_bits;
    const Mask16 deep = bits(found.deep);
    SearchEnds ends{bits(is_far) & active, bits(found.stuck) & active,
                    (inside_bits & deep) | near_bits, (inside_bits & ~deep) | touch_bits};
    ends.close |= late(active & ~ends.all());
    return ends;
  }

  /// From the second's frame to the first's.
  alignas(64) Column turn[9] = {};
  alignas(64) Column shift[3] = {};
  /// Squares of distances of the cores: the shapes are apart above `far` and overlap up to `near`.
  alignas(64) Column far = {};
  alignas(64) Column near = {};
  alignas(64) Column height_along = {};
  alignas(64) Column slot_mine[Points ? kSlots : 1][3] = {};
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

  T enough_;
};

}  // namespace winnow::WINNOW_ISA_NAME::hull
