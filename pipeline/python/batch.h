#pragma once

#include "pipeline/python/arrays.h"
#include "pipeline/python/locks.h"

#include <winnow/core/execution.h>
#include <winnow/core/status.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <new>
#include <shared_mutex>
#include <string>
#include <vector>

namespace winnow::python {

/// Number of queries that one task answers with the same buffers.
inline constexpr std::size_t kQueriesPerTask = 256;

[[nodiscard]] inline std::size_t tasks_for(std::size_t queries) noexcept {
  return (queries + kQueriesPerTask - 1) / kQueriesPerTask;
}

/// Result of a batch of queries: the first failure, if any.
struct Outcome {
  Status status = Status::ok;
  std::size_t entry = 0;
};

/// Throws unless the status is ok.
inline void accept(const Outcome& outcome, const char* call) {
  accept(outcome.status, std::string(call) + ", entry " + std::to_string(outcome.entry));
}

/// Calls `answer(task, query)` for each query. The queries of a task run in sequence on one thread
/// until one fails. Returns the failure of the first query that failed; the result does not depend
/// on the number of threads.
template <typename Answer>
[[nodiscard]] Outcome answer_all(const Execution& execution, std::size_t queries, Answer&& answer) {
  std::vector<Outcome> outcomes(tasks_for(queries));
  execution.for_each(outcomes.size(), [&](std::size_t task) {
    const std::size_t end = std::min(queries, (task + 1) * kQueriesPerTask);
    for (std::size_t i = task * kQueriesPerTask; i < end; ++i) {
      Status status = Status::out_of_memory;
      try {
        status = answer(task, i);
      } catch (const std::bad_alloc&) {
        // The status is out_of_memory already.
      }
      if (status != Status::ok) {
        outcomes[task] = {status, i};
        return;
      }
    }
  });
  for (const Outcome& outcome : outcomes) {
    if (outcome.status != Status::ok) return outcome;
  }
  return {};
}

/// Returns an array (n,) of answer(i), with shared access.
template <typename T, typename Answer>
[[nodiscard]] py::array each_answer(std::shared_mutex& mutex, std::size_t count, Answer&& answer) {
  auto result = fresh<T>(count);
  T* const to = result.mutable_data();
  reading(mutex, [&] {
    for (std::size_t i = 0; i < count; ++i) to[i] = answer(i);
  });
  return result;
}
/// Returns an array (n,) uint64 of keys.
template <typename Answer>
[[nodiscard]] py::array each_key(std::shared_mutex& mutex, std::size_t count, Answer&& answer) {
  return each_answer<std::uint64_t>(
      mutex, count, [&](std::size_t i) { return std::bit_cast<std::uint64_t>(answer(i)); });
}

/// The lists of results of all queries, and the index at which each of them begins. Tasks fill
/// lists of their own, which `join` concatenates.
template <typename Entry>
struct Lists {
  explicit Lists(std::size_t queries) : of_task(tasks_for(queries)), first(queries + 1) {}

  std::vector<std::vector<Entry>> of_task;
  /// While tasks run, element [i + 1] is the number of entries of query i.
  std::vector<std::uint64_t> first;
  std::vector<Entry> entries;

  void put(std::size_t task, std::size_t query, const Entry* begin, const Entry* end) {
    of_task[task].insert(of_task[task].end(), begin, end);
    first[query + 1] += static_cast<std::uint64_t>(end - begin);
  }
  void join() {
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    if (of_task.size() == 1) {
      entries = std::move(of_task.front());
      return;
    }
    entries.reserve(first.back());
    for (const std::vector<Entry>& list : of_task) {
      entries.insert(entries.end(), list.begin(), list.end());
    }
  }
};

}  // namespace winnow::python
