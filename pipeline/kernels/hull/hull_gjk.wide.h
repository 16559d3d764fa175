#pragma once

// Steps 1 and 2 of the hull kernels (hull_answers.wide.h has the sequence).
//
// Step 1: place_hulls fills in a HullPair, the state of a pair that the steps pass on.
//
// Step 2: HullSearch finds the closest features of pairs of hulls in float, by GJK (Gilbert,
// Johnson, Keerthi 1988) with one pair per lane. A lane that is done takes the next pair, so that
// fifteen easy pairs do not wait for a hard one. If the origin is inside the difference, the search
// restarts towards a point outside and finds a face of the difference that is a good guess for the
// nearest one. The limits of the states far and inside include the errors of float. All other
// results are guesses, which the later steps prove before they use them.
//
// A step of GJK has the nearest point v of the simplex, and computes the support point w of the
// difference against v. No point of the difference is lower along v than w: |v| is an upper bound
// of its distance from the origin, v . w / |v| a lower one. A lane ends
// - far if the lower bound exceeds the caller's limit;
// - apart if the two bounds are equal up to rounding, if w is already in the simplex, or if adding
//   it leads no nearer to the origin;
// - inside or close if the simplex contains the origin;
// - after too many steps, as if it were apart.

#include "pipeline/kernels/cores/gjk_lanes.wide.h"
#include "pipeline/kernels/cores/hull_core.wide.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// Result of the float search about the cores.
enum class HullState : std::uint32_t {
  /// Farther apart than the caller needs.
  far,
  /// Closest features found, but not proven.
  apart,
  /// The overlap exceeds the errors of float.
  inside,
  /// Touching or overlapping, up to the errors of float.
  close,
};

/// "First" is body a of the pair, or body b if `swapped`: see computes_b_first.
struct HullPair : PairPlacement {
  const HullShape* first;
  const HullShape* second;
  /// An upper bound of every length that occurs: the distance of the hulls' origins, plus the
  /// reach_of each hull.
  double size;
  /// Sum of the roundings.
  double rounding;
  /// The search stops with state far if the cores are farther apart than this plus the rounding;
  /// infinite to never stop.
  double far;
  /// `turn` and `shift` in float. The `scaled_` numbers are multiplied by `scale`, a power of two
  /// that brings `size` into [1, 2).
  float turn_float[9];
  float scaled_turn[9];
  float scaled_shift[3];
  float scale;
  std::uint32_t index;
  bool swapped;
  // Outcome of the search.
  HullState state;
  /// `count` vertex pairs of the closest features: vertex of the first | vertex of the second <<
  /// 16.
  std::uint32_t count;
  std::uint32_t vertices[3];
  /// first - second at the closest points, scaled.
  float gap[3];
  /// State far: a lower bound of the distance of the cores, times the length of `gap`, scaled. It
  /// is the height along `gap` of the last support point, above which lie all points of the
  /// difference.
  float height_along;
  /// Square of an upper bound of the penetration depth, scaled.
  float depth_squared;
  /// The latest support points of first - second, scaled.
  static constexpr std::uint32_t kTrail = 8;
  float trail[kTrail][3];
  std::uint32_t trail_length;
};

/// Beyond these sizes, products of four floats may not be normal numbers.
inline constexpr double kSmallestHull = 1e-8;
inline constexpr double kLargestHull = 1e8;
/// The search stores vertex numbers in 16 bits.
inline constexpr std::uint32_t kMaxHullVertices = 65535;

/// Fills in the inputs of the search, with b first if `swapped`; returns false if poses or sizes
/// are out of range. `PointSecond`: see `place`.
template <bool PointSecond = false>
static inline bool place_hulls(const HullShape& a, const HullShape& b, const Pose& pose_a,
                               const Pose& pose_b, bool swapped, HullPair& pair) {
  pair.swapped = swapped;
  pair.first = swapped ? &b : &a;
  pair.second = swapped ? &a : &b;
  if (!place<PointSecond>(swapped ? pose_b : pose_a, swapped ? pose_a : pose_b, pair)) return false;
  pair.rounding = a.rounding + b.rounding;
  const double size = reach_of(a) + reach_of(b) + __builtin_fabs(pair.shift[0]) +
                      __builtin_fabs(pair.shift[1]) + __builtin_fabs(pair.shift[2]);
  if (!(size > kSmallestHull && size < kLargestHull)) return false;
  if (!(pair.rounding < kLargestHull)) return false;
  const auto scale = static_cast<float>(scale_of(size));
  pair.size = size;
  pair.scale = scale;
  for (int i = 0; i < 9; ++i) {
    const auto turn_float = static_cast<float>(pair.turn[i]);
    pair.turn_float[i] = turn_float;
    pair.scaled_turn[i] = turn_float * scale;
  }
  for (int i = 0; i < 3; ++i) pair.scaled_shift[i] = static_cast<float>(pair.shift[i]) * scale;
  return true;
}

/// The second's vertex number is stored above the first's.
constexpr float second_pattern(std::uint32_t number) {
  return number_pattern(number << 16U);
}

/// The second's point that is farthest along a direction, in the first's frame and scaled, and its
/// number.
struct SecondSupport {
  Vec3<float> point;
  Floats number;
};

/// Second hulls as stored in the pool.
class HullSeconds {
 public:
  void put(unsigned lane, const HullPair& pair) {
    vertices_.put(lane, *pair.second);
    for (int i = 0; i < 9; ++i) turn_[i][lane] = pair.scaled_turn[i];
    for (int i = 0; i < 3; ++i) shift_[i][lane] = pair.scaled_shift[i];
  }

  SecondSupport find(const Vec3<float>& d, Mask16 active) {
    Floats t[9];
    for (int i = 0; i < 9; ++i) t[i] = Floats::load(turn_[i]);
    const auto turned_back = [&](int i) { return t[i] * d.x + t[3 + i] * d.y + t[6 + i] * d.z; };
    vertices_.find({turned_back(0), turned_back(1), turned_back(2)}, active);
    const Vec3<float> v = vertices_.vertex();
    const auto placed = [&](int i) {
      return t[3 * i] * v.x + t[3 * i + 1] * v.y + t[3 * i + 2] * v.z + Floats::load(shift_[i]);
    };
    return {{placed(0), placed(1), placed(2)}, vertices_.numbers(16)};
  }

 private:
  FarthestVertices vertices_;
  alignas(64) float turn_[9][kLanes] = {};
  alignas(64) float shift_[3][kLanes] = {};
};

/// Cores of spheres, capsules and boxes: a center and `Axes` half axes. Bit k of a vertex's number
/// is set if it is at the positive end of half axis k.
template <int Axes>
class CenteredSeconds {
 public:
  void put(unsigned lane, const HullPair& pair) {
    for (int i = 0; i < 3; ++i) middle_[i][lane] = pair.scaled_shift[i];
    for (int k = 0; k < Axes; ++k) {
      // A segment runs along z.
      const int along = Axes == 1 ? 2 : k;
      const float half = pair.second->vertex_float[along][(1U << Axes) - 1];
      for (int i = 0; i < 3; ++i) arm_[k][i][lane] = pair.scaled_turn[3 * i + along] * half;
    }
  }

  [[nodiscard]] SecondSupport find(const Vec3<float>& d, Mask16 /*active*/) const {
    const Floats zero(0.0F);
    SecondSupport r{{Floats::load(middle_[0]), Floats::load(middle_[1]), Floats::load(middle_[2])},
                    zero};
    for (int k = 0; k < Axes; ++k) {
      const Vec3<float> arm{Floats::load(arm_[k][0]), Floats::load(arm_[k][1]),
                            Floats::load(arm_[k][2])};
      const LaneMask<float> far = dot(arm, d) > zero;
      r.point = r.point + select(far, arm, -arm);
      r.number = r.number | select(far, Floats(second_pattern(1U << k)), zero);
    }
    return r;
  }

 private:
  alignas(64) float middle_[3][kLanes] = {};
  alignas(64) float arm_[Axes > 0 ? Axes : 1][3][kLanes] = {};
};

class TriangleSeconds {
 public:
  void put(unsigned lane, const HullPair& pair) {
    const float* const* vertex = pair.second->vertex_float;
    for (int v = 0; v < 3; ++v) {
      const float x[3] = {vertex[0][v], vertex[1][v], vertex[2][v]};
      float placed[3];
      turn3(pair.scaled_turn, x, placed);
      for (int i = 0; i < 3; ++i) corner_[v][i][lane] = placed[i] + pair.scaled_shift[i];
    }
  }

  [[nodiscard]] SecondSupport find(const Vec3<float>& d, Mask16 /*active*/) const {
    SecondSupport r{corner(0), Floats(0.0F)};
    Floats highest = dot(r.point, d);
    for (int v = 1; v < 3; ++v) {
      const Vec3<float> other = corner(v);
      const Floats height = dot(other, d);
      const LaneMask<float> higher = height > highest;
      highest = select(higher, height, highest);
      r.point = select(higher, other, r.point);
      r.number = select(higher, Floats(second_pattern(static_cast<std::uint32_t>(v))), r.number);
    }
    return r;
  }

 private:
  [[nodiscard]] Vec3<float> corner(int v) const {
    return {Floats::load(corner_[v][0]), Floats::load(corner_[v][1]), Floats::load(corner_[v][2])};
  }

  alignas(64) float corner_[3][3][kLanes] = {};
};

/// `Seconds` computes the supports of the second hulls: HullSeconds, CenteredSeconds or
/// TriangleSeconds.
template <typename Seconds>
class HullSearch {
 public:
  /// `overlap_only`: the search stops with state inside as soon as the rounded shapes certainly
  /// overlap, and does not restart.
  HullSearch(HullPair* pairs, std::uint32_t count, bool overlap_only)
      : pairs_(pairs, count), overlap_only_(overlap_only) {}

  void run() {
    for (unsigned lane = 0; lane < kLanes; ++lane) refill(lane);
    while (pairs_.active() != 0) {
      Mask16 done = step();
      for (; done != 0; done &= done - 1) {
        const unsigned lane = first(done);
        hand_back(lane);
        refill(lane);
      }
    }
  }

 private:
  using Search = GjkLanes<float>;

  static constexpr std::uint32_t kMaxSteps = 48;
  /// Maximal number of steps after a restart from outside.
  static constexpr std::uint32_t kRestartSteps = 8;
  /// Distance of the restart's goal from the origin, relative to the lowest height found.
  static constexpr float kOutside = 1.25F;
  /// Error bound of the height of a support point, scaled. It includes the error in the choice of
  /// the highest vertex (see kLaneBits).
  static constexpr float kLengthError = 6e-6F;

  void refill(unsigned lane) {
    HullPair* const next = pairs_.refill(lane);
    if (next == nullptr) return;
    HullPair& pair = *next;
    firsts_.put(lane, *pair.first);
    seconds_.put(lane, pair);
    scale_[lane] = pair.scale;
    const auto scaled = [&](double length) { return static_cast<float>(length) * pair.scale; };
    const float far = scaled(pair.far + pair.rounding) + kLengthError;
    lanes_.far[lane] = far * far;
    const float near = scaled(pair.rounding) - kLengthError;
    lanes_.near[lane] = overlap_only_ && near > 0.0F ? near * near : -1.0F;
    depth_[lane] = __builtin_inff();
    lanes_.start(lane);
    restarted_[lane] = 0.0F;
    for (int k = 0; k < 3; ++k) goal_[k][lane] = 0.0F;
    pair.trail_length = 0;
    float center[3];
    start_direction(pair, center);
    float square = 0.0F;
    for (int i = 0; i < 3; ++i) {
      lanes_.gap[i][lane] = center[i];
      square += center[i] * center[i];
    }
    lanes_.square[lane] = square;
  }

  /// The vector from the second's center to the first's: a point of their difference.
  static void start_direction(const HullPair& pair, float* d) {
    double middle[3];
    turn3(pair.turn, pair.second->center.data(), middle);
    for (int i = 0; i < 3; ++i) {
      d[i] = static_cast<float>(pair.first->center[i] - (middle[i] + pair.shift[i])) * pair.scale;
    }
    if (!(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > Search::kTouching * Search::kTouching)) {
      d[0] = 1.0F;
      d[1] = 0.0F;
      d[2] = 0.0F;
    }
  }

  /// See GjkLanes::step.
  struct Rules {
    HullSearch& search;
    LaneMask<float> restarted;
    /// The support point and its vertices.
    Vec3<float> w;
    Floats name;

    [[gnu::always_inline]] void find(const Vec3<float>& v) {
      search.firsts_.find(-v, search.pairs_.active());
      const SecondSupport second = search.seconds_.find(v, search.pairs_.active());
      name = search.firsts_.numbers(0) | second.number;
      w = search.firsts_.vertex() * Floats::load(search.scale_) - second.point -
          Search::load3(search.goal_);
    }
    /// After a restart, distances from the goal bound no distance of the cores.
    [[gnu::always_inline]] LaneMask<float> ends(const Vec3<float>& v, const Floats& square,
                                                const Floats& height) const {
      if (!search.overlap_only_) search.note_depth(w, v, square, height);
      return search.lanes_.is_far(height, square) & !restarted;
    }
    /// The bounds |v| and v . w / |v| differ by at most kNoGain. `gain` is v . v - v . w; rounding
    /// may make it negative.
    [[gnu::always_inline]] LaneMask<float> has_no_gain(const Floats& gain,
                                                       const Floats& square) const {
      return (gain <= Floats(0.0F)) |
             (gain * gain <= Floats(Search::kNoGain * Search::kNoGain) * square);
    }
    [[gnu::always_inline]] void keep(int s, const LaneMask<float>& take) const {
      select(take, name, Floats::load(search.slot_name_[s])).store(search.slot_name_[s]);
    }
  };

  /// Advances all lanes by one step; returns the lanes that are done. A lane that has been
  /// restarted cannot end apart: its origin is inside, and the nearest feature to the goal is a
  /// guess for the nearest face.
  Mask16 step() {
    const LaneMask<float> restarted = Floats::load(restarted_) > Floats(0.0F);
    Rules rules{*this, restarted, {}, {}};
    const Mask16 active = pairs_.active();
    const SearchEnds ends = lanes_.ends_of(lanes_.step(active, rules), active);
    const Mask16 restarted_bits = bits(restarted);
    pairs_.mark(ends.far, HullState::far);
    pairs_.mark(ends.apart & ~restarted_bits, HullState::apart);
    pairs_.mark(ends.apart & restarted_bits, HullState::close);
    pairs_.mark(ends.inside, HullState::inside);
    pairs_.mark(ends.close, HullState::close);
    Mask16 done = ends.all();
    if (!overlap_only_) done &= ~restart_from_outside(ends.enclosed & ~restarted_bits);
    const Mask16 late = lanes_.late(active & ~done, kMaxSteps);
    pairs_.mark(late & ~restarted_bits, HullState::apart);
    pairs_.mark(late & restarted_bits, HullState::close);
    return done | late;
  }

  /// Restarts the lanes whose origin is inside: the goal becomes a point outside, in the direction
  /// with the lowest height. Returns the lanes that have such a point.
  Mask16 restart_from_outside(Mask16 lanes) {
    Mask16 restarts = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
      const unsigned lane = first(lanes);
      const float depth = __builtin_sqrtf(depth_[lane]);
      if (!(depth > Search::kTouching && depth < 2.0F)) continue;
      float square = 0.0F;
      for (int k = 0; k < 3; ++k) square += lowest_[k][lane] * lowest_[k][lane];
      const float reach = depth * kOutside / __builtin_sqrtf(square);
      square = 0.0F;
      for (int k = 0; k < 3; ++k) {
        lanes_.gap[k][lane] = lowest_[k][lane] * reach;
        goal_[k][lane] = -lanes_.gap[k][lane];
        square += lanes_.gap[k][lane] * lanes_.gap[k][lane];
      }
      lanes_.square[lane] = square;
      lanes_.start(lane);
      restarted_[lane] = 1.0F;
      // `late` ends the lane after kRestartSteps more.
      lanes_.steps[lane] = kMaxSteps - kRestartSteps;
      restarts |= 1U << lane;
    }
    return restarts;
  }

  /// Keeps the lowest height of the difference over the origin, and its direction.
  void note_depth(const Vec3<float>& w, const Vec3<float>& gap, const Floats& square,
                  const Floats& height) {
    const Floats zero(0.0F);
    const Vec3<float> goal = Search::load3(goal_);
    const Floats over = height + dot(gap, goal);
    const Floats depth = select(over > zero, zero, over * over / square);
    const Floats before = Floats::load(depth_);
    const LaneMask<float> is_lower = depth < before;
    select(is_lower, depth, before).store(depth_);
    Search::store3(select(is_lower, gap, Search::load3(lowest_)), lowest_);
    remember(w + goal);
  }

  /// Stores points of the difference for HullDepth.
  void remember(const Vec3<float>& w) {
    alignas(64) float point[3][kLanes];
    Search::store3(w, point);
    for (Mask16 rest = pairs_.active(); rest != 0; rest &= rest - 1) {
      const unsigned lane = first(rest);
      HullPair& pair = pairs_[lane];
      float* to = pair.trail[pair.trail_length++ % HullPair::kTrail];
      for (int k = 0; k < 3; ++k) to[k] = point[k][lane];
    }
  }

  void hand_back(unsigned lane) {
    HullPair& pair = pairs_[lane];
    pair.count = 0;
    for (int s = 0; s < kSlots; ++s) {
      if (lanes_.present[s][lane] > 0.0F && pair.count < 3) {
        pair.vertices[pair.count++] = __builtin_bit_cast(std::uint32_t, slot_name_[s][lane]);
      }
    }
    for (int i = 0; i < 3; ++i) pair.gap[i] = lanes_.gap[i][lane];
    pair.height_along = lanes_.height_along[lane];
    pair.depth_squared = depth_[lane];
  }

  LanePairs<HullPair, kLanes> pairs_;
  bool overlap_only_;
  FarthestVertices firsts_;
  Seconds seconds_;
  Search lanes_;
  alignas(64) float scale_[kLanes] = {};
  /// 1 if the origin is inside and the search continues from the point `goal_` outside.
  alignas(64) float restarted_[kLanes] = {};
  alignas(64) float goal_[3][kLanes] = {};
  alignas(64) float lowest_[3][kLanes] = {};
  alignas(64) float depth_[kLanes] = {};
  alignas(64) float slot_name_[kSlots][kLanes] = {};
};

}  // namespace winnow::WINNOW_ISA_NAME::hull
