#pragma once

// Which rows no longer keep to the bounds of their cell or strip.

#include "partitions/rows/row_view.h"
#include "partitions/structures/cells/cell_axis.h"
#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Lower ends within [from, to] on one axis, edges within limit.
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

/// Calls kept(row) for every 16 rows of [begin, end) and writes those that it leaves out, but for
/// empty rows, which have nothing to lose; returns how many.
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
