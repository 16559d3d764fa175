#include <winnow/partitions/flat_grid.kernel.h>
#include <winnow/partitions/hits.kernel.h>

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

struct Run {
  std::uint32_t begin;
  std::uint32_t end;
};

/// Rows of cells [first, last] of a line.
Run run_of(const GridView& grid, std::uint32_t line, std::uint32_t first, std::uint32_t last) {
  const std::uint32_t* start = grid.start + std::size_t{line} * grid.axis[0].count;
  return {start[first], start[last + 1]};
}

/// A run of cells is tested to its end.
struct ToTheEnd {
  bool operator()(const QueryBox&, std::uint32_t) const { return true; }
};

/// The lines that a line's cells are tested against: those after it whose cells can touch.
struct Neighbours {
  std::uint32_t line[4];
  int count = 0;

  Neighbours(const GridView& grid, std::uint32_t own) {
    const std::uint32_t mids = grid.axis[1].count;
    const std::uint32_t mid = own % mids;
    if (mid + 1 < mids) line[count++] = own + 1;
    if (own / mids + 1 == grid.axis[2].count) return;
    if (mid > 0) line[count++] = own + mids - 1;
    line[count++] = own + mids;
    if (mid + 1 < mids) line[count++] = own + mids + 1;
  }
};

bool self_pairs(const GridView& grid, std::uint32_t begin, std::uint32_t end, PairSink& sink) {
  const std::uint32_t cells = grid.axis[0].count;
  HitList<HitMode::unordered> hits(grid.rows, grid.rows.id, nullptr, sink);
  RunList list(grid.rows, grid.rows.column, hits, ToTheEnd{}, sink);
  for (std::uint32_t line = begin; line < end; ++line) {
    const std::uint32_t* start = grid.start + std::size_t{line} * cells;
    if (start[0] == start[cells]) continue;
    const Neighbours neighbours(grid, line);
    for (std::uint32_t c = 0; c < cells; ++c) {
      if (start[c] == start[c + 1]) continue;
      const std::uint32_t before = c > 0 ? c - 1 : 0;
      const std::uint32_t after = c + 1 < cells ? c + 1 : c;
      Run runs[4];
      for (int k = 0; k < neighbours.count; ++k) {
        runs[k] = run_of(grid, neighbours.line[k], before, after);
      }
      for (std::uint32_t r = start[c]; r < start[c + 1]; ++r) {
        // Behind the row itself: the pair with an earlier one is that one's.
        if (!list.add(r, r + 1, start[after + 1])) return false;
        for (int k = 0; k < neighbours.count; ++k) {
          if (!list.add(r, runs[k].begin, runs[k].end)) return false;
        }
      }
    }
  }
  return list.finish() && hits.flush();
}

struct Query {
  template <HitMode Mode>
  static bool run(const GridView& grid, const QueryBatch& batch, PairSink& sink) {
    HitList<Mode> hits(grid.rows, batch.id, batch.moved, sink);
    RunList list(grid.rows, batch.column, hits, ToTheEnd{}, sink);
    for (std::uint32_t k = batch.begin; k < batch.end; ++k) {
      const std::uint32_t row = batch.rows != nullptr ? batch.rows[k] : k;
      const QueryBox q(batch.column, row);
      if (!(q.low[0] <= q.high[0])) continue;
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
          // Whole lines follow each other in memory: one run.
          const bool whole = first[0] == 0 && last[0] + 1 == grid.axis[0].count;
          const std::uint32_t until = whole ? last[1] : mid;
          const Run run{run_of(grid, lines + mid, first[0], last[0]).begin,
                        run_of(grid, lines + until, first[0], last[0]).end};
          if (!list.add(row, run.begin, run.end)) return false;
          mid = until + 1;
        }
      }
    }
    return list.finish() && hits.flush();
  }
};

bool query(const GridView& grid, const QueryBatch& batch, PairSink& sink) {
  return with_mode<Query>(grid, batch, sink);
}

/// What a row of one cell must keep to: its lower corner within [from, to], its edges within limit.
struct CellBounds {
  float from[3];
  float to[3];
  float limit[3];
};

bool keeps_to(const CellBounds& cell, const float* const* low, const float* const* high,
              std::uint32_t r) {
  bool kept = true;
  for (int a = 0; a < 3; ++a) {
    const float x = low[a][r];
    kept &= (x >= cell.from[a]) & (x <= cell.to[a]) & (high[a][r] - x <= cell.limit[a]);
  }
  return kept;
}

std::uint32_t find_misfits(const GridView& grid, std::uint32_t begin, std::uint32_t end,
                           std::uint32_t* out) {
  const float* low[3];
  const float* high[3];
  CellBounds cell;
  for (int a = 0; a < 3; ++a) {
    low[a] = grid.rows.column[grid.axis[a].axis];
    high[a] = grid.rows.column[3 + grid.axis[a].axis];
    cell.limit[a] = grid.axis[a].limit;
  }
  std::uint32_t found = 0;
  const std::uint32_t cells = grid.axis[0].count;
  for (std::uint32_t line = begin; line < end; ++line) {
    const std::uint32_t at[2] = {line % grid.axis[1].count, line / grid.axis[1].count};
    for (int a = 1; a < 3; ++a) {
      cell.from[a] = grid.axis[a].from[at[a - 1]];
      cell.to[a] = grid.axis[a].to[at[a - 1]];
    }
    const std::uint32_t* start = grid.start + std::size_t{line} * cells;
    for (std::uint32_t c = 0; c < cells; ++c) {
      cell.from[0] = grid.axis[0].from[c];
      cell.to[0] = grid.axis[0].to[c];
      for (std::uint32_t r = start[c]; r < start[c + 1]; ++r) {
        out[found] = r;
        // An empty row has no id and nothing to lose.
        found += !keeps_to(cell, low, high, r) && grid.rows.id[r] != ~0U ? 1U : 0U;
      }
    }
  }
  return found;
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const FlatGridKernels WINNOW_KERNEL_TABLE(flat_grid_kernels) = {
    WINNOW_ISA_NAME::self_pairs, WINNOW_ISA_NAME::query, WINNOW_ISA_NAME::find_misfits};

}  // namespace winnow
