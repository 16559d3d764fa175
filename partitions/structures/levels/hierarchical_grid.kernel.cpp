// Kernels of HierarchicalGrid: self pairs, batch queries and the search for misfits in lines of
// cells.

#include "partitions/structures/levels/hierarchical_grid.kernel.h"
#include "partitions/structures/cells/cells.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Returns the index of the first stored line whose number is not below `number`.
std::uint32_t lines_below(const LevelsView& grid, const GridLevel& g, std::uint32_t number) {
  std::uint32_t at = g.first_line;
  std::uint32_t left = g.end_line - at;
  while (left > 0) {
    const std::uint32_t half = (left + 1) / 2;
    at += grid.number[at + half - 1] < number ? half : 0;
    left -= half;
  }
  return at;
}

/// Calls visit(begin, end) with ascending ranges of rows that contain all rows whose boxes may
/// overlap [low, high]. Stops and returns false if visit returns false.
template <typename Visit>
[[gnu::always_inline]] inline bool visit_level(const LevelsView& grid, const GridLevel& g,
                                               const float* low, const float* high, Visit&& visit) {
  const std::uint32_t from = first_cell(g.fast, low[g.fast.axis]);
  const std::uint32_t to = last_cell(g.fast, high[g.fast.axis]);
  const std::uint32_t first_mid = first_cell(g.mid, low[g.mid.axis]);
  const std::uint32_t last_mid = last_cell(g.mid, high[g.mid.axis]);
  const std::uint32_t last_slow = last_cell(g.slow, high[g.slow.axis]);
  for (std::uint32_t slow = first_cell(g.slow, low[g.slow.axis]); slow <= last_slow; ++slow) {
    const bool backwards = (slow & 1U) != 0;
    const std::uint32_t a = line_number(g, backwards ? last_mid : first_mid, slow);
    const std::uint32_t b = line_number(g, backwards ? first_mid : last_mid, slow) + 1;
    const std::uint32_t* rank = grid.rank + g.first_rank;
    std::uint32_t line = g.ranked ? rank[a] : lines_below(grid, g, a);
    const std::uint32_t end = g.ranked ? rank[b] : lines_below(grid, g, b);
    if (line == end && !g.ranked) {
      // The lines are sparse: continues at the next stored line.
      if (line == g.end_line) break;
      const std::uint32_t next = grid.number[line] / g.mids;
      slow = next > slow ? next - 1 : slow;
      continue;
    }
    if (from == 0 && to == g.steps && line < end) {
      const GridLine& last = grid.line[end - 1];
      if (!visit(grid.start[grid.line[line].cell], grid.start[last.cell + last.last_cell + 1])) {
        return false;
      }
      continue;
    }
    for (; line < end; ++line) {
      const GridLine& l = grid.line[line];
      const bool back = (grid.number[line] & 1U) != 0;
      const std::uint32_t first = back ? g.steps - to : from;
      const std::uint32_t last = back ? g.steps - from : to;
      const std::uint32_t cell = (first > l.first ? first - l.first : 0) >> l.shift;
      if (last < l.first || cell > l.last_cell) continue;
      const std::uint32_t until = (last - l.first) >> l.shift;
      const std::uint32_t end_cell = (until < l.last_cell ? until : l.last_cell) + 1;
      if (!visit(grid.start[l.cell + cell], grid.start[l.cell + end_cell])) return false;
    }
  }
  return true;
}

/// Tests which rows may stay in one cell of an axis.
class CellBoundsTest {
 public:
  CellBoundsTest(const RowView& rows, const LevelAxis& axis, std::uint32_t cell)
      : low_(rows.column[axis.axis]),
        high_(rows.column[3 + axis.axis]),
        axis_(axis),
        // The first and the last cell are unbounded.
        from_(cell == 0 ? -__builtin_inff() : static_cast<float>(cell)),
        to_(static_cast<float>(cell) == axis.last ? __builtin_inff()
                                                  : static_cast<float>(cell + 1)) {}

  [[nodiscard]] Mask16 kept(std::size_t row) const {
    const Floats x = Floats::load_unaligned(low_ + row);
    const Floats slack = Floats(axis_.slack);
    return bits(from_ <= place(x + slack)) & ~bits(to_ <= place(x - slack)) & short_enough(x, row);
  }
  [[nodiscard]] Mask16 near_key(std::size_t row, const float* key) const {
    const Floats x = Floats::load_unaligned(low_ + row);
    const Floats slack = Floats(axis_.slack);
    const Floats at = Floats::load_unaligned(key + row);
    return bits(x - slack <= at) & bits(at <= x + slack) & short_enough(x, row);
  }

 private:
  [[nodiscard]] Floats place(const Floats& x) const { return (x - axis_.origin) * axis_.inverse; }
  [[nodiscard]] Mask16 short_enough(const Floats& x, std::size_t row) const {
    return bits(Floats::load_unaligned(high_ + row) - x <= axis_.limit);
  }

  const float* low_;
  const float* high_;
  const LevelAxis& axis_;
  float from_;
  float to_;
};

struct LevelCells {
  template <bool Filtered>
  static bool find_pairs(const LevelsView& grid, std::uint32_t begin, std::uint32_t end,
                         PairSink& sink) {
    BlockPairs<Filtered> pairs(grid.rows, sink);
    std::uint32_t level = 0;
    for (std::uint32_t block = begin; block < end; ++block) {
      while (block * kLanes >= grid.level[level].end_row) ++level;
      if (!pairs.start(block * kLanes, block * kLanes + kLanes)) continue;
      const auto add = [&](std::uint32_t from, std::uint32_t to) {
        return pairs.add_run(from, to);
      };
      for (std::uint32_t l = level; l < grid.levels; ++l) {
        if (!visit_level(grid, grid.level[l], pairs.low(), pairs.high(), add)) return false;
      }
      if (!pairs.finish()) return false;
    }
    return true;
  }

  static AllRows needs_rows(const LevelsView&) { return {}; }
  template <typename Visit>
  static bool visit_runs(const LevelsView& grid, const QueryBox& q, Visit&& visit) {
    for (std::uint32_t l = 0; l < grid.levels; ++l) {
      if (!visit_level(grid, grid.level[l], q.low, q.high, visit)) return false;
    }
    return true;
  }

  static std::uint32_t find_misfits(const LevelsView& grid, std::uint32_t begin, std::uint32_t end,
                                    std::uint32_t* out) {
    std::uint32_t found = 0;
    const GridLevel* level = grid.level;
    for (std::uint32_t l = begin; l < end; ++l) {
      while (l >= level->end_line) ++level;
      const LineCells cells = cells_of_line(*level, grid.number[l]);
      const CellBoundsTest mids(grid.rows, level->mid, cells.mid);
      const CellBoundsTest slows(grid.rows, level->slow, cells.slow);
      const CellBoundsTest fasts(grid.rows, level->fast, 0);
      const GridLine& line = grid.line[l];
      found += write_misfits(
          grid.rows, grid.start[line.cell], grid.start[line.cell + line.last_cell + 1], out + found,
          [&](std::size_t row) {
            return mids.kept(row) & slows.kept(row) & fasts.near_key(row, grid.key);
          });
    }
    return found;
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const HierarchicalGridKernels WINNOW_KERNEL_TABLE(hierarchical_grid_kernels) =
    WINNOW_ISA_NAME::CellFunctions<WINNOW_ISA_NAME::LevelCells, LevelsView>::table();

}  // namespace winnow
