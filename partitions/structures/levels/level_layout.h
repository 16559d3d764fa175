#pragma once

#include <winnow/core/execution.h>
#include "core/memory/bounds_pool.h"
#include "partitions/structures/levels/hierarchical_grid.kernel.h"
#include "partitions/structures/levels/size_classes.h"

#include <cstdint>
#include <span>

namespace winnow {

/// Lays out the cells of a level for its rows: axes, how wide cells are, how far objects may drift.
/// The rows' part of `level` is left alone.
void lay_level(const BoundsPool& pool, std::span<const std::uint32_t> rows,
               const Execution& execution, GridLevel& level) noexcept;

}  // namespace winnow
