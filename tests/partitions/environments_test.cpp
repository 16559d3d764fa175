// Many small worlds in one partition: they do not collide with each other and cost no more than
// separate partitions.

#include <algorithm>
#include <array>

#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

// Copies of one kind of world at the same place, separated only by their environments.
class Worlds {
 public:
  Worlds(const Config& config, std::size_t worlds, std::size_t objects)
      : together_(config), worlds_(worlds) {
    std::vector<ObjectFilter> filters;
    for (std::size_t w = 0; w < worlds; ++w) {
      for (const Aabb& box : uniform_boxes(objects, 1 + w)) boxes_.push_back(box);
      filters.resize(boxes_.size(), {1, ~0U, environment(w)});
    }
    // Shuffles the order of insertion, as worlds that run at the same time would.
    Random random(7);
    for (std::size_t i = boxes_.size(); i > 1; --i) {
      const std::size_t j = random.below(i);
      std::swap(boxes_[i - 1], boxes_[j]);
      std::swap(filters[i - 1], filters[j]);
    }
    keys_ = together_.insert(boxes_);
    together_.set_filter(keys_, filters);
  }

  [[nodiscard]] static std::uint32_t environment(std::size_t w) {
    return static_cast<std::uint32_t>(w * 1000003U);
  }
  [[nodiscard]] World& together() { return together_; }
  [[nodiscard]] std::vector<Aabb>& boxes() { return boxes_; }
  [[nodiscard]] const std::vector<Key>& keys() const { return keys_; }

  // Returns the tests of a full query if each world has its own partition.
  [[nodiscard]] std::uint64_t tests_apart(const Config& config) const {
    std::uint64_t sum = 0;
    for (std::size_t w = 0; w < worlds_; ++w) {
      World apart(config);
      for (const auto& [id, entry] : together_.entries()) {
        if (entry.filter.environment == environment(w)) apart.insert(entry.box);
      }
      PairBuffer buffer;
      EXPECT_EQ(apart.self_pairs(buffer), Status::ok);
      sum += apart.partition().statistics().last_tests;
    }
    return sum;
  }

 private:
  World together_;
  std::size_t worlds_;
  std::vector<Aabb> boxes_;
  std::vector<Key> keys_;
};

class Environments : public Conformance {};

TEST_P(Environments, moving_worlds_never_pair_with_each_other) {
  Worlds worlds(config(), 12, 40);
  World& world = worlds.together();
  PairBuffer buffer;
  Random random(2);
  for (const Motion motion : kMotions) {
    move(motion, worlds.boxes(), random);
    world.update(worlds.keys(), worlds.boxes());
    EXPECT_TRUE(world.agrees(buffer)) << to_string(motion);
    EXPECT_TRUE(world.agrees(buffer, {.order = Order::canonical, .incremental = false}));
  }
}

TEST_P(Environments, objects_that_change_environment_pair_correctly) {
  World world(config());
  PairBuffer buffer;
  Random random(11);
  std::vector<Key> keys;
  for (int frame = 0; frame < 30; ++frame) {
    SCOPED_TRACE(frame);
    for (const Aabb& box : uniform_boxes(20, static_cast<std::uint64_t>(frame) + 1)) {
      keys.push_back(world.insert(box));
      if (frame % 3 != 0) {
        world.set_filter(keys.back(), {1, 1, static_cast<std::uint32_t>(frame) / 3});
      }
    }
    for (int i = 0; i < 8; ++i) {
      const std::uint32_t to =
          random.chance(0.2) ? kAllEnvironments : static_cast<std::uint32_t>(random.below(9));
      world.set_filter(keys[random.below(keys.size())], {1, ~0U, to});
    }
    while (keys.size() > 120) {
      const std::size_t at = random.below(keys.size());
      world.remove(keys[at]);
      keys[at] = keys.back();
      keys.pop_back();
    }
    ASSERT_TRUE(world.agrees(buffer));
  }
}

TEST_P(Environments, object_of_every_environment_pairs_with_all) {
  Worlds worlds(config(), 8, 25);
  World& world = worlds.together();
  const Key ground = world.insert(Aabb{{-100, -100, -100}, {100, 100, 100}});
  world.set_filter(ground, {1, 1, kAllEnvironments});
  PairBuffer buffer;
  ASSERT_TRUE(world.agrees(buffer));
  const auto touches_ground = [&](const Pair& p) {
    return p.first == ground.id || p.second == ground.id;
  };
  EXPECT_EQ(std::ranges::count_if(buffer, touches_ground), 200);
}

INSTANTIATE_TEST_SUITE_P(All, Environments, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

TEST(EnvironmentsOfSpheres, coincident_spheres_pair_only_within_environments) {
  Partition partition(bounds_n_squared(), {.volume = Volume::sphere});
  const std::vector<Sphere> spheres(60, Sphere{{1, 2, 3}, 1.0F});
  std::vector<Key> keys(spheres.size());
  ASSERT_EQ(partition.insert(spheres, {}, keys), Status::ok);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto environment = static_cast<std::uint32_t>(i % 6);
    ASSERT_EQ(partition.set_filter(keys[i], {1, 1, environment}), Status::ok);
  }
  PairBuffer buffer;
  ASSERT_EQ(partition.self_pairs(buffer), Status::ok);
  EXPECT_EQ(buffer.size(), 6U * 45U);
  ASSERT_EQ(partition.remove(std::span<const Key>(keys).first(30)), Status::ok);
  ASSERT_EQ(partition.self_pairs(buffer), Status::ok);
  EXPECT_EQ(buffer.size(), 6U * 10U);
  EXPECT_TRUE(std::ranges::all_of(
      buffer, [](const Pair& pair) { return pair.first % 6 == pair.second % 6; }));
}

// Counts tests of 16 boxes, not time: the count is equal on every instruction set and number of
// threads, so one configuration of each structure suffices.
class EnvironmentWork : public Conformance {
 protected:
  // Allows a twentieth more, for the few nodes that contain the end of one world and the start of
  // the next, and for the levels above all worlds.
  void expect_no_more_than_apart(Worlds& worlds) {
    PairBuffer buffer;
    ASSERT_EQ(worlds.together().self_pairs(buffer, {.incremental = false}), Status::ok);
    const std::uint64_t together = worlds.together().partition().statistics().last_tests;
    Config tree = config();
    // With environments, rows are in a tree whatever the structure is, except for brute force. The
    // reference is therefore a tree for each world.
    if (tree.partition != "NSquared" && tree.partition != "BoundsNSquared") {
      tree.partition = "LinearBvh";
    }
    const std::uint64_t apart = worlds.tests_apart(tree);
    EXPECT_LE(together, apart + apart / 20);
    EXPECT_GT(together, 0U);
  }
};

TEST_P(EnvironmentWork, work_for_many_worlds_is_their_sum) {
  Worlds worlds(config(), 40, 160);
  expect_no_more_than_apart(worlds);
}

TEST_P(EnvironmentWork, work_stays_the_sum_after_environment_changes) {
  Worlds worlds(config(), 30, 128);
  World& world = worlds.together();
  PairBuffer buffer;
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  // Every object moves on to the next world, which makes the whole row order wrong.
  for (std::size_t i = 0; i < worlds.keys().size(); ++i) {
    ObjectFilter filter = world.entries().at(worlds.keys()[i].id).filter;
    filter.environment =
        (filter.environment + Worlds::environment(1 + i % 7)) % Worlds::environment(30);
    world.set_filter(worlds.keys()[i], filter);
  }
  expect_no_more_than_apart(worlds);
}

TEST_P(EnvironmentWork, work_for_tiny_worlds_is_not_quadratic) {
  constexpr std::size_t kWorlds = 1500;
  Worlds worlds(config(), kWorlds, 3);
  PairBuffer buffer;
  ASSERT_TRUE(worlds.together().agrees(buffer, {.incremental = false}));
  EXPECT_LT(worlds.together().partition().statistics().last_tests, 40 * kWorlds);
}

std::vector<Config> one_config_a_partition() {
  std::vector<Config> configs;
  for (const std::string_view name : structure_names()) {
    configs.push_back({std::string(name), active_isa(), 1});
  }
  return configs;
}

INSTANTIATE_TEST_SUITE_P(All, EnvironmentWork, testing::ValuesIn(one_config_a_partition()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
