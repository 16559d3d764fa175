// Divides a large set of points into cells by counting (kernels in coarse_cut.kernel.cpp); the
// first step of KdCuts with KdPrecision::cells.

#include "partitions/tree/coarse_cut.h"

#include "core/sort/parallel_ranges.h"

#include <algorithm>

namespace winnow {

WINNOW_DEFINE_KERNELS(CoarseCutKernels, coarse_cut_kernels)

namespace {

constexpr std::size_t kMaxRanges = 64;

/// Ranges of the points; each is read and written by one task.
struct CoarseRanges {
  static constexpr std::size_t kMinLength = 16384;

  std::size_t count;
  std::size_t length;
  const Execution& execution;

  CoarseRanges(std::size_t points, const Execution& e)
      : count(points), length(even_range_length(points, kMinLength, kMaxRanges)), execution(e) {}

  /// Calls body(range index, begin, end).
  template <typename Body>
  void for_each(Body&& body) const {
    for_each_range(execution, count, length,
                   [&](std::size_t begin, std::size_t end) { body(begin / length, begin, end); });
  }
};

bool plan_cells(const KdSet& set, std::size_t target_cells, const CoarseRanges& ranges,
                CoarseCells& plan) {
  std::array<std::array<float, 3>, kMaxRanges> least;
  std::array<std::array<float, 3>, kMaxRanges> greatest;
  ranges.for_each([&](std::size_t s, std::size_t begin, std::size_t end) {
    for (std::size_t a = 0; a < 3; ++a) {
      coarse_cut_kernels().reach(set.at[a] + begin, end - begin, least[s][a], greatest[s][a]);
    }
  });
  const std::size_t last = (ranges.count - 1) / ranges.length;
  for (std::size_t s = 1; s <= last; ++s) {
    for (std::size_t a = 0; a < 3; ++a) {
      least[0][a] = std::min(least[0][a], least[s][a]);
      greatest[0][a] = std::max(greatest[0][a], greatest[s][a]);
    }
  }
  const auto cells =
      static_cast<std::uint32_t>(std::clamp<std::size_t>(target_cells, 1, kMaxCoarseCells));
  return coarse_cut_kernels().plan(set.at, set.count, least[0].data(), greatest[0].data(), cells,
                                   plan);
}

using CoarsePlaces = std::array<std::array<std::uint32_t, kMaxCoarseCells>, kMaxRanges>;

// Turns the sizes of cells within ranges into the ranges' output positions.
void place_ranges(CoarsePlaces& places, std::size_t ranges, CoarseSizes& sizes) {
  std::uint32_t next = 0;
  for (std::size_t c = 0; c < sizes.size(); ++c) {
    const std::uint32_t first = next;
    for (std::size_t s = 0; s < ranges; ++s) {
      const std::uint32_t size = places[s][c];
      places[s][c] = next;
      next += size;
    }
    sizes[c] = next - first;
  }
}

}  // namespace

bool cut_in_cells(KdSet& set, std::size_t target_cells, const Execution& execution,
                  CoarseSizes& sizes) {
  const CoarseRanges ranges(set.count, execution);
  CoarseCells plan;
  if (!plan_cells(set, target_cells, ranges, plan)) return false;
  auto* const cell = reinterpret_cast<std::uint8_t*>(set.at_room[2]);
  CoarsePlaces places;
  ranges.for_each([&](std::size_t s, std::size_t begin, std::size_t end) {
    places[s].fill(0);
    coarse_cut_kernels().assign(plan, set.at, begin, end, cell, places[s].data());
  });
  place_ranges(places, (ranges.count - 1) / ranges.length + 1, sizes);
  ranges.for_each([&](std::size_t s, std::size_t begin, std::size_t end) {
    auto next = places[s];
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t to = next[cell[i]]++;
      set.at_room[0][to] = set.at[0][i];
      set.at_room[1][to] = set.at[1][i];
      set.row_room[to] = set.row[i];
    }
  });
  // The first axis was copied out of its column, which now receives the third.
  ranges.for_each([&](std::size_t s, std::size_t begin, std::size_t end) {
    auto next = places[s];
    for (std::size_t i = begin; i < end; ++i) set.at[0][next[cell[i]]++] = set.at[2][i];
    std::copy(set.row_room + begin, set.row_room + end, set.row + begin);
  });
  float* const old[3] = {set.at[0], set.at[1], set.at[2]};
  set.at[0] = set.at_room[0];
  set.at[1] = set.at_room[1];
  set.at[2] = old[0];
  set.at_room[0] = old[1];
  set.at_room[1] = old[2];
  return true;
}

}  // namespace winnow
