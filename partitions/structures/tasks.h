#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/memory.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace winnow {

inline constexpr std::size_t kMaxTasks = 64;

/// Divides units of work into at most `most` tasks of about equal size.
struct TaskCut {
  std::size_t units = 0;
  std::size_t most = kMaxTasks;

  [[nodiscard]] std::size_t tasks() const noexcept { return std::min(most, units); }
  /// The first unit of a task; for task == tasks() the number of units.
  [[nodiscard]] std::uint32_t first(std::size_t task) const noexcept {
    return static_cast<std::uint32_t>(units * task / tasks());
  }
};

/// Appends the rows that tasks find to `out`, in the order of tasks. find(begin, end, found) visits
/// units, writes the rows that it finds to `found` and returns their number. Task i writes to
/// scratch + offset(first unit), which has room for all of the task's rows; `rows` is the number of
/// rows of all tasks. Returns false and appends nothing if more than `most` rows are found. One
/// task in eight runs first; if the results of these tasks predict more than `most` rows, the
/// others do not run.
template <typename Offset, typename Find>
[[nodiscard]] bool append_in_order(const Execution& execution, const TaskCut& cut, std::size_t rows,
                                   std::uint32_t* scratch, Offset&& offset, Find&& find,
                                   Column<std::uint32_t>& out, std::size_t most) {
  constexpr std::size_t kOneIn = 8;
  constexpr std::size_t kFewRows = 32;  // a sample of fewer rows than one in this many is too small
  const std::size_t tasks = cut.tasks();
  std::array<std::size_t, kMaxTasks> found{};
  const auto room = [&](std::size_t task) { return scratch + offset(cut.first(task)); };
  const auto run = [&](std::size_t task) {
    found[task] = find(cut.first(task), cut.first(task + 1), room(task));
  };
  const auto sampled = [](std::size_t i) { return i * kOneIn + kOneIn / 2; };
  execution.for_each(tasks / kOneIn, [&](std::size_t i) { run(sampled(i)); });
  // The products may exceed 32 bits.
  std::uint64_t seen = 0;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < tasks / kOneIn; ++i) {
    seen += static_cast<std::uint64_t>(room(sampled(i) + 1) - room(sampled(i)));
    sum += found[sampled(i)];
  }
  if (kFewRows * seen > rows && sum * rows > (std::uint64_t{most} + most / 4) * seen) return false;
  execution.for_each(tasks, [&](std::size_t task) {
    const bool is_sampled = task / kOneIn < tasks / kOneIn && task == sampled(task / kOneIn);
    if (!is_sampled) run(task);
  });
  if (std::accumulate(found.begin(), found.end(), std::size_t{0}) > most) return false;
  for (std::size_t task = 0; task < tasks; ++task) {
    std::copy_n(room(task), found[task], out.end());
    out.set_size(out.size() + found[task]);
  }
  return true;
}

}  // namespace winnow
