#pragma once

#include "partitions/structures/cells/cells.kernel.h"
#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

struct CellLayoutKernels {
  /// Writes the cell of each row of [begin, end), or ~0 for empty rows and for rows with an edge
  /// above the limit. `begin` is a multiple of 16; columns are readable and `cell` is writable up
  /// to the next multiple of 16 after `end`.
  void (*cells)(const float* const* column, const CellAxis* axes, std::size_t begin,
                std::size_t end, std::uint32_t* cell);
};

WINNOW_KERNELS(CellLayoutKernels, cell_layout_kernels);

}  // namespace winnow
