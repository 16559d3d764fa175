// The work of queries, counted in tests of 16 boxes and not in time, so that it repeats exactly:
// hostile scenes must not cost much more than their number of pairs demands, and objects at rest
// must cost less than moving ones.

#include <algorithm>
#include <initializer_list>
#include <limits>

#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

constexpr std::size_t kObjects = 20000;

class Work : public Conformance {};

// Partitions with cells or a tree; the others test every pair by design.
class BoundedWork : public Work {
 protected:
  // Allows 32 tests for each object and one for each pair. Brute force needs 625 for each object at
  // this size, easy scenes about five.
  void expect_bounded(const std::vector<Aabb>& boxes) {
    World world(config());
    world.insert(boxes);
    PairBuffer buffer;
    ASSERT_EQ(world.self_pairs(buffer), Status::ok);
    const Statistics s = world.partition().statistics();
    EXPECT_GT(s.last_tests, 0U);
    EXPECT_LE(s.last_tests, 32 * boxes.size() + buffer.size());
  }
};

TEST_P(BoundedWork, uniform_boxes_need_few_tests) {
  expect_bounded(uniform_boxes(kObjects));
}
TEST_P(BoundedWork, dense_clusters_need_few_tests) {
  expect_bounded(clustered_boxes(kObjects));
}
TEST_P(BoundedWork, mixed_sizes_need_few_tests) {
  expect_bounded(mixed_boxes(kObjects));
}
TEST_P(BoundedWork, boxes_that_overlap_on_x_need_few_tests) {
  expect_bounded(wall_boxes(kObjects, 0));
}
TEST_P(BoundedWork, boxes_that_overlap_on_y_need_few_tests) {
  expect_bounded(wall_boxes(kObjects, 1));
}
TEST_P(BoundedWork, boxes_that_overlap_on_z_need_few_tests) {
  expect_bounded(wall_boxes(kObjects, 2));
}
TEST_P(BoundedWork, one_far_outlier_needs_few_tests) {
  expect_bounded(outlier_boxes(kObjects));
}
TEST_P(BoundedWork, two_scales_need_few_tests) {
  expect_bounded(two_scale_boxes(kObjects));
}
TEST_P(BoundedWork, exponential_sizes_need_few_tests) {
  expect_bounded(exponential_boxes(kObjects));
}

TEST_P(BoundedWork, infinite_boxes_need_few_tests) {
  std::vector<Aabb> boxes = uniform_boxes(kObjects);
  constexpr float inf = std::numeric_limits<float>::infinity();
  for (int i = 0; i < 8; ++i) {
    const float z = static_cast<float>(i);
    boxes[static_cast<std::size_t>(i) * 1000] = {{-inf, -inf, z}, {inf, inf, z}};
  }
  expect_bounded(boxes);
}

// Points in groups of 20 at one position.
TEST_P(BoundedWork, coincident_objects_need_few_tests) {
  std::vector<Aabb> boxes = uniform_boxes(kObjects);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    boxes[i] = boxes[i / 20 * 20];
    boxes[i].max = boxes[i].min;
  }
  expect_bounded(boxes);
}

// A structure that was built for the old positions must not be used for the new ones.
TEST_P(BoundedWork, frame_with_all_objects_jumping_needs_few_tests) {
  World world(config());
  const std::vector<Key> keys = world.insert(uniform_boxes(kObjects));
  PairBuffer buffer;
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  const std::vector<Aabb> boxes = clustered_boxes(kObjects);
  world.update(keys, boxes);
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  EXPECT_LE(world.partition().statistics().last_tests, 32 * boxes.size() + buffer.size());
}

TEST_P(Work, frame_without_motion_needs_no_tests) {
  World world(config());
  world.insert(uniform_boxes(2000));
  PairBuffer buffer;
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  EXPECT_EQ(world.partition().statistics().last_tests, 0U);
}

TEST_P(Work, few_movers_need_under_half_the_tests) {
  World world(config());
  std::vector<Aabb> boxes = uniform_boxes(5000);
  const std::vector<Key> keys = world.insert(boxes);
  PairBuffer buffer;
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  Random random(3);
  std::vector<Key> moved_keys;
  std::vector<Aabb> moved_boxes;
  for (const std::size_t i : move(Motion::few, boxes, random)) {
    moved_keys.push_back(keys[i]);
    moved_boxes.push_back(boxes[i]);
  }
  world.update(moved_keys, moved_boxes);
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  const std::uint64_t few = world.partition().statistics().last_tests;
  ASSERT_EQ(world.self_pairs(buffer, {.incremental = false}), Status::ok);
  EXPECT_LT(2 * few, world.partition().statistics().last_tests);
}

// Counters, not timings: the count is equal on every instruction set and number of threads.
std::vector<Config> configs_without(std::initializer_list<std::string_view> names) {
  std::vector<Config> configs;
  for (const std::string_view name : structure_names()) {
    if (std::ranges::find(names, name) != names.end()) continue;
    configs.push_back({std::string(name), active_isa(), 1});
  }
  return configs;
}

INSTANTIATE_TEST_SUITE_P(All, BoundedWork,
                         testing::ValuesIn(configs_without({"NSquared", "BoundsNSquared"})),
                         testing::PrintToStringParamName());
INSTANTIATE_TEST_SUITE_P(All, Work, testing::ValuesIn(configs_without({"NSquared"})),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
