#pragma once

// GJK (Gilbert, Johnson, Keerthi 1988), one search per lane: the step that all searches in lanes
// share (`take_step`). The height of the last support point bounds the distance from below; the
// nearest point of the simplex bounds it from above. GjkLanes stores the simplices in columns, for
// search_lanes.wide.h and hull_gjk.wide.h; the searches of moving cores keep them in registers.

#include "pipeline/kernels/cores/simplex.wide.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// The outcome of a step, by lane.
template <typename T>
struct GjkStep {
  /// The search ended before the support point was added.
  LaneMask<T> ended;
  /// The search makes no progress; the origin is in the simplex, with the new point; the nearest
  /// feature becomes the simplex.
  LaneMask<T> stuck;
  LaneMask<T> inside;
  LaneMask<T> moves;
  /// Squared distance of the nearest feature.
  Lanes<T> square;
  /// The origin is certainly in the simplex.
  LaneMask<T> deep;
};

/// Replaces simplices, whose slots `present` are in use, by their nearest features in the lanes
/// that proceed: put(slot, lanes that store the new point there, lanes in which the slot is then in
/// use). `gap` is the nearest point before and after the step, `square_yet` its squared length
/// before. `fresh`: there was no simplex; `no_gain`: the new point is hardly nearer to the origin
/// than `gap`.
template <typename T, typename Put>
[[gnu::always_inline]] inline GjkStep<T> take_step(
    const LaneMask<T> (&present)[kSlots], const SimplexNearest<T>& nearest,
    const Lanes<T>& square_yet, const LaneMask<T>& fresh, const LaneMask<T>& ended,
    const LaneMask<T>& no_gain, Vec3<T>& gap, Put&& put) {
  const Lanes<T> square = dot(nearest.point, nearest.point);
  const LaneMask<T> stuck = (!fresh) & (no_gain | nearest.repeated | (square >= square_yet)) &
                            (!(nearest.inside | ended));
  const LaneMask<T> moves = !(ended | stuck | nearest.inside);
  LaneMask<T> placed = !moves;
  for (int s = 0; s < kSlots; ++s) {
    const LaneMask<T> take = (!placed) & (!nearest.keep[s]);
    placed = placed | take;
    put(s, take, (moves & (take | nearest.keep[s])) | ((!moves) & present[s]));
  }
  gap = select(moves, nearest.point, gap);
  return {ended, stuck, nearest.inside & !ended, moves, square, nearest.deep};
}

/// The lanes whose search ended, by outcome.
struct SearchEnds {
  Mask16 far;
  Mask16 apart;
  Mask16 inside;
  Mask16 close;
  /// The simplex contains the origin; part of `inside` and `close`.
  Mask16 enclosed;

  [[nodiscard]] Mask16 all() const { return far | apart | inside | close; }
};

/// Pairs in the lanes, and pairs that wait for a lane.
template <typename Pair, int Width>
class LanePairs {
 public:
  LanePairs(Pair* pairs, std::uint32_t count) : next_(pairs), end_(pairs + count) {}

  /// Puts the next pair into a lane and returns it; if there is none, the lane becomes inactive.
  Pair* refill(unsigned lane) {
    if (next_ == end_) {
      active_ &= ~(1U << lane);
      return nullptr;
    }
    active_ |= 1U << lane;
    return pair_[lane] = next_++;
  }

  template <typename State>
  void mark(Mask16 lanes, State state) {
    for (; lanes != 0; lanes &= lanes - 1) pair_[first(lanes)]->state = state;
  }

  [[nodiscard]] Mask16 active() const { return active_; }
  Pair& operator[](unsigned lane) const { return *pair_[lane]; }

 private:
  Pair* next_;
  Pair* end_;
  Mask16 active_ = 0;
  Pair* pair_[Width] = {};
};

/// The state of the searches in the lanes; lengths are about 1.
template <typename T>
class GjkLanes {
 public:
  static constexpr int kWidth = Lanes<T>::kCount;
  static constexpr bool kIsDouble = sizeof(T) == sizeof(double);
  /// The search ends if the bounds of the distance differ by at most this.
  static constexpr T kNoGain = kIsDouble ? T(2e-15) : T(4e-7F);
  /// If its nearest point is closer, the simplex counts as touching the origin.
  static constexpr T kTouching = kIsDouble ? T(1e-13) : T(2e-6F);
  using Column = T[kWidth];

  /// Starts without a simplex; the caller sets the first direction.
  void start(unsigned lane) {
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

  /// Advances the `active` lanes by one step: adds a support point to the simplex of each lane and
  /// keeps the feature that is nearest to the origin. `Rules` defines the search:
  /// - find(v) computes `w`, the support point of the difference against v.
  /// - ends(v, v . v, v . w) returns the lanes that end at w.
  /// - has_no_gain(v . v - v . w, v . v) returns the lanes without progress.
  /// - keep(slot, lanes) stores more about w in the lanes in which w enters the slot.
  template <typename Rules>
  [[gnu::always_inline]] GjkStep<T> step(Mask16 active, Rules& rules) {
    const Lanes<T> zero(T(0));
    const Lanes<T> one(T(1));
    const Simplex<T> simplex = load();
    Vec3<T> v = load3(gap);
    const Lanes<T> square_yet = Lanes<T>::load(square);
    rules.find(v);
    const Lanes<T> height = dot(v, rules.w);
    height.store(height_along);
    const LaneMask<T> ended = rules.ends(v, square_yet, height);
    if ((active & ~bits(ended)) == 0) {
      const LaneMask<T> none = zero > one;
      return {ended, none, none, none, square_yet, none};
    }
    const LaneMask<T> no_gain = rules.has_no_gain(square_yet - height, square_yet);
    const auto put = [&](int s, const LaneMask<T>& take, const LaneMask<T>& used) {
      store3(select(take, rules.w, simplex.point[s]), slot[s]);
      rules.keep(s, take);
      select(used, one, zero).store(present[s]);
    };
    const GjkStep<T> r = take_step(simplex.present, nearest_of(simplex, rules.w), square_yet,
                                   Lanes<T>::load(fresh) > zero, ended, no_gain, v, put);
    store3(v, gap);
    select(r.moves, r.square, square_yet).store(square);
    zero.store(fresh);
    return r;
  }

  /// The lanes in which the support point is beyond `far`.
  [[gnu::always_inline]] LaneMask<T> is_far(const Lanes<T>& height,
                                            const Lanes<T>& square_yet) const {
    return (height > Lanes<T>(T(0))) & (height * height > Lanes<T>::load(far) * square_yet);
  }

  /// The outcome of a step whose `ended` lanes are far.
  [[gnu::always_inline]] SearchEnds ends_of(const GjkStep<T>& step, Mask16 active) const {
    const Mask16 enclosed = bits(step.inside) & active;
    const Mask16 deep = bits(step.deep);
    const Mask16 moving = bits(step.moves) & active;
    const Mask16 near_bits = bits(step.square <= Lanes<T>::load(near)) & moving;
    const Mask16 touch_bits =
        bits(step.square <= Lanes<T>(kTouching * kTouching)) & moving & ~near_bits;
    return {bits(step.ended) & active, bits(step.stuck) & active, (enclosed & deep) | near_bits,
            (enclosed & ~deep) | touch_bits, enclosed};
  }

  /// Counts a step of `lanes`; returns those that have made `most` steps.
  Mask16 late(Mask16 lanes, std::uint32_t most) {
    Mask16 r = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
      const unsigned lane = first(lanes);
      if (++steps[lane] >= most) r |= 1U << lane;
    }
    return r;
  }

  /// Vectors of lanes that are computed one after the other: compute(lane, argument, result).
  template <typename Compute>
  [[gnu::always_inline]] static Vec3<T> one_by_one(const Vec3<T>& arguments, Mask16 lanes,
                                                   Compute&& compute) {
    alignas(64) T d[3][kWidth];
    alignas(64) T x[3][kWidth] = {};
    store3(arguments, d);
    for (; lanes != 0; lanes &= lanes - 1) {
      const unsigned lane = first(lanes);
      const T argument[3] = {d[0][lane], d[1][lane], d[2][lane]};
      T result[3];
      compute(lane, argument, result);
      for (int k = 0; k < 3; ++k) x[k][lane] = result[k];
    }
    return load3(x);
  }

  [[nodiscard]] [[gnu::always_inline]] Simplex<T> load() const {
    Simplex<T> simplex;
    for (int s = 0; s < kSlots; ++s) {
      simplex.point[s] = load3(slot[s]);
      simplex.present[s] = Lanes<T>::load(present[s]) > Lanes<T>(T(0));
    }
    return simplex;
  }
  [[gnu::always_inline]] static Vec3<T> load3(const Column* v) {
    return {Lanes<T>::load(v[0]), Lanes<T>::load(v[1]), Lanes<T>::load(v[2])};
  }
  [[gnu::always_inline]] static void store3(const Vec3<T>& v, Column* to) {
    v.x.store(to[0]);
    v.y.store(to[1]);
    v.z.store(to[2]);
  }

  /// The simplex; `present` is 1 where there is a point.
  alignas(64) Column slot[kSlots][3] = {};
  alignas(64) Column present[kSlots] = {};
  /// 1 before the first step.
  alignas(64) Column fresh = {};
  /// The nearest point of the simplex, and its square.
  alignas(64) Column gap[3] = {};
  alignas(64) Column square = {};
  /// The height of the last support point along `gap`, times the length of `gap`.
  alignas(64) Column height_along = {};
  /// Squares of distances of the cores: the shapes are apart above `far` and overlap up to `near`.
  alignas(64) Column far = {};
  alignas(64) Column near = {};
  std::uint32_t steps[kWidth] = {};
};

}  // namespace winnow::WINNOW_ISA_NAME::hull
