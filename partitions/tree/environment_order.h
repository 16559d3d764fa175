#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include <winnow/core/object_filter.h>
#include "core/memory/bounds_pool.h"
#include "partitions/tree/kd_order.h"

#include <cstdint>
#include <span>

namespace winnow {

/// Sorts row numbers by environment, keeping the order within each; objects of every environment
/// come last. Rows must be live; filters are by object id. O(n). False, and nothing changed, if
/// memory is refused.
[[nodiscard]] bool sort_by_environment(const BoundsPool& pool, const ObjectFilter* filters,
                                       std::span<std::uint32_t> rows,
                                       Column<std::uint64_t>& scratch, const Execution& execution);

/// Sorts row numbers by environment and each environment by place (see sort_by_kd_cuts), so that
/// worlds that lie on top of each other come one after another; `room` and `points` are what that
/// needs.
[[nodiscard]] bool sort_by_environment_and_place(const BoundsPool& pool,
                                                 const ObjectFilter* filters,
                                                 std::span<std::uint32_t> rows,
                                                 Column<std::uint64_t>& scratch,
                                                 std::uint32_t* room, Column<float>& points,
                                                 const Execution& execution);

/// Appends rows sorted by environment to `order`. An environment of more than a block has blocks
/// to itself, padded by kNoObject: a block with the end of one world and the start of another would
/// be as large as both. Smaller ones share blocks. False if memory is refused.
[[nodiscard]] bool append_environments(const BoundsPool& pool, const ObjectFilter* filters,
                                       std::span<const std::uint32_t> rows,
                                       Column<std::uint32_t>& order) noexcept;

}  // namespace winnow
