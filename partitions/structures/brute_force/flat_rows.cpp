#include "partitions/structures/brute_force/flat_rows.h"

#include <cmath>

namespace winnow {

WINNOW_DEFINE_KERNELS(FlatKernels, flat_kernels)

std::uint32_t FlatTask::bound(const BoundsPool& pool, std::size_t task) noexcept {
  const std::size_t tasks = flat_tasks(pool);
  if (task >= tasks) return static_cast<std::uint32_t>(pool.blocks());
  // Blocks behind x of all meet x^2 of the pairs.
  const double left = 1.0 - static_cast<double>(task) / static_cast<double>(tasks);
  const double done = (1.0 - std::sqrt(left)) * static_cast<double>(pool.blocks());
  return static_cast<std::uint32_t>(done);
}

}  // namespace winnow
