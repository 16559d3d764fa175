#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include "core/memory/bounds_pool.h"

#include <cstdint>
#include <span>

namespace winnow {

/// A box and its row, moved as one while rows are put in order.
struct SahBox {
  float low[3];
  float high[3];
  std::uint32_t row;
};

/// Appends rows to `order` for a block tree that is asked often and built seldom: blocks of 16, and
/// the nodes of 16 above them, get as little surface as a greedy search finds. Sets of rows are cut
/// in two from the top down, on one of the three axes or by size, where surface area times number,
/// summed over both sides, is least (the surface-area heuristic: Goldsmith and Salmon, "Automatic
/// creation of object hierarchies for ray tracing", IEEE CG&A 7(5), 1987; in bins: Wald, "On fast
/// construction of SAH-based bounding volume hierarchies", 2007). Cuts are made only where the
/// first side fills its subtrees (top-down greedy split: García, López and Leutenegger, "A greedy
/// algorithm for bulk loading R-trees", 1998). Places left empty, so that cuts are freer, were not
/// worth it: 8 % more places save 0 to 3 % of the tests, and 25 % save no more.
///
/// Rows must be live; their boxes are those of the pool's first three slabs. O(n log n), some ten
/// times as long as `sort_by_kd_cuts`; the same result on any number of threads. False if memory is
/// refused.
[[nodiscard]] bool append_in_sah_order(const BoundsPool& pool, std::span<const std::uint32_t> rows,
                                       Column<SahBox>& scratch, Column<std::uint32_t>& order,
                                       const Execution& execution);

}  // namespace winnow
