// Overlaps with regions and boxes, compared with brute force.

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/queries/questions.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

Status query_overlap(World& world, const Region& region, OverlapBuffer& buffer,
                     Order order = Order::fast, const Filter& filter = {}) {
  return world.threads().run(
      [&] { return world.partition().overlap(region, buffer, filter, order); });
}

std::vector<Pair> boxes_against(World& world, const std::vector<Aabb>& boxes, PairBuffer& buffer,
                                Order order, const Filter& filter = {}) {
  EXPECT_EQ(world.threads().run(
                [&] { return world.partition().overlap(BoxView(boxes), buffer, filter, order); }),
            Status::ok);
  return {buffer.begin(), buffer.end()};
}

class Overlaps : public Conformance {};

TEST_P(Overlaps, regions_of_every_kind_overlap_exactly) {
  OverlapBuffer buffer;
  for (const QuestionSet& set : question_sets()) {
    World world(config());
    world.insert(set.boxes);
    for (std::size_t i = 0; i < set.regions.size(); ++i) {
      const Order order = i % 2 == 0 ? Order::fast : Order::canonical;
      SCOPED_TRACE(set.name + ", " + to_string(set.regions[i]));
      ASSERT_EQ(query_overlap(world, set.regions[i], buffer, order), Status::ok);
      ASSERT_TRUE(right_objects(buffer, set.region_truths[i], order));
    }
  }
}

TEST_P(Overlaps, overlaps_of_changing_objects_are_right) {
  World world(config());
  std::vector<Aabb> boxes = mixed_boxes(800);
  std::vector<Key> keys = world.insert(boxes);
  Random random(6);
  OverlapBuffer buffer;
  PairBuffer pairs;
  // Ids depend only on the calls, so all configurations have the same reference.
  static std::vector<RegionCandidates> truths;
  std::size_t question = 0;
  for (int frame = 0; frame < 10; ++frame) {
    SCOPED_TRACE(frame);
    move(kMotions[static_cast<std::size_t>(frame) % kMotions.size()], boxes, random);
    world.update(keys, boxes);
    for (int n = 0; n < 40; ++n) {
      const std::size_t i = random.below(keys.size());
      world.remove(keys[i]);
      keys[i] = world.insert(boxes[i]);
    }
    const std::vector<Object> objects = world.objects();
    std::deque<std::vector<Plane>> planes;
    for (const Region& region : some_regions(boxes, 14, random, planes)) {
      SCOPED_TRACE(to_string(region));
      ASSERT_EQ(query_overlap(world, region, buffer, Order::canonical), Status::ok);
      if (question == truths.size()) truths.push_back(candidates(region, objects));
      ASSERT_TRUE(right_objects(buffer, truths[question++], Order::canonical));
    }
    const std::vector<Aabb> query_boxes(boxes.begin() + 100, boxes.begin() + 150);
    ASSERT_EQ(boxes_against(world, query_boxes, pairs, Order::canonical),
              cross_pairs(numbered(query_boxes), objects));
  }
}

TEST(OverlapBuffers, moved_from_buffer_is_empty) {
  Partition partition(linear_bvh());
  std::vector<Key> keys(50);
  ASSERT_EQ(partition.insert(uniform_boxes(50), {}, keys), Status::ok);
  OverlapBuffer from;
  ASSERT_EQ(partition.overlap(Sphere{{0, 0, 0}, 1e6F}, from), Status::ok);
  ASSERT_EQ(from.inside().size(), 50U);
  const OverlapBuffer to(std::move(from));
  EXPECT_EQ(to.inside().size(), 50U);
  EXPECT_TRUE(from.ids().empty());
  EXPECT_TRUE(from.inside().empty());
  EXPECT_TRUE(from.crossing().empty());
}

TEST_P(Overlaps, boxes_give_exact_pairs) {
  PairBuffer buffer;
  for (const QuestionSet& set : question_sets()) {
    SCOPED_TRACE(set.name);
    World world(config());
    world.insert(set.boxes);
    std::vector<Aabb> query_boxes;
    for (std::size_t i = 0; i < set.boxes.size(); i += 1 + set.boxes.size() / 40) {
      query_boxes.push_back(set.boxes[i]);
      query_boxes.push_back({set.boxes[i].min, set.boxes[i].min.max(set.boxes[0].max)});
    }
    std::erase_if(query_boxes, [](const Aabb& box) { return !box.is_valid(); });
    const std::vector<Pair> truth = cross_pairs(numbered(query_boxes), set.objects);
    ASSERT_EQ(boxes_against(world, query_boxes, buffer, Order::canonical), truth);
    std::vector<Pair> fast = boxes_against(world, query_boxes, buffer, Order::fast);
    std::sort(fast.begin(), fast.end());
    ASSERT_EQ(fast, truth);
  }
}

TEST_P(Overlaps, empty_box_list_has_no_pairs) {
  World world(config());
  world.insert(uniform_boxes(100));
  PairBuffer buffer;
  EXPECT_TRUE(boxes_against(world, {}, buffer, Order::fast).empty());
}

TEST_P(Overlaps, whole_space_contains_every_object) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  World world(config());
  world.insert(mixed_boxes(500));
  OverlapBuffer buffer;
  ASSERT_EQ(query_overlap(world, std::span<const Plane>{}, buffer), Status::ok);
  EXPECT_EQ(buffer.inside().size(), 500U);
  EXPECT_EQ(buffer.size(), 500U);
  ASSERT_EQ(
      query_overlap(world, Aabb{Eigen::Vector3f::Constant(-inf), Eigen::Vector3f::Constant(inf)},
                    buffer),
      Status::ok);
  EXPECT_EQ(buffer.inside().size(), 500U);
}

TEST_P(Overlaps, predicate_selects_the_overlaps) {
  World world(config());
  std::vector<ClientData> data;
  for (std::size_t i = 0; i < 700; ++i) data.push_back(i);
  const std::vector<Aabb> boxes = mixed_boxes(700);
  world.insert(boxes, data);
  Filter filter;
  filter.predicate.accept = [](void*, Key key, ClientData value) {
    return key.id == value && value % 3 == 0;
  };
  const auto refused = [](ObjectId id) { return id % 3 != 0; };
  Random random(7);
  std::deque<std::vector<Plane>> planes;
  OverlapBuffer buffer;
  for (const Region& region : some_regions(boxes, 56, random, planes)) {
    SCOPED_TRACE(to_string(region));
    ASSERT_EQ(query_overlap(world, region, buffer, Order::canonical), Status::ok);
    std::vector<ObjectId> inside(buffer.inside().begin(), buffer.inside().end());
    std::vector<ObjectId> crossing(buffer.crossing().begin(), buffer.crossing().end());
    std::erase_if(inside, refused);
    std::erase_if(crossing, refused);
    ASSERT_EQ(query_overlap(world, region, buffer, Order::canonical, filter), Status::ok);
    ASSERT_TRUE(std::ranges::equal(buffer.inside(), inside));
    ASSERT_TRUE(std::ranges::equal(buffer.crossing(), crossing));
  }
  PairBuffer pairs;
  std::vector<Pair> expected = boxes_against(world, boxes, pairs, Order::canonical);
  std::erase_if(expected, [](const Pair& pair) { return pair.second % 3 != 0; });
  EXPECT_EQ(boxes_against(world, boxes, pairs, Order::canonical, filter), expected);
}

// A buffer with pairs of boxes must not count as a result of `self_pairs`.
TEST_P(Overlaps, buffer_of_box_pairs_is_no_earlier_frame) {
  World world(config());
  const std::vector<Aabb> boxes = uniform_boxes(400);
  const std::vector<Key> keys = world.insert(boxes);
  PairBuffer buffer;
  ASSERT_TRUE(world.agrees(buffer));
  boxes_against(world, {boxes[0], boxes[1]}, buffer, Order::fast);
  world.update(keys[0], boxes[5]);
  ASSERT_TRUE(world.agrees(buffer));
}

INSTANTIATE_TEST_SUITE_P(All, Overlaps, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

// In canonical order all partitions return identical results. In fast order the results of one
// structure are identical on every instruction set and number of threads.
TEST(OverlapResults, overlaps_are_identical_in_every_config) {
  for (const QuestionSet& set : question_sets()) {
    for (const Order order : {Order::fast, Order::canonical}) {
      std::vector<std::vector<ObjectId>> expected;
      std::string partition;
      for (const Config& config : all_configs()) {
        if (config.threads == 8) continue;
        if (order == Order::fast && config.partition != partition) expected.clear();
        partition = config.partition;
        const IsaScope isa(config.isa);
        World world(config);
        world.insert(set.boxes);
        OverlapBuffer buffer;
        for (std::size_t i = 0; i < set.regions.size(); ++i) {
          ASSERT_EQ(query_overlap(world, set.regions[i], buffer, order), Status::ok);
          std::vector<ObjectId> found(buffer.ids().begin(), buffer.ids().end());
          found.push_back(static_cast<ObjectId>(buffer.inside().size()));
          if (i == expected.size()) expected.push_back(found);
          ASSERT_TRUE(found == expected[i])
              << to_string(config) << " on " << set.name << ", " << to_string(set.regions[i]);
        }
      }
    }
  }
}

}  // namespace
}  // namespace winnow::test
