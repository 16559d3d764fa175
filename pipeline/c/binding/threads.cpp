// C binding of winnow_threads: a oneTBB arena with a given number of threads, as a job system.

#include <winnow/c/core.h>

#include "core/memory/catch_bad_alloc.h"
#include "pipeline/c/binding/arguments.h"

#include <winnow/core/execution.h>

#if WINNOW_HAVE_TBB
#include <tbb/task_arena.h>
#endif

namespace winnow::c {
namespace {

constexpr std::size_t kMaxThreads = 4096;

}  // namespace
}  // namespace winnow::c

struct winnow_threads {
  explicit winnow_threads(std::size_t count) : threads(count) {
#if WINNOW_HAVE_TBB
    arena.initialize(static_cast<int>(count));
#endif
  }

  void for_each(std::size_t count, winnow::JobSystem::Task task, void* tasks) {
    const auto run = [&] {
      winnow::Execution::parallel().for_each(count, [&](std::size_t i) { task(tasks, i); });
    };
#if WINNOW_HAVE_TBB
    arena.execute(run);
#else
    run();
#endif
  }

  std::size_t threads;
#if WINNOW_HAVE_TBB
  tbb::task_arena arena;
#endif
};

winnow_status winnow_threads_create(size_t count, winnow_threads** threads) {
  if (threads == nullptr || count == 0 || count > winnow::c::kMaxThreads) {
    return WINNOW_INVALID_ARGUMENT;
  }
  if (count > 1 && WINNOW_HAVE_TBB == 0) return WINNOW_UNSUPPORTED;
  winnow_threads* const made = winnow::catch_bad_alloc([&] { return new winnow_threads(count); },
                                                       static_cast<winnow_threads*>(nullptr));
  if (made == nullptr) return WINNOW_OUT_OF_MEMORY;
  *threads = made;
  return WINNOW_OK;
}

void winnow_threads_destroy(winnow_threads* threads) {
  delete threads;
}

winnow_status winnow_threads_execution(const winnow_threads* threads, winnow_execution* execution) {
  if (threads == nullptr || execution == nullptr) return WINNOW_INVALID_ARGUMENT;
  execution->kind = WINNOW_EXECUTION_ON;
  execution->jobs.context = const_cast<winnow_threads*>(threads);
  execution->jobs.threads = threads->threads;
  execution->jobs.parallel_for = [](void* context, size_t count,
                                    void (*task)(void* tasks, size_t i), void* tasks) {
    static_cast<winnow_threads*>(context)->for_each(count, task, tasks);
  };
  return WINNOW_OK;
}
