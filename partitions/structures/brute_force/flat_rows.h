#pragma once

#include "core/memory/bounds_pool.h"
#include "partitions/structures/brute_force/flat_rows.kernel.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace winnow {

// What NSquared and BoundsNSquared share: how unordered rows are cut into tasks.

inline constexpr std::size_t kFlatTasks = 64;

inline std::size_t flat_tasks(const BoundsPool& pool) noexcept {
  return std::min(kFlatTasks, pool.blocks());
}

/// Blocks [begin, end) of a task. Early blocks meet more later ones: tasks take blocks so that each
/// has about the same number of block pairs.
struct FlatTask {
  std::uint32_t begin;
  std::uint32_t end;
  FlatTask(const BoundsPool& pool, std::size_t task) noexcept
      : begin(bound(pool, task)), end(bound(pool, task + 1)) {}

 private:
  static std::uint32_t bound(const BoundsPool& pool, std::size_t task) noexcept;
};

/// `blocks` are the filters of the rows' blocks.
[[nodiscard]] inline FlatView flat_view(const TreeView& blocks, const BoundsPool& pool) noexcept {
  return {blocks.rows, static_cast<std::uint32_t>(pool.rows()), blocks};
}

}  // namespace winnow
