// Kernels of brute_force.cpp, for each kind of volume: tests blocks of 16 rows against single rows.
// With filters, blocks whose filters cannot pass are skipped.

#include "partitions/structures/brute_force/flat_rows.kernel.h"
#include "partitions/tree/hits.wide.h"
#include "partitions/tree/traversal.wide.h"
#include "simd/lanes/boxes.h"
#include "simd/lanes/compress.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

// The id of an empty row. Empty rows make no queries.
constexpr std::uint32_t kNoId = ~0U;

/// Returns the rows of [at, at + 16) that have an object.
Mask16 live_rows(const RowView& rows, std::size_t at) {
  Mask16 live = 0;
  for (unsigned i = 0; i < kLanes; ++i) {
    live |= static_cast<Mask16>(rows.id[at + i] != kNoId) << i;
  }
  return live;
}

/// Accepts all rows but holes.
struct Untested {
  struct Block {
    Mask16 live;
  };
  struct Query {};
  [[gnu::always_inline]] static Block load(const RowView& rows, std::size_t row) {
    return {live_rows(rows, row)};
  }
  [[gnu::always_inline]] static Query query(const float* const*, std::size_t) { return {}; }
  static Mask16 test(const Block& block, const Query&) { return block.live; }
};

/// Tests boxes (3 slabs) and k-DOPs, whose further slabs follow the box's six columns.
template <int Slabs>
struct SlabTest {
  using Block = Slabs16<Slabs>;
  struct Query {
    float low[Slabs];
    float high[Slabs];
  };
  [[gnu::always_inline]] static Block load(const RowView& rows, std::size_t row) {
    Block block;
    for (int s = 0; s < Slabs; ++s) {
      block.low[s] = Floats::load(rows.column[low_end(s)] + row);
      block.high[s] = Floats::load(rows.column[high_end(s)] + row);
    }
    return block;
  }
  [[gnu::always_inline]] static Query query(const float* const* column, std::size_t r) {
    Query q;
    for (int s = 0; s < Slabs; ++s) {
      q.low[s] = column[low_end(s)][r];
      q.high[s] = column[high_end(s)][r];
    }
    return q;
  }
  [[gnu::always_inline]] static Mask16 test(const Block& block, const Query& q) {
    return overlap(block, q.low, q.high);
  }

 private:
  static constexpr int low_end(int s) { return s < 3 ? s : s + 3; }
  static constexpr int high_end(int s) { return s < 3 ? s + 3 : Slabs + s; }
};

/// Tests spheres.
struct SphereTest {
  struct Block {
    Floats center[3];
    Floats radius;
  };
  struct Query {
    float center[3];
    float radius;
  };
  [[gnu::always_inline]] static Block load(const RowView& rows, std::size_t row) {
    Block b;
    for (int axis = 0; axis < 3; ++axis) {
      b.center[axis] = Floats::load(rows.column[kBallCenter + axis] + row);
    }
    b.radius = Floats::load(rows.column[kBallRadius] + row);
    return b;
  }
  [[gnu::always_inline]] static Query query(const float* const* column, std::size_t r) {
    Query q;
    for (int axis = 0; axis < 3; ++axis) q.center[axis] = column[kBallCenter + axis][r];
    q.radius = column[kBallRadius][r];
    return q;
  }
  [[gnu::always_inline]] static Mask16 test(const Block& b, const Query& q) {
    return spheres_overlap_one(b.center, b.radius, q.center, q.radius);
  }
};

/// Calls visit(begin, end) for ranges of blocks from `from` on that contain all blocks whose
/// filters may pass `range`. Two ranges are at least `gap` blocks apart.
template <bool Filtered, typename Visit>
bool visit_runs(const FlatView& view, std::uint32_t from, const FilterRange& range,
                std::uint32_t gap, Visit&& visit) {
  if (!Filtered || view.blocks.levels == 0) {
    return visit(from, (view.row_count + kLanes - 1) / kLanes);
  }
  std::uint32_t begin = from;
  std::uint32_t end = from;
  const auto test = [&](std::uint32_t level, std::uint32_t first_node) {
    return passing_nodes(view.blocks, level, first_node, kAllRows, range);
  };
  const auto visit_group = [&](std::uint32_t group) {
    Mask16 open = test(0, group * kLanes);
    if (group == from / kLanes) open &= ~lanes_below(from % kLanes);
    while (open != 0) {
      const unsigned at = first(open);
      const unsigned behind = first(~open & ~lanes_below(at));
      const std::uint32_t next = group * kLanes + at;
      if (next >= end + gap) {
        if (!visit(begin, end)) return false;
        begin = next;
      }
      end = group * kLanes + behind;
      open &= ~lanes_below(behind);
    }
    return true;
  };
  const bool whole = view.blocks.levels == 1
                         ? visit_group(0)
                         : traverse_from(view.blocks, 1, from / kLanes, test, visit_group);
  return whole && visit(begin, end);
}

/// Hits of the loop of volume tests. Filters are tested after the loop, which then needs fewer
/// registers.
struct NotedHits {
  static constexpr std::uint32_t kRoom = 64;

  std::uint32_t size = 0;
  std::uint32_t place[kRoom];
  std::uint32_t mask[kRoom];

  void add(std::uint32_t at, Mask16 hits) {
    place[size] = at;
    mask[size] = hits;
    size += hits != 0 ? 1U : 0U;
  }
};

/// Writes all pairs of rows of block a with rows of block b >= a.
template <typename Test>
bool block_pair(const FlatView& view, std::uint32_t a, std::uint32_t b, PairSink& sink) {
  if (!has_room(sink)) return false;
  const std::uint32_t first_row = a * kLanes;
  const std::uint32_t rows =
      view.row_count - first_row < kLanes ? view.row_count - first_row : kLanes;
  const auto block = Test::load(view.rows, std::size_t{b} * kLanes);
  const Uints ids = Uints::load_unaligned(view.rows.id + std::size_t{b} * kLanes);
  for (std::uint32_t i = 0; i < rows; ++i) {
    const std::uint32_t id = view.rows.id[first_row + i];
    if (id == kNoId) continue;
    Mask16 hits = Test::test(block, Test::query(view.rows.column, first_row + i));
    if (a == b) hits &= ~lanes_below(i + 1);
    if (hits != 0) sink.cursor += 2 * emit_pairs<true>(hits, ids, id, sink.cursor);
  }
  sink.tests += rows;
  return true;
}

/// As above for rows with filters; only the rows of block a in `query_rows` are tested. Filters are
/// tested after the loop of volume tests, which then needs fewer registers.
template <typename Test>
bool filtered_block_pair(const FlatView& view, std::uint32_t a, Mask16 query_rows, std::uint32_t b,
                         PairSink& sink) {
  if (!has_room(sink)) return false;
  const std::uint32_t a_row = a * kLanes;
  const std::uint32_t b_row = b * kLanes;
  const auto block = Test::load(view.rows, b_row);
  Mask16 found[kLanes];
  Mask16 any = 0;
  const auto test_row = [&](std::uint32_t i) {
    found[i] = Test::test(block, Test::query(view.rows.column, a_row + i));
    any |= found[i];
  };
  if (view.rows.environments) {
    query_rows = passing_rows(view.rows, a_row, query_rows, range_of(view.blocks.filters[0], b));
    for (Mask16 left = query_rows; left != 0; left &= left - 1) test_row(first(left));
  } else {
    // With one environment few rows are excluded: a selection would cost more than their tests.
    for (std::uint32_t i = 0; i < kLanes; ++i) test_row(i);
  }
  sink.tests += count(query_rows);
  if (any == 0) return true;
  const QueryFilters filters(view.rows);
  const Uints ids = Uints::load_unaligned(view.rows.id + b_row);
  for (Mask16 left = query_rows; left != 0; left &= left - 1) {
    const unsigned i = first(left);
    const Mask16 overlapping = a == b ? found[i] & ~lanes_below(i + 1) : found[i];
    if (overlapping == 0) continue;
    const Mask16 hits = passing_rows(view.rows, b_row, overlapping, filters.of(a_row + i));
    sink.cursor += 2 * emit_pairs<true>(hits, ids, view.rows.id[a_row + i], sink.cursor);
  }
  return true;
}

template <typename Test, bool Filtered>
bool find_self_pairs(const FlatView& view, std::uint32_t begin, std::uint32_t end, PairSink& sink) {
  for (std::uint32_t a = begin; a < end; ++a) {
    const FilterRange range = Filtered ? range_of(view.blocks.filters[0], a) : FilterRange{};
    const Mask16 live = Filtered ? live_rows(view.rows, a * kLanes) : kAllRows;
    const auto visit = [&](std::uint32_t first_block, std::uint32_t behind) {
      for (std::uint32_t b = first_block; b < behind; ++b) {
        const bool done = Filtered ? filtered_block_pair<Test>(view, a, live, b, sink)
                                   : block_pair<Test>(view, a, b, sink);
        if (!done) return false;
      }
      return true;
    };
    if (!visit_runs<Filtered>(view, a, range, 1, visit)) return false;
  }
  return true;
}

template <typename Test>
bool self_pairs(const FlatView& view, std::uint32_t begin, std::uint32_t end, PairSink& sink) {
  return are_filtered(view.rows) ? find_self_pairs<Test, true>(view, begin, end, sink)
                                 : find_self_pairs<Test, false>(view, begin, end, sink);
}

/// Writes the hits of one batch row that pass the filters.
template <bool Filtered>
bool report_noted(const FlatView& view, const QueryBatch& batch, std::uint32_t row,
                  const NotedHits& noted, const FilterRange& range, PairSink& sink) {
  for (std::uint32_t k = 0; k < noted.size; ++k) {
    const std::uint32_t at = noted.place[k];
    Mask16 hits = noted.mask[k];
    if (batch.mode == HitMode::moved) hits &= reported_lanes(batch.moved, row, at);
    if constexpr (Filtered) hits = passing_rows(view.rows, at, hits, range);
    if (!has_room(sink)) return false;
    report(batch.mode, hits, view.rows.id + at, batch.id[row], sink);
  }
  return true;
}

template <typename Test>
struct FlatQuery {
  /// Testing up to this many blocks in vain costs less than ending a range.
  static constexpr std::uint32_t kGap = 8;

  template <bool Filtered>
  static bool run(const FlatView& view, const QueryBatch& batch, PairSink& sink) {
    const QueryFilters filters(batch);
    for (std::uint32_t k = batch.begin; k < batch.end; ++k) {
      const std::uint32_t row = batch.rows != nullptr ? batch.rows[k] : k;
      if (batch.id[row] == kNoId) continue;
      const auto q = Test::query(batch.column, row);
      const FilterRange range = Filtered ? filters.of(row) : FilterRange{};
      const auto visit = [&](std::uint32_t begin, std::uint32_t end) {
        sink.tests += end - begin;
        while (begin < end) {
          const std::uint32_t some =
              end - begin < NotedHits::kRoom ? end : begin + NotedHits::kRoom;
          NotedHits noted;
          for (std::uint32_t b = begin; b < some; ++b) {
            const auto block = Test::load(view.rows, std::size_t{b} * kLanes);
            noted.add(b * kLanes, Test::test(block, q));
          }
          if (!report_noted<Filtered>(view, batch, row, noted, range, sink)) return false;
          begin = some;
        }
        return true;
      };
      if (!visit_runs<Filtered>(view, 0, range, kGap, visit)) return false;
    }
    return true;
  }
};

template <typename Test>
bool query(const FlatView& view, const QueryBatch& batch, PairSink& sink) {
  return with_filters<FlatQuery<Test>>(view, batch, sink);
}

template <typename Test>
constexpr FlatKernel kKernel{self_pairs<Test>, query<Test>};

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const FlatKernels WINNOW_KERNEL_TABLE(flat_kernels) = {
    WINNOW_ISA_NAME::kKernel<WINNOW_ISA_NAME::Untested>,
    WINNOW_ISA_NAME::kKernel<WINNOW_ISA_NAME::SlabTest<3>>,
    WINNOW_ISA_NAME::kKernel<WINNOW_ISA_NAME::SphereTest>,
    WINNOW_ISA_NAME::kKernel<WINNOW_ISA_NAME::SlabTest<7>>,
    WINNOW_ISA_NAME::kKernel<WINNOW_ISA_NAME::SlabTest<9>>,
    WINNOW_ISA_NAME::kKernel<WINNOW_ISA_NAME::SlabTest<13>>};

}  // namespace winnow
