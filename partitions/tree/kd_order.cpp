#include "partitions/tree/kd_order.h"

#include "core/sort/split_jobs.h"
#include "core/sort/stretches.h"
#include "partitions/tree/kd_order.kernel.h"
#include "partitions/tree/tile_order.kernel.h"

#include <algorithm>
#include <array>

namespace winnow {

WINNOW_DEFINE_KERNELS(KdOrderKernels, kd_order_kernels)
WINNOW_DEFINE_KERNELS(TileOrderKernels, tile_order_kernels)

namespace {

// Parts up to this size are put in tiles.
constexpr std::size_t kTiledPart = 4096;
constexpr std::size_t kPointsPerTask = 16384;

// The tiles of a set, which is large enough for them. False if they would not tell its points
// apart.
bool sort_in_tiles(const KdSet& set) {
  TileSet tiles;
  std::copy_n(set.at, 3, tiles.at);
  tiles.row = set.row;
  tiles.row_room = set.row_room;
  std::copy_n(set.at_room, 3, tiles.room);
  tiles.count = set.count;
  return tile_order_kernels().sort(tiles);
}

// Cuts a set until tiles, or blocks, are left.
void finish(KdSet set) {
  while (set.count >= kFewestInTiles) {
    if (set.count <= kTiledPart && sort_in_tiles(set)) return;
    finish(kd_order_kernels().split(set));
  }
  kd_order_kernels().finish(set);
}

}  // namespace

bool sort_by_kd_cuts(const BoundsPool& pool, std::span<std::uint32_t> rows, std::uint32_t* room,
                     Column<float>& scratch, const Execution& execution) {
  const std::size_t count = rows.size();
  if (!scratch.resize(6 * count)) return false;
  if (count <= kBlockRows) return true;
  KdSet all;
  all.row = rows.data();
  all.row_room = room;
  all.count = count;
  const std::array<const float*, 6> boxes = box_columns(pool);
  for (std::size_t a = 0; a < 3; ++a) {
    all.at[a] = scratch.data() + a * count;
    all.at_room[a] = scratch.data() + (3 + a) * count;
  }
  const KdOrderKernels& kernels = kd_order_kernels();
  for_stretches(execution, count, kPointsPerTask, [&](std::size_t begin, std::size_t end) {
    kernels.centres(boxes.data(), rows.data(), begin, end, all.at);
  });
  if (count <= kTiledPart) {
    finish(all);
  } else if (count > kMostInTiles || !sort_in_tiles(all)) {
    run_split_jobs(all, kTiledPart, execution, kernels.split, finish);
  }
  return true;
}

}  // namespace winnow
