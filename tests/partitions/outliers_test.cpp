// Objects that jump away from the other objects of their tree block, or out of their cells.

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "tests/support/motion.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

// Moves a share of the boxes to positions of other boxes.
std::vector<std::size_t> jump(std::vector<Aabb>& boxes, double share, Random& random) {
  std::vector<std::size_t> jumped;
  const std::vector<Aabb> before = boxes;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (random.uniform(0.0, 1.0) >= share) continue;
    const Vec3f extent = boxes[i].max - boxes[i].min;
    boxes[i].min = before[random.below(boxes.size())].min;
    boxes[i].max = boxes[i].min + extent;
    jumped.push_back(i);
  }
  return jumped;
}

TEST(Outliers, outlier_costs_its_block_no_tests) {
  std::vector<Aabb> boxes = uniform_boxes(8000);
  Partition partition(linear_bvh());
  std::vector<Key> keys(boxes.size());
  ASSERT_EQ(partition.insert(boxes, {}, keys), Status::ok);
  PairBuffer buffer;
  const PairOptions anew{.incremental = false};
  ASSERT_EQ(partition.self_pairs(buffer, anew), Status::ok);
  const std::uint64_t fresh = partition.statistics().last_tests;
  Random random(3);
  for (int frame = 0; frame < 12; ++frame) {
    (void)jump(boxes, 0.01, random);
    ASSERT_EQ(partition.update(keys, boxes), Status::ok);
    ASSERT_EQ(partition.self_pairs(buffer, anew), Status::ok);
    EXPECT_LT(partition.statistics().last_tests, 3 * fresh) << frame;
  }
  EXPECT_LT(partition.statistics().builds, 6U);
}

// Blocks of large objects are wide although no object has jumped. After the objects have become
// small, objects that jump must be found again.
TEST(Outliers, outliers_are_found_after_blocks_were_wide) {
  constexpr std::size_t kObjects = 8000;
  constexpr std::size_t kLarge = 200;
  const std::vector<Aabb> small = uniform_boxes(kObjects);
  const auto largest = std::ranges::max(small, {}, [](const Aabb& box) { return box.max[0]; });
  std::vector<Aabb> boxes = small;
  for (std::size_t i = 0; i < kLarge; ++i) {
    boxes[i].max += Vec3f::constant(0.5F * largest.max[0]);
  }
  Partition partition(linear_bvh());
  std::vector<Key> keys(kObjects);
  PairBuffer buffer;
  const PairOptions anew{.incremental = false};
  const auto tests = [&](const std::vector<Aabb>& now) {
    EXPECT_EQ(partition.update(keys, now), Status::ok);
    EXPECT_EQ(partition.self_pairs(buffer, anew), Status::ok);
    return partition.statistics().last_tests;
  };
  ASSERT_EQ(partition.insert(boxes, {}, keys), Status::ok);
  ASSERT_EQ(partition.self_pairs(buffer, anew), Status::ok);
  const std::uint64_t builds = partition.statistics().builds;
  boxes = small;
  const std::uint64_t fresh = tests(boxes);
  Random random(7);
  for (int frame = 0; frame < 3; ++frame) {
    (void)jump(boxes, 0.002, random);
    const std::uint64_t now = tests(boxes);
    EXPECT_LT(now, fresh + fresh / 3) << frame;
  }
  EXPECT_EQ(partition.statistics().builds, builds);
}

class OutlierObjects : public Conformance {};

TEST_P(OutlierObjects, outliers_miss_no_pair) {
  for (const double share : {0.002, 0.02, 0.2}) {
    std::vector<Aabb> boxes = mixed_boxes(scaled(900));
    boxes[3].max = Vec3f::constant(std::numeric_limits<float>::infinity());
    World world(config());
    const std::vector<Key> keys = world.insert(boxes);
    PairBuffer buffer;
    Random random(9);
    for (int frame = 0; frame < 12; ++frame) {
      const std::vector<std::size_t> jumped = jump(boxes, share, random);
      if (frame % 2 == 0) {
        world.update(keys, boxes);
      } else {
        for (const std::size_t i : jumped) world.update(keys[i], boxes[i]);
      }
      ASSERT_TRUE(world.agrees(buffer)) << "share " << share << ", frame " << frame;
      ASSERT_TRUE(world.holds_its_objects()) << "share " << share << ", frame " << frame;
    }
  }
}

std::vector<Config> grids() {
  std::vector<Config> configs = exact_configs();
  std::erase_if(configs, [](const Config& config) { return !config.partition.ends_with("Grid"); });
  return configs;
}

class Leavers : public Conformance {};

// With this many cells a task reads several lines of cells, and objects may have left any of them.
TEST_P(Leavers, objects_that_leave_cells_miss_no_pair) {
  World world(config());
  std::vector<Aabb> boxes = uniform_boxes(12000);
  const std::vector<Key> keys = world.insert(boxes);
  PairBuffer buffer;
  ASSERT_TRUE(world.agrees(buffer));
  Random random(10);
  for (int frame = 0; frame < 3; ++frame) {
    move(Motion::little, boxes, random);
    (void)jump(boxes, 0.02, random);
    world.update(keys, boxes);
    ASSERT_TRUE(world.agrees(buffer)) << frame;
  }
}

class Newcomers : public Conformance {};

// The tail (see rows.h) grows and shrinks by a few blocks, is sorted, and its objects are moved
// into the order, with and without filters.
TEST_P(Newcomers, newcomers_miss_no_pair) {
  for (const bool filtered : {false, true}) {
    World world(config());
    const std::vector<Aabb> places = uniform_boxes(scaled(900));
    std::vector<Key> keys = world.insert(places);
    PairBuffer buffer;
    Random random(12);
    ASSERT_TRUE(world.agrees(buffer));
    for (int frame = 0; frame < 50; ++frame) {
      const std::size_t come = random.below(frame % 10 == 9 ? 60 : 12);
      for (std::size_t i = 0; i < come; ++i) {
        keys.push_back(world.insert(places[random.below(places.size())]));
        if (filtered && i % 3 == 0) world.set_filter(keys.back(), {2, ~std::uint32_t{2}});
      }
      if (frame % 3 == 0) {
        ASSERT_EQ(world.partition().refresh(), Status::ok);
      }
      for (std::size_t i = random.below(8); i > 0 && !keys.empty(); --i) {
        std::swap(keys[random.below(keys.size())], keys.back());
        world.remove(keys.back());
        keys.pop_back();
      }
      for (std::size_t i = random.below(6); i > 0 && !keys.empty(); --i) {
        world.update(keys[random.below(keys.size())], places[random.below(places.size())]);
      }
      ASSERT_TRUE(world.agrees(buffer)) << "frame " << frame << (filtered ? ", filtered" : "");
    }
    ASSERT_TRUE(world.holds_its_objects());
  }
}

INSTANTIATE_TEST_SUITE_P(All, Newcomers, testing::ValuesIn(all_configs()));
INSTANTIATE_TEST_SUITE_P(All, OutlierObjects, testing::ValuesIn(all_configs()));
INSTANTIATE_TEST_SUITE_P(All, Leavers, testing::ValuesIn(grids()));

}  // namespace
}  // namespace winnow::test
