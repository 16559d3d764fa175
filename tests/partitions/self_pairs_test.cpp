// self_pairs compared with brute force, on scenes that are hard for partitions.

#include <algorithm>

#include "tests/support/config.h"
#include "tests/support/hostile_scenes.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

class SelfPairs : public Conformance {
 protected:
  void expect_right_pairs(const std::vector<Scene>& scenes) {
    for (const Scene& scene : scenes) {
      SCOPED_TRACE(scene.name);
      World world(config());
      // A partition that reports every pair is too slow for large scenes.
      if (!world.partition().is_exact() && scene.boxes.size() > 1100) continue;
      world.insert(scene.boxes);
      PairBuffer buffer;
      for (const Order order : {Order::fast, Order::canonical}) {
        ASSERT_EQ(world.self_pairs(buffer, {.order = order}), Status::ok);
        ASSERT_TRUE(right_pairs(buffer.pairs(), scene.pairs, world.partition().is_exact()));
      }
      EXPECT_TRUE(std::is_sorted(buffer.begin(), buffer.end()));
    }
  }
};

TEST_P(SelfPairs, pairs_of_random_scenes_are_right) {
  expect_right_pairs(random_scenes());
}

TEST_P(SelfPairs, pairs_of_degenerate_scenes_are_right) {
  expect_right_pairs(degenerate_scenes());
}

TEST_P(SelfPairs, pairs_of_infinite_boxes_are_right) {
  expect_right_pairs(infinite_scenes());
}

TEST_P(SelfPairs, pairs_at_float_range_ends_are_right) {
  expect_right_pairs(extreme_float_scenes());
}

TEST_P(SelfPairs, pairs_at_every_block_boundary_are_right) {
  expect_right_pairs(block_boundary_scenes());
}

// Sorting, bucketing and tree building must not depend on the order of insertion.
TEST_P(SelfPairs, pairs_of_sorted_and_reversed_input_are_right) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Aabb> boxes = uniform_boxes(600);
    std::sort(boxes.begin(), boxes.end(),
              [axis](const Aabb& a, const Aabb& b) { return a.min[axis] < b.min[axis]; });
    World ascending(config());
    ascending.insert(boxes);
    EXPECT_TRUE(ascending.agrees()) << "axis " << axis;
    std::reverse(boxes.begin(), boxes.end());
    World descending(config());
    descending.insert(boxes);
    EXPECT_TRUE(descending.agrees()) << "axis " << axis;
  }
}

TEST_P(SelfPairs, pairs_after_an_explicit_refresh_are_right) {
  World world(config());
  world.insert(uniform_boxes(500));
  const Status status = world.threads().run([&] { return world.partition().refresh(); });
  ASSERT_EQ(status, Status::ok);
  EXPECT_TRUE(world.agrees());
}

INSTANTIATE_TEST_SUITE_P(All, SelfPairs, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
