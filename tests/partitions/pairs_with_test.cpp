// pairs_with: two partitions of any structures, compared with brute force.

#include <algorithm>

#include "tests/support/hostile_scenes.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

class PairsWith : public Conformance {
 protected:
  testing::AssertionResult agree(World& a, World& b, PairBuffer& buffer,
                                 Order order = Order::fast) {
    if (const Status status = a.pairs_with(b.partition(), buffer, {.order = order});
        status != Status::ok) {
      return testing::AssertionFailure() << "answered " << winnow::to_string(status);
    }
    if (order == Order::canonical && !std::is_sorted(buffer.begin(), buffer.end())) {
      return testing::AssertionFailure() << "canonical order is not sorted";
    }
    return right_cross_pairs(buffer.pairs(), cross_pairs(a.objects(), b.objects()),
                             a.partition().is_exact() && b.partition().is_exact());
  }

  Config like_this(std::string_view partition) {
    return {std::string(partition), config().isa, config().threads};
  }
};

TEST_P(PairsWith, pairs_with_every_other_structure_are_right) {
  World mine(config());
  mine.insert(mixed_boxes(300));
  PairBuffer buffer;
  for (const std::string_view name : structure_names()) {
    World other(like_this(name));
    other.insert(mixed_boxes(200, 2));
    EXPECT_TRUE(agree(mine, other, buffer)) << name;
    EXPECT_TRUE(agree(mine, other, buffer, Order::canonical)) << name;
    EXPECT_TRUE(agree(other, mine, buffer)) << name << " reversed";
  }
}

TEST_P(PairsWith, pairs_with_an_empty_partition_are_none) {
  World mine(config());
  World other(config());
  PairBuffer buffer;
  EXPECT_TRUE(agree(mine, other, buffer));
  mine.insert(uniform_boxes(40));
  EXPECT_TRUE(agree(mine, other, buffer));
  EXPECT_TRUE(agree(other, mine, buffer));
  EXPECT_TRUE(buffer.empty());
}

// The pairs of a partition with itself: every object with itself, and every other pair in both
// orders.
TEST_P(PairsWith, pairs_with_itself_are_all_ordered_pairs) {
  World world(config());
  world.insert(uniform_boxes(300));
  PairBuffer buffer;
  EXPECT_TRUE(agree(world, world, buffer));
  EXPECT_TRUE(std::ranges::find(buffer, Pair{7, 7}) != buffer.end());
}

TEST_P(PairsWith, pairs_of_large_and_small_partition_are_right) {
  World large(config());
  World small(config());
  large.insert(clustered_boxes(900));
  PairBuffer buffer;
  for (int count = 1; count <= 18; ++count) {
    small.insert(large.entries().at(static_cast<ObjectId>(40 * count)).box);
    EXPECT_TRUE(agree(large, small, buffer)) << count;
    EXPECT_TRUE(agree(small, large, buffer)) << count;
  }
}

TEST_P(PairsWith, pairs_with_hostile_scenes_are_right) {
  PairBuffer buffer;
  World crowd(config());
  crowd.insert(uniform_boxes(150));
  for (const std::vector<Scene>* scenes :
       {&degenerate_scenes(), &infinite_scenes(), &extreme_float_scenes()}) {
    for (const Scene& scene : *scenes) {
      SCOPED_TRACE(scene.name);
      World hostile(config());
      hostile.insert(scene.boxes);
      EXPECT_TRUE(agree(hostile, crowd, buffer));
      EXPECT_TRUE(agree(crowd, hostile, buffer));
    }
  }
}

TEST_P(PairsWith, pairs_of_moving_partitions_are_right) {
  World a(config());
  World b(config());
  Random random(3);
  std::vector<Aabb> boxes_a = mixed_boxes(250);
  std::vector<Aabb> boxes_b = mixed_boxes(150, 2);
  std::vector<Key> keys_a = a.insert(boxes_a);
  const std::vector<Key> keys_b = b.insert(boxes_b);
  PairBuffer buffer;
  for (int frame = 0; frame < 15; ++frame) {
    const Motion motion = kMotions[static_cast<std::size_t>(frame) % kMotions.size()];
    move(motion, boxes_a, random);
    a.update(keys_a, boxes_a);
    if (frame % 2 == 0) {
      move(motion, boxes_b, random);
      b.update(keys_b, boxes_b);
    }
    if (frame % 5 == 3) {
      a.remove(keys_a.back());
      keys_a.pop_back();
      boxes_a.pop_back();
    }
    EXPECT_TRUE(agree(a, b, buffer)) << to_string(motion) << ", frame " << frame;
  }
}

INSTANTIATE_TEST_SUITE_P(All, PairsWith, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
