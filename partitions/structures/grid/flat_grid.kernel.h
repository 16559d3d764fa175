#pragma once

#include "partitions/structures/cells/cells.kernel.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// Rows in cell order: cell c contains rows [start[c], start[c + 1]). Cells along axis 0 are
/// consecutive, so neighbouring cells of a line are one range of rows.
struct GridView {
  RowView rows;
  const std::uint32_t* start = nullptr;
  CellAxis axis[3];
};

/// Places and units are lines: cells along axis 0.
using FlatGridKernels = CellKernels<GridView>;

WINNOW_KERNELS(FlatGridKernels, flat_grid_kernels);

}  // namespace winnow
