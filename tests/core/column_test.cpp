// Column: alignment, growth, prefaulted pages, refused memory, and sizes that overflow.

#include <gtest/gtest.h>
#include <winnow/core/memory.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

struct Odd {
  std::array<std::uint8_t, 24> bytes;  // 24 does not divide a cache line
};

template <typename T>
bool is_aligned(const Column<T>& column) {
  return reinterpret_cast<std::uintptr_t>(column.data()) % 64 == 0;
}

TEST(Column, capacity_is_aligned_and_in_whole_lines) {
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

TEST(Column, growth_keeps_the_content) {
  CountingMemory memory;
  Column<std::uint32_t> column(&memory);
  for (std::uint32_t i = 0; i < 5000; ++i) ASSERT_TRUE(column.push_back(i));
  ASSERT_EQ(column.size(), 5000U);
  for (std::uint32_t i = 0; i < 5000; ++i) ASSERT_EQ(column[i], i);
  EXPECT_EQ(column.bytes().used, 5000 * sizeof(std::uint32_t));
  EXPECT_EQ(column.bytes().reserved, memory.outstanding());
}

TEST(Column, reserve_with_touched_pages_keeps_the_content) {
  CountingMemory memory;
  Column<Odd> column(&memory);
  ASSERT_TRUE(column.reserve(0, Pages::prefaulted));
  for (std::size_t i = 0; i < 1000; ++i) {
    ASSERT_TRUE(column.push_back({{static_cast<std::uint8_t>(i)}}));
    if (i % 100 == 0) {
      ASSERT_TRUE(column.reserve(2 * i, Pages::prefaulted));
    }
  }
  for (std::size_t i = 0; i < 1000; ++i) {
    ASSERT_EQ(column[i].bytes[0], static_cast<std::uint8_t>(i));
  }
  EXPECT_EQ(column.bytes().reserved, memory.outstanding());
}

TEST(Column, touch_writes_to_every_page_of_the_content) {
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

TEST(Column, growth_takes_few_steps) {
  CountingMemory memory;
  Column<std::uint32_t> column(&memory);
  for (std::uint32_t i = 0; i < 100000; ++i) ASSERT_TRUE(column.push_back(i));
  EXPECT_LT(memory.requests(), 30U);
}

TEST(Column, refused_memory_leaves_the_column_unchanged) {
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

TEST(Column, growth_takes_less_if_spare_room_is_refused) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  Column<std::uint32_t> column(&memory);
  ASSERT_TRUE(column.resize(64));
  memory.refuse_one_after(0);
  EXPECT_TRUE(column.grow(65));
  EXPECT_EQ(column.capacity(), 80U);
}

TEST(Column, shrink_keeps_at_least_the_content) {
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

TEST(Column, refused_shrink_keeps_the_capacity) {
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

TEST(Column, reserve_beyond_the_address_space_is_refused) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  Column<Odd> column(&memory);
  EXPECT_FALSE(column.reserve(std::size_t{1} << 58U));
  EXPECT_EQ(column.capacity(), 0U);
}

// Sizes in bytes that overflow must not wrap around to zero.
TEST(Column, reserve_whose_bytes_overflow_is_refused) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  Column<std::uint64_t> column(&memory);
  ASSERT_TRUE(column.push_back(7));
  const std::size_t before = memory.outstanding();
  for (const std::size_t count :
       {std::size_t{1} << 61U, (std::size_t{1} << 61U) + 1, std::size_t{1} << 63U, ~std::size_t{0},
        Column<std::uint64_t>::kMaxSize, Column<std::uint64_t>::kMaxSize + 1}) {
    EXPECT_FALSE(column.reserve(count));
    EXPECT_FALSE(column.grow(count));
    EXPECT_FALSE(column.resize(count));
  }
  EXPECT_EQ(memory.outstanding(), before);
  EXPECT_EQ(column.size(), 1U);
  EXPECT_EQ(column[0], 7U);
}

TEST(Column, move_and_swap_do_not_copy) {
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

TEST(Column, release_returns_all_memory) {
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
