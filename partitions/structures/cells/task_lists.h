#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace winnow {

inline constexpr std::size_t kMostTasks = 64;

/// Appends to `out`, until it holds `limit`, what tasks find, in the order of the tasks. Task i
/// writes to scratch + offset(i) on, where it has room for all it can find, and returns how many it
/// wrote.
template <typename Offset, typename Find>
void append_in_order(const Execution& execution, std::size_t tasks, std::uint32_t* scratch,
                     Offset&& offset, Find&& find, Column<std::uint32_t>& out, std::size_t limit) {
  std::array<std::size_t, kMostTasks> found{};
  execution.for_each(tasks,
                     [&](std::size_t task) { found[task] = find(task, scratch + offset(task)); });
  for (std::size_t task = 0; task < tasks; ++task) {
    const std::size_t count = std::min(found[task], limit - out.size());
    std::copy_n(scratch + offset(task), count, out.end());
    out.set_size(out.size() + count);
  }
}

}  // namespace winnow
