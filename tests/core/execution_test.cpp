#include <gtest/gtest.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#include <winnow/core/execution.h>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include <array>
#include <atomic>
#include <cfenv>
#include <thread>
#include <utility>
#include <vector>

#include "tests/support/config.h"

namespace winnow::test {
namespace {

TEST(Execution, runs_every_index_exactly_once) {
  for (const int threads : thread_counts()) {
    Threads arena(threads);
    for (const Execution execution : {Execution::serial(), Execution::parallel()}) {
      for (const std::size_t count : {0U, 1U, 2U, 7U, 1000U}) {
        std::vector<std::atomic<int>> runs(count + 1);
        arena.run([&] { execution.for_each(count, [&](std::size_t i) { ++runs[i]; }); });
        for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(runs[i], 1) << i << " of " << count;
        ASSERT_EQ(runs[count], 0);
      }
    }
  }
}

TEST(Execution, that_is_serial_stays_on_the_calling_thread_in_order) {
  Threads arena(8);
  std::vector<std::size_t> order;
  arena.run([&] {
    const std::thread::id caller = std::this_thread::get_id();
    EXPECT_EQ(Execution::serial().concurrency(), 1U);
    Execution::serial().for_each(100, [&](std::size_t i) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      order.push_back(i);
    });
  });
  for (std::size_t i = 0; i < 100; ++i) ASSERT_EQ(order[i], i);
}

TEST(Execution, stays_inside_the_arena_of_the_caller) {
  for (const int threads : {1, 2, 8}) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      EXPECT_EQ(Execution::parallel().concurrency(), static_cast<std::size_t>(threads));
      Execution::parallel().for_each(500, [&](std::size_t) {
        const int slot = tbb::this_task_arena::current_thread_index();
        EXPECT_EQ(tbb::this_task_arena::max_concurrency(), threads);
        EXPECT_GE(slot, 0);
        EXPECT_LT(slot, threads);
      });
    });
  }
}

// Two tasks that wait for each other can only both end if two threads run them.
TEST(Execution, uses_the_threads_of_the_arena) {
  tbb::task_arena arena(2);
  std::atomic<int> met{0};
  arena.execute([&] {
    Execution::parallel().for_each(2, [&](std::size_t) {
      ++met;
      while (met.load() < 2) std::this_thread::yield();
    });
  });
  EXPECT_EQ(met, 2);
}

/// The caller's floating-point environment, restored at the end of a scope.
class EnvironmentScope {
 public:
  EnvironmentScope() { std::fegetenv(&before_); }
  ~EnvironmentScope() { std::fesetenv(&before_); }
  EnvironmentScope(const EnvironmentScope&) = delete;
  EnvironmentScope& operator=(const EnvironmentScope&) = delete;

  /// Rounds upward and, where this knows how to ask for that, flushes denormal numbers to zero.
  static void change() {
    std::fesetround(FE_UPWARD);
#if defined(__SSE__)
    _mm_setcsr(_mm_getcsr() | 0x8040U);
#endif
  }

 private:
  std::fenv_t before_{};
};

/// What a denormal number and a rounded sum are here.
std::pair<float, float> arithmetic_here() {
  const volatile float tiny = 1e-40F;
  const volatile float one = 1.0F;
  const volatile float less = 1e-9F;
  return {tiny * one, one + less};
}

// The host may set it after the workers were started.
TEST(Execution, runs_tasks_in_the_floating_point_environment_of_the_caller) {
  tbb::task_arena arena(2);
  const auto is_everywhere_as_here = [] {
    std::array<std::pair<float, float>, 2> seen;
    std::atomic<int> met{0};
    Execution::parallel().for_each(2, [&](std::size_t i) {
      ++met;
      while (met.load() < 2) std::this_thread::yield();
      seen[i] = arithmetic_here();
    });
    return seen[0] == arithmetic_here() && seen[1] == arithmetic_here();
  };
  arena.execute([&] {
    EXPECT_TRUE(is_everywhere_as_here());
    const auto before = arithmetic_here();
    {
      const EnvironmentScope scope;
      EnvironmentScope::change();
      EXPECT_TRUE(is_everywhere_as_here());
      EXPECT_FALSE(arithmetic_here() == before);
    }
    EXPECT_TRUE(is_everywhere_as_here());
    EXPECT_TRUE(arithmetic_here() == before);
  });
}

// Else a call would return with part of its work done, and say that all is well.
TEST(Execution, runs_every_task_though_the_group_of_the_caller_is_cancelled) {
  tbb::task_arena arena(2);
  std::atomic<int> runs{0};
  arena.execute([&] {
    tbb::task_group group;
    group.run_and_wait([&] {
      group.cancel();
      Execution::parallel().for_each(100, [&](std::size_t) { ++runs; });
    });
  });
  EXPECT_EQ(runs, 100);
}

// A task that waits must not pick up other work of the arena, or a caller that holds a lock could
// meet itself.
TEST(Execution, runs_nothing_else_while_a_task_waits) {
  tbb::task_arena arena(2);
  std::atomic<int> mixed{0};
  arena.execute([&] {
    Execution::parallel().for_each(40, [&](std::size_t) {
      thread_local bool inside = false;
      if (inside) ++mixed;
      inside = true;
      Execution::parallel().for_each(40, [](std::size_t) { std::this_thread::yield(); });
      inside = false;
    });
  });
  EXPECT_EQ(mixed, 0);
}

}  // namespace
}  // namespace winnow::test
