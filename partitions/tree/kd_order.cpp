// Orders rows for a block tree by k-d cuts. OrderPlan (index/order_plan.h) runs KdCuts in steps;
// the kernels are in kd_order.kernel.cpp, tile_order.kernel.cpp and coarse_cut.kernel.cpp.

#include "partitions/tree/kd_order.h"

#include "core/sort/parallel_ranges.h"
#include "partitions/tree/coarse_cut.h"
#include "partitions/tree/kd_order.kernel.h"
#include "partitions/tree/tile_order.kernel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

namespace winnow {

WINNOW_DEFINE_KERNELS(KdOrderKernels, kd_order_kernels)
WINNOW_DEFINE_KERNELS(TileOrderKernels, tile_order_kernels)

namespace {

// Sets that cuts leave are sorted in tiles from this size down, the set of all rows from
// kMaxInTiles down.
constexpr std::size_t kTiledPart = 4096;
// Tiling a set takes about as long as this many cuts of each row.
constexpr std::size_t kCutsOfTiles = 2;
constexpr std::size_t kPointsPerTask = 16384;

// Points per coarse cell: small enough for tiles, even if cells are unequal.
constexpr std::size_t kCoarsePart = 3072;

// Sorts a set of at least kMinInTiles points in tiles. Returns false if tiles would not separate
// its points.
bool sort_in_tiles(const KdSet& set) {
  TileSet tiles;
  std::copy_n(set.at, 3, tiles.at);
  tiles.row = set.row;
  tiles.row_room = set.row_room;
  std::copy_n(set.at_room, 3, tiles.room);
  tiles.count = set.count;
  return tile_order_kernels().sort(tiles);
}

// Cuts a set until its parts are blocks, or are sorted in tiles. `split` leaves the first part in
// `set` and returns the second.
void finish_set(KdSet set, KdPrecision precision) {
  while (precision != KdPrecision::blocks && set.count >= kMinInTiles) {
    if (set.count <= kTiledPart && sort_in_tiles(set)) return;
    finish_set(kd_order_kernels().split(set), precision);
  }
  kd_order_kernels().finish(set);
}

// The cost of finish_set, in cuts of each row.
std::size_t cuts_of(std::size_t count, KdPrecision precision) noexcept {
  return precision != KdPrecision::blocks
             ? kCutsOfTiles
             : static_cast<std::size_t>(std::bit_width(count / kBlockRows));
}

}  // namespace

KdSet KdCuts::set_of(const RowRange& range) const noexcept {
  KdSet set;
  set.row = rows_.data() + range.begin;
  set.row_room = room_ + range.begin;
  set.count = range.count;
  for (std::size_t a = 0; a < 3; ++a) {
    set.at[a] = at_[a] + range.begin;
    set.at_room[a] = at_room_[a] + range.begin;
  }
  return set;
}

bool KdCuts::start(const BoundsPool& pool, std::span<std::uint32_t> rows, std::uint32_t* room,
                   Column<float>& scratch, const Execution& execution, KdPrecision precision) {
  const std::size_t count = rows.size();
  if (!scratch.resize(kd_scratch(count))) return false;
  rows_ = rows;
  room_ = room;
  for (std::size_t a = 0; a < 3; ++a) {
    at_[a] = scratch.data() + a * count;
    at_room_[a] = scratch.data() + (3 + a) * count;
  }
  open_ = 0;
  precision_ = precision;
  // At most kTiledPart rows are one set, which `advance` finishes.
  whole_ = precision != KdPrecision::blocks && count > kTiledPart && count <= kMaxInTiles;
  coarse_ = precision == KdPrecision::cells && count > kMaxInTiles;
  if (count <= kBlockRows) return true;
  sets_[open_++] = {0, static_cast<std::uint32_t>(count)};
  const std::array<const float*, 6> boxes = box_columns(pool);
  for_each_even_range(execution, count, kPointsPerTask, [&](std::size_t begin, std::size_t end) {
    kd_order_kernels().centres(boxes.data(), rows.data(), begin, end, at_);
  });
  return true;
}

// True if all rows were sorted in tiles at once.
bool KdCuts::tile_whole(std::size_t& work) {
  if (!std::exchange(whole_, false)) return false;
  work -= std::min(work, kCutsOfTiles * rows_.size());
  if (!sort_in_tiles(set_of(sets_[0]))) return false;
  open_ = 0;
  return true;
}

// Replaces the set of all rows by its coarse cells, unless its points are concentrated in few
// places.
void KdCuts::cut_coarsely(std::size_t& work, const Execution& execution) {
  if (!std::exchange(coarse_, false)) return;
  work -= std::min(work, kCutsOfTiles * rows_.size());
  KdSet all = set_of(sets_[0]);
  CoarseSizes sizes;
  if (!cut_in_cells(all, rows_.size() / kCoarsePart, execution, sizes)) return;
  std::copy_n(all.at, 3, at_);
  std::copy_n(all.at_room, 3, at_room_);
  open_ = 0;
  std::uint32_t begin = 0;
  for (const std::uint32_t count : sizes) {
    if (count != 0) sets_[open_++] = {begin, count};
    begin += count;
  }
}

// Cuts every set that is too large for tiles in two, on all threads. Returns false if there is
// none, or if twice as many sets might not have room.
bool KdCuts::cut_each_in_two(std::size_t& work, const Execution& execution) {
  const std::size_t before = open_;
  if (2 * before > kMaxSets) return false;
  execution.for_each(before, [&](std::size_t i) {
    RowRange& first = sets_[i];
    RowRange& second = sets_[before + i];
    second = {first.begin, 0};
    if (first.count <= kTiledPart) return;
    KdSet set = set_of(first);
    // `split` returns the second side.
    second.count = static_cast<std::uint32_t>(kd_order_kernels().split(set).count);
    first.count -= second.count;
    second.begin += first.count;
  });
  for (std::size_t i = before; i < 2 * before; ++i) {
    if (sets_[i].count == 0) continue;
    work -= std::min<std::size_t>(work, sets_[i].count + sets_[i - before].count);
    sets_[open_++] = sets_[i];
  }
  return open_ > before;
}

bool KdCuts::advance(std::size_t work, const Execution& execution) {
  if (tile_whole(work)) return true;
  cut_coarsely(work, execution);
  while (work != 0 && open_ != 0 && cut_each_in_two(work, execution)) {
  }
  // One thread finishes each of the remaining sets.
  std::size_t taken = 0;
  for (; taken < open_ && work != 0; ++taken) {
    const std::size_t count = sets_[open_ - 1 - taken].count;
    work -= std::min(work, count * cuts_of(count, precision_));
  }
  execution.for_each(taken,
                     [&](std::size_t i) { finish_set(set_of(sets_[open_ - 1 - i]), precision_); });
  open_ -= taken;
  return open_ == 0;
}

bool sort_by_kd_cuts(const BoundsPool& pool, std::span<std::uint32_t> rows, std::uint32_t* room,
                     Column<float>& scratch, const Execution& execution, KdPrecision precision) {
  KdCuts cuts;
  if (!cuts.start(pool, rows, room, scratch, execution, precision)) return false;
  (void)cuts.advance(std::numeric_limits<std::size_t>::max(), execution);
  return true;
}

}  // namespace winnow
