#include <winnow/core/execution.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

namespace winnow {

std::size_t Execution::concurrency() const noexcept {
  if (!parallel_) return 1;
  const int threads = tbb::this_task_arena::max_concurrency();
  return threads > 1 ? static_cast<std::size_t>(threads) : 1;
}

void Execution::run(std::size_t count, void* context, void (*task)(void*, std::size_t)) const {
  if (count <= 1 || concurrency() == 1) {
    for (std::size_t i = 0; i < count; ++i) task(context, i);
    return;
  }
  // Workers keep the floating-point environment of when the arena was made: they take the caller's,
  // so that its rounding, and what it makes of denormal numbers, are those of all tasks. Isolated:
  // whoever cancels the work that the call is part of must not leave it half done.
  using Context = tbb::task_group_context;
  Context environment(Context::isolated, Context::default_traits | Context::fp_settings);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i) task(context, i);
        },
        tbb::simple_partitioner(), environment);
  });
}

}  // namespace winnow
