// Trees beyond the conformance suite: the quality of their orders, counted in tests of 16 boxes,
// and the limits of looseness and levels.

#include <winnow/core/eigen.h>
#include <winnow/partitions/partition.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tests/support/hosts.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"
#include "tests/support/reference.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

std::vector<Key> fill(Partition& partition, const std::vector<Aabb>& boxes) {
  std::vector<Key> keys(boxes.size());
  EXPECT_EQ(partition.insert(BoxView(std::span(boxes)), {}, keys), Status::ok);
  return keys;
}

std::uint64_t tests_of_pairs(Partition& partition) {
  PairBuffer pairs;
  EXPECT_EQ(partition.self_pairs(pairs, {.incremental = false}), Status::ok);
  return partition.statistics().last_tests;
}

std::uint64_t tests_of_pairs(const std::string& name, const std::vector<Aabb>& boxes) {
  Partition partition(structure_named(name), {.execution = Execution::serial()});
  fill(partition, boxes);
  return tests_of_pairs(partition);
}

// Expects the pairs of brute force.
void expect_right_pairs(const Partition& partition, const std::vector<Aabb>& boxes) {
  Partition judge(bounds_n_squared());
  fill(judge, boxes);
  PairBuffer expected;
  PairBuffer found;
  ASSERT_EQ(judge.self_pairs(expected, {.order = Order::canonical}), Status::ok);
  ASSERT_EQ(partition.self_pairs(found, {.order = Order::canonical}), Status::ok);
  EXPECT_TRUE(std::ranges::equal(found.pairs(), expected.pairs()));
}

// Returns boxes in one plane.
std::vector<Aabb> flat_boxes(std::size_t count) {
  std::vector<Aabb> boxes = uniform_boxes(count);
  const float spread = 3.0F;
  for (Aabb& box : boxes) {
    box.min.x() *= spread;
    box.max.x() = box.min.x() + 1.0F;
    box.min.z() = 0.0F;
    box.max.z() = 1.0F;
  }
  return boxes;
}

// Returns boxes of which a third rest on one floor.
std::vector<Aabb> floor_boxes(std::size_t count) {
  std::vector<Aabb> boxes = uniform_boxes(count);
  for (std::size_t i = 0; i < boxes.size(); i += 3) {
    boxes[i].max.z() -= boxes[i].min.z();
    boxes[i].min.z() = 0.0F;
  }
  return boxes;
}

TEST(LinearBvhOrder, order_needs_hardly_more_tests_than_static_order) {
  for (const std::size_t objects : {1000U, 5000U, 20000U}) {
    for (const auto& boxes :
         {uniform_boxes(objects), clustered_boxes(objects), mixed_boxes(objects),
          pile_boxes(objects), flat_boxes(objects), floor_boxes(objects), outlier_boxes(objects),
          two_scale_boxes(objects)}) {
      EXPECT_LE(4 * tests_of_pairs("LinearBvh", boxes), 5 * tests_of_pairs("StaticBvh", boxes));
    }
  }
}

// Moves every object to the position of the object `by` indices later.
std::vector<Aabb> passed_on(const std::vector<Aabb>& boxes, std::size_t by) {
  std::vector<Aabb> next = boxes;
  std::rotate(next.begin(), next.begin() + static_cast<std::ptrdiff_t>(by), next.end());
  return next;
}

// After all objects have exchanged positions, the order is split by cells, if cells separate the
// objects.
TEST(LinearBvhOrder, torn_order_is_right_and_independent_of_threads) {
  constexpr std::size_t kObjects = 18000;  // more than fit into one set of tiles
  const std::vector<Aabb> one_place(kObjects / 40, Aabb{{1, 2, 3}, {2, 3, 4}});
  std::vector<Aabb> line = uniform_boxes(kObjects);
  for (Aabb& box : line) box = {{box.min.x() * 30.0F, 0, 0}, {box.min.x() * 30.0F + 1.0F, 1, 1}};
  std::vector<Aabb> heap = uniform_boxes(kObjects - one_place.size());
  heap.insert(heap.end(), one_place.begin(), one_place.end());
  for (const auto& boxes : {uniform_boxes(kObjects), clustered_boxes(kObjects),
                            flat_boxes(kObjects), outlier_boxes(kObjects), line, heap}) {
    Partition serial(linear_bvh(), {.execution = Execution::serial()});
    Partition parallel(linear_bvh(), {.execution = Execution::on(jobs_of(kHosts.front(), 4))});
    const std::vector<Key> serial_keys = fill(serial, boxes);
    const std::vector<Key> parallel_keys = fill(parallel, boxes);
    PairBuffer of_serial;
    PairBuffer of_parallel;
    std::vector<Aabb> now = boxes;
    for (int frame = 0; frame < 5; ++frame) {
      ASSERT_EQ(serial.self_pairs(of_serial), Status::ok);
      ASSERT_EQ(parallel.self_pairs(of_parallel), Status::ok);
      EXPECT_TRUE(std::ranges::equal(of_serial.pairs(), of_parallel.pairs()));
      now = passed_on(now, 7777);
      ASSERT_EQ(serial.update(serial_keys, BoxView(std::span(now))), Status::ok);
      ASSERT_EQ(parallel.update(parallel_keys, BoxView(std::span(now))), Status::ok);
    }
    expect_right_pairs(serial, now);
  }
}

// Returns uniform boxes, but every `every`-th is tiny and near the origin.
std::vector<Aabb> boxes_and_dust(std::size_t count, std::size_t every) {
  std::vector<Aabb> boxes = uniform_boxes(count);
  for (std::size_t i = every / 2; i < count; i += every) {
    boxes[i].min *= 1e-4F;
    boxes[i].max *= 1e-4F;
  }
  return boxes;
}

// Large and tiny boxes alternate: samples of the rows must contain both.
TEST(LinearBvhOrder, alternating_object_sizes_cost_no_more_tests) {
  const auto tests_of_torn = [](const std::vector<Aabb>& boxes) {
    Partition partition(linear_bvh(), {.execution = Execution::serial()});
    const std::vector<Key> keys = fill(partition, boxes);
    std::uint64_t most = 0;
    for (std::size_t frame = 1; frame < 4; ++frame) {
      most = std::max(most, tests_of_pairs(partition));
      // Tiny boxes change places only with tiny boxes.
      const std::vector<Aabb> moved = passed_on(boxes, 168 * frame);
      EXPECT_EQ(partition.update(keys, BoxView(std::span(moved))), Status::ok);
    }
    return std::max(most, tests_of_pairs(partition));
  };
  Random random(4);
  for (const std::size_t objects : {1000U, 5000U, 10000U, 20000U, 70000U}) {
    for (const std::size_t every : {2U, 3U, 4U, 7U, 8U}) {
      std::vector<Aabb> boxes = boxes_and_dust(objects, every);
      const std::uint64_t by_turns = tests_of_torn(boxes);
      for (std::size_t i = boxes.size(); i > 1; --i)
        std::swap(boxes[i - 1], boxes[random.below(i)]);
      EXPECT_LE(4 * by_turns, 5 * tests_of_torn(boxes)) << objects << ", " << every;
    }
  }
}

// A step that is long for a tiny box may be short for a large one.
TEST(TreeOrder, order_survives_small_moves_of_large_objects) {
  for (const StructureKind& kind : {linear_bvh(), static_bvh()}) {
    Partition partition(kind);
    std::vector<Aabb> boxes = boxes_and_dust(4000, 2);
    const std::vector<Key> keys = fill(partition, boxes);
    Random random(5);
    PairBuffer pairs;
    for (int frame = 0; frame < 8; ++frame) {
      ASSERT_EQ(partition.self_pairs(pairs), Status::ok);
      for (Aabb& box : boxes) {
        const float step =
            0.02F * static_cast<float>(random.uniform(-1, 1)) * (box.max.x() - box.min.x());
        box.min.x() += step;
        box.max.x() += step;
      }
      ASSERT_EQ(partition.update(keys, BoxView(std::span(boxes))), Status::ok);
    }
    ASSERT_EQ(partition.self_pairs(pairs), Status::ok);
    EXPECT_EQ(partition.statistics().builds, 1U) << kind.name();
    expect_right_pairs(partition, boxes);
  }
}

TEST(StaticBvhOrder, static_order_needs_no_more_tests_than_linear) {
  constexpr std::size_t kObjects = 20000;
  for (const auto& boxes : {uniform_boxes(kObjects), clustered_boxes(kObjects),
                            mixed_boxes(kObjects), pile_boxes(kObjects), flat_boxes(kObjects)}) {
    EXPECT_LE(tests_of_pairs("StaticBvh", boxes), tests_of_pairs("LinearBvh", boxes));
  }
}

TEST(StaticBvhOrder, static_order_leaves_no_empty_places) {
  Partition tree(static_bvh());
  fill(tree, mixed_boxes(5003));
  ASSERT_EQ(tree.refresh(), Status::ok);
  EXPECT_EQ(tree.statistics().cells, (5003U + 15U) / 16U);
}

TEST(LooseOctreeLevels, quadtree_needs_no_more_tests_in_flat_worlds) {
  const std::vector<Aabb> boxes = flat_boxes(20000);
  EXPECT_LE(tests_of_pairs("LooseQuadtree", boxes), tests_of_pairs("LooseOctree", boxes));
}

TEST(LooseOctreeLevels, levels_are_bounded_for_any_sizes) {
  std::vector<Aabb> boxes = uniform_boxes(600);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const float edge = std::pow(10.0F, -9.0F + 12.0F * static_cast<float>(i) / 600.0F);
    boxes[i].max = as_eigen(boxes[i].min).array() + edge;
  }
  Partition tree(loose_octree());
  fill(tree, boxes);
  expect_right_pairs(tree, boxes);
  EXPECT_GT(tree.statistics().levels, 1U);
  EXPECT_LE(tree.statistics().levels, 10U);
  EXPECT_GT(tree.statistics().cells, 1U);
}

TEST(LooseFactor, any_loose_factor_gives_the_same_pairs) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<Aabb> boxes = mixed_boxes(800);
  for (const float loose : {-kInfinity, 0.0F, 1.0F, 1.5F, 2.0F, 100.0F, kInfinity,
                            std::numeric_limits<float>::quiet_NaN()}) {
    SCOPED_TRACE(loose);
    Partition octree(loose_octree(loose));
    fill(octree, boxes);
    expect_right_pairs(octree, boxes);
    Partition quadtree(loose_quadtree(loose));
    fill(quadtree, boxes);
    expect_right_pairs(quadtree, boxes);
  }
}

TEST(LooseFactor, move_by_half_the_size_keeps_the_node) {
  std::vector<Aabb> boxes = mixed_boxes(4000);
  Partition tree(loose_octree());
  const std::vector<Key> keys = fill(tree, boxes);
  ASSERT_EQ(tree.refresh(), Status::ok);
  const Statistics before = tree.statistics();
  for (Aabb& box : boxes) {
    // A step of 0.6 edges is shorter than the looseness of the node, whose cell is at least as
    // large as the box.
    const float step = 0.6F * (box.max.x() - box.min.x());
    as_eigen(box.min).array() += step;
    as_eigen(box.max).array() += step;
  }
  ASSERT_EQ(tree.update(keys, BoxView(std::span(boxes))), Status::ok);
  ASSERT_EQ(tree.refresh(), Status::ok);
  EXPECT_EQ(tree.statistics().builds, before.builds);
  EXPECT_EQ(tree.statistics().irregular, before.irregular);
  expect_right_pairs(tree, boxes);
}

}  // namespace
}  // namespace winnow::test
