#pragma once

#include "partitions/rows/row_view.h"
#include "partitions/structures/cells/cell_axis.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// Rows in cell order: cell c holds rows [start[c], start[c + 1]). Cells along axis 0 follow each
/// other, so that neighbouring cells of a line are one run of rows.
struct GridView {
  RowView rows;
  const std::uint32_t* start = nullptr;
  CellAxis axis[3];
};

struct FlatGridKernels {
  /// All pairs whose earlier cell lies in lines [begin, end); a line is a row of cells on axis 0.
  bool (*self_pairs)(const GridView&, std::uint32_t begin, std::uint32_t end, PairSink&);
  /// All hits of the batch's boxes.
  bool (*query)(const GridView&, const QueryBatch&, PairSink&);
  /// Writes to `out` the rows of lines [begin, end) that left their cell, line by line; returns how
  /// many.
  std::uint32_t (*find_misfits)(const GridView&, std::uint32_t begin, std::uint32_t end,
                                std::uint32_t* out);
};

WINNOW_KERNELS(FlatGridKernels, flat_grid_kernels);

}  // namespace winnow
