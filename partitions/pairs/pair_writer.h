#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/filter.h>
#include <winnow/core/results.h>
#include <winnow/core/status.h>
#include "partitions/rows/row_view.h"

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace winnow {

/// Appends the output of many tasks to a PairBuffer in the order of the tasks, whichever threads
/// run them. On one thread, tasks write directly into the buffer. On several threads, a task also
/// does so if all tasks before it are done and the buffer has room. Schedulers give a thread runs
/// of consecutive tasks, so the output of the thread that runs the first tasks needs no copy. All
/// other tasks claim pages of scratch memory, which are copied in order at the end. The number of
/// pages follows the capacity of the buffer, so that frames with the same results allocate nothing.
class PairWriter {
 public:
  /// Appends only pairs that `predicate` accepts. The predicate is called on the thread that found
  /// the pair.
  PairWriter(PairBuffer& out, const Execution& execution,
             const PairPredicate& predicate = {}) noexcept
      : out_(out), execution_(execution), predicate_(predicate) {}

  /// Runs run(i, sink) for every i < tasks; `run` returns false if its sink could not grow.
  template <typename Run>
  Status append(std::size_t tasks, Run&& run) {
    return append(tasks, &run, [](void* context, std::size_t i, PairSink& sink) {
      return (*static_cast<std::remove_reference_t<Run>*>(context))(i, sink);
    });
  }

  /// Makes room for up to `pairs` pairs of up to `tasks` tasks. False if memory is refused.
  [[nodiscard]] static bool reserve(PairBuffer& out, std::size_t pairs, std::size_t tasks,
                                    const Execution& execution, Pages pages) noexcept;

  /// Returns the tests of 16 volumes that the tasks counted.
  [[nodiscard]] std::uint64_t tests() const noexcept { return tests_; }

 private:
  using WriteTask = bool (*)(void*, std::size_t, PairSink&);
  struct PageClaims;
  struct TaskOutput;
  struct SerialOutput;

  [[nodiscard]] static std::size_t pages_for(const PairBuffer& out, std::size_t tasks) noexcept;
  Status append(std::size_t tasks, void* context, WriteTask run);
  Status append_serial(std::size_t tasks, void* context, WriteTask run);
  Status append_parallel(std::size_t tasks, void* context, WriteTask run);
  bool make_pages(PageClaims& claims, std::size_t pages, std::size_t tasks);
  static std::size_t more_pages(PageClaims& claims, std::size_t tasks);
  void run_on_pages(std::size_t tasks, PageClaims& claims, void* context, WriteTask run);
  Status gather_pages(std::size_t tasks, PageClaims& claims);
  std::size_t keep_accepted(Pair* begin, std::size_t checked, const PairSink& sink) const noexcept;

  PairBuffer& out_;
  const Execution& execution_;
  const PairPredicate predicate_;
  std::uint64_t tests_ = 0;
};

}  // namespace winnow
