#pragma once

#include <winnow/core/export.h>

#include <cstddef>
#include <type_traits>

namespace winnow {

/// A host's own way to run tasks side by side: its job system, its pool of threads.
struct JobSystem {
  /// Does one task of `tasks`. It does not throw.
  using Task = void (*)(void* tasks, std::size_t i);

  /// Calls `task(tasks, i)` once for every i < count, on any threads and in any order, and returns
  /// when all of these calls have. What came before it happens before the tasks, and these before
  /// it returns. While it waits it does nothing else that may call winnow, since its caller may
  /// hold a lock. It is called from any thread, several at once, also from tasks of its own if the
  /// host calls winnow there; it must not throw.
  void (*parallel_for)(void* context, std::size_t count, Task task, void* tasks) = nullptr;
  /// Handed to parallel_for; it outlives everything that the job system was given to.
  void* context = nullptr;
  /// How many tasks may run at the same time, and the most that a call of parallel_for is given.
  /// More or fewer cost time alone.
  std::size_t threads = 1;

  /// The same function, context and number of threads.
  friend constexpr bool operator==(const JobSystem&, const JobSystem&) noexcept = default;
};

/// How a partition uses the machine. Tasks run in the floating-point environment of the caller
/// (rounding, flushing of denormal numbers). Results and their order are the same on any number of
/// threads, whoever runs them.
class Execution {
 public:
  /// All work is done by the thread that calls.
  [[nodiscard]] static constexpr Execution serial() noexcept { return Execution({}, false); }
  /// As oneTBB tasks inside the arena of the thread that calls, so the caller decides on the number
  /// of threads (`tbb::task_arena(n).execute(...)`). They run to the end also where the caller's
  /// own group of tasks is cancelled. A winnow that was built without oneTBB runs them one after
  /// the other.
  [[nodiscard]] static constexpr Execution parallel() noexcept { return Execution({}, true); }
  /// By the host's own means.
  [[nodiscard]] static constexpr Execution on(const JobSystem& jobs) noexcept {
    return jobs.parallel_for != nullptr && jobs.threads > 1 ? Execution(jobs, false) : serial();
  }

  /// Threads that can work on a call made from here.
  [[nodiscard]] WINNOW_API std::size_t concurrency() const noexcept;

  /// Calls `task(i)` once for every i < count, in any order; returns when all are done. Tasks must
  /// not throw. A task never runs unrelated work of the arena while it waits, so it may be called
  /// under a lock.
  template <typename Task>
  void for_each(std::size_t count, Task&& task) const {
    run(count, &task, [](void* context, std::size_t i) {
      (*static_cast<std::remove_reference_t<Task>*>(context))(i);
    });
  }

  /// Work is done by the same means.
  friend constexpr bool operator==(const Execution&, const Execution&) noexcept = default;

 private:
  constexpr Execution(const JobSystem& jobs, bool arena) noexcept : jobs_(jobs), arena_(arena) {}
  WINNOW_API void run(std::size_t count, void* context, void (*task)(void*, std::size_t)) const;

  JobSystem jobs_;
  bool arena_;
};

}  // namespace winnow
