#include <winnow/partitions/hierarchical_grid.kernel.h>
#include <winnow/partitions/hits.wide.h>
#include <winnow/partitions/misfits.wide.h>

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Stored lines with a number below `number`.
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

/// Calls visit(begin, end) with runs of rows, ascending, among which are all whose boxes may
/// overlap [low, high]. Stops when it says false.
template <typename Visit>
[[gnu::always_inline]] inline bool visit_runs(const LevelsView& grid, const GridLevel& g,
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
      // Objects far apart: on to where the next line is.
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

/// Pairs of a block of 16 rows with the rows behind it. Rows of a block lie close together: one box
/// around them asks the grid, 16 rows at a time, who may touch any of them, and only those are
/// tested one by one, each against the whole block, which stays in registers.
template <bool Filtered>
class BlockPairs {
 public:
  BlockPairs(const LevelsView& grid, PairSink& sink)
      : grid_(grid), sink_(sink), filters_(grid.rows) {}

  bool add(std::uint32_t block, std::uint32_t level) {
    at_ = block * kLanes;
    const Box16 rows = load_slabs<3>(grid_.rows.column, at_);
    for (int a = 0; a < 3; ++a) {
      low_[a] = reduce_min(rows.low[a]);
      high_[a] = reduce_max(rows.high[a]);
    }
    if (!(low_[0] <= high_[0])) return true;  // holes only
    test_self(rows);
    std::uint32_t next = block + 1;
    for (std::uint32_t l = level; l < grid_.levels; ++l) {
      const auto visit = [&](std::uint32_t begin, std::uint32_t end) {
        // Runs ascend but may share a block.
        const std::uint32_t first = begin / kLanes > next ? begin / kLanes : next;
        const std::uint32_t last = (end + kLanes - 1) / kLanes;
        next = last > next ? last : next;
        return add_blocks(first, last);
      };
      if (!visit_runs(grid_, grid_.level[l], low_, high_, visit)) return false;
    }
    return test_blocks() && test_rows();
  }

 private:
  static constexpr unsigned kBlockRoom = 512;
  static constexpr unsigned kRowRoom = 1024;

  /// Of two rows of the block the one in front asks.
  void test_self(const Box16& rows) {
    for (unsigned i = 0; i + 1 < kLanes; ++i) {
      const QueryBox q(grid_.rows.column, at_ + i);
      add_hits(at_ + i, overlap(rows, q.low, q.high) & ~lanes_below(i + 1), hits_);
    }
    sink_.tests += kLanes - 1;
  }

  /// Whether a test hits is a coin toss to the branch predictor: no branch here. The count is the
  /// caller's, in a register.
  void add_hits(std::uint32_t row, Mask16 mask, unsigned& count) {
    hit_row_[count] = row;
    hit_mask_[count] = mask;
    count += mask != 0 ? 1U : 0U;
  }

  bool add_blocks(std::uint32_t first, std::uint32_t last) {
    for (; first < last; first += kLanes) {
      if (blocks_ > kBlockRoom - kLanes && !test_blocks()) return false;
      store_unaligned(block_ + blocks_, count_from(first));
      blocks_ += last - first < kLanes ? last - first : kLanes;
    }
    return true;
  }

  /// Lists the rows of the listed blocks that may touch any row of the own one.
  bool test_blocks() {
    const float low[3] = {low_[0], low_[1], low_[2]};
    const float high[3] = {high_[0], high_[1], high_[2]};
    unsigned rows = rows_;
    for (unsigned k = 0; k < blocks_; ++k) {
      if (rows > kRowRoom - kLanes) {
        rows_ = rows;
        if (!test_rows()) return false;
        rows = 0;
      }
      const std::uint32_t at = block_[k] * kLanes;
      const Mask16 mask = overlap(load_slabs<3>(grid_.rows.column, at), low, high);
      rows += compress_store(mask, count_from(at), row_ + rows);
    }
    sink_.tests += blocks_;
    rows_ = rows;
    blocks_ = 0;
    return true;
  }

  /// Tests the listed rows against the own block, which stays in registers.
  bool test_rows() {
    const Box16 rows = load_slabs<3>(grid_.rows.column, at_);
    unsigned hits = hits_;
    for (unsigned k = 0; k < rows_; ++k) {
      const QueryBox q(grid_.rows.column, row_[k]);
      add_hits(row_[k], overlap(rows, q.low, q.high), hits);
    }
    sink_.tests += rows_;
    hits_ = hits;
    rows_ = 0;
    return report_hits();
  }

  bool report_hits() {
    if (has_more_to_test(grid_.rows)) drop_boxes();
    const Uint16 ids = load_unaligned(grid_.rows.id + at_);
    for (unsigned k = 0; k < hits_; ++k) {
      if (!has_room(sink_)) return false;
      const std::uint32_t id = grid_.rows.id[hit_row_[k]];
      Mask16 mask = hit_mask_[k];
      if constexpr (Filtered) mask = passing_rows(grid_.rows, at_, mask, filters_.of(id));
      sink_.cursor += 2 * emit_pairs<true>(mask, ids, id, sink_.cursor);
    }
    hits_ = 0;
    return true;
  }

  /// Keeps the hits of the volumes in the boxes.
  void drop_boxes() {
    for (unsigned k = 0; k < hits_; ++k) hit_at_[k] = at_;
    hits_ = keep_volume_hits(grid_.rows, grid_.rows.column, hit_row_, hit_at_, hit_mask_, hits_);
  }

  const LevelsView& grid_;
  PairSink& sink_;
  const AskingFilters filters_;
  std::uint32_t at_ = 0;
  float low_[3];
  float high_[3];
  unsigned blocks_ = 0;
  unsigned rows_ = 0;
  unsigned hits_ = 0;
  std::uint32_t block_[kBlockRoom + kLanes];
  std::uint32_t row_[kRowRoom + kLanes];
  std::uint32_t hit_row_[kRowRoom + 2 * kLanes];
  std::uint32_t hit_at_[kRowRoom + 2 * kLanes];  // of volumes other than boxes
  std::uint32_t hit_mask_[kRowRoom + 2 * kLanes];
};

template <bool Filtered>
bool find_self_pairs(const LevelsView& grid, std::uint32_t begin, std::uint32_t end,
                     PairSink& sink) {
  BlockPairs<Filtered> pairs(grid, sink);
  std::uint32_t level = 0;
  for (std::uint32_t block = begin; block < end; ++block) {
    while (block * kLanes >= grid.level[level].end_row) ++level;
    if (!pairs.add(block, level)) return false;
  }
  return true;
}

bool self_pairs(const LevelsView& grid, std::uint32_t begin, std::uint32_t end, PairSink& sink) {
  return grid.rows.filter != nullptr ? find_self_pairs<true>(grid, begin, end, sink)
                                     : find_self_pairs<false>(grid, begin, end, sink);
}

/// A run of cells is tested to its end.
struct ToTheEnd {
  bool operator()(const QueryBox&, std::uint32_t) const { return true; }
};

struct Query {
  template <HitMode Mode, bool Filtered>
  static bool run(const LevelsView& grid, const QueryBatch& batch, PairSink& sink) {
    HitList<Mode, Filtered> hits(grid.rows, batch, sink);
    RunList list(grid.rows, batch.column, hits, ToTheEnd{}, sink);
    for (std::uint32_t k = batch.begin; k < batch.end; ++k) {
      const std::uint32_t row = batch.rows != nullptr ? batch.rows[k] : k;
      const QueryBox q(batch.column, row);
      if (!(q.low[0] <= q.high[0])) continue;
      for (std::uint32_t l = 0; l < grid.levels; ++l) {
        const auto add = [&](std::uint32_t begin, std::uint32_t end) {
          return list.add(row, begin, end);
        };
        if (!visit_runs(grid, grid.level[l], q.low, q.high, add)) return false;
      }
    }
    return list.finish() && hits.flush();
  }
};

bool query(const LevelsView& grid, const QueryBatch& batch, PairSink& sink) {
  return with_mode<Query>(grid, batch, sink);
}

/// The rows that may stay in one cell of an axis.
class Keeping {
 public:
  Keeping(const RowView& rows, const LevelAxis& axis, std::uint32_t cell)
      : low_(rows.column[axis.axis]),
        high_(rows.column[3 + axis.axis]),
        axis_(axis),
        // The first and the last cell have no end.
        from_(cell == 0 ? -__builtin_inff() : static_cast<float>(cell)),
        to_(static_cast<float>(cell) == axis.last ? __builtin_inff()
                                                  : static_cast<float>(cell + 1)) {}

  [[nodiscard]] Mask16 kept(std::size_t row) const {
    const Float16 x = load_unaligned(low_ + row);
    const Float16 slack = broadcast(axis_.slack);
    return less_equal(broadcast(from_), place(add(x, slack))) &
           ~less_equal(broadcast(to_), place(subtract(x, slack))) & short_enough(x, row);
  }
  [[nodiscard]] Mask16 near_key(std::size_t row, const float* key) const {
    const Float16 x = load_unaligned(low_ + row);
    const Float16 slack = broadcast(axis_.slack);
    const Float16 at = load_unaligned(key + row);
    return less_equal(subtract(x, slack), at) & less_equal(at, add(x, slack)) &
           short_enough(x, row);
  }

 private:
  [[nodiscard]] Float16 place(const Float16& x) const {
    return multiply(subtract(x, broadcast(axis_.origin)), broadcast(axis_.inverse));
  }
  [[nodiscard]] Mask16 short_enough(const Float16& x, std::size_t row) const {
    return less_equal(subtract(load_unaligned(high_ + row), x), broadcast(axis_.limit));
  }

  const float* low_;
  const float* high_;
  const LevelAxis& axis_;
  float from_;
  float to_;
};

std::uint32_t find_misfits(const LevelsView& grid, const GridLevel& g, std::uint32_t begin,
                           std::uint32_t end, std::uint32_t* out) {
  std::uint32_t found = 0;
  for (std::uint32_t l = begin; l < end; ++l) {
    const LineCells cells = cells_of_line(g, grid.number[l]);
    const Keeping mids(grid.rows, g.mid, cells.mid);
    const Keeping slows(grid.rows, g.slow, cells.slow);
    const Keeping fasts(grid.rows, g.fast, 0);
    const GridLine& line = grid.line[l];
    found +=
        write_misfits(grid.rows, grid.start[line.cell], grid.start[line.cell + line.last_cell + 1],
                      out + found, [&](std::size_t row) {
                        return mids.kept(row) & slows.kept(row) & fasts.near_key(row, grid.key);
                      });
  }
  return found;
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const HierarchicalGridKernels WINNOW_KERNEL_TABLE(hierarchical_grid_kernels) = {
    WINNOW_ISA_NAME::self_pairs, WINNOW_ISA_NAME::query, WINNOW_ISA_NAME::find_misfits};

}  // namespace winnow
