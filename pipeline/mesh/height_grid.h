#pragma once

#include "pipeline/mesh/mesh_view.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

class HeightField;

/// Side of a tile of level 0 in squares, and of a tile of a higher level in tiles of the level
/// below.
inline constexpr std::uint32_t kTileSquares = 16;
inline constexpr std::uint32_t kTileTiles = 4;

/// Layout of the minimum and maximum heights over a grid of squares: level 0 has a tile for every
/// 16 x 16 squares, level l + 1 for every 4 x 4 tiles of level l; the last level is one tile.
struct HeightPyramid {
  /// 2^27 squares in a row make 2^23 tiles, which 12 divisions by 4 reduce to one.
  static constexpr std::uint32_t kMaxLevels = 13;

  struct Level {
    std::uint32_t columns = 0;
    std::uint32_t rows = 0;
    std::size_t first = 0;
  };
  Level level[kMaxLevels];
  std::uint32_t levels = 0;
  std::size_t tiles = 0;

  /// Side of a tile of `level` in squares.
  [[nodiscard]] static constexpr std::uint32_t span(std::uint32_t level) noexcept {
    return kTileSquares << (2 * level);
  }
  /// The pyramid over columns x rows squares.
  [[nodiscard]] static HeightPyramid plan(std::uint32_t columns, std::uint32_t rows) noexcept;
};

/// A range of squares, or of tiles: columns [low[0], high[0]) of rows [low[1], high[1]).
struct TileRange {
  std::uint32_t low[2];
  std::uint32_t high[2];
};

/// Samples on a grid, and the height ranges of its tiles.
struct HeightGrid {
  const float* heights = nullptr;
  /// Numbers of samples.
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  double spacing[2] = {1.0, 1.0};
  const HeightPyramid* pyramid = nullptr;
  const float* low = nullptr;
  const float* high = nullptr;

  [[nodiscard]] std::uint32_t square_columns() const noexcept { return columns - 1; }
  [[nodiscard]] std::uint32_t square_rows() const noexcept { return rows - 1; }
  /// Reads the heights of a square's corners: its own sample, the next column, the next row, the
  /// next column and row.
  void corners(std::uint32_t column, std::uint32_t row, float (&height)[4]) const noexcept {
    const float* at = heights + std::size_t{row} * columns + column;
    height[0] = at[0];
    height[1] = at[1];
    height[2] = at[columns];
    height[3] = at[columns + std::size_t{1}];
  }
  /// Returns false if the square is a hole or outside the grid.
  [[nodiscard]] bool has_square(std::uint32_t column, std::uint32_t row) const noexcept;
};

/// Recomputes the height ranges of the tiles over a range of squares, on all levels. Tiles without
/// triangles get low = +inf and high = -inf. `low` and `high` are the grid's arrays.
void fit_tiles(const HeightGrid& grid, const TileRange& squares, float* low, float* high) noexcept;

/// The grid of a field; without columns if nothing is built.
[[nodiscard]] HeightGrid grid_of(const HeightField& field) noexcept;

// Traversals, in the field's own frame. A slot is the number of a triangle.

/// Writes the numbers of all triangles whose boxes overlap [min, max] to `out`, in ascending order.
/// If the sink is full, further triangles are only counted.
void height_overlap(const HeightGrid& grid, const double min[3], const double max[3],
                    SlotSink& out) noexcept;
/// As mesh_cast.
void height_cast(const HeightGrid& grid, const double min[3], const double max[3],
                 const double direction[3], double limit, const SlotVisitor& visitor) noexcept;
/// As mesh_near, but without scale, by the distance of boxes of triangles, and up to 16 slots at a
/// time.
void height_near(const HeightGrid& grid, const double min[3], const double max[3], double limit,
                 const SlotVisitor& visitor) noexcept;

}  // namespace winnow
