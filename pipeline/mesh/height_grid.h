#pragma once

#include "pipeline/mesh/mesh_view.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

class HeightField;

/// Squares along a side of a tile of level 0, and tiles along a side of one of a higher level.
inline constexpr std::uint32_t kTileSquares = 16;
inline constexpr std::uint32_t kTileTiles = 4;

/// How the least and greatest heights over a grid of squares are laid out: level 0 has a tile for
/// every 16 x 16 squares, level l + 1 for every 4 x 4 tiles of level l, the last level one tile.
struct HeightPyramid {
  /// 2^27 squares in a row are 2^23 tiles, and 12 times a quarter of them.
  static constexpr std::uint32_t kMaxLevels = 13;

  struct Level {
    std::uint32_t columns = 0;
    std::uint32_t rows = 0;
    std::size_t first = 0;
  };
  Level level[kMaxLevels];
  std::uint32_t levels = 0;
  std::size_t tiles = 0;

  /// Squares along a side of a tile.
  [[nodiscard]] static constexpr std::uint32_t span(std::uint32_t level) noexcept {
    return kTileSquares << (2 * level);
  }
  /// For columns x rows squares.
  [[nodiscard]] static HeightPyramid plan(std::uint32_t columns, std::uint32_t rows) noexcept;
};

/// A range of squares, or of tiles: columns [low[0], high[0]) of rows [low[1], high[1]).
struct TileRange {
  std::uint32_t low[2];
  std::uint32_t high[2];
};

/// Samples over a grid, and the heights of its tiles.
struct HeightGrid {
  const float* heights = nullptr;
  /// Of samples.
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  double spacing[2] = {1.0, 1.0};
  const HeightPyramid* pyramid = nullptr;
  const float* low = nullptr;
  const float* high = nullptr;

  [[nodiscard]] std::uint32_t square_columns() const noexcept { return columns - 1; }
  [[nodiscard]] std::uint32_t square_rows() const noexcept { return rows - 1; }
  /// The heights of a square's corners: at its low column and row, then by column, then by row.
  void corners(std::uint32_t column, std::uint32_t row, float (&height)[4]) const noexcept {
    const float* at = heights + std::size_t{row} * columns + column;
    height[0] = at[0];
    height[1] = at[1];
    height[2] = at[columns];
    height[3] = at[columns + std::size_t{1}];
  }
  /// False for a hole.
  [[nodiscard]] bool has_square(std::uint32_t column, std::uint32_t row) const noexcept;
};

/// Finds the heights of the tiles over a range of squares anew, on all levels. Tiles without
/// triangles get +inf and -inf. `low` and `high` are those of the grid.
void fit_tiles(const HeightGrid& grid, const TileRange& squares, float* low, float* high) noexcept;

/// Without columns if nothing is built.
[[nodiscard]] HeightGrid grid_of(const HeightField& field) noexcept;

// Traversals, in the field's own frame. A slot is the number of a triangle.

/// The numbers of all triangles whose boxes meet [min, max], ascending; counts on where there is no
/// room.
void height_overlap(const HeightGrid& grid, const double min[3], const double max[3],
                    SlotSink& out) noexcept;
/// As mesh_sweep.
void height_sweep(const HeightGrid& grid, const double min[3], const double max[3],
                  const double direction[3], double limit, const SlotVisitor& visitor) noexcept;
/// As mesh_near.
void height_near(const HeightGrid& grid, const double min[3], const double max[3], double limit,
                 const SlotVisitor& visitor) noexcept;

}  // namespace winnow
