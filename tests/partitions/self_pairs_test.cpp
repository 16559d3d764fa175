// self_pairs against the slow obvious twin on scenes made to break partitions.

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
      // A partition that reports every pair needs no large scenes to be wrong.
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

TEST_P(SelfPairs, are_right_on_random_scenes) {
  expect_right_pairs(random_scenes());
}

TEST_P(SelfPairs, are_right_on_degenerate_scenes) {
  expect_right_pairs(degenerate_scenes());
}

TEST_P(SelfPairs, are_right_with_infinite_boxes) {
  expect_right_pairs(infinite_scenes());
}

TEST_P(SelfPairs, are_right_at_the_ends_of_the_float_range) {
  expect_right_pairs(extreme_float_scenes());
}

TEST_P(SelfPairs, are_right_at_every_block_boundary) {
  expect_right_pairs(block_boundary_scenes());
}

// Sorting, bucketing and tree building must not depend on the order of insertion.
TEST_P(SelfPairs, are_right_for_sorted_and_reversed_input) {
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

TEST_P(SelfPairs, need_no_refresh_and_do_not_mind_one) {
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
