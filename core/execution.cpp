#include <winnow/core/execution.h>

#if WINNOW_HAVE_TBB
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#endif

#if defined(__SSE__) && !defined(__wasm__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace winnow {
namespace {

#if WINNOW_HAVE_TBB
std::size_t arena_threads() noexcept {
  const int threads = tbb::this_task_arena::max_concurrency();
  return threads > 1 ? static_cast<std::size_t>(threads) : 1;
}

// Workers keep the floating-point environment of when the arena was made: they take the caller's,
// so that its rounding, and what it makes of denormal numbers, are those of all tasks. Isolated:
// whoever cancels the work that the call is part of must not leave it half done.
void run_in_arena(std::size_t count, void* tasks, JobSystem::Task task) {
  using Context = tbb::task_group_context;
  Context environment(Context::isolated, Context::default_traits | Context::fp_settings);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i) task(tasks, i);
        },
        tbb::simple_partitioner(), environment);
  });
}
#endif

#if defined(__SSE__) && !defined(__wasm__)
// Of code that is compiled for SSE it is all in one register.
using FloatEnvironment = unsigned;
FloatEnvironment float_environment() noexcept {
  return _mm_getcsr();
}
void enter(const FloatEnvironment& environment) noexcept {
  _mm_setcsr(environment);
}
#else
using FloatEnvironment = std::fenv_t;
FloatEnvironment float_environment() noexcept {
  FloatEnvironment environment;
  std::fegetenv(&environment);
  return environment;
}
void enter(const FloatEnvironment& environment) noexcept {
  std::fesetenv(&environment);
}
#endif

/// Tasks that a host's threads run in the environment of the caller, and end in their own.
struct HostedTasks {
  void* tasks;
  JobSystem::Task task;
  FloatEnvironment callers = float_environment();

  static void run(void* hosted, std::size_t i) {
    const auto& self = *static_cast<const HostedTasks*>(hosted);
    const FloatEnvironment own = float_environment();
    enter(self.callers);
    self.task(self.tasks, i);
    enter(own);
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
  if (count <= 1 || concurrency() == 1) {
    for (std::size_t i = 0; i < count; ++i) task(context, i);
    return;
  }
  if (jobs_.parallel_for != nullptr) {
    HostedTasks hosted{context, task};
    return jobs_.parallel_for(jobs_.context, count, HostedTasks::run, &hosted);
  }
#if WINNOW_HAVE_TBB
  run_in_arena(count, context, task);
#endif
}

}  // namespace winnow
