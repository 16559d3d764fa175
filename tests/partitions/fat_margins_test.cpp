// Fat volumes: no true pair is missed, and an object that stays within its margin does not count as
// moved.

#include <winnow/core/eigen.h>
#include <winnow/core/results.h>

#include <cmath>
#include <limits>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

bool holds(const Aabb& outer, const Aabb& inner) {
  return (as_eigen(outer.min).array() <= as_eigen(inner.min).array()).all() &&
         (as_eigen(outer.max).array() >= as_eigen(inner.max).array()).all();
}

Aabb moved(const Aabb& box, float by) {
  return {as_eigen(box.min).array() + by, as_eigen(box.max).array() + by};
}

std::vector<Aabb> all_moved(const std::vector<Aabb>& boxes, float by) {
  std::vector<Aabb> result;
  for (const Aabb& box : boxes) result.push_back(moved(box, by));
  return result;
}

class FatMargins : public Conformance {
 protected:
  Partition with_fat_margin(const FatMargin& fat_margin, const std::vector<Aabb>& boxes) {
    Partition partition(structure_named(config().partition),
                        {.execution = config().execution(), .fat_margin = fat_margin});
    keys_.resize(boxes.size());
    EXPECT_EQ(partition.insert(boxes, {}, keys_), Status::ok);
    return partition;
  }

  void update(Partition& partition, std::span<const Key> keys, const std::vector<Aabb>& boxes) {
    EXPECT_EQ(threads_.run([&] { return partition.update(keys, boxes); }), Status::ok);
  }

  Statistics after_query(const Partition& partition) {
    EXPECT_EQ(threads_.run([&] { return partition.self_pairs(buffer_); }), Status::ok);
    return partition.statistics();
  }

  std::vector<Aabb> stored(const Partition& partition) {
    std::vector<Aabb> boxes(keys_.size());
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      boxes[i] = expect_ok(partition.bounds(keys_[i]));
    }
    return boxes;
  }

  // Expects the pairs of the stored boxes, each of which contains the given box.
  void expect_right(const Partition& partition, const std::vector<Aabb>& given) {
    (void)after_query(partition);
    const std::vector<Aabb> boxes = stored(partition);
    const bool tests_boxes = config().partition != "NSquared";
    EXPECT_TRUE(right_pairs(buffer_.pairs(), true_pairs(numbered(boxes)), tests_boxes));
    EXPECT_TRUE(right_pairs(buffer_.pairs(), true_pairs(numbered(given)), false));
    for (std::size_t i = 0; i < given.size(); ++i) ASSERT_TRUE(holds(boxes[i], given[i])) << i;
  }

  std::vector<Key> keys_;
  PairBuffer buffer_;
  Threads threads_{config().threads};
};

TEST_P(FatMargins, moving_fat_boxes_miss_no_pair) {
  for (const FatMargin fat_margin :
       {FatMargin{.distance = 0.05F}, FatMargin{.share = 0.2F},
        FatMargin{.distance = 0.01F, .share = 0.01F}, FatMargin{.share = 1e38F}}) {
    const std::size_t count = fat_margin.share < 1 ? 150 : 30;
    for (std::vector<Aabb> boxes : {uniform_boxes(count), mixed_boxes(count)}) {
      auto partition = with_fat_margin(fat_margin, boxes);
      EXPECT_FALSE(partition.is_exact());
      Random random(7);
      for (const Motion motion : kMotions) {
        (void)move(motion, boxes, random);
        update(partition, keys_, boxes);
        expect_right(partition, boxes);
        // Updates some of them in arbitrary order.
        const std::vector<Key> some{keys_[3], keys_[1], keys_[2]};
        for (const std::size_t i : {1U, 2U, 3U}) boxes[i] = moved(boxes[i], 0.03F);
        update(partition, some, {boxes[3], boxes[1], boxes[2]});
        boxes[4] = moved(boxes[4], 0.3F);
        EXPECT_EQ(partition.update(keys_[4], boxes[4]), Status::ok);
        expect_right(partition, boxes);
      }
    }
  }
}

TEST_P(FatMargins, infinite_huge_and_tiny_boxes_miss_no_pair) {
  std::vector<Aabb> boxes = exponential_boxes(60);
  boxes.push_back({{-kInf, -kInf, -kInf}, {kInf, kInf, 0.0F}});
  boxes.push_back({{0.0F, 0.0F, 0.0F}, {kInf, 1.0F, 1.0F}});
  boxes.push_back({{-3e38F, -3e38F, -3e38F}, {3e38F, 3e38F, 3e38F}});
  boxes.push_back({{1e30F, 1e30F, 1e30F}, {1e30F, 1e30F, 1e30F}});
  boxes.push_back({{1e-40F, 0.0F, 0.0F}, {1e-40F, 0.0F, 0.0F}});
  for (const FatMargin fat_margin :
       {FatMargin{.distance = 1.0F}, FatMargin{.share = 0.5F}, FatMargin{.distance = 3e38F},
        FatMargin{.distance = kInf, .share = kInf}}) {
    auto partition = with_fat_margin(fat_margin, boxes);
    expect_right(partition, boxes);
    // At rest nothing changes, even if the margin is lost in rounding or is infinite.
    const std::vector<Aabb> before = stored(partition);
    update(partition, keys_, boxes);
    EXPECT_EQ(after_query(partition).last_tests, 0U);
    EXPECT_EQ(stored(partition), before);
  }
}

TEST_P(FatMargins, motion_within_the_margin_costs_no_test) {
  const std::vector<Aabb> boxes = uniform_boxes(400);
  auto partition = with_fat_margin({.distance = 0.1F}, boxes);
  (void)after_query(partition);
  const Statistics before = after_query(partition);
  for (const float by : {0.0F, 0.04F, -0.09F, 0.09F}) {
    update(partition, keys_, all_moved(boxes, by));
    EXPECT_EQ(partition.update(keys_[9], moved(boxes[9], -by)), Status::ok);
    const Statistics now = after_query(partition);
    EXPECT_EQ(now.last_tests, 0U) << by;
    EXPECT_EQ(now.builds, before.builds);
    EXPECT_EQ(now.refits, before.refits);
  }
  // One object that leaves its margin costs the work of one object.
  std::vector<Aabb> next = boxes;
  next[7] = moved(next[7], 0.2F);
  update(partition, keys_, next);
  const Statistics now = after_query(partition);
  EXPECT_EQ(now.incremental_queries, before.incremental_queries + 5);
  EXPECT_GT(now.last_tests, 0U);
  EXPECT_LE(now.last_tests, 40U);
  expect_right(partition, next);
}

TEST_P(FatMargins, margin_has_the_given_size_and_shrinks) {
  const Aabb large{{0, 0, 0}, {8, 2, 4}};
  auto partition = with_fat_margin({.distance = 0.5F, .share = 0.25F}, {large});
  Aabb box = expect_ok(partition.bounds(keys_[0]));
  EXPECT_EQ(box, (Aabb{{-2.5F, -2.5F, -2.5F}, {10.5F, 4.5F, 6.5F}}));
  ASSERT_EQ(partition.update(keys_[0], {{1, 0, 1}, {7, 2, 4}}), Status::ok);
  box = expect_ok(partition.bounds(keys_[0]));
  EXPECT_EQ(box.max.x(), 10.5F) << "a little smaller";
  ASSERT_EQ(partition.update(keys_[0], {{1, 1, 1}, {2, 2, 2}}), Status::ok);
  box = expect_ok(partition.bounds(keys_[0]));
  EXPECT_EQ(box, (Aabb{{0.25F, 0.25F, 0.25F}, {2.75F, 2.75F, 2.75F}})) << "much smaller";
}

// Comparing each of the two boxes with the stored box would make the last one look unchanged.
TEST_P(FatMargins, repeated_key_takes_the_last_box) {
  const Aabb box{{0, 0, 0}, {1, 1, 1}};
  auto partition = with_fat_margin({.distance = 0.5F}, {box});
  const Key key = keys_[0];
  update(partition, std::vector<Key>{key, key}, {moved(box, 5.0F), box});
  Aabb now = expect_ok(partition.bounds(key));
  EXPECT_TRUE(holds(now, box));
}

TEST_P(FatMargins, all_queries_read_the_fat_boxes) {
  const std::vector<Aabb> boxes = uniform_boxes(300);
  auto partition = with_fat_margin({.share = 0.1F}, boxes);
  const std::vector<Aabb> given = all_moved(boxes, 0.05F);
  update(partition, keys_, given);
  const std::vector<Aabb> now = stored(partition);
  const std::vector<Aabb> query_boxes = uniform_boxes(40, 2);
  ASSERT_EQ(partition.overlap(BoxView(query_boxes), buffer_, {}, Order::canonical), Status::ok);
  EXPECT_TRUE(
      right_cross_pairs(buffer_.pairs(), cross_pairs(numbered(query_boxes), numbered(now)), true));
  EXPECT_TRUE(right_cross_pairs(buffer_.pairs(),
                                cross_pairs(numbered(query_boxes), numbered(given)), false));
  HitBuffer hits;
  ASSERT_EQ(partition.nearest({{0, 0, 0}, {0, 0, 0}}, 300, kInf, hits), Status::ok);
  EXPECT_EQ(hits.size(), 300U);
}

INSTANTIATE_TEST_SUITE_P(All, FatMargins, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

template <int K>
void expect_fat_kdops(Volume volume) {
  Partition partition(
      bounds_n_squared(),
      {.execution = Execution::serial(), .volume = volume, .fat_margin = {.distance = 0.1F}});
  const std::vector<Aabb> boxes = uniform_boxes(200);
  std::vector<Kdop<K>> kdops;
  for (const Aabb& box : boxes) {
    kdops.push_back(Kdop<K>::around(std::vector<Vec3f>{box.min, box.max}));
  }
  std::vector<Key> keys(kdops.size());
  ASSERT_EQ(partition.insert(std::span<const Kdop<K>>(kdops), {}, keys), Status::ok);
  PairBuffer buffer;
  ASSERT_EQ(partition.self_pairs(buffer), Status::ok);
  // 0.05 on each axis is 0.0866 along the diagonal.
  Random random(3);
  for (std::size_t i = 0; i < kdops.size(); ++i) {
    const auto by = static_cast<float>(random.uniform(-0.05, 0.05));
    const Aabb box = moved(boxes[i], by);
    kdops[i] = Kdop<K>::around(std::vector<Vec3f>{box.min, box.max});
  }
  ASSERT_EQ(partition.update(keys, std::span<const Kdop<K>>(kdops)), Status::ok);
  ASSERT_EQ(partition.self_pairs(buffer, {.order = Order::canonical}), Status::ok);
  EXPECT_EQ(partition.statistics().last_tests, 0U);
  std::vector<Pair> truth;
  for (ObjectId i = 0; i < kdops.size(); ++i) {
    for (ObjectId j = i + 1; j < kdops.size(); ++j) {
      if (kdops[i].overlaps(kdops[j])) truth.push_back({i, j});
    }
  }
  EXPECT_TRUE(right_pairs(buffer.pairs(), truth, false));
}

TEST(FatVolumes, fat_kdop_contains_motion_within_the_margin) {
  expect_fat_kdops<14>(Volume::kdop14);
  expect_fat_kdops<18>(Volume::kdop18);
  expect_fat_kdops<26>(Volume::kdop26);
}

TEST(FatVolumes, fat_sphere_contains_motion_within_the_margin) {
  Partition partition(
      bounds_n_squared(),
      {.execution = Execution::serial(), .volume = Volume::sphere, .fat_margin = {.share = 0.25F}});
  std::vector<Sphere> spheres{{{0, 0, 0}, 1.0F}, {{2.8F, 0, 0}, 1.0F}};
  std::vector<Key> keys(2);
  ASSERT_EQ(partition.insert(spheres, {}, keys), Status::ok);
  PairBuffer buffer;
  ASSERT_EQ(partition.self_pairs(buffer), Status::ok);
  EXPECT_EQ(buffer.size(), 1U);
  spheres[0].center = {0.3F, 0.3F, 0.2F};
  ASSERT_EQ(partition.update(keys, spheres), Status::ok);
  ASSERT_EQ(partition.self_pairs(buffer), Status::ok);
  EXPECT_EQ(partition.statistics().last_tests, 0U);
  spheres[0].center = {-0.6F, 0, 0};
  ASSERT_EQ(partition.update(keys, spheres), Status::ok);
  ASSERT_EQ(partition.self_pairs(buffer), Status::ok);
  EXPECT_EQ(buffer.size(), 0U);
}

}  // namespace
}  // namespace winnow::test
