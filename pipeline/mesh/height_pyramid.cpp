#include "pipeline/mesh/height_pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

struct Heights {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();

  void add(float least, float greatest) {
    low = std::min(low, least);
    high = std::max(high, greatest);
  }
};

bool has_all(const float (&height)[4]) {
  return !(std::isnan(height[0]) || std::isnan(height[1]) || std::isnan(height[2]) ||
           std::isnan(height[3]));
}

Heights over_squares(const HeightGrid& grid, std::uint32_t tile_column, std::uint32_t tile_row) {
  Heights result;
  const std::uint32_t last_row = std::min(grid.square_rows(), (tile_row + 1) * kTileSquares);
  const std::uint32_t last_column =
      std::min(grid.square_columns(), (tile_column + 1) * kTileSquares);
  for (std::uint32_t row = tile_row * kTileSquares; row < last_row; ++row) {
    for (std::uint32_t column = tile_column * kTileSquares; column < last_column; ++column) {
      float height[4];
      grid.corners(column, row, height);
      if (!has_all(height)) continue;
      result.add(std::min({height[0], height[1], height[2], height[3]}),
                 std::max({height[0], height[1], height[2], height[3]}));
    }
  }
  return result;
}

Heights over_tiles(const HeightPyramid& pyramid, std::uint32_t level, std::uint32_t tile_column,
                   std::uint32_t tile_row, const float* low, const float* high) {
  const HeightPyramid::Level& below = pyramid.level[level - 1];
  Heights result;
  const std::uint32_t last_row = std::min(below.rows, (tile_row + 1) * kTileTiles);
  const std::uint32_t last_column = std::min(below.columns, (tile_column + 1) * kTileTiles);
  for (std::uint32_t row = tile_row * kTileTiles; row < last_row; ++row) {
    for (std::uint32_t column = tile_column * kTileTiles; column < last_column; ++column) {
      const std::size_t at = below.first + std::size_t{row} * below.columns + column;
      result.add(low[at], high[at]);
    }
  }
  return result;
}

}  // namespace

HeightPyramid HeightPyramid::plan(std::uint32_t columns, std::uint32_t rows) noexcept {
  HeightPyramid result;
  std::uint32_t side = kTileSquares;
  do {
    columns = (columns + side - 1) / side;
    rows = (rows + side - 1) / side;
    result.level[result.levels++] = {columns, rows, result.tiles};
    result.tiles += std::size_t{columns} * rows;
    side = kTileTiles;
  } while (columns > 1 || rows > 1);
  return result;
}

bool HeightGrid::has_square(std::uint32_t column, std::uint32_t row) const noexcept {
  if (column >= square_columns() || row >= square_rows()) return false;
  float height[4];
  corners(column, row, height);
  return has_all(height);
}

void fit_tiles(const HeightGrid& grid, const TileRange& squares, float* low, float* high) noexcept {
  const HeightPyramid& pyramid = *grid.pyramid;
  for (std::uint32_t level = 0; level < pyramid.levels; ++level) {
    const HeightPyramid::Level& tiles = pyramid.level[level];
    const std::uint32_t span = HeightPyramid::span(level);
    for (std::uint32_t row = squares.low[1] / span; row <= (squares.high[1] - 1) / span; ++row) {
      for (std::uint32_t column = squares.low[0] / span; column <= (squares.high[0] - 1) / span;
           ++column) {
        const Heights heights = level == 0 ? over_squares(grid, column, row)
                                           : over_tiles(pyramid, level, column, row, low, high);
        const std::size_t at = tiles.first + std::size_t{row} * tiles.columns + column;
        low[at] = heights.low;
        high[at] = heights.high;
      }
    }
  }
}

}  // namespace winnow
