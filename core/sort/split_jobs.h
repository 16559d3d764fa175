#pragma once

#include <winnow/core/execution.h>

#include <array>
#include <cstddef>

namespace winnow {

/// Sorts by cutting a set in two again and again. `split` leaves one side to the job that it is
/// given and returns the other; `finish` does the rest of a job on one thread; an empty job says
/// so. Jobs of more than `worth_sharing` are split breadth first until there is enough for all
/// threads: which jobs these are depends on the set alone, whatever the number of threads.
template <typename Job, typename Split, typename Finish>
void run_split_jobs(const Job& first, std::size_t worth_sharing, const Execution& execution,
                    Split&& split, Finish&& finish) {
  constexpr std::size_t kMostJobs = 64;
  std::array<Job, 2 * kMostJobs> jobs;
  std::size_t open = 1;
  jobs[0] = first;
  for (bool more = true; more && open <= kMostJobs / 2;) {
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
