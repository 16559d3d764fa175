#pragma once

#include <winnow/core/execution.h>

#include <array>
#include <cstddef>

namespace winnow {

/// Sorts a set by dividing it in two again and again, in parallel. `split` keeps one side in the
/// job that is passed to it and returns the other; `finish` sorts the rest of a job on one thread;
/// an empty job has size 0. Jobs larger than `worth_sharing` are split breadth first until there
/// are more than 32 jobs or none can be split. The resulting jobs depend only on the set, not on
/// the number of threads.
template <typename Job, typename Split, typename Finish>
void divide_in_parallel(const Job& first, std::size_t worth_sharing, const Execution& execution,
                        Split&& split, Finish&& finish) {
  constexpr std::size_t kMaxJobs = 64;
  std::array<Job, 2 * kMaxJobs> jobs;
  std::size_t open = 1;
  jobs[0] = first;
  for (bool more = true; more && open <= kMaxJobs / 2;) {
    execution.for_each(open, [&](std::size_t i) {
      jobs[open + i] = jobs[i].size() > worth_sharing ? split(jobs[i]) : Job{};
    });
    std::size_t kept = open;
    for (std::size_t i = open; i < 2 * open; ++i) {
      if (jobs[i].size() != 0) jobs[kept++] = jobs[i];
    }
    more = kept > open;
    open = kept;
  }
  execution.for_each(open, [&](std::size_t i) { finish(jobs[i]); });
}

}  // namespace winnow
