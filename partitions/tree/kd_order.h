#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include "core/memory/bounds_pool.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Floats of scratch that it takes to cut so many rows.
[[nodiscard]] constexpr std::size_t kd_scratch(std::size_t rows) noexcept {
  return 6 * rows;
}

/// Puts rows in order for a block tree over them: sets of rows are cut in two from the top down, at
/// the middle of the axis along which their centres reach farthest, and only where the first side
/// fills its subtrees of 16^k blocks, so that every node of the implicit tree is one such set
/// (overlap minimizing top-down bulk loading: Lee and Lee, "OMT: overlap minimizing top-down bulk
/// loading algorithm for R-tree", CAiSE 2003). Boxes of all sizes mix well: a cut follows where
/// they lie, and a large box widens no more than the one block that it is in.
///
/// Rows are live, their boxes in the pool's first six columns; `room` is for as many. O(n log n);
/// the same result on any number of threads and any instruction set. False, and `rows` unchanged,
/// if memory is refused.
[[nodiscard]] bool sort_by_kd_cuts(const BoundsPool& pool, std::span<std::uint32_t> rows,
                                   std::uint32_t* room, Column<float>& scratch,
                                   const Execution& execution);

}  // namespace winnow
