#pragma once

#include <winnow/core/execution.h>
#include "core/memory/bounds_pool.h"
#include "partitions/structures/levels/hierarchical_grid.kernel.h"
#include "partitions/structures/levels/size_classes.h"

#include <array>
#include <cstdint>
#include <span>

namespace winnow {

/// Lays out the cells of a level for its rows: axes, how wide cells are, how far objects may drift.
/// Some of its rows may be empty: what stood there has edges up to `least_longest`, on each axis.
/// The rows' part of `level` is left alone.
void lay_level(const BoundsPool& pool, std::span<const std::uint32_t> rows,
               const std::array<float, 3>& least_longest, const Execution& execution,
               GridLevel& level) noexcept;

}  // namespace winnow
