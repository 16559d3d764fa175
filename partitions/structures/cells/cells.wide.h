#pragma once

// Common code of kernels for structures with cells: the table of their functions, and the search
// for rows outside the bounds of their cell.

#include "partitions/structures/cells/cells.kernel.h"
#include "partitions/tree/block_pairs.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// The kernel functions of a structure. `Cells` provides find_pairs, visit_runs (visits ranges of
/// rows that contain all rows overlapping a box), needs_rows (where a range ends) and find_misfits.
template <typename Cells, typename View>
struct CellFunctions {
  static bool self_pairs(const View& view, std::uint32_t begin, std::uint32_t end, PairSink& sink) {
    return are_filtered(view.rows) ? Cells::template find_pairs<true>(view, begin, end, sink)
                                   : Cells::template find_pairs<false>(view, begin, end, sink);
  }

  template <bool Filtered>
  static bool run(const View& view, const QueryBatch& batch, PairSink& sink) {
    HitList<Filtered> hits(view.rows, batch, sink);
    RunList list(view.rows, batch.column, hits, Cells::needs_rows(view), sink);
    for (std::uint32_t k = batch.begin; k < batch.end; ++k) {
      const std::uint32_t row = batch.rows != nullptr ? batch.rows[k] : k;
      const QueryBox q(batch.column, row);
      if (!(q.low[0] <= q.high[0])) continue;
      const auto add = [&](std::uint32_t begin, std::uint32_t end) {
        return list.add(row, begin, end);
      };
      if (!Cells::visit_runs(view, q, add)) return false;
    }
    return list.finish() && hits.flush();
  }
  static bool query(const View& view, const QueryBatch& batch, PairSink& sink) {
    return with_filters<CellFunctions>(view, batch, sink);
  }

  static constexpr CellKernels<View> table() { return {self_pairs, query, Cells::find_misfits}; }
};

/// Tests on one axis: lower bound within [from, to], edge within limit.
struct AxisBounds {
  const float* low;
  const float* high;
  float from;
  float to;
  float limit;

  AxisBounds(const RowView& rows, const CellAxis& axis, std::uint32_t cell)
      : low(rows.column[axis.axis]),
        high(rows.column[3 + axis.axis]),
        from(axis.from[cell]),
        to(axis.to[cell]),
        limit(axis.limit) {}

  [[nodiscard]] Mask16 kept(std::size_t row) const {
    const Floats x = Floats::load_unaligned(low + row);
    return bits(from <= x) & bits(x <= to) & short_enough(x, row);
  }
  [[nodiscard]] Mask16 short_enough(const Floats& x, std::size_t row) const {
    return bits(Floats::load_unaligned(high + row) - x <= limit);
  }
};

/// Calls kept(row) for each 16 rows of [begin, end) and writes the rows that it rejects, without
/// empty rows; returns their number.
template <typename Kept>
std::uint32_t write_misfits(const RowView& rows, std::uint32_t begin, std::uint32_t end,
                            std::uint32_t* out, Kept&& kept) {
  std::uint32_t found = 0;
  for (std::uint32_t row = begin; row < end; row += kLanes) {
    const Mask16 lanes = end - row < kLanes ? lanes_below(end - row) : kAllRows;
    for (Mask16 bad = ~kept(row) & lanes; bad != 0; bad &= bad - 1) {
      const std::uint32_t r = row + first(bad);
      out[found] = r;
      found += rows.id[r] != ~0U ? 1U : 0U;
    }
  }
  return found;
}

}  // namespace winnow::WINNOW_ISA_NAME
