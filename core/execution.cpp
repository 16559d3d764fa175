#include <winnow/core/execution.h>
#include "core/threads/atomic_ref.h"
#include "core/threads/float_environment.h"

#include <algorithm>
#include <array>
#include <cstddef>

#if WINNOW_HAVE_TBB
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#endif

namespace winnow {
namespace {

// Maximum number of threads that share a call; further threads stay idle.
constexpr std::size_t kMaxShares = 64;

/// Tasks divided into one contiguous range per thread. A thread takes tasks one by one from its own
/// range, then from the ranges of others (work stealing). Most neighbouring tasks thus run on one
/// thread, and taking a task costs one atomic addition.
class SharedTasks {
 public:
  SharedTasks(std::size_t count, std::size_t threads, void* tasks, JobSystem::Task task) noexcept
      : shares_(std::min({count, threads, kMaxShares})), tasks_(tasks), task_(task) {
    for (std::size_t s = 0; s < shares_; ++s) {
      share_[s] = {.next = count * s / shares_, .end = count * (s + 1) / shares_};
    }
  }

  [[nodiscard]] std::size_t shares() const noexcept { return shares_; }

  /// Runs tasks of range `own`, then of the other ranges, until all tasks have been started.
  void run(std::size_t own) noexcept {
    for (std::size_t k = 0; k < shares_; ++k) {
      TaskRange& share = share_[own + k < shares_ ? own + k : own + k - shares_];
      for (std::size_t i = take(share); i < share.end; i = take(share)) task_(tasks_, i);
    }
  }

 private:
  struct alignas(64) TaskRange {
    std::size_t next;
    std::size_t end;
  };
  static std::size_t take(TaskRange& share) noexcept {
    return AtomicRef<std::size_t>(share.next).fetch_add(1, std::memory_order_relaxed);
  }

  std::array<TaskRange, kMaxShares> share_;  // only the first shares_ are initialised
  const std::size_t shares_;
  void* const tasks_;
  const JobSystem::Task task_;
};

#if WINNOW_HAVE_TBB
std::size_t arena_threads() noexcept {
  const int threads = tbb::this_task_arena::max_concurrency();
  return threads > 1 ? static_cast<std::size_t>(threads) : 1;
}

// TBB's workers have the floating-point environment that was set when their arena was created. The
// context captures the caller's environment, so that all tasks round and treat denormals as the
// caller does. The context is isolated, so that a cancellation of the caller's task group does not
// leave the call half done.
void run_in_arena(SharedTasks& tasks) {
  using Context = tbb::task_group_context;
  Context environment(Context::isolated, Context::default_traits | Context::fp_settings);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, tasks.shares(), 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t s = range.begin(); s != range.end(); ++s) tasks.run(s);
        },
        tbb::simple_partitioner(), environment);
  });
}
#endif

/// Runs tasks on a thread of the host in the floating-point environment of the caller, and restores
/// the thread's own environment afterwards.
struct HostedTasks {
  SharedTasks& tasks;
  FloatControl callers = float_control();

  static void run(void* hosted, std::size_t share) {
    const auto& self = *static_cast<const HostedTasks*>(hosted);
    const FloatControl own = float_control();
    set_float_control(self.callers);
    self.tasks.run(share);
    set_float_control(own);
  }
};

}  // namespace

std::size_t Execution::concurrency() const noexcept {
  if (jobs_.parallel_for != nullptr) return jobs_.threads;
#if WINNOW_HAVE_TBB
  if (arena_) return arena_threads();
#endif
  return 1;
}

void Execution::run(std::size_t count, void* context, void (*task)(void*, std::size_t)) const {
  const std::size_t threads = count <= 1 ? 1 : concurrency();
  if (threads == 1) {
    for (std::size_t i = 0; i < count; ++i) task(context, i);
    return;
  }
  SharedTasks tasks(count, threads, context, task);
  if (jobs_.parallel_for != nullptr) {
    HostedTasks hosted{tasks};
    const HostFloatEnvironment around;
    return jobs_.parallel_for(jobs_.context, tasks.shares(), HostedTasks::run, &hosted);
  }
#if WINNOW_HAVE_TBB
  run_in_arena(tasks);
#endif
}

}  // namespace winnow
