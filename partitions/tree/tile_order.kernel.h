#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Rows, the centres of their boxes, and room for as many rows.
struct TileSet {
  /// Columns of centres, readable to the next multiple of 16 after the last.
  const float* at[3] = {};
  std::uint32_t* row = nullptr;
  std::uint32_t* row_room = nullptr;
  float* room = nullptr;  ///< for three numbers of each
  std::size_t count = 0;
};

inline constexpr std::size_t kFewestInTiles = 64;
inline constexpr std::size_t kMostInTiles = 16384;

struct TileOrderKernels {
  /// Puts `kFewestInTiles` to `kMostInTiles` rows in order. False, and they stay as they are, where
  /// too many lie in too little of the range over which all of them are spread.
  bool (*sort)(const TileSet&);
};

WINNOW_KERNELS(TileOrderKernels, tile_order_kernels);

}  // namespace winnow
