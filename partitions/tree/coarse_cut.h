#pragma once

#include <winnow/core/execution.h>
#include "partitions/tree/coarse_cut.kernel.h"
#include "partitions/tree/kd_order.kernel.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace winnow {

/// How many points each cell has.
using CoarseSizes = std::array<std::uint32_t, kMostCoarseCells>;

/// Puts a set of some ten thousand points in about `wanted` cells (at most kMostCoarseCells), one
/// behind the other, in two passes over the points, where cuts in two would take one for each time
/// that the number of cells doubles: slabs, lines and cells of equal numbers, by a sample (compare
/// Leutenegger, Lopez and Edgington, "STR: a simple and efficient algorithm for R-tree packing",
/// ICDE 1997). Points and the room for them change places in the set; its rows do not. The same on
/// any number of threads and any instruction set. False, and nothing changed, where the points lie
/// in heaps.
[[nodiscard]] bool cut_in_cells(KdSet& set, std::size_t wanted, const Execution& execution,
                                CoarseSizes& sizes);

}  // namespace winnow
