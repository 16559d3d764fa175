#pragma once

// GJK for pairs of cores of one kind each, one search per lane; the second core is placed in the
// frame of the first. Used by overlap_test.wide.h and by the curved kernels
// (curved_search.wide.h).

#include "pipeline/kernels/cores/core_lanes.wide.h"
#include "pipeline/kernels/cores/gjk_lanes.wide.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// The state of the searches in the lanes. `Points`: also stores the points of the first core from
/// which the differences were computed.
template <typename T, bool Points>
class SearchLanes : public GjkLanes<T> {
  using Base = GjkLanes<T>;

 public:
  using Base::kIsDouble;
  using Base::kWidth;
  using Base::load3;
  using Base::store3;
  using typename Base::Column;

  static constexpr std::uint32_t kMaxSteps = kIsDouble ? 60 : 20;
  /// The search ends if the bounds of the distance differ by at most kNoGain, and relative to the
  /// distance by at most kNoTurn. The relative difference is about the square of the angle by which
  /// the direction may be wrong.
  static constexpr T kNoTurn = kIsDouble ? T(1e-13) : T(1e-5F);
  /// User shapes: relative difference of the bounds at which the search ends. The direction is then
  /// wrong by less than 0.003 degrees.
  static constexpr T kUserGain = T(1e-9);

  explicit SearchLanes(bool own) : enough_(own ? kUserGain : T(0)) {}

  /// Advances the `active` lanes by one step; supports(side, d) returns the support points of the
  /// cores.
  template <typename Supports>
  [[gnu::always_inline]] SearchEnds step(Mask16 active, Supports&& supports) {
    Rules<Supports> rules{*this, supports, {}, {}};
    SearchEnds ends = Base::ends_of(Base::step(active, rules), active);
    if (Points && ends.enclosed != 0) {
      store3(rules.w, latest);
      store3(rules.mine, latest_mine);
    }
    ends.close |= Base::late(active & ~ends.all(), kMaxSteps);
    return ends;
  }

  /// From the second's frame to the first's.
  alignas(64) Column turn[9] = {};
  alignas(64) Column shift[3] = {};
  alignas(64) Column slot_mine[Points ? kSlots : 1][3] = {};
  /// The last point of a search that ended inside.
  alignas(64) Column latest[3] = {};
  alignas(64) Column latest_mine[3] = {};

 private:
  template <typename Supports>
  struct Rules {
    SearchLanes& lanes;
    Supports& supports;
    /// The support point, and the point of the first core in it.
    Vec3<T> w;
    Vec3<T> mine;

    [[gnu::always_inline]] void find(const Vec3<T>& v) {
      Lanes<T> m[9];
      for (int i = 0; i < 9; ++i) m[i] = Lanes<T>::load(lanes.turn[i]);
      mine = supports(0, -v);
      const Vec3<T> theirs = turned(m, supports(1, turned_back(m, v)));
      w = mine - (theirs + load3(lanes.shift));
    }
    [[gnu::always_inline]] LaneMask<T> ends(const Vec3<T>& /*v*/, const Lanes<T>& square,
                                            const Lanes<T>& height) const {
      return lanes.is_far(height, square);
    }
    [[gnu::always_inline]] LaneMask<T> has_no_gain(const Lanes<T>& gain,
                                                   const Lanes<T>& square) const {
      return (gain <= Lanes<T>(lanes.enough_) * square) |
             ((gain * gain <= Lanes<T>(Base::kNoGain * Base::kNoGain) * square) &
              (gain <= Lanes<T>(kNoTurn) * square));
    }
    [[gnu::always_inline]] void keep(int s, const LaneMask<T>& take) const {
      if constexpr (Points) {
        store3(select(take, mine, load3(lanes.slot_mine[s])), lanes.slot_mine[s]);
      }
    }
  };

  T enough_;
};

}  // namespace winnow::WINNOW_ISA_NAME::hull
