// Inputs that are split into several tasks: the result equals single calls in order.

#include <winnow/partitions/partition.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/scenes.h"

namespace winnow::test {
namespace {

constexpr std::size_t kObjects = 20000;

/// Two partitions with the same objects: one gets batches, the other single calls.
struct PartitionAndReference {
  Partition batched;
  Partition single;
  std::vector<Key> keys;
  std::vector<Key> other_keys;

  explicit PartitionAndReference(const PartitionOptions& options)
      : batched(bounds_n_squared(), options), single(bounds_n_squared(), options) {}

  void insert(const BoxView& boxes) {
    keys.resize(boxes.count);
    other_keys.resize(boxes.count);
    ASSERT_EQ(batched.insert(boxes, {}, keys), Status::ok);
    for (std::size_t i = 0; i < boxes.count; ++i) {
      other_keys[i] = expect_ok(single.insert(boxes[i], 0));
    }
  }

  /// Updates entries `which` of the boxes, in the second partition one by one in their order.
  void update(const std::vector<std::size_t>& which, const std::vector<Aabb>& boxes) {
    std::vector<Key> some;
    std::vector<Aabb> their;
    for (const std::size_t i : which) {
      some.push_back(keys[i]);
      their.push_back(boxes[i]);
      ASSERT_EQ(single.update(other_keys[i], boxes[i]), Status::ok);
    }
    ASSERT_EQ(batched.update(some, their), Status::ok);
  }

  void expect_alike() const {
    std::vector<Aabb> boxes(keys.size());
    std::vector<Aabb> others(keys.size());
    ASSERT_EQ(batched.bounds(keys, boxes), Status::ok);
    ASSERT_EQ(single.bounds(other_keys, others), Status::ok);
    EXPECT_TRUE(std::ranges::equal(boxes, others));
  }
};

std::vector<PartitionOptions> all_options() {
  std::vector<PartitionOptions> all;
  for (const Volume volume : {Volume::aabb, Volume::sphere, Volume::kdop14, Volume::kdop26}) {
    for (const float margin : {0.0F, 0.05F}) {
      PartitionOptions& options = all.emplace_back();
      options.volume = volume;
      options.fat_margin.distance = margin;
    }
  }
  return all;
}

TEST(LargeInput, batch_insert_equals_single_inserts) {
  const std::vector<Aabb> boxes = uniform_boxes(kObjects);
  std::vector<float> columns;
  for (int c = 0; c < 6; ++c) {
    for (const Aabb& box : boxes) columns.push_back(c < 3 ? box.min[c] : box.max[c - 3]);
  }
  const auto at = [&](std::size_t c) { return columns.data() + c * kObjects; };
  for (const PartitionOptions& options : all_options()) {
    for (const BoxView& view :
         {BoxView(boxes), BoxView({at(0), at(1), at(2)}, {at(3), at(4), at(5)}, kObjects)}) {
      PartitionAndReference partitions(options);
      ASSERT_NO_FATAL_FAILURE(partitions.insert(view));
      partitions.expect_alike();
    }
  }
}

TEST(LargeInput, batch_update_equals_single_updates) {
  std::vector<Aabb> boxes = uniform_boxes(kObjects);
  for (const PartitionOptions& options : all_options()) {
    PartitionAndReference partitions(options);
    ASSERT_NO_FATAL_FAILURE(partitions.insert(boxes));
    std::uint64_t seed = 2;
    const auto update = [&](std::vector<std::size_t> which, const char* what) {
      SCOPED_TRACE(what);
      // Some boxes move far, some within the margin.
      const std::vector<Aabb> next = uniform_boxes(kObjects, seed++);
      for (std::size_t i = 0; i < kObjects; ++i) {
        if (i % 3 == 0) boxes[i] = next[i];
        boxes[i].max[0] += 0.01F;
      }
      ASSERT_NO_FATAL_FAILURE(partitions.update(which, boxes));
      partitions.expect_alike();
    };
    std::vector<std::size_t> which(kObjects);
    for (std::size_t i = 0; i < kObjects; ++i) which[i] = i;
    update(which, "all");
    std::ranges::reverse(which);
    update(which, "all, from the last to the first");
    std::ranges::reverse(which);
    std::swap(which[9000], which[17000]);
    update(which, "all, two out of order");
    which.push_back(11);
    update(which, "one twice");
    std::erase_if(which, [](std::size_t i) { return i % 5 == 2; });
    std::ranges::sort(which);
    which.erase(which.begin() + 8, which.begin() + 10);
    update(which, "most");
    std::erase_if(which, [](std::size_t i) { return i % 16 > 6; });
    update(which, "fewer than half");
  }
}

TEST(LargeInput, one_invalid_box_changes_nothing) {
  const std::vector<Aabb> boxes = uniform_boxes(kObjects);
  for (const PartitionOptions& options : all_options()) {
    PartitionAndReference partitions(options);
    ASSERT_NO_FATAL_FAILURE(partitions.insert(boxes));
    for (const std::size_t bad : {std::size_t{0}, std::size_t{10001}, kObjects - 1}) {
      std::vector<Aabb> next = uniform_boxes(kObjects, 2);
      next[bad].max[1] = std::numeric_limits<float>::quiet_NaN();
      EXPECT_EQ(partitions.batched.update(partitions.keys, next), Status::invalid_bounds);
      std::vector<Key> keys(kObjects);
      EXPECT_EQ(partitions.batched.insert(next, {}, keys), Status::invalid_bounds);
      next[bad].max[1] = next[bad].min[1];
      keys = partitions.keys;
      keys[bad] = Key{};
      EXPECT_EQ(partitions.batched.update(keys, next), Status::invalid_key);
    }
    partitions.expect_alike();
  }
}

}  // namespace
}  // namespace winnow::test
