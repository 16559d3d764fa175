#pragma once

#include <winnow/core/execution.h>
#include "partitions/tree/coarse_cut.kernel.h"
#include "partitions/tree/kd_order.kernel.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace winnow {

/// The number of points in each cell.
using CoarseSizes = std::array<std::uint32_t, kMaxCoarseCells>;

/// Sorts a set of at least some ten thousand points into about `target_cells` cells (at most
/// kMaxCoarseCells), one after another: slabs, lines and cells with equal numbers of points,
/// estimated from a sample (compare Leutenegger, Lopez and Edgington, "STR: a simple and efficient
/// algorithm for R-tree packing", ICDE 1997). Takes two passes over the points; binary cuts would
/// take one pass for each doubling of the number of cells. Swaps point columns of the set with its
/// room; its rows stay in their column. The result is the same for any number of threads and any
/// instruction set. Returns false and changes nothing if the points are concentrated in few places.
[[nodiscard]] bool cut_in_cells(KdSet& set, std::size_t target_cells, const Execution& execution,
                                CoarseSizes& sizes);

}  // namespace winnow
