// Rebuilds that are planned over several refreshes while objects move, come and go: no pair may be
// missed before, during or after the new order is taken.

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "tests/support/counting_memory.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

constexpr std::size_t kWholeBuilds = std::numeric_limits<std::size_t>::max();
constexpr int kFrames = 80;

// Boxes with constant velocities that turn back at the ends of the scene.
class Drift {
 public:
  Drift(std::vector<Aabb> start, float longest_step) : boxes(std::move(start)) {
    Aabb all = boxes.front();
    for (const Aabb& box : boxes) all.merge(box);
    low_ = all.min;
    high_ = all.max;
    Random random(5);
    const auto step = [&] { return static_cast<float>(random.uniform(-1.0, 1.0)) * longest_step; };
    for (std::size_t i = 0; i < boxes.size(); ++i) steps_.emplace_back(step(), step(), step());
  }

  void go_on() {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (int a = 0; a < 3; ++a) {
        float& step = steps_[i][a];
        if (boxes[i].min[a] + step < low_[a] || boxes[i].max[a] + step > high_[a]) step = -step;
        boxes[i].min[a] += step;
        boxes[i].max[a] += step;
      }
    }
  }

  std::vector<Aabb> boxes;

 private:
  Vec3f low_;
  Vec3f high_;
  std::vector<Vec3f> steps_;
};

class PlannedBuilds : public Conformance {
 protected:
  // Returns the configuration with this build budget.
  [[nodiscard]] Config config_with(std::size_t budget) const {
    Config config = GetParam();
    config.build_budget = budget;
    return config;
  }
  [[nodiscard]] static std::size_t count() { return scaled(1400); }
};

TEST(PlannedBuild, refresh_without_a_query_does_not_advance_plans) {
  Drift drift(uniform_boxes(4000), 0.03F);
  std::vector<Partition> partitions;
  for (int i = 0; i < 2; ++i) partitions.emplace_back(linear_bvh());
  std::vector<Key> keys(drift.boxes.size());
  for (Partition& one : partitions) ASSERT_EQ(one.insert(drift.boxes, {}, keys), Status::ok);
  // The ids are the same, so the keys of both partitions differ only in their stamps.
  std::vector<Key> others = keys;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    keys[i] = partitions[0].key_of(others[i].id);
  }
  PairBuffer pairs;
  for (int frame = 0; frame < 2 * kFrames; ++frame) {
    drift.go_on();
    ASSERT_EQ(partitions[0].update(keys, drift.boxes), Status::ok);
    ASSERT_EQ(partitions[1].update(others, drift.boxes), Status::ok);
    // Refreshes before the query, then updates some objects again.
    ASSERT_EQ(partitions[1].refresh(), Status::ok);
    const std::size_t few = 40;
    ASSERT_EQ(partitions[1].update(std::span(others).first(few),
                                   BoxView(std::span(drift.boxes).first(few))),
              Status::ok);
    for (const Partition& one : partitions) ASSERT_EQ(one.self_pairs(pairs), Status::ok);
  }
  EXPECT_GE(partitions[0].statistics().builds, 3U);
  EXPECT_LE(partitions[1].statistics().builds, partitions[0].statistics().builds + 1);
}

TEST(PlannedBuild, planned_order_is_taken_before_it_is_due) {
  for (const char* const name : {"FlatGrid", "HierarchicalGrid", "SweepAndPrune"}) {
    Drift drift(uniform_boxes(2000), 0.03F);
    Partition partition(structure_named(name));
    std::vector<Key> keys(drift.boxes.size());
    ASSERT_EQ(partition.insert(drift.boxes, {}, keys), Status::ok);
    std::size_t most_irregular = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
      drift.go_on();
      ASSERT_EQ(partition.update(keys, drift.boxes), Status::ok);
      ASSERT_EQ(partition.refresh(), Status::ok);
      most_irregular = std::max(most_irregular, partition.statistics().irregular);
    }
    const Statistics statistics = partition.statistics();
    EXPECT_GE(statistics.planned_builds, 2U) << name;
    // At most two builds are not planned.
    EXPECT_GE(statistics.planned_builds + 2, statistics.builds) << name;
    EXPECT_LT(most_irregular, drift.boxes.size() / 16 + 64) << name;
  }
}

// Returns the number of frames with all objects drifting before a planned order is taken.
std::size_t frames_before_plan(const char* name) {
  Drift drift(uniform_boxes(2000), 0.03F);
  Partition partition(structure_named(name));
  std::vector<Key> keys(drift.boxes.size());
  EXPECT_EQ(partition.insert(drift.boxes, {}, keys), Status::ok);
  std::size_t frames = 0;
  while (partition.statistics().planned_builds == 0 && frames < kFrames) {
    drift.go_on();
    EXPECT_EQ(partition.update(keys, drift.boxes), Status::ok);
    EXPECT_EQ(partition.refresh(), Status::ok);
    ++frames;
  }
  return frames - 1;
}

TEST(PlannedBuild, plan_is_delayed_while_few_objects_move) {
  for (const char* const name : {"FlatGrid", "HierarchicalGrid", "SweepAndPrune"}) {
    Drift drift(uniform_boxes(2000), 0.03F);
    Partition partition(structure_named(name));
    std::vector<Key> keys(drift.boxes.size());
    ASSERT_EQ(partition.insert(drift.boxes, {}, keys), Status::ok);
    const std::size_t lively = frames_before_plan(name);
    const std::size_t few = keys.size() / 100;
    const auto move_first = [&](std::size_t count) {
      drift.go_on();
      ASSERT_EQ(partition.update(std::span(keys).first(count),
                                 BoxView(std::span(drift.boxes).first(count))),
                Status::ok);
      ASSERT_EQ(partition.refresh(), Status::ok);
    };
    for (std::size_t frame = 0; frame < lively; ++frame) move_first(keys.size());
    for (int frame = 0; frame < 8; ++frame) {
      move_first(few);
      EXPECT_EQ(partition.statistics().planned_builds, 0U) << name << ", frame " << frame;
    }
    move_first(few);
    EXPECT_EQ(partition.statistics().planned_builds, 1U) << name;
  }
}

// A plan processes levels from small to large objects. Large objects that jump before the plan
// reaches their level are sorted by their new positions.
TEST(PlannedBuild, planned_order_uses_positions_after_jumps) {
  constexpr std::size_t kSmall = 1600;
  constexpr std::size_t kObjects = 2000;
  constexpr std::size_t kTurns = 20;
  constexpr std::size_t kJumpsEach = (kObjects - kSmall) / kTurns;
  Drift drift(uniform_boxes(kObjects), 0.0F);
  for (std::size_t i = kSmall; i < kObjects; ++i) {
    drift.boxes[i].max += 7.0F * (drift.boxes[i].max - drift.boxes[i].min);
  }
  Partition partition(hierarchical_grid(), {.build_budget = kObjects});
  std::vector<Key> keys(kObjects);
  ASSERT_EQ(partition.insert(drift.boxes, {}, keys), Status::ok);
  std::uint64_t planned = 0;
  for (std::size_t frame = 0; frame < 2 * kFrames; ++frame) {
    for (std::size_t i = kSmall + frame % kTurns; i < kObjects; i += kTurns) {
      const Vec3f edges = drift.boxes[i].max - drift.boxes[i].min;
      const Vec3f to = drift.boxes[(i * 7919 + frame) % kSmall].min;
      drift.boxes[i] = {to, to + edges};
    }
    ASSERT_EQ(partition.update(keys, drift.boxes), Status::ok);
    ASSERT_EQ(partition.refresh(), Status::ok);
    const Statistics now = partition.statistics();
    ASSERT_EQ(now.levels, 2U);
    // The plan did not contain objects that jumped in the last two frames.
    if (now.planned_builds > planned) {
      EXPECT_LE(now.irregular, 2 * kJumpsEach) << "frame " << frame;
    }
    planned = now.planned_builds;
  }
  EXPECT_GE(planned, 2U);
}

TEST(PlannedBuild, whole_builds_make_no_plan) {
  Drift drift(uniform_boxes(2000), 0.03F);
  Partition partition(hierarchical_grid(), {.build_budget = kWholeBuilds});
  std::vector<Key> keys(drift.boxes.size());
  ASSERT_EQ(partition.insert(drift.boxes, {}, keys), Status::ok);
  for (int frame = 0; frame < kFrames; ++frame) {
    drift.go_on();
    ASSERT_EQ(partition.update(keys, drift.boxes), Status::ok);
    ASSERT_EQ(partition.refresh(), Status::ok);
  }
  EXPECT_GE(partition.statistics().builds, 3U);
  EXPECT_EQ(partition.statistics().planned_builds, 0U);
}

TEST_P(PlannedBuilds, drift_during_a_plan_misses_no_pair) {
  for (const auto& start : {uniform_boxes(count()), mixed_boxes(count())}) {
    for (const std::size_t budget : {std::size_t{0}, count(), kWholeBuilds}) {
      Drift drift(start, 0.02F);
      World world(config_with(budget));
      const std::vector<Key> keys = world.insert(drift.boxes);
      PairBuffer buffer;
      for (int frame = 0; frame < kFrames; ++frame) {
        drift.go_on();
        world.update(keys, drift.boxes);
        ASSERT_TRUE(world.agrees(buffer)) << "budget " << budget << ", frame " << frame;
      }
    }
  }
}

// The refresh that takes an order may not get all objects that moved during the plan.
TEST_P(PlannedBuilds, different_movers_in_each_frame_miss_no_pair) {
  Drift drift(uniform_boxes(count()), 0.1F);
  World world(config_with(count()));
  std::vector<Aabb> given = drift.boxes;
  const std::vector<Key> keys = world.insert(given);
  constexpr std::size_t kTurns = 6;
  PairBuffer buffer;
  for (std::size_t frame = 0; frame < 2 * kFrames; ++frame) {
    drift.go_on();
    for (std::size_t i = frame % kTurns; i < keys.size(); i += kTurns) {
      given[i] = drift.boxes[i];
      world.update(keys[i], given[i]);
    }
    ASSERT_TRUE(world.agrees(buffer)) << "frame " << frame;
  }
}

TEST_P(PlannedBuilds, arrivals_and_jumps_during_plans_miss_no_pair) {
  for (const std::size_t budget : {std::size_t{1}, 2 * count()}) {
    Drift drift(uniform_boxes(count()), 0.02F);
    World world(config_with(budget));
    std::vector<Key> keys = world.insert(drift.boxes);
    Key last = world.insert(drift.boxes[0]);
    Random random(11);
    PairBuffer buffer;
    for (int frame = 0; frame < kFrames; ++frame) {
      drift.go_on();
      world.update(keys, drift.boxes);
      for (int n = 0; n < 3; ++n) {
        const std::size_t gone = random.below(keys.size());
        world.remove(keys[gone]);
        keys[gone] = world.insert(drift.boxes[gone]);
        const std::size_t jumper = random.below(keys.size());
        drift.boxes[jumper] = drift.boxes[random.below(keys.size())];
        world.update(keys[jumper], drift.boxes[jumper]);
        const std::size_t filtered = random.below(keys.size());
        world.set_filter(keys[filtered], {.layers = 1U << random.below(4)});
      }
      // The last arrival leaves in one frame, and another arrives in the next.
      if (frame % 2 == 0) {
        world.remove(last);
      } else {
        last = world.insert(drift.boxes[random.below(keys.size())]);
      }
      ASSERT_TRUE(world.agrees(buffer)) << "budget " << budget << ", frame " << frame;
      ASSERT_TRUE(world.holds_its_objects()) << "budget " << budget << ", frame " << frame;
    }
  }
}

TEST_P(PlannedBuilds, plan_is_dropped_if_all_rows_change) {
  Drift drift(uniform_boxes(count()), 0.02F);
  World world(config_with(1));
  std::vector<Key> keys = world.insert(drift.boxes);
  PairBuffer buffer;
  for (int frame = 0; frame < kFrames; ++frame) {
    drift.go_on();
    world.update(keys, drift.boxes);
    if (frame % 23 == 11) {
      world.remove(std::span<const Key>(keys).first(keys.size() / 2));
      const std::vector<Key> fresh =
          world.insert(std::span<const Aabb>(drift.boxes).first(keys.size() / 2));
      std::copy(fresh.begin(), fresh.end(), keys.begin());
    }
    if (frame % 23 == 17) world.partition().release_memory();
    if (frame == 60) world.set_filter(keys[0], {.environment = 3});
    ASSERT_TRUE(world.agrees(buffer)) << "frame " << frame;
  }
}

TEST_P(PlannedBuilds, pair_order_is_equal_on_one_thread) {
  Drift drift(clustered_boxes(count()), 0.02F);
  World world(config_with(0));
  Config one_thread = config_with(0);
  one_thread.threads = 1;
  World reference(one_thread);
  const std::vector<Key> keys = world.insert(drift.boxes);
  const std::vector<Key> reference_keys = reference.insert(drift.boxes);
  PairBuffer buffer;
  PairBuffer reference_buffer;
  for (int frame = 0; frame < kFrames; ++frame) {
    drift.go_on();
    world.update(keys, drift.boxes);
    reference.update(reference_keys, drift.boxes);
    ASSERT_EQ(world.self_pairs(buffer), Status::ok);
    ASSERT_EQ(reference.self_pairs(reference_buffer), Status::ok);
    ASSERT_TRUE(std::ranges::equal(buffer.pairs(), reference_buffer.pairs())) << "frame " << frame;
  }
}

TEST_P(PlannedBuilds, refused_memory_during_a_plan_is_recoverable) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  Drift drift(mixed_boxes(count()), 0.05F);
  World world(config_with(1), &memory);
  const std::vector<Key> keys = world.insert(drift.boxes);
  PairBuffer buffer;
  for (int frame = 0; frame < kFrames; ++frame) {
    drift.go_on();
    world.update(keys, drift.boxes);
    memory.refuse_after(static_cast<std::size_t>(frame % 3));
    const Status status = world.threads().run([&] { return world.partition().refresh(); });
    memory.grant_all();
    ASSERT_TRUE(status == Status::ok || status == Status::out_of_memory);
    EXPECT_EQ(world.partition().footprint().total().reserved, memory.outstanding());
    ASSERT_TRUE(world.agrees(buffer)) << "frame " << frame;
    if (frame % 10 == 9) world.partition().release_memory();
  }
}

INSTANTIATE_TEST_SUITE_P(All, PlannedBuilds, testing::ValuesIn(exact_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
