#pragma once

#include <winnow/core/export.h>

#include <cstddef>
#include <type_traits>

namespace winnow {

/// How a partition uses the machine. Parallel work runs as oneTBB tasks inside the arena of the
/// thread that calls, so the caller decides on the number of threads
/// (`tbb::task_arena(n).execute(...)`). Tasks run in the floating-point environment of the caller
/// (rounding, flushing of denormal numbers), and to the end also where the caller's own group of
/// tasks is cancelled. Results and their order are the same on any number.
class Execution {
 public:
  [[nodiscard]] static constexpr Execution serial() noexcept { return Execution(false); }
  [[nodiscard]] static constexpr Execution parallel() noexcept { return Execution(true); }

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

  friend constexpr bool operator==(const Execution&, const Execution&) noexcept = default;

 private:
  explicit constexpr Execution(bool parallel) noexcept : parallel_(parallel) {}
  WINNOW_API void run(std::size_t count, void* context, void (*task)(void*, std::size_t)) const;

  bool parallel_;
};

}  // namespace winnow
