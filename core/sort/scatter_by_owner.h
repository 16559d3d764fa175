#pragma once

#include <winnow/core/execution.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Maximum number of owners: with more, scanning all rows costs more than another thread saves.
inline constexpr std::size_t kMaxOwners = 8;

/// Returns the number of threads that share the rows of a list with scattered targets. Each thread
/// owns some targets, scans all rows, and processes the rows of its targets. Without owners, cores
/// would write to the same cache lines, whose transfers cost more than the scan.
[[nodiscard]] inline std::size_t owner_count(std::size_t rows,
                                             const Execution& execution) noexcept {
  constexpr std::size_t kRowsPerOwner = 8192;
  return std::clamp<std::size_t>(rows / kRowsPerOwner, 1,
                                 std::min(kMaxOwners, execution.concurrency()));
}

/// Calls body(row, target) for the rows whose target is in [first, end), in ascending order.
/// `owners` is the number of threads that all targets are divided among.
template <typename Body>
void for_rows_of_owner(std::span<const std::uint32_t> target, std::size_t first, std::size_t end,
                       std::size_t owners, Body&& body) {
  if (owners == 1) {
    for (std::size_t row = 0; row < target.size(); ++row) {
      if (target[row] < end) body(static_cast<std::uint32_t>(row), target[row]);
    }
    return;
  }
  // The owner of a row is unpredictable, so rows are collected without a branch.
  std::array<std::uint32_t, 1024> own;
  for (std::size_t begin = 0; begin < target.size(); begin += own.size()) {
    const std::size_t stop = std::min(target.size(), begin + own.size());
    std::size_t found = 0;
    for (std::size_t row = begin; row < stop; ++row) {
      own[found] = static_cast<std::uint32_t>(row);
      found += target[row] - first < end - first ? 1 : 0;
    }
    for (std::size_t i = 0; i < found; ++i) body(own[i], target[own[i]]);
  }
}

/// Calls body(row, target) in parallel for all rows whose target is below `targets`. One thread
/// gets all rows of a target, in ascending order.
template <typename Body>
void for_rows_by_target(std::span<const std::uint32_t> target, std::size_t targets,
                        const Execution& execution, Body&& body) {
  const std::size_t owners = owner_count(target.size(), execution);
  execution.for_each(owners, [&](std::size_t owner) {
    for_rows_of_owner(target, targets * owner / owners, targets * (owner + 1) / owners, owners,
                      body);
  });
}

}  // namespace winnow
