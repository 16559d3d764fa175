#pragma once

#include "partitions/structures/cells/cells.kernel.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// One axis of a level's cells. `cell_at` computes the cell of a position and reads no table, so an
/// axis may have millions of cells. The result is monotonic in the position even with float
/// rounding, so the cells from one position to another contain all objects with a lower bound in
/// between. An object keeps its cell if its lower bound has moved by at most `slack`.
struct LevelAxis {
  std::uint32_t axis = 0;  ///< 0, 1, 2 for x, y, z
  float origin = 0.0F;
  float inverse = 0.0F;  ///< cells per unit length; 0 if the axis is not divided
  float last = 0.0F;     ///< number of the last cell, exact in float
  float limit = 0.0F;    ///< longest edge of the level, computed in float
  float slack = 0.0F;
  float pad = 0.0F;  ///< at least the longest edge plus the slack
};

static inline std::uint32_t cell_at(const LevelAxis& a, float x) {
  const float t = (x - a.origin) * a.inverse;
  return static_cast<std::uint32_t>(t > 0.0F ? (t < a.last ? t : a.last) : 0.0F);
}
/// Returns the first cell that may contain an object that extends to x or beyond.
static inline std::uint32_t first_cell(const LevelAxis& a, float x) {
  return cell_at(a, x - a.pad);
}
/// Returns the last cell that may contain an object with a lower bound <= x.
static inline std::uint32_t last_cell(const LevelAxis& a, float x) {
  return cell_at(a, x + a.slack);
}

/// Consecutive cells along the fast axis, from the line's first object to its last; each cell is
/// 2^shift steps long. Odd lines run backwards: their steps are counted from the other end of the
/// axis.
struct GridLine {
  std::uint32_t first = 0;      ///< step at which cell 0 begins
  std::uint32_t last_cell = 0;  ///< number of the last cell
  std::uint32_t shift = 0;
  std::uint32_t cell = 0;  ///< index of cell 0 in `start`
};

/// The cells of one level. Each line is one cell of the middle and one of the slow axis. Lines are
/// numbered in alternating directions, so that successive lines are neighbours. Only lines with
/// objects are stored, by ascending number.
struct GridLevel {
  LevelAxis fast;
  LevelAxis mid;
  LevelAxis slow;
  std::uint32_t mids = 1;       ///< lines along the middle axis
  std::uint32_t steps = 0;      ///< the last step of the fast axis: a power of two minus one
  std::uint32_t first_row = 0;  ///< a multiple of 16
  std::uint32_t end_row = 0;
  std::uint32_t first_line = 0;
  std::uint32_t end_line = 0;
  std::uint32_t first_rank = 0;
  bool ranked = false;  ///< true: `rank` has the lines; false: binary search
};

/// Levels from the smallest objects to the largest. Rows are sorted by level, line and cell.
struct LevelsView {
  RowView rows;
  const GridLevel* level = nullptr;
  std::uint32_t levels = 0;
  const GridLine* line = nullptr;
  const std::uint32_t* number = nullptr;  ///< of each line
  const std::uint32_t* rank = nullptr;    ///< by line number: the first stored line >= it
  const std::uint32_t* start = nullptr;   ///< first row of each cell
  const float* key = nullptr;             ///< by row: lower bound on the fast axis at the build
};

static inline std::uint32_t line_number(const GridLevel& g, std::uint32_t mid, std::uint32_t slow) {
  return slow * g.mids + ((slow & 1U) != 0 ? g.mids - 1 - mid : mid);
}

/// The cells of a line on the middle and the slow axis.
struct LineCells {
  std::uint32_t mid;
  std::uint32_t slow;
};
static inline LineCells cells_of_line(const GridLevel& g, std::uint32_t number) {
  const std::uint32_t slow = number / g.mids;
  const std::uint32_t mid = number % g.mids;
  return {(slow & 1U) != 0 ? g.mids - 1 - mid : mid, slow};
}

/// A place is an index of LevelsView::line, which has the lines of all levels. A unit is a block of
/// 16 rows.
using HierarchicalGridKernels = CellKernels<LevelsView>;

WINNOW_KERNELS(HierarchicalGridKernels, hierarchical_grid_kernels);

}  // namespace winnow
