#pragma once

// Self pairs of blocks of rows, for the block tree (block_tree.kernel.cpp) and the kernels of cell
// structures (cells/cells.wide.h).

#include "partitions/tree/hits.wide.h"
#include "simd/lanes/boxes.h"
#include "simd/lanes/compress.h"

namespace winnow::WINNOW_ISA_NAME {

/// Finds the pairs of a block of up to 16 rows with each other and with rows behind them. The rows
/// of a block are close together: the box around them first selects candidate rows, 16 at a time,
/// and then each candidate is tested against a copy of the whole block, which stays in registers.
template <bool Filtered>
class BlockPairs {
 public:
  BlockPairs(const RowView& rows, PairSink& sink) : rows_(rows), sink_(sink), filters_(rows) {}

  /// Starts with rows [begin, end). Pairs within the block are found unless `excludes_self_pairs`.
  /// Returns false if all rows are holes. `filtered` is true if filters must be tested on hits.
  bool start(std::uint32_t begin, std::uint32_t end, bool excludes_self_pairs = false,
             bool filtered = true) {
    at_ = begin;
    behind_ = end;
    next_ = end / kLanes;
    for (int s = 0; s < 6; ++s) {
      Floats::load_unaligned(rows_.column[s] + begin).store_unaligned(own_[s]);
      const float empty = s < 3 ? __builtin_inff() : -__builtin_inff();
      for (std::uint32_t i = end - begin; i < kLanes; ++i) own_[s][i] = empty;
    }
    filtered_ = Filtered && filtered;
    for (int a = 0; a < 3; ++a) {
      low_[a] = reduce_min(Floats::load(own_[a]));
      high_[a] = reduce_max(Floats::load(own_[3 + a]));
    }
    if (!(low_[0] <= high_[0])) return false;
    if (!excludes_self_pairs) test_self();
    return true;
  }

  /// The box around the block.
  [[nodiscard]] const float* low() const { return low_; }
  [[nodiscard]] const float* high() const { return high_; }

  /// Adds rows [begin, end) behind the block as candidates. Ranges must ascend, but successive
  /// ranges may share a block of rows.
  bool add_run(std::uint32_t begin, std::uint32_t end) {
    std::uint32_t first = begin / kLanes > next_ ? begin / kLanes : next_;
    const std::uint32_t last = (end + kLanes - 1) / kLanes;
    next_ = last > next_ ? last : next_;
    for (; first < last; first += kLanes) {
      if (candidate_blocks_ > kBlockRoom - kLanes && !test_blocks()) return false;
      count_from(first).store_unaligned(candidate_block_ + candidate_blocks_);
      candidate_blocks_ += last - first < kLanes ? last - first : kLanes;
    }
    return true;
  }

  /// Adds the blocks of rows first + i for each bit i of the mask as candidates. These must be
  /// behind the block, and each may be added only once.
  bool add_blocks(std::uint32_t first, Mask16 mask) {
    if (candidate_blocks_ > kBlockRoom - kLanes && !test_blocks()) return false;
    candidate_blocks_ +=
        compress_store(mask, count_from(first), candidate_block_ + candidate_blocks_);
    return true;
  }

  /// Tests the candidates. Returns false if the sink is full.
  bool finish() { return test_blocks() && test_rows(); }

 private:
  static constexpr unsigned kBlockRoom = 512;
  static constexpr unsigned kRowRoom = 1024;
  // Candidate blocks are in six columns each, at unpredictable addresses, so they are prefetched
  // this many tests ahead.
  static constexpr unsigned kAhead = 6;

  /// Tests each row against the later rows of the block.
  void test_self() {
    const Box16 rows = own_rows();
    for (unsigned i = 0; i + 1 < kLanes; ++i) {
      const QueryBox q(rows_.column, at_ + i);
      add_hits(at_ + i, overlap(rows, q.low, q.high) & ~lanes_below(i + 1), hits_);
    }
    sink_.tests += kLanes - 1;
  }

  /// Branchless, because hits are unpredictable. The caller keeps the count in a register.
  void add_hits(std::uint32_t row, Mask16 mask, unsigned& count) {
    hit_row_[count] = row;
    hit_mask_[count] = mask;
    count += mask != 0 ? 1U : 0U;
  }

  /// Lists the rows of candidate blocks that overlap the box around the block.
  bool test_blocks() {
    const float low[3] = {low_[0], low_[1], low_[2]};
    const float high[3] = {high_[0], high_[1], high_[2]};
    unsigned listed = candidate_rows_;
    for (unsigned k = 0; k < candidate_blocks_; ++k) {
      if (listed > kRowRoom - kLanes) {
        candidate_rows_ = listed;
        if (!test_rows()) return false;
        listed = 0;
      }
      const std::uint32_t at = candidate_block_[k] * kLanes;
      const std::uint32_t ahead = candidate_block_[k + kAhead] * kLanes;
      for (int c = 0; c < 6; ++c) __builtin_prefetch(rows_.column[c] + ahead);
      // The rows of the block itself may end within this block of rows.
      const std::uint32_t own = behind_ > at ? behind_ - at : 0;
      const Mask16 overlapping = overlap(load_slabs<3>(rows_.column, at), low, high);
      const Mask16 mask = overlapping & ~lanes_below(own);
      listed += compress_store(mask, count_from(at), candidate_row_ + listed);
    }
    sink_.tests += candidate_blocks_;
    candidate_rows_ = listed;
    candidate_blocks_ = 0;
    return true;
  }

  /// Tests the listed rows against the block, which stays in registers.
  bool test_rows() {
    const Box16 rows = own_rows();
    unsigned hits = hits_;
    for (unsigned k = 0; k < candidate_rows_; ++k) {
      const QueryBox q(rows_.column, candidate_row_[k]);
      add_hits(candidate_row_[k], overlap(rows, q.low, q.high), hits);
    }
    sink_.tests += candidate_rows_;
    hits_ = hits;
    candidate_rows_ = 0;
    return report_hits();
  }

  bool report_hits() {
    if (has_more_to_test(rows_)) drop_boxes();
    if constexpr (Filtered) {
      if (filtered_) return report_filtered_hits();
    }
    return write_hits([](Mask16 mask, std::uint32_t) { return mask; });
  }

  bool report_filtered_hits() {
    if (rows_.environments) {
      return write_hits([&](Mask16 mask, std::uint32_t row) {
        return passing_rows(rows_, at_, mask, filters_.of(row));
      });
    }
    const std::uint32_t* const layers = rows_.filter.layers;
    const std::uint32_t* const masks = rows_.filter.mask;
    const Uints own_layers = Uints::load_unaligned(layers + at_);
    const Uints own_masks = Uints::load_unaligned(masks + at_);
    return write_hits([&](Mask16 mask, std::uint32_t row) {
      return mask & test_bits(own_layers, masks[row]) & test_bits(own_masks, layers[row]);
    });
  }

  /// Writes the hits that passing(hits, partner row) returns.
  template <typename Passing>
  [[gnu::always_inline]] bool write_hits(Passing&& passing) {
    const Uints ids = Uints::load_unaligned(rows_.id + at_);
    const std::uint32_t* const row_id = rows_.id;
    // A local copy: stores of pairs could alias the member.
    std::uint32_t* cursor = sink_.cursor;
    for (unsigned k = 0; k < hits_; ++k) {
      if (__builtin_expect(cursor > sink_.limit, 0) != 0) {
        sink_.cursor = cursor;
        if (!sink_.grow(sink_)) return false;
        cursor = sink_.cursor;
      }
      const std::uint32_t id = row_id[hit_row_[k]];
      const Mask16 mask = passing(hit_mask_[k], hit_row_[k]);
      cursor += 2 * emit_pairs<true>(mask, ids, id, cursor);  // the smaller id first
    }
    sink_.cursor = cursor;
    hits_ = 0;
    return true;
  }

  /// Drops hits of boxes whose volumes do not overlap.
  void drop_boxes() {
    for (unsigned k = 0; k < hits_; ++k) hit_at_[k] = at_;
    hits_ = keep_volume_hits(rows_, rows_.column, hit_row_, hit_at_, hit_mask_, hits_);
  }

  [[nodiscard]] Box16 own_rows() const {
    Box16 box;
    for (int a = 0; a < 3; ++a) {
      box.low[a] = Floats::load(own_[a]);
      box.high[a] = Floats::load(own_[3 + a]);
    }
    return box;
  }

  const RowView& rows_;
  PairSink& sink_;
  const QueryFilters filters_;
  alignas(64) float own_[6][kLanes];
  bool filtered_ = false;
  std::uint32_t at_ = 0;
  std::uint32_t behind_ = 0;  // end of the rows of the block
  std::uint32_t next_ = 0;    // for add_run: first block of rows that is not listed yet
  float low_[3];
  float high_[3];
  unsigned candidate_blocks_ = 0;
  unsigned candidate_rows_ = 0;
  unsigned hits_ = 0;
  std::uint32_t candidate_block_[kBlockRoom + kLanes] = {};
  std::uint32_t candidate_row_[kRowRoom + kLanes];
  std::uint32_t hit_row_[kRowRoom + 2 * kLanes];
  std::uint32_t hit_at_[kRowRoom + 2 * kLanes];  // for volumes other than boxes
  std::uint32_t hit_mask_[kRowRoom + 2 * kLanes];
};

}  // namespace winnow::WINNOW_ISA_NAME
