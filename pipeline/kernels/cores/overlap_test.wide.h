#pragma once

// Overlap tests in float for pairs of any convex kinds; only certain results count. A block of
// pairs is loaded and placed in lanes and tested once along the line of the cores' centers, which
// separates most pairs that are apart. The remaining pairs are searched by GJK in lanes; a lane
// that is done takes the next pair. Lengths are divided by the pair's size.

#include "pipeline/kernels/answers.wide.h"
#include "pipeline/kernels/cores/core_kinds.wide.h"
#include "pipeline/kernels/cores/hull_core.wide.h"
#include "pipeline/kernels/cores/search_lanes.wide.h"
#include "pipeline/kernels/user_support.wide.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// Returns the vertices that for_farthest_vertices finds; 0 in the other lanes.
[[gnu::noinline]] static Vec3<float> farthest_vertices(const HullShape* const* hull,
                                                       const Vec3<float>& direction, Mask16 active,
                                                       VertexHeights& rows) {
  alignas(64) float x[3][kLanes] = {};
  for_farthest_vertices(hull, direction, active, rows, [&](unsigned lane, std::uint32_t vertex) {
    for (int i = 0; i < 3; ++i) x[i][lane] = hull[lane]->vertex_float[i][vertex];
  });
  return {Floats::load(x[0]), Floats::load(x[1]), Floats::load(x[2])};
}

class OverlapTest {
 public:
  /// Error bound of a height: three times the sum of about 90 rounding errors.
  static constexpr float kLengthError = 1.6e-5F;

  /// Answers a job except the pairs that it lists in `uncertified`; returns their number.
  [[gnu::noinline]] static std::uint32_t run(NarrowJob& job) {
    if (job.count == 0) return 0;
    OverlapTest overlap_test(job);
    for_blocks<float>(job, [&](const PairBlock<float>& block) {
      const Mask16 strange = overlap_test.first_step(block);
      overlap_test.uncertified_ = write_uncertified(job, block, overlap_test.uncertified_, strange);
      overlap_test.search(false);
    });
    overlap_test.search(true);
    return overlap_test.uncertified_;
  }

 private:
  using Search = SearchLanes<float, false>;
  static constexpr int kWidth = Search::kWidth;
  static constexpr float kSmallest = 1e-20F;
  static constexpr float kLargest = 1e20F;

  explicit OverlapTest(const NarrowJob& job)
      : job_(job),
        kind_{job.shapes[job.pairs->a].kind(), job.shapes[job.pairs->b].kind()},
        lanes_(kind_[1] == ShapeKind::support) {}

  /// The shapes in lanes whose cores have no numbers: hulls and user shapes.
  struct Singles {
    const HullShape* hull[2][kWidth];
    const SupportShape* own[2][kWidth];
    alignas(64) float scale[kWidth];
  };

  /// The placement of the cores of a block, with the second in the frame of the first.
  struct PlacedCores {
    Floats turn[9];
    Vec3<float> shift;
    Floats rounding;
    Floats scale;
    Mask16 usable;
  };

  [[gnu::always_inline]] PlacedCores place(const PairBlock<float>& block, LoadedCores (&side)[2]) {
    load_cores<SideA>(job_, block, kind_[0], side[0]);
    load_cores<SideB>(job_, block, kind_[1], side[1]);
    const Rotation<float> frame = rotation(load_turn<SideA>(job_, block));
    const Rotation<float> axes = rotation(load_turn<SideB>(job_, block));
    const Vec3<float> x = frame.to_local(axes.x);
    const Vec3<float> y = frame.to_local(axes.y);
    const Vec3<float> z = frame.to_local(axes.z);
    const Vec3<float> shift = frame.to_local(load_offset(job_, block));
    // NaN for an invalid pose.
    const Floats size =
        side[0].reach + side[1].reach + norm_l1(shift) + (norm_l1(x) + norm_l1(y)) * Floats(0.0F);
    const LaneMask<float> usable = (size > Floats(kSmallest)) & (size < Floats(kLargest));
    const Floats scale = select(usable, Floats(1.0F) / size, Floats(0.0F));
    for (LoadedCores& cores : side) {
      const int count = core_numbers(cores.core.kind);
      for (int i = 0; i < count; ++i) cores.core.number[i] = cores.core.number[i] * scale;
      cores.center = cores.center * scale;
      cores.inner = cores.inner * scale;
    }
    return {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z},
            shift * scale,
            (side[0].rounding + side[1].rounding) * scale,
            scale,
            bits(usable) & block.lanes()};
  }

  /// The first step of a block; returns the lanes that are out of range.
  [[gnu::noinline]] Mask16 first_step(const PairBlock<float>& block) {
    LoadedCores side[2];
    const PlacedCores placed = place(block, side);
    const Floats one(1.0F);
    const Floats zero(0.0F);
    const Floats rounding = placed.rounding;
    Vec3<float> gap = side[0].center - (turned(placed.turn, side[1].center) + placed.shift);
    Floats square = dot(gap, gap);
    const Floats ball = side[0].inner + side[1].inner + rounding - Floats(kLengthError);
    const Mask16 balls_overlap = bits((ball > zero) & (square < ball * ball)) & placed.usable;
    const Mask16 open = placed.usable & ~balls_overlap;
    const LaneMask<float> none = square <= Floats(Search::kTouching * Search::kTouching);
    gap.x = select(none, one, gap.x);
    square = select(none, square + one, square);

    put_singles(block, placed.scale);
    const Vec3<float> mine = points(side[0].core, 0, block_singles_, open, -gap);
    const Vec3<float> theirs = turned(
        placed.turn, points(side[1].core, 1, block_singles_, open, turned_back(placed.turn, gap)));
    const Vec3<float> found = mine - (theirs + placed.shift);
    const Floats height = dot(gap, found);
    const Floats reach = rounding + Floats(kLengthError);
    const Floats far = reach * reach;
    const Floats sure = rounding - Floats(kLengthError);
    const Floats near = select(sure > zero, sure * sure, -one);
    const Floats next_square = dot(found, found);
    const Mask16 apart = bits((height > zero) & (height * height > far * square)) & open;
    const Mask16 overlapping = (bits(next_square <= near) & open & ~apart) | balls_overlap;
    decide(apart, block.first, 0);
    decide(overlapping, block.first, 1);
    waiting_ = open & ~(apart | overlapping);
    if (waiting_ != 0) {
      first_pair_ = block.first;
      set_aside(side, placed);
      Search::store3(found, found_);
      far.store(far_);
      near.store(near_);
      next_square.store(square_);
    }
    return block.lanes() & ~placed.usable;
  }

  void set_aside(const LoadedCores (&side)[2], const PlacedCores& placed) {
    for (int i = 0; i < 2; ++i) {
      const int count = core_numbers(kind_[i]);
      for (int k = 0; k < count; ++k) side[i].core.number[k].store(number_[i][k]);
    }
    for (int k = 0; k < 9; ++k) placed.turn[k].store(turn_[k]);
    Search::store3(placed.shift, shift_);
  }

  /// Advances the searches until all waiting pairs have a lane, or, if `ends`, until all lanes are
  /// done.
  [[gnu::noinline]] void search(bool ends) {
    for (Mask16 free = kAllRows & ~active_; free != 0 && waiting_ != 0; free &= free - 1) {
      refill(first(free));
    }
    while (active_ != 0 && (ends || waiting_ != 0)) {
      const SearchEnds found = lanes_.step(active_, [&](int side, const Vec3<float>& d) {
        CoreLanes<float> core;
        core.kind = kind_[side];
        for (int i = 0; i < kCoreNumbers; ++i) {
          core.number[i] = Floats::load(lane_number_[side][i]);
        }
        return points(core, side, lane_singles_, active_, d);
      });
      for (Mask16 done = found.all(); done != 0; done &= done - 1) {
        const unsigned lane = first(done);
        const Mask16 bit = 1U << lane;
        if (((found.far | found.inside) & bit) != 0) {
          job_.overlap[pair_[lane]] = (found.inside & bit) != 0 ? 1 : 0;
        } else {
          job_.uncertified[uncertified_++] = pair_[lane];
        }
        active_ &= ~bit;
        refill(lane);
      }
    }
  }

  /// Puts the next waiting pair into a lane, after its first step.
  void refill(unsigned lane) {
    if (waiting_ == 0) return;
    const unsigned row = first(waiting_);
    waiting_ &= waiting_ - 1;
    active_ |= 1U << lane;
    pair_[lane] = first_pair_ + row;
    for (int side = 0; side < 2; ++side) {
      const int count = core_numbers(kind_[side]);
      for (int i = 0; i < count; ++i) lane_number_[side][i][lane] = number_[side][i][row];
      if (is_single(kind_[side])) {
        lane_singles_.hull[side][lane] = block_singles_.hull[side][row];
        lane_singles_.own[side][lane] = block_singles_.own[side][row];
      }
    }
    lane_singles_.scale[lane] = block_singles_.scale[row];
    for (int i = 0; i < 9; ++i) lanes_.turn[i][lane] = turn_[i][row];
    for (int k = 0; k < 3; ++k) lanes_.shift[k][lane] = shift_[k][row];
    lanes_.far[lane] = far_[row];
    lanes_.near[lane] = near_[row];
    const float point[3] = {found_[0][row], found_[1][row], found_[2][row]};
    lanes_.start_from(lane, point, square_[row]);
  }

  void put_singles(const PairBlock<float>& block, const Floats& scale) {
    scale.store(block_singles_.scale);
    for (int side = 0; side < 2; ++side) {
      if (!is_single(kind_[side])) continue;
      for (int lane = 0; lane < kWidth; ++lane) {
        const std::uint32_t i = side == 0 ? shape_index<SideA>(job_, block, lane)
                                          : shape_index<SideB>(job_, block, lane);
        const bool own = kind_[side] == ShapeKind::support;
        block_singles_.hull[side][lane] = own ? nullptr : job_.tables->hulls + i;
        block_singles_.own[side][lane] = own ? job_.tables->supports + i : nullptr;
      }
    }
  }

  /// The support points of the cores of one side.
  [[gnu::always_inline]] Vec3<float> points(const CoreLanes<float>& core, int side,
                                            const Singles& singles, Mask16 active,
                                            const Vec3<float>& d) {
    return support(core, d, [&](const Vec3<float>& along) {
      if (core.kind == ShapeKind::support) return user_points(singles, side, active, along);
      return farthest_vertices(singles.hull[side], along, active, heights_) *
             Floats::load(singles.scale);
    });
  }

  [[gnu::noinline]] static Vec3<float> user_points(const Singles& singles, int side, Mask16 active,
                                                   const Vec3<float>& along) {
    return Search::one_by_one(
        along, active, [&](unsigned lane, const float* direction, float* point) {
          user_support(*singles.own[side][lane], direction, singles.scale[lane], point);
        });
  }

  void decide(Mask16 lanes, std::uint32_t first_pair, std::uint8_t overlap) {
    for (; lanes != 0; lanes &= lanes - 1) job_.overlap[first_pair + first(lanes)] = overlap;
  }

  const NarrowJob& job_;
  const ShapeKind kind_[2];
  std::uint32_t uncertified_ = 0;

  // The searches and their pairs.
  Mask16 active_ = 0;
  Search lanes_;
  std::uint32_t pair_[kWidth] = {};
  alignas(64) float lane_number_[2][kCoreNumbers][kWidth] = {};
  Singles lane_singles_;

  // A block after its first step, and its pairs that wait for a lane.
  Mask16 waiting_ = 0;
  std::uint32_t first_pair_ = 0;
  alignas(64) float number_[2][kCoreNumbers][kWidth];
  alignas(64) float turn_[9][kWidth];
  alignas(64) float shift_[3][kWidth];
  alignas(64) float found_[3][kWidth];
  alignas(64) float far_[kWidth];
  alignas(64) float near_[kWidth];
  alignas(64) float square_[kWidth];
  Singles block_singles_;
  VertexHeights heights_;
};

/// Answers the `count` pairs that overlap_test() has left in `uncertified`. The large Answers
/// object is constructed only if there are any; most jobs of one pair leave none.
template <typename Answers>
std::uint32_t answer_uncertified(NarrowJob& job, std::uint32_t count) {
  if (count == 0) return 0;
  Answers answers(job);
  // At most as many indices are written as have been read, so unread entries are not overwritten.
  for (std::uint32_t k = 0; k < count; ++k) answers.take(job.uncertified[k]);
  return answers.finish_taken();
}

}  // namespace winnow::WINNOW_ISA_NAME::hull
