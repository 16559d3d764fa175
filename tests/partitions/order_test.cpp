// The order of results: identical bytes on any number of threads and any instruction set.

#include <algorithm>
#include <optional>

#include "tests/support/hostile_scenes.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

using Frames = std::vector<std::vector<Pair>>;

// Runs a fixed history of inserts, moves, removals and queries; returns the results of every query.
Frames play(const Config& config, Order order) {
  const IsaScope isa(config.isa);
  World world(config);
  Random random(5);
  std::vector<Aabb> boxes = mixed_boxes(1500);
  std::vector<Key> keys = world.insert(boxes);
  PairBuffer buffer;
  Frames frames;
  for (int frame = 0; frame < 10; ++frame) {
    const Motion motion = kMotions[static_cast<std::size_t>(frame) % kMotions.size()];
    std::vector<Key> moved_keys;
    std::vector<Aabb> moved_boxes;
    for (const std::size_t i : move(motion, boxes, random)) {
      moved_keys.push_back(keys[i]);
      moved_boxes.push_back(boxes[i]);
    }
    world.update(moved_keys, moved_boxes);
    for (int n = 0; n < frame % 4; ++n) {
      const std::size_t i = random.below(keys.size());
      world.remove(keys[i]);
      keys[i] = world.insert(boxes[i]);
    }
    EXPECT_EQ(world.self_pairs(buffer, {.order = order, .incremental = frame != 7}), Status::ok);
    frames.emplace_back(buffer.begin(), buffer.end());
  }
  return frames;
}

class ResultOrder : public testing::TestWithParam<std::string> {
 protected:
  void expect_one_result_on_every_config(Order order) {
    std::optional<Frames> first;
    for (const Config& config : all_configs()) {
      if (config.partition != GetParam()) continue;
      const Frames frames = play(config, order);
      if (!first) {
        first = frames;
        continue;
      }
      for (std::size_t i = 0; i < frames.size(); ++i) {
        ASSERT_TRUE(frames[i] == (*first)[i]) << to_string(config) << ", frame " << i;
      }
    }
  }
};

TEST_P(ResultOrder, fast_order_is_equal_in_every_config) {
  expect_one_result_on_every_config(Order::fast);
}

TEST_P(ResultOrder, canonical_order_is_equal_in_every_config) {
  expect_one_result_on_every_config(Order::canonical);
}

TEST_P(ResultOrder, pairs_with_order_is_equal_in_every_config) {
  std::vector<Pair> first;
  for (const Config& config : all_configs()) {
    if (config.partition != GetParam()) continue;
    const IsaScope isa(config.isa);
    World a(config);
    World b(config);
    a.insert(mixed_boxes(700));
    b.insert(mixed_boxes(500, 2));
    PairBuffer buffer;
    ASSERT_EQ(a.pairs_with(b.partition(), buffer), Status::ok);
    ASSERT_FALSE(buffer.empty());
    if (first.empty()) first.assign(buffer.begin(), buffer.end());
    EXPECT_TRUE(std::ranges::equal(buffer, first)) << to_string(config);
  }
}

std::vector<std::string> names() {
  const std::vector<std::string_view> all = structure_names();
  return {all.begin(), all.end()};
}

INSTANTIATE_TEST_SUITE_P(All, ResultOrder, testing::ValuesIn(names()),
                         [](const auto& name) { return name.param; });

// All exact partitions return identical bytes in canonical order.
TEST(CanonicalOrder, canonical_order_is_identical_for_exact_partitions) {
  for (const std::vector<Scene>* scenes : {&random_scenes(), &infinite_scenes()}) {
    for (const Scene& scene : *scenes) {
      for (const std::string& name : names()) {
        World world({name, active_isa(), 2});
        if (!world.partition().is_exact()) continue;
        world.insert(scene.boxes);
        PairBuffer buffer;
        ASSERT_EQ(world.self_pairs(buffer, {.order = Order::canonical}), Status::ok);
        EXPECT_TRUE(std::ranges::equal(buffer, scene.pairs)) << name << " on " << scene.name;
      }
    }
  }
}

}  // namespace
}  // namespace winnow::test
