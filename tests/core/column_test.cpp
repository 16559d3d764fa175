#include <gtest/gtest.h>
#include <winnow/core/column.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

struct Odd {
  std::array<std::uint8_t, 24> bytes;  // does not divide a cache line
};

template <typename T>
bool is_aligned(const Column<T>& column) {
  return reinterpret_cast<std::uintptr_t>(column.data()) % 64 == 0;
}

TEST(Column, is_aligned_to_64_bytes_and_holds_whole_lines) {
  CountingMemory memory;
  Column<float> floats(&memory);
  Column<Odd> odds(&memory);
  for (std::size_t n = 1; n < 300; n += 7) {
    ASSERT_TRUE(floats.reserve(n));
    ASSERT_TRUE(odds.reserve(n));
    EXPECT_TRUE(is_aligned(floats));
    EXPECT_TRUE(is_aligned(odds));
    EXPECT_GE(floats.capacity(), n);
    EXPECT_LT(floats.capacity(), n + 16);
    EXPECT_GE(odds.capacity(), n);
    EXPECT_EQ(floats.bytes().reserved % 64, 0U);
    EXPECT_EQ(floats.bytes().reserved + odds.bytes().reserved, memory.outstanding());
  }
}

TEST(Column, keeps_its_content_when_it_grows) {
  CountingMemory memory;
  Column<std::uint32_t> column(&memory);
  for (std::uint32_t i = 0; i < 5000; ++i) ASSERT_TRUE(column.push_back(i));
  ASSERT_EQ(column.size(), 5000U);
  for (std::uint32_t i = 0; i < 5000; ++i) ASSERT_EQ(column[i], i);
  EXPECT_EQ(column.bytes().used, 5000 * sizeof(std::uint32_t));
  EXPECT_EQ(column.bytes().reserved, memory.outstanding());
}

TEST(Column, keeps_its_content_when_its_room_is_touched) {
  CountingMemory memory;
  Column<Odd> column(&memory);
  ASSERT_TRUE(column.reserve(0, Pages::touched));
  for (std::size_t i = 0; i < 1000; ++i) {
    ASSERT_TRUE(column.push_back({{static_cast<std::uint8_t>(i)}}));
    if (i % 100 == 0) {
      ASSERT_TRUE(column.reserve(2 * i, Pages::touched));
    }
  }
  for (std::size_t i = 0; i < 1000; ++i) {
    ASSERT_EQ(column[i].bytes[0], static_cast<std::uint8_t>(i));
  }
  EXPECT_EQ(column.bytes().reserved, memory.outstanding());
}

TEST(Column, has_every_page_behind_its_content_written_to) {
  constexpr std::size_t kPage = 4096;
  CountingMemory memory;
  Column<std::uint8_t> column(&memory);
  ASSERT_TRUE(column.reserve(10 * kPage));
  std::fill_n(column.data(), 10 * kPage, std::uint8_t{1});
  column.set_size(kPage + 100);
  column.touch();
  EXPECT_EQ(std::count(column.begin(), column.end(), 0), 0);
  for (std::size_t page = 1; page < 9; ++page) {
    const auto* const begin = column.data() + 100 + page * kPage;
    EXPECT_NE(std::count(begin, begin + kPage, 0), 0) << page;
  }
}

TEST(Column, grows_in_few_steps) {
  CountingMemory memory;
  Column<std::uint32_t> column(&memory);
  for (std::uint32_t i = 0; i < 100000; ++i) ASSERT_TRUE(column.push_back(i));
  EXPECT_LT(memory.requests(), 30U);
}

TEST(Column, is_unchanged_when_memory_is_refused) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  Column<std::uint32_t> column(&memory);
  ASSERT_TRUE(column.resize(16));
  std::iota(column.begin(), column.end(), 0U);
  const std::uint32_t* const data = column.data();
  memory.refuse_after(0);
  EXPECT_FALSE(column.reserve(17));
  EXPECT_FALSE(column.grow(17));
  EXPECT_FALSE(column.resize(17));
  EXPECT_FALSE(column.push_back(99));
  EXPECT_EQ(column.data(), data);
  EXPECT_EQ(column.size(), 16U);
  EXPECT_EQ(column.capacity(), 16U);
  for (std::uint32_t i = 0; i < 16; ++i) EXPECT_EQ(column[i], i);
  EXPECT_EQ(memory.outstanding(), 64U);
}

TEST(Column, gets_by_with_less_when_generous_growth_is_refused) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  Column<std::uint32_t> column(&memory);
  ASSERT_TRUE(column.resize(64));
  memory.refuse_one_after(0);
  EXPECT_TRUE(column.grow(65));
  EXPECT_EQ(column.capacity(), 80U);
}

TEST(Column, shrinks_to_no_less_than_it_holds) {
  CountingMemory memory;
  Column<std::uint32_t> column(&memory);
  ASSERT_TRUE(column.reserve(1000));
  for (std::uint32_t i = 0; i < 20; ++i) ASSERT_TRUE(column.push_back(i));
  ASSERT_TRUE(column.shrink(100));
  EXPECT_EQ(column.capacity(), 112U);
  ASSERT_TRUE(column.shrink(2000));
  EXPECT_EQ(column.capacity(), 112U);
  ASSERT_TRUE(column.shrink(0));
  EXPECT_EQ(column.capacity(), 32U);
  ASSERT_EQ(column.size(), 20U);
  for (std::uint32_t i = 0; i < 20; ++i) EXPECT_EQ(column[i], i);
  EXPECT_EQ(memory.outstanding(), 128U);
}

TEST(Column, that_cannot_get_less_keeps_what_it_has) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  Column<std::uint32_t> column(&memory);
  ASSERT_TRUE(column.reserve(1000));
  ASSERT_TRUE(column.push_back(7));
  memory.refuse_one_after(0);
  EXPECT_FALSE(column.shrink(16));
  EXPECT_EQ(column.capacity(), 1008U);
  EXPECT_EQ(column[0], 7U);
}

TEST(Column, that_asks_for_more_bytes_than_there_are_is_refused) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  Column<Odd> column(&memory);
  EXPECT_FALSE(column.reserve(std::size_t{1} << 58U));
  EXPECT_EQ(column.capacity(), 0U);
}

// Numbers of bytes that no longer can be counted must not begin again at zero.
TEST(Column, that_asks_for_more_than_can_be_counted_is_refused) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  Column<std::uint64_t> column(&memory);
  ASSERT_TRUE(column.push_back(7));
  const std::size_t before = memory.outstanding();
  for (const std::size_t count :
       {std::size_t{1} << 61U, (std::size_t{1} << 61U) + 1, std::size_t{1} << 63U, ~std::size_t{0},
        Column<std::uint64_t>::kMost, Column<std::uint64_t>::kMost + 1}) {
    EXPECT_FALSE(column.reserve(count));
    EXPECT_FALSE(column.grow(count));
    EXPECT_FALSE(column.resize(count));
  }
  EXPECT_EQ(memory.outstanding(), before);
  EXPECT_EQ(column.size(), 1U);
  EXPECT_EQ(column[0], 7U);
}

TEST(Column, moves_and_swaps_without_copying) {
  CountingMemory memory;
  Column<float> a(&memory);
  ASSERT_TRUE(a.resize(20));
  a[3] = 3.0F;
  Column<float> b(std::move(a));
  EXPECT_EQ(b.size(), 20U);
  EXPECT_EQ(b[3], 3.0F);
  Column<float> c(&memory);
  c.swap(b);
  EXPECT_EQ(b.size(), 0U);
  EXPECT_EQ(c[3], 3.0F);
  EXPECT_EQ(memory.requests(), 1U);
}

TEST(Column, gives_everything_back) {
  CountingMemory memory;
  Column<Odd> column(&memory);
  ASSERT_TRUE(column.resize(1000));
  column.clear();
  EXPECT_EQ(column.size(), 0U);
  EXPECT_GT(memory.outstanding(), 0U);
  column.release();
  EXPECT_EQ(memory.outstanding(), 0U);
  EXPECT_EQ(column.bytes(), Bytes{});
  ASSERT_TRUE(column.push_back({}));
}

}  // namespace
}  // namespace winnow::test
