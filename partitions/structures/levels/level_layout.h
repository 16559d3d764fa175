#pragma once

#include <winnow/core/execution.h>
#include "core/memory/bounds_pool.h"
#include "partitions/structures/levels/hierarchical_grid.kernel.h"
#include "partitions/structures/levels/size_classes.h"

#include <array>
#include <cstdint>
#include <span>

namespace winnow {

/// Computes the cells of a level for its rows: the order of axes, the widths of cells, and the
/// slack within which objects may drift. Rows that have become empty are skipped; `least_longest`
/// is a lower limit of the longest edges per axis, for objects that left such rows. The row range
/// of `level` is not changed.
void lay_level(const BoundsPool& pool, std::span<const std::uint32_t> rows,
               const std::array<float, 3>& least_longest, const Execution& execution,
               GridLevel& level) noexcept;

}  // namespace winnow
