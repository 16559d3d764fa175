#include <gtest/gtest.h>
#include <winnow/core/results.h>

#include <algorithm>
#include <vector>

#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

TEST(Pair, pairs_are_ordered_by_first_then_second) {
  EXPECT_LT((Pair{1, 9}), (Pair{2, 0}));
  EXPECT_LT((Pair{1, 2}), (Pair{1, 3}));
  EXPECT_EQ((Pair{1, 2}), (Pair{1, 2}));
}

TEST(PairBuffer, cleared_buffer_keeps_its_memory) {
  CountingMemory memory;
  PairBuffer buffer(&memory);
  EXPECT_TRUE(buffer.empty());
  ASSERT_TRUE(buffer.reserve(100));
  for (ObjectId i = 0; i < 100; ++i) ASSERT_TRUE(buffer.edit().push_back({i, i + 1}));
  EXPECT_EQ(memory.requests(), 1U);
  EXPECT_EQ(buffer.size(), 100U);
  EXPECT_EQ(buffer[7], (Pair{7, 8}));
  EXPECT_EQ(buffer.pairs().size(), 100U);
  buffer.clear();
  EXPECT_TRUE(buffer.empty());
  EXPECT_EQ(memory.outstanding(), buffer.footprint().total().reserved);
  EXPECT_GE(buffer.footprint().results.reserved, 100 * sizeof(Pair));
  EXPECT_EQ(buffer.footprint().results.used, 0U);
}

TEST(PairBuffer, shrink_keeps_the_pairs) {
  PairBuffer buffer;
  ASSERT_TRUE(buffer.reserve(1000));
  for (ObjectId i = 0; i < 10; ++i) ASSERT_TRUE(buffer.edit().push_back({i, i + 1}));
  ASSERT_TRUE(buffer.shrink(16));
  EXPECT_EQ(buffer.capacity(), 16U);
  ASSERT_EQ(buffer.size(), 10U);
  EXPECT_EQ(buffer[9], (Pair{9, 10}));
}

TEST(PairBuffer, partition_by_predicate_loses_no_pair) {
  for (const std::size_t count : {0U, 1U, 2U, 100U}) {
    for (const ObjectId step : {1U, 2U, 7U, 1000U}) {
      PairBuffer buffer;
      std::vector<Pair> all;
      for (ObjectId i = 0; i < count; ++i) {
        all.push_back({i, i + 1});
        ASSERT_TRUE(buffer.edit().push_back(all.back()));
      }
      const auto is_first = [step](const Pair& pair) { return pair.first % step != 0; };
      const std::size_t first = buffer.partition(is_first);
      EXPECT_EQ(first, static_cast<std::size_t>(std::ranges::count_if(all, is_first)));
      const auto pairs = buffer.pairs();
      EXPECT_TRUE(std::ranges::all_of(pairs.first(first), is_first));
      EXPECT_TRUE(std::ranges::none_of(pairs.subspan(first), is_first));
      std::vector<Pair> left(pairs.begin(), pairs.end());
      std::ranges::sort(left);
      EXPECT_EQ(left, all);
    }
  }
}

TEST(PairBuffer, assign_copies_the_pairs_of_another_buffer) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  PairBuffer one(&memory);
  PairBuffer other(&memory);
  for (ObjectId i = 0; i < 100; ++i) ASSERT_TRUE(one.edit().push_back({i, i + 1}));
  ASSERT_TRUE(other.assign(one));
  EXPECT_TRUE(std::ranges::equal(other.pairs(), one.pairs()));
  ASSERT_TRUE(other.assign(other));
  EXPECT_EQ(other.size(), 100U);
  ASSERT_TRUE(one.assign(PairBuffer(&memory)));
  EXPECT_TRUE(one.empty());
  other.release();
  ASSERT_TRUE(other.edit().push_back({1, 2}));
  ASSERT_TRUE(one.edit().push_back({3, 4}));
  while (one.size() < 50) ASSERT_TRUE(one.edit().push_back({5, 6}));
  memory.refuse_after(0);
  EXPECT_FALSE(other.assign(one));
  ASSERT_EQ(other.size(), 1U);
  EXPECT_EQ(other[0], (Pair{1, 2}));
}

TEST(PairBuffer, refused_memory_leaves_the_buffer_unchanged) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  PairBuffer buffer(&memory);
  ASSERT_TRUE(buffer.edit().push_back({1, 2}));
  memory.refuse_after(0);
  EXPECT_FALSE(buffer.reserve(1000));
  EXPECT_EQ(buffer.size(), 1U);
  EXPECT_EQ(buffer[0], (Pair{1, 2}));
}

}  // namespace
}  // namespace winnow::test
