#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include "core/memory/bounds_pool.h"

#include <cstdint>
#include <span>

namespace winnow {

/// Sorts row numbers so that boxes of one size class and one place lie together: by class of the
/// longest edge (factors of 4), then by the Morton code of the centre, turned level by level into
/// the place on Hilbert's curve where axes take turns. Runs whose codes are all equal, as an
/// outlier or two scales in one scene make them, are sorted again within their own bounds, so the
/// order is spatial at every scale. O(n) for ordinary scenes, O(n log n) for the worst. Rows must
/// be live, of an AABB pool. False, and nothing changed, if memory is refused.
[[nodiscard]] bool sort_by_morton(const BoundsPool& pool, std::span<std::uint32_t> rows,
                                  Column<std::uint64_t>& scratch, const Execution& execution);

}  // namespace winnow
