#pragma once

#include <winnow/core/export.h>

#include <cstddef>
#include <type_traits>

namespace winnow {

/// A host's own job system or thread pool, on which winnow runs its tasks in parallel.
struct JobSystem {
  /// Runs task `i` of `tasks`; it does not throw.
  using Task = void (*)(void* tasks, std::size_t i);

  /// Calls `task(tasks, i)` once for every i < count, on any threads and in any order, and returns
  /// after all calls have returned. Everything before the call happens before the tasks, and the
  /// tasks happen before the function returns. While the function blocks, it must not run other
  /// work that may call winnow, because its caller may hold a lock. It may be called from any
  /// thread, from several threads at once, and from its own tasks if the host calls winnow there.
  /// It must not throw.
  void (*parallel_for)(void* context, std::size_t count, Task task, void* tasks) = nullptr;
  /// Passed to `parallel_for`; must outlive everything that the job system is passed to.
  void* context = nullptr;
  /// Number of tasks that may run at the same time, and the largest `count` that is passed to
  /// `parallel_for`. It affects only speed.
  std::size_t threads = 1;

  /// True if function, context and number of threads are equal.
  friend constexpr bool operator==(const JobSystem&, const JobSystem&) noexcept = default;
};

/// How a call of winnow runs its work: on the calling thread, as oneTBB tasks, or on a host's job
/// system. Tasks run in the floating-point environment of the caller (rounding, flushing of
/// denormals). Results and their order do not depend on this choice or on the number of threads.
class Execution {
 public:
  /// Runs all work on the calling thread.
  [[nodiscard]] static constexpr Execution serial() noexcept { return Execution({}, false); }
  /// Runs work as oneTBB tasks inside the arena of the calling thread: the caller controls the
  /// number of threads (`tbb::task_arena(n).execute(...)`). The tasks run to completion even if the
  /// caller's own task group is cancelled. If winnow was built without oneTBB, the tasks run one
  /// after another.
  [[nodiscard]] static constexpr Execution parallel() noexcept { return Execution({}, true); }
  /// Runs work on the host's job system; serially if `jobs` has no `parallel_for` or only one
  /// thread.
  [[nodiscard]] static constexpr Execution on(const JobSystem& jobs) noexcept {
    return jobs.parallel_for != nullptr && jobs.threads > 1 ? Execution(jobs, false) : serial();
  }

  /// Returns the number of threads that can work on a call made from here.
  [[nodiscard]] WINNOW_API std::size_t concurrency() const noexcept;

  /// Calls `task(i)` once for every i < count, in any order; returns after all calls have returned.
  /// Tasks must not throw. The caller may hold a lock, because its thread runs no unrelated work of
  /// the arena during the call.
  template <typename Task>
  void for_each(std::size_t count, Task&& task) const {
    run(count, &task, [](void* context, std::size_t i) {
      (*static_cast<std::remove_reference_t<Task>*>(context))(i);
    });
  }

  /// True if both run work in the same way.
  friend constexpr bool operator==(const Execution&, const Execution&) noexcept = default;

 private:
  constexpr Execution(const JobSystem& jobs, bool arena) noexcept : jobs_(jobs), arena_(arena) {}
  WINNOW_API void run(std::size_t count, void* context, void (*task)(void*, std::size_t)) const;

  JobSystem jobs_;
  bool arena_;
};

}  // namespace winnow
