#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/filter.h>
#include <winnow/core/memory.h>
#include "core/memory/bounds_pool.h"

#include <cstdint>
#include <span>

namespace winnow {

/// Sorts row numbers by environment, stably; objects of every environment come last. Rows must be
/// live; filters are indexed by object id. O(n). Returns false and changes nothing if an allocation
/// fails.
[[nodiscard]] bool sort_by_environment(const BoundsPool& pool, const ObjectFilter* filters,
                                       std::span<std::uint32_t> rows,
                                       Column<std::uint64_t>& scratch, const Execution& execution);

/// Sorts row numbers by environment, and each environment by position (see sort_by_kd_cuts, which
/// uses `room` and `points`), so that the rows of a world are consecutive even if worlds overlap in
/// space.
[[nodiscard]] bool sort_by_environment_and_place(const BoundsPool& pool,
                                                 const ObjectFilter* filters,
                                                 std::span<std::uint32_t> rows,
                                                 Column<std::uint64_t>& scratch,
                                                 std::uint32_t* room, Column<float>& points,
                                                 const Execution& execution);

/// Appends rows that are sorted by environment to `order`. An environment of more than a block gets
/// blocks of its own, padded with kNoObject: a block with rows of two worlds would have a box
/// around both. Smaller environments share blocks. Returns false if an allocation fails.
[[nodiscard]] bool append_environments(const BoundsPool& pool, const ObjectFilter* filters,
                                       std::span<const std::uint32_t> rows,
                                       Column<std::uint32_t>& order) noexcept;

}  // namespace winnow
