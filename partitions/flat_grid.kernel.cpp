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

std::uint32_t find_misfits(const GridView& grid, std::uint32_t* out, std::uint32_t limit) {
  const std::uint32_t cells[3] = {grid.axis[0].count, grid.axis[1].count, grid.axis[2].count};
  std::uint32_t found = 0;
  const std::uint32_t* start = grid.start;
  std::uint32_t at[3];
  for (at[2] = 0; at[2] < cells[2]; ++at[2]) {
    for (at[1] = 0; at[1] < cells[1]; ++at[1]) {
      for (at[0] = 0; at[0] < cells[0]; ++at[0], ++start) {
        for (std::uint32_t r = start[0]; r < start[1]; ++r) {
          bool fits = true;
          for (int a = 0; a < 3; ++a) {
            const CellAxis& axis = grid.axis[a];
            const float low = grid.rows.column[axis.axis][r];
            const float edge = grid.rows.column[3 + axis.axis][r] - low;
            fits &= (low >= axis.from[at[a]]) & (low <= axis.to[at[a]]) & (edge <= axis.limit);
          }
          // An empty row has no id and nothing to lose.
          if (fits || grid.rows.id[r] == ~0U) continue;
          if (found == limit) return found;
          out[found++] = r;
        }
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
