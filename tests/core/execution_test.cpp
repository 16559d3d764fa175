// Execution: every index runs once; the threads and the floating-point environment of tasks; a
// waiting task runs no other work.

#include <gtest/gtest.h>
#include <winnow/core/execution.h>

#if WINNOW_HAVE_TBB
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#endif

#include <array>
#include <atomic>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/support/config.h"
#include "tests/support/float_modes.h"
#include "tests/support/platform.h"

#if WINNOW_TEST_THREADS
#include <thread>
#endif

namespace winnow::test {
namespace {

TEST(Execution, every_index_runs_exactly_once) {
  for (const Workers& workers : all_workers()) {
    Threads arena(workers.threads);
    for (const std::size_t count : {0U, 1U, 2U, 7U, 1000U}) {
      std::vector<std::atomic<int>> runs(count + 1);
      arena.run([&] { workers.execution().for_each(count, [&](std::size_t i) { ++runs[i]; }); });
      for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(runs[i], 1) << i << " of " << count;
      ASSERT_EQ(runs[count], 0);
    }
  }
}

#if WINNOW_TEST_THREADS
TEST(Execution, serial_execution_stays_on_the_calling_thread) {
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
#endif

TEST(Execution, host_execution_has_the_threads_of_the_host) {
  JobSystem jobs = jobs_of("reversed", 5);
  EXPECT_EQ(Execution::on(jobs).concurrency(), 5U);
  EXPECT_FALSE(Execution::on(jobs) == Execution::parallel());
  EXPECT_TRUE(Execution::on(jobs) == Execution::on(jobs));
  jobs.threads = 1;
  EXPECT_TRUE(Execution::on(jobs) == Execution::serial());
  jobs.threads = 0;
  EXPECT_TRUE(Execution::on(jobs) == Execution::serial());
  EXPECT_TRUE(Execution::on({}) == Execution::serial());
}

TEST(Execution, nested_loops_on_a_host_run_every_index) {
  for (const std::string_view host : kHosts) {
    const Execution execution = Execution::on(jobs_of(host, 4));
    std::vector<std::atomic<int>> runs(20 * 30 * 5);
    execution.for_each(20, [&](std::size_t i) {
      execution.for_each(30, [&](std::size_t j) {
        execution.for_each(5, [&](std::size_t k) { ++runs[(i * 30 + j) * 5 + k]; });
      });
    });
    for (const std::atomic<int>& count : runs) ASSERT_EQ(count, 1) << host;
  }
}

// Each thread first runs its own range of consecutive indices. Threads that have finished then run
// the ranges of threads that have not started.
TEST(Execution, host_threads_get_ranges_and_then_the_rest) {
  struct Host {
    std::size_t given = 0;
    std::vector<std::size_t> order;
  } host;
  const auto last_first = [](void* context, std::size_t count, JobSystem::Task task, void* tasks) {
    static_cast<Host*>(context)->given = count;
    while (count > 0) task(tasks, --count);
  };
  Execution::on({last_first, &host, 3}).for_each(9, [&](std::size_t i) {
    host.order.push_back(i);
  });
  EXPECT_EQ(host.given, 3U);
  EXPECT_EQ(host.order, (std::vector<std::size_t>{6, 7, 8, 0, 1, 2, 3, 4, 5}));
}

#if !WINNOW_HAVE_TBB
TEST(Execution, parallel_without_arenas_runs_serially) {
  EXPECT_EQ(Execution::parallel().concurrency(), 1U);
  std::vector<std::size_t> order;
  Execution::parallel().for_each(100, [&](std::size_t i) { order.push_back(i); });
  for (std::size_t i = 0; i < 100; ++i) ASSERT_EQ(order[i], i);
}
#endif

#ifdef FE_UPWARD
constexpr FloatMode kOtherMode{FE_UPWARD, true, true};

/// A denormal number and a rounded sum as this thread computes them.
std::pair<float, float> arithmetic_here() {
  const volatile float tiny = 1e-40F;
  const volatile float one = 1.0F;
  const volatile float less = 1e-9F;
  return {tiny * one, one + less};
}

// The host may change the environment after the workers have started.
TEST(Execution, tasks_have_the_float_environment_of_the_caller) {
  const auto is_everywhere_as_here = [](const Execution& execution) {
    std::array<std::pair<float, float>, 2> seen;
    std::atomic<int> started{0};
    execution.for_each(2, [&](std::size_t i) {
      ++started;
      while (started.load() < 2) std::this_thread::yield();
      seen[i] = arithmetic_here();
    });
    return seen[0] == arithmetic_here() && seen[1] == arithmetic_here();
  };
  const auto check = [&](const Execution& execution) {
    EXPECT_TRUE(is_everywhere_as_here(execution));
    const auto before = arithmetic_here();
    {
      const FloatModeScope scope(kOtherMode);
      EXPECT_TRUE(is_everywhere_as_here(execution));
      EXPECT_FALSE(arithmetic_here() == before);
    }
    EXPECT_TRUE(is_everywhere_as_here(execution));
    EXPECT_TRUE(arithmetic_here() == before);
  };
#if WINNOW_TEST_THREADS
  check(Execution::on(jobs_of("pool", 2)));
#endif
#if WINNOW_HAVE_TBB
  tbb::task_arena(2).execute([&] { check(Execution::parallel()); });
#endif
}

// The threads of a host may have any floating-point environment.
TEST(Execution, host_thread_keeps_its_own_float_environment) {
  const auto backwards = jobs_of("reversed", 2);
  const auto in_another = [](void* context, std::size_t count, JobSystem::Task task, void* tasks) {
    const FloatModeScope scope(kOtherMode);
    const auto before = arithmetic_here();
    static_cast<const JobSystem*>(context)->parallel_for(nullptr, count, task, tasks);
    EXPECT_TRUE(arithmetic_here() == before);
  };
  const auto here = arithmetic_here();
  JobSystem jobs{in_another, const_cast<JobSystem*>(&backwards), 2};
  Execution::on(jobs).for_each(2, [&](std::size_t) { EXPECT_TRUE(arithmetic_here() == here); });
}
#endif

#if WINNOW_HAVE_TBB
TEST(Execution, parallel_execution_stays_inside_the_arena) {
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

// Two tasks that wait for each other can end only if two threads run them.
TEST(Execution, threads_of_the_arena_are_used) {
  tbb::task_arena arena(2);
  std::atomic<int> started{0};
  arena.execute([&] {
    Execution::parallel().for_each(2, [&](std::size_t) {
      ++started;
      while (started.load() < 2) std::this_thread::yield();
    });
  });
  EXPECT_EQ(started, 2);
}

// A call must not skip tasks and then return ok.
TEST(Execution, all_tasks_run_in_a_cancelled_group) {
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

// A waiting task must not start other work of the arena: a caller that holds a lock could block
// itself.
TEST(Execution, waiting_task_runs_no_other_work) {
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
#endif

}  // namespace
}  // namespace winnow::test
