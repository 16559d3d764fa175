// The granular flow simulation: its results are equal on all ISAs and threads, it misses no
// contact, gains no energy and does not allocate after warm-up. Also scene races.

#include "bench/common/counting_resource.h"
#include "bench/measure/scene_race.h"
#include "bench/simulation/flow_run.h"
#include "tests/support/config.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace winnow::bench {
namespace {

FlowOptions small_flow(FlowShape shape = FlowShape::mixed) {
  FlowOptions options;
  options.objects = 300;
  options.shape = shape;
  // With this speed the bodies collide within the simulated steps.
  options.stir = 3.0;
  options.step = 2e-3;
  options.law.frequency = 125.0;
  options.execution = Execution::serial();
  return options;
}

std::uint64_t fingerprint_after(std::size_t steps, const FlowOptions& options) {
  GranularFlow flow(options);
  for (std::size_t i = 0; i < steps; ++i) flow.step();
  return flow.fingerprint();
}

TEST(GranularFlow, flow_is_equal_on_all_isas_and_threads) {
  constexpr std::size_t kSteps = 1000;
  FlowOptions serial = small_flow();
  serial.objects = 120;
  FlowOptions parallel = serial;
  parallel.execution = Execution::parallel();
  std::uint64_t expected = 0;
  {
    const test::IsaScope scope(available_isas().front());
    expected = fingerprint_after(kSteps, serial);
  }
  for (const Isa isa : available_isas()) {
    const test::IsaScope scope(isa);
    test::Threads threads(2);
    EXPECT_EQ(threads.run([&] { return fingerprint_after(kSteps, parallel); }), expected)
        << to_string(isa);
    if (isa == available_isas().front()) continue;
    EXPECT_EQ(fingerprint_after(kSteps, serial), expected) << to_string(isa);
  }
}

TEST(GranularFlow, profiling_does_not_change_the_flow) {
  GranularFlow plain(small_flow());
  GranularFlow profiled(small_flow());
  for (std::size_t i = 0; i < 100; ++i) {
    plain.step();
    profiled.step(i % 3 == 0);
  }
  EXPECT_EQ(plain.fingerprint(), profiled.fingerprint());
}

TEST(GranularFlow, contacts_are_neither_lost_nor_invented) {
  for (const FlowShape shape : {FlowShape::spheres, FlowShape::boxes}) {
    GranularFlow flow(small_flow(shape));
    flow.keep_contact_poses();
    FlowFaults faults;
    for (std::size_t i = 0; i < 500; ++i) {
      flow.step();
      if (i % 20 == 0) faults += check_contacts(flow);
    }
    EXPECT_GT(faults.compared, 500U);
    EXPECT_EQ(faults.lost, 0U);
    EXPECT_EQ(faults.invented, 0U);
    EXPECT_EQ(faults.doubled, 0U);
  }
}

TEST(GranularFlow, contacts_create_no_energy) {
  for (const FlowShape shape : {FlowShape::spheres, FlowShape::boxes}) {
    GranularFlow flow(small_flow(shape));
    FlowHistory history;
    for (std::size_t i = 0; i < 800; ++i) {
      flow.step();
      history.add(flow);
    }
    EXPECT_LT(history.greatest_rise(), 1e-3);
    const double lost = history.samples().front().balance() - history.samples().back().balance();
    EXPECT_GT(lost, 0.0);
    EXPECT_GT(flow.returned(), 0U);
    EXPECT_LT(history.deepest(), 0.3);
  }
}

TEST(GranularFlow, warm_flow_does_not_allocate) {
  CountingResource memory;
  FlowOptions options = small_flow(FlowShape::spheres);
  options.memory = &memory;
  GranularFlow flow(options);
  for (std::size_t i = 0; i < 1500; ++i) flow.step();
  const std::size_t before = memory.allocations();
  for (std::size_t i = 0; i < 300; ++i) flow.step();
  EXPECT_EQ(memory.allocations(), before);
}

TEST(GranularFlow, check_reports_contacts_that_are_missing) {
  GranularFlow flow(small_flow());
  flow.keep_contact_poses();
  for (std::size_t i = 0; i < 300; ++i) flow.step();
  const FlowFaults faults = check_contacts(flow, Contacts());
  EXPECT_GT(faults.compared, 10U);
  EXPECT_EQ(faults.lost, faults.compared);
}

TEST(SceneRace, heaps_of_equal_seeds_are_equal_and_dense) {
  const auto set = make_heap(400, 7);
  const auto again = make_heap(400, 7);
  for (std::size_t i = 0; i < set->poses.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(set->poses[i].position[axis], again->poses[i].position[axis]);
    }
  }
  std::array<SceneContender, 1> contenders{{{make_winnow_scene(1), 1}}};
  const auto timings = race_scene(*set, kMoving, contenders, 1);
  EXPECT_GT(timings.front().finds.touching, 400U);
  EXPECT_LT(timings.front().finds.touching, 2000U);
}

TEST(SceneRace, all_engines_find_equal_contacts) {
  const auto set = make_landscape(60, 24, 5);
  std::array<SceneContender, 2> contenders{
      {{make_winnow_scene(1), 1}, {make_winnow_scene(2, {.cache_tolerance = kCacheTolerance}), 2}}};
  const auto timings = race_scene(*set, kResting, contenders, 2);
  ASSERT_EQ(timings.size(), 2U);
  EXPECT_GE(timings[0].finds.touching, 60U);
  EXPECT_EQ(timings[0].finds.touching, timings[1].finds.touching);
  EXPECT_EQ(timings[0].ms.size(), 2U);
}

}  // namespace
}  // namespace winnow::bench
