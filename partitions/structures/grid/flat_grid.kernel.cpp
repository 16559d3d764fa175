// Kernels of FlatGrid: self pairs, batch queries and the search for misfits in lines of cells.

#include "partitions/structures/grid/flat_grid.kernel.h"
#include "partitions/structures/cells/cells.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

struct Run {
  std::uint32_t begin;
  std::uint32_t end;
};

/// Returns the rows of cells [first, last] of a line.
Run run_of(const GridView& grid, std::uint32_t line, std::uint32_t first, std::uint32_t last) {
  const std::uint32_t* start = grid.start + std::size_t{line} * grid.axis[0].count;
  return {start[first], start[last + 1]};
}

/// Adds the rows of line `own` and of later lines that may touch a block of line `own`.
template <bool Filtered>
bool add_neighbours(const GridView& grid, std::uint32_t own, BlockPairs<Filtered>& pairs) {
  std::uint32_t first[3];
  std::uint32_t last[3];
  for (int a = 0; a < 3; ++a) {
    const CellAxis& axis = grid.axis[a];
    first[a] = first_cell(axis, pairs.low()[axis.axis] - axis.reach);
    last[a] = last_cell(axis, pairs.high()[axis.axis]);
  }
  const std::uint32_t mids = grid.axis[1].count;
  for (std::uint32_t slow = own / mids; slow <= last[2]; ++slow) {
    const std::uint32_t from = slow * mids + first[1];
    const std::uint32_t to = slow * mids + last[1];
    for (std::uint32_t line = from > own ? from : own; line <= to; ++line) {
      const Run run = run_of(grid, line, first[0], last[0]);
      if (!pairs.add_run(run.begin, run.end)) return false;
    }
  }
  return true;
}

/// Appends the rows that left their cell along the line to the `found` ascending rows at `out`,
/// without duplicates, and returns the new count. Cells are short, so this tests single rows; the
/// other bounds are tested 16 rows at a time.
std::uint32_t left_along_line(const GridView& grid, const std::uint32_t* start, std::uint32_t* out,
                              std::uint32_t found) {
  const CellAxis& axis = grid.axis[0];
  const float* const low = grid.rows.column[axis.axis];
  const std::uint32_t* known = out;
  const std::uint32_t* const end = out + found;
  for (std::uint32_t c = 0; c < axis.count; ++c) {
    const float from = axis.from[c];
    const float to = axis.to[c];
    for (std::uint32_t r = start[c]; r < start[c + 1]; ++r) {
      const bool kept = (low[r] >= from) & (low[r] <= to);
      if (kept || grid.rows.id[r] == ~0U) continue;
      while (known != end && *known < r) ++known;
      if (known == end || *known != r) out[found++] = r;
    }
  }
  return found;
}

struct GridCells {
  template <bool Filtered>
  static bool find_pairs(const GridView& grid, std::uint32_t begin, std::uint32_t end,
                         PairSink& sink) {
    const std::uint32_t cells = grid.axis[0].count;
    BlockPairs<Filtered> pairs(grid.rows, sink);
    for (std::uint32_t line = begin; line < end; ++line) {
      const std::uint32_t last = grid.start[std::size_t{line + 1} * cells];
      for (std::uint32_t r = grid.start[std::size_t{line} * cells]; r < last; r += kLanes) {
        if (!pairs.start(r, last - r < kLanes ? last : r + kLanes)) continue;
        if (!add_neighbours(grid, line, pairs) || !pairs.finish()) return false;
      }
    }
    return true;
  }

  static AllRows needs_rows(const GridView&) { return {}; }
  template <typename Visit>
  static bool visit_runs(const GridView& grid, const QueryBox& q, Visit&& visit) {
    std::uint32_t first[3];
    std::uint32_t last[3];
    for (int a = 0; a < 3; ++a) {
      const CellAxis& axis = grid.axis[a];
      first[a] = first_cell(axis, q.low[axis.axis] - axis.reach);
      last[a] = last_cell(axis, q.high[axis.axis]);
    }
    for (std::uint32_t slow = first[2]; slow <= last[2]; ++slow) {
      const std::uint32_t lines = slow * grid.axis[1].count;
      std::uint32_t mid = first[1];
      while (mid <= last[1]) {
        // Whole lines are consecutive rows: one range.
        const bool whole = first[0] == 0 && last[0] + 1 == grid.axis[0].count;
        const std::uint32_t until = whole ? last[1] : mid;
        const std::uint32_t begin = run_of(grid, lines + mid, first[0], last[0]).begin;
        if (!visit(begin, run_of(grid, lines + until, first[0], last[0]).end)) return false;
        mid = until + 1;
      }
    }
    return true;
  }

  static std::uint32_t find_misfits(const GridView& grid, std::uint32_t begin, std::uint32_t end,
                                    std::uint32_t* out) {
    std::uint32_t found = 0;
    const std::uint32_t cells = grid.axis[0].count;
    const std::uint32_t mids = grid.axis[1].count;
    for (std::uint32_t line = begin; line < end; ++line) {
      const std::uint32_t* start = grid.start + std::size_t{line} * cells;
      if (start[0] == start[cells]) continue;
      const AxisBounds mid(grid.rows, grid.axis[1], line % mids);
      const AxisBounds slow(grid.rows, grid.axis[2], line / mids);
      const AxisBounds along(grid.rows, grid.axis[0], 0);
      std::uint32_t* const line_out = out + found;
      const std::uint32_t wide =
          write_misfits(grid.rows, start[0], start[cells], line_out, [&](std::size_t row) {
            return mid.kept(row) & slow.kept(row) &
                   along.short_enough(Floats::load_unaligned(along.low + row), row);
          });
      found += left_along_line(grid, start, line_out, wide);
    }
    return found;
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const FlatGridKernels WINNOW_KERNEL_TABLE(flat_grid_kernels) =
    WINNOW_ISA_NAME::CellFunctions<WINNOW_ISA_NAME::GridCells, GridView>::table();

}  // namespace winnow
