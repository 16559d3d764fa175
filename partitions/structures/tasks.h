#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace winnow {

inline constexpr std::size_t kMostTasks = 64;

/// Units of work, cut into tasks that take about as many each.
struct TaskCut {
  std::size_t units = 0;
  std::size_t most = kMostTasks;

  [[nodiscard]] std::size_t tasks() const noexcept { return std::min(most, units); }
  /// The first unit of a task; of the one behind the last, the end.
  [[nodiscard]] std::uint32_t first(std::size_t task) const noexcept {
    return static_cast<std::uint32_t>(units * task / tasks());
  }
};

/// Appends to `out`, until it holds `limit`, what tasks find, in the order of the tasks.
/// find(begin, end, out) goes through units, writes to `out` and returns how many it wrote; task i
/// is given scratch + offset(first unit), where it has room for all that it can find.
template <typename Offset, typename Find>
void append_in_order(const Execution& execution, const TaskCut& cut, std::uint32_t* scratch,
                     Offset&& offset, Find&& find, Column<std::uint32_t>& out, std::size_t limit) {
  std::array<std::size_t, kMostTasks> found{};
  const auto room = [&](std::size_t task) { return scratch + offset(cut.first(task)); };
  execution.for_each(cut.tasks(), [&](std::size_t task) {
    found[task] = find(cut.first(task), cut.first(task + 1), room(task));
  });
  for (std::size_t task = 0; task < cut.tasks(); ++task) {
    const std::size_t count = std::min(found[task], limit - out.size());
    std::copy_n(room(task), count, out.end());
    out.set_size(out.size() + count);
  }
}

}  // namespace winnow
