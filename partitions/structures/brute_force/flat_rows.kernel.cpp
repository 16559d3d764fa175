#include "partitions/structures/brute_force/flat_rows.kernel.h"
#include "partitions/tree/hits.wide.h"
#include "partitions/tree/traversal.wide.h"
#include "simd/lanes/boxes.h"
#include "simd/lanes/compress.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

// The id of an empty row, which is never asked about.
constexpr std::uint32_t kNoId = ~0U;

/// Reports everything but holes.
struct Untested {
  struct Block {
    Mask16 live;
  };
  struct Query {};
  static Block load(const RowView& rows, std::size_t row) {
    Mask16 live = 0;
    for (unsigned i = 0; i < kLanes; ++i) {
      live |= static_cast<Mask16>(rows.id[row + i] != kNoId) << i;
    }
    return {live};
  }
  static Query query(const float* const*, std::size_t) { return {}; }
  static Mask16 test(const Block& block, const Query&) { return block.live; }
};

/// Boxes (3 slabs) and k-DOPs, whose further slabs follow the box's six columns.
template <int Slabs>
struct SlabTest {
  using Block = Slabs16<Slabs>;
  struct Query {
    float low[Slabs];
    float high[Slabs];
  };
  static Block load(const RowView& rows, std::size_t row) {
    Block block;
    for (int s = 0; s < Slabs; ++s) {
      block.low[s] = Floats::load(rows.column[low_end(s)] + row);
      block.high[s] = Floats::load(rows.column[high_end(s)] + row);
    }
    return block;
  }
  static Query query(const float* const* column, std::size_t r) {
    Query q;
    for (int s = 0; s < Slabs; ++s) {
      q.low[s] = column[low_end(s)][r];
      q.high[s] = column[high_end(s)][r];
    }
    return q;
  }
  static Mask16 test(const Block& block, const Query& q) { return overlap(block, q.low, q.high); }

 private:
  static constexpr int low_end(int s) { return s < 3 ? s : s + 3; }
  static constexpr int high_end(int s) { return s < 3 ? s + 3 : Slabs + s; }
};

/// Spheres.
struct SphereTest {
  struct Block {
    Floats center[3];
    Floats radius;
  };
  struct Query {
    float center[3];
    float radius;
  };
  static Block load(const RowView& rows, std::size_t row) {
    Block b;
    for (int axis = 0; axis < 3; ++axis) {
      b.center[axis] = Floats::load(rows.column[kBallCenter + axis] + row);
    }
    b.radius = Floats::load(rows.column[kBallRadius] + row);
    return b;
  }
  static Query query(const float* const* column, std::size_t r) {
    Query q;
    for (int axis = 0; axis < 3; ++axis) q.center[axis] = column[kBallCenter + axis][r];
    q.radius = column[kBallRadius][r];
    return q;
  }
  // Called, it would have the block's registers written to memory and read again.
  [[gnu::always_inline]] static Mask16 test(const Block& b, const Query& q) {
    return balls_meet(b.center, b.radius, q.center, q.radius);
  }
};

/// Calls visit(block) for every block from `from` on that may hold something that `range` may meet.
template <bool Filtered, typename Visit>
bool visit_blocks(const FlatView& view, std::uint32_t from, const FilterRange& range,
                  Visit&& visit) {
  if (!Filtered || view.blocks.levels == 0) {
    const std::uint32_t blocks = (view.row_count + kLanes - 1) / kLanes;
    for (std::uint32_t b = from; b < blocks; ++b) {
      if (!visit(b)) return false;
    }
    return true;
  }
  const auto test = [&](std::uint32_t level, std::uint32_t first_node) {
    return passing_nodes(view.blocks, level, first_node, kAllRows, range);
  };
  return traverse_from(view.blocks, 0, from, test, visit);
}

/// All pairs of rows of block a with rows of block b >= a.
template <typename Test, bool Filtered>
bool block_pair(const FlatView& view, std::uint32_t a, std::uint32_t b, PairSink& sink) {
  if (!has_room(sink)) return false;
  const std::uint32_t first_row = a * kLanes;
  const std::uint32_t rows =
      view.row_count - first_row < kLanes ? view.row_count - first_row : kLanes;
  const auto block = Test::load(view.rows, std::size_t{b} * kLanes);
  const Uints ids = Uints::load_unaligned(view.rows.id + std::size_t{b} * kLanes);
  FilterRange b_range{};
  if constexpr (Filtered) b_range = range_of(view.blocks.filters[0], b);
  std::uint32_t left_out = 0;
  for (std::uint32_t i = 0; i < rows; ++i) {
    const std::uint32_t id = view.rows.id[first_row + i];
    if (id == kNoId) continue;
    if (Filtered && !may_meet(range_of(view.rows.filter[id]), b_range)) {
      ++left_out;
      continue;
    }
    Mask16 hits = Test::test(block, Test::query(view.rows.column, first_row + i));
    if (a == b) hits &= ~lanes_below(i + 1);
    if constexpr (Filtered) {
      hits = passing_rows(view.rows, b * kLanes, hits, view.rows.filter[id]);
    }
    if (hits != 0) sink.cursor += 2 * emit_pairs<true>(hits, ids, id, sink.cursor);
  }
  sink.tests += rows - left_out;
  return true;
}

template <typename Test, bool Filtered>
bool find_self_pairs(const FlatView& view, std::uint32_t begin, std::uint32_t end, PairSink& sink) {
  for (std::uint32_t a = begin; a < end; ++a) {
    const FilterRange range = Filtered ? range_of(view.blocks.filters[0], a) : FilterRange{};
    const bool done = visit_blocks<Filtered>(view, a, range, [&](std::uint32_t b) {
      return block_pair<Test, Filtered>(view, a, b, sink);
    });
    if (!done) return false;
  }
  return true;
}

template <typename Test>
bool self_pairs(const FlatView& view, std::uint32_t begin, std::uint32_t end, PairSink& sink) {
  return are_filtered(view.rows) ? find_self_pairs<Test, true>(view, begin, end, sink)
                                 : find_self_pairs<Test, false>(view, begin, end, sink);
}

template <typename Test>
struct FlatQuery {
  template <HitMode Mode, bool Filtered>
  static bool run(const FlatView& view, const QueryBatch& batch, PairSink& sink) {
    const AskingFilters filters(batch);
    for (std::uint32_t k = batch.begin; k < batch.end; ++k) {
      const std::uint32_t row = batch.rows != nullptr ? batch.rows[k] : k;
      if (batch.id[row] == kNoId) continue;
      const auto q = Test::query(batch.column, row);
      const FilterRange range = Filtered ? filters.of(batch.id[row]) : FilterRange{};
      std::uint32_t tests = 0;
      const bool done = visit_blocks<Filtered>(view, 0, range, [&](std::uint32_t b) {
        const auto block = Test::load(view.rows, std::size_t{b} * kLanes);
        ++tests;
        Mask16 hits = Test::test(block, q);
        if constexpr (Mode == HitMode::moved) {
          hits &= reported_lanes(batch.moved, row, b * kLanes);
        }
        if constexpr (Filtered) hits = passing_rows(view.rows, b * kLanes, hits, range);
        if (hits == 0) return true;
        if (!has_room(sink)) return false;
        report<Mode>(hits, view.rows.id + std::size_t{b} * kLanes, batch.id[row], sink);
        return true;
      });
      sink.tests += tests;
      if (!done) return false;
    }
    return true;
  }
};

template <typename Test>
bool query(const FlatView& view, const QueryBatch& batch, PairSink& sink) {
  return with_mode<FlatQuery<Test>>(view, batch, sink);
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
