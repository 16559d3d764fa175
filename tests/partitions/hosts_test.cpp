// Partitions on the threads of a host program: the calls that a host may make, and results that do
// not depend on the host.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/config.h"
#include "tests/support/float_modes.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace winnow::test {
namespace {

using Frames = std::vector<std::vector<Pair>>;

// Enough objects that builds, updates and pairs are distributed over threads.
Frames play(std::string_view name, const Execution& execution) {
  Random random(3);
  Partition partition(structure_named(name), {.execution = execution});
  std::vector<Aabb> boxes = mixed_boxes(partition.is_exact() ? scaled(20'000) : 500);
  std::vector<Key> keys(boxes.size());
  EXPECT_EQ(partition.insert(boxes, {}, keys), Status::ok);
  PairBuffer pairs;
  Frames frames;
  for (const Motion motion : {Motion::little, Motion::few, Motion::little}) {
    EXPECT_EQ(partition.self_pairs(pairs), Status::ok);
    frames.emplace_back(pairs.pairs().begin(), pairs.pairs().end());
    move(motion, boxes, random);
    EXPECT_EQ(partition.update(keys, boxes), Status::ok);
  }
  return frames;
}

class Hosts : public testing::TestWithParam<std::string_view> {};

TEST_P(Hosts, host_gets_the_pairs_of_one_thread) {
  const Frames serial = play(GetParam(), Execution::serial());
  for (const std::string_view host : kHosts) {
    EXPECT_TRUE(play(GetParam(), Execution::on(jobs_of(host, 3))) == serial) << host;
  }
}

// For example, each of many worlds runs in its own task.
TEST_P(Hosts, host_may_call_from_its_own_tasks) {
  const Frames serial = play(GetParam(), Execution::serial());
  for (const std::string_view host : kHosts) {
    const Execution execution = Execution::on(jobs_of(host, 3));
    std::vector<Frames> worlds(4);
    execution.for_each(worlds.size(),
                       [&](std::size_t i) { worlds[i] = play(GetParam(), execution); });
    for (const Frames& world : worlds) EXPECT_TRUE(world == serial) << host;
  }
}

/// Returns a sum that depends on the rounding mode of this thread.
float sum_here() {
  const volatile float one = 1.0F;
  const volatile float less = 1e-9F;
  return one + less;
}

#ifdef FE_UPWARD
// The host may change the mode while it waits for tasks and afterwards.
TEST_P(Hosts, tasks_run_in_the_mode_of_the_caller) {
  struct Host {
    JobSystem jobs = jobs_of("reversed", 2);
    std::vector<float> sums;
  } host;
  const auto run = [](void* context, std::size_t count, JobSystem::Task task, void* tasks) {
    auto& self = *static_cast<Host*>(context);
    self.sums.push_back(sum_here());
    self.jobs.parallel_for(self.jobs.context, count, task, tasks);
    self.sums.push_back(sum_here());
  };
  const Execution execution = Execution::on(JobSystem{run, &host, 2});
  const FloatModeScope scope({FE_UPWARD, true, true});
  const float expected = sum_here();
  ASSERT_GT(expected, 1.0F);
  static_cast<void>(play(GetParam(), execution));
  // Only NSquared has no work to distribute.
  EXPECT_TRUE(!host.sums.empty() || GetParam() == "NSquared");
  for (const float sum : host.sums) EXPECT_EQ(sum, expected);
  EXPECT_EQ(sum_here(), expected);
}
#endif

// Readers that find the partition stale wait for the reader that refreshes it.
TEST_P(Hosts, host_may_query_from_many_tasks) {
  for (const std::string_view host : kHosts) {
    const Execution execution = Execution::on(jobs_of(host, 3));
    Partition partition(structure_named(GetParam()), {.execution = execution});
    const std::vector<Aabb> boxes = mixed_boxes(1000);
    std::vector<Key> keys(boxes.size());
    ASSERT_EQ(partition.insert(boxes, {}, keys), Status::ok);
    std::vector<PairBuffer> buffers(6);
    execution.for_each(buffers.size(), [&](std::size_t i) {
      EXPECT_EQ(partition.self_pairs(buffers[i]), Status::ok);
    });
    for (const PairBuffer& buffer : buffers) {
      EXPECT_TRUE(std::ranges::equal(buffer.pairs(), buffers[0].pairs())) << host;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Hosts, testing::ValuesIn(structure_names()),
                         [](const auto& name) { return std::string(name.param); });

}  // namespace
}  // namespace winnow::test
