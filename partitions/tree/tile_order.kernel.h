#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Rows with the centres of their boxes, and columns of the same size as scratch.
struct TileSet {
  const float* at[3] = {};
  std::uint32_t* row = nullptr;
  std::uint32_t* row_room = nullptr;
  float* room[3] = {};  ///< for one number per row each
  std::size_t count = 0;
};

inline constexpr std::size_t kMinInTiles = 64;
inline constexpr std::size_t kMaxInTiles = 16384;

/// Orders kMinInTiles to kMaxInTiles rows for a block tree only by counting, instead of cutting
/// from the top down (compare sort-tile-recursive packing: Leutenegger, Lopez and Edgington, "STR:
/// a simple and efficient algorithm for R-tree packing", ICDE 1997). One axis is cut into slabs,
/// and slabs into lines, with about equal numbers of points, and each line is sorted in steps along
/// the third and longest axis. Successive lines run in opposite directions, so that a block that
/// starts in one line may end in the next. Pairs take some percent more tests than after cuts.
struct TileOrderKernels {
  /// Sorts `kMinInTiles` to `kMaxInTiles` rows. Returns false and changes nothing if too many
  /// rows are in too small a part of their range.
  bool (*sort)(const TileSet&);
};

WINNOW_KERNELS(TileOrderKernels, tile_order_kernels);

}  // namespace winnow
