// How much work a query does, counted in tests of 16 boxes and not in time, so that it repeats
// exactly: hostile scenes must not cost much more than their number of pairs demands, and objects
// that stay where they are must not cost what moving ones do.

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
  // At most 32 tests an object and one a pair. Brute force needs 625 an object at this size, kind
  // scenes about five.
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

TEST_P(BoundedWork, holds_on_uniform_boxes) {
  expect_bounded(uniform_boxes(kObjects));
}
TEST_P(BoundedWork, holds_on_few_dense_clusters) {
  expect_bounded(clustered_boxes(kObjects));
}
TEST_P(BoundedWork, holds_on_mixed_sizes) {
  expect_bounded(mixed_boxes(kObjects));
}
TEST_P(BoundedWork, holds_where_all_overlap_on_x) {
  expect_bounded(wall_boxes(kObjects, 0));
}
TEST_P(BoundedWork, holds_where_all_overlap_on_y) {
  expect_bounded(wall_boxes(kObjects, 1));
}
TEST_P(BoundedWork, holds_where_all_overlap_on_z) {
  expect_bounded(wall_boxes(kObjects, 2));
}
TEST_P(BoundedWork, holds_with_one_far_outlier) {
  expect_bounded(outlier_boxes(kObjects));
}
TEST_P(BoundedWork, holds_on_two_scales) {
  expect_bounded(two_scale_boxes(kObjects));
}
TEST_P(BoundedWork, holds_on_exponential_sizes) {
  expect_bounded(exponential_boxes(kObjects));
}

TEST_P(BoundedWork, holds_with_infinite_boxes_among_ordinary_ones) {
  std::vector<Aabb> boxes = uniform_boxes(kObjects);
  constexpr float inf = std::numeric_limits<float>::infinity();
  for (int i = 0; i < 8; ++i) {
    const float z = static_cast<float>(i);
    boxes[static_cast<std::size_t>(i) * 1000] = {{-inf, -inf, z}, {inf, inf, z}};
  }
  expect_bounded(boxes);
}

// Points on few places: what overlaps must be reported, and no more than that be tested.
TEST_P(BoundedWork, holds_where_objects_lie_on_each_other) {
  std::vector<Aabb> boxes = uniform_boxes(kObjects);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    boxes[i] = boxes[i / 20 * 20];
    boxes[i].max = boxes[i].min;
  }
  expect_bounded(boxes);
}

// A structure made for where objects were must not be asked about where they are.
TEST_P(BoundedWork, holds_in_the_frame_in_which_everything_jumps) {
  World world(config());
  const std::vector<Key> keys = world.insert(uniform_boxes(kObjects));
  PairBuffer buffer;
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  const std::vector<Aabb> boxes = clustered_boxes(kObjects);
  world.update(keys, boxes);
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  EXPECT_LE(world.partition().statistics().last_tests, 32 * boxes.size() + buffer.size());
}

TEST_P(Work, is_none_in_a_frame_in_which_nothing_moves) {
  World world(config());
  world.insert(uniform_boxes(2000));
  PairBuffer buffer;
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  EXPECT_EQ(world.partition().statistics().last_tests, 0U);
}

TEST_P(Work, is_less_than_half_in_a_frame_in_which_one_in_twenty_moves) {
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

// Counters, never timings: one instruction set and one thread say what all do.
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
