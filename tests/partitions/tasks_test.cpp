#include "partitions/structures/tasks.h"
#include <gtest/gtest.h>
#include "core/sort/parallel_ranges.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace winnow::test {
namespace {

constexpr std::size_t kRowsOfUnit = 3;

struct Search {
  std::size_t units;
  std::size_t most;
  std::size_t looked_at = 0;  // units
  bool all = false;
  std::vector<std::uint32_t> found;

  /// Searches rows with row % one_in == 0.
  Search(std::size_t units_in, std::size_t one_in, std::size_t most_in)
      : units(units_in), most(most_in) {
    const std::size_t rows = kRowsOfUnit * units;
    std::vector<std::uint32_t> scratch(rows);
    Column<std::uint32_t> out(std::pmr::get_default_resource());
    if (!out.reserve(most + 1)) return;
    std::atomic<std::size_t> looked{0};
    all = append_in_order(
        Execution::parallel(), {units}, rows, scratch.data(),
        [](std::uint32_t unit) { return kRowsOfUnit * unit; },
        [&](std::uint32_t begin, std::uint32_t end, std::uint32_t* to) {
          looked += end - begin;
          std::size_t count = 0;
          for (std::size_t row = kRowsOfUnit * begin; row < kRowsOfUnit * end; ++row) {
            if (row % one_in == 0) to[count++] = static_cast<std::uint32_t>(row);
          }
          return count;
        },
        out, most);
    looked_at = looked;
    found.assign(out.begin(), out.end());
  }
};

TEST(AppendInOrder, rows_are_in_order_and_units_read_once) {
  for (const std::size_t units : {1U, 3U, 7U, 8U, 13U, 64U, 65U, 1000U}) {
    const Search search(units, 5, kRowsOfUnit * units);
    EXPECT_TRUE(search.all);
    EXPECT_EQ(search.looked_at, units);
    std::vector<std::uint32_t> expected;
    for (std::uint32_t row = 0; row < kRowsOfUnit * units; row += 5) expected.push_back(row);
    EXPECT_EQ(search.found, expected) << units << " units";
  }
}

TEST(AppendInOrder, sample_with_too_many_rows_stops_the_search) {
  const Search search(1000, 1, 1000);
  EXPECT_FALSE(search.all);
  EXPECT_TRUE(search.found.empty());
  EXPECT_LT(search.looked_at, 200U);
}

TEST(AppendInOrder, one_row_over_the_limit_is_reported) {
  const std::size_t rows = 5 * 200;
  EXPECT_TRUE(Search(rows / kRowsOfUnit, 5, 200).all);
  const Search one_more(rows / kRowsOfUnit, 5, 199);
  EXPECT_FALSE(one_more.all);
  EXPECT_TRUE(one_more.found.empty());
  EXPECT_EQ(one_more.looked_at, one_more.units);
}

TEST(EvenRanges, ranges_are_even_for_eight_threads) {
  for (const std::size_t longest : {1U, 64U, 100U, 8192U, 16384U}) {
    for (const std::size_t count : {0U, 1U, 63U, 64U, 65U, 8193U, 16385U, 100000U, 1000003U}) {
      const std::size_t length = even_range_length(count, longest);
      ASSERT_GE(length, 1U);
      ASSERT_LE(length, longest);
      std::vector<std::size_t> sizes((count + length - 1) / length);
      for_each_even_range(
          Execution::serial(), count, longest,
          [&](std::size_t begin, std::size_t end) { sizes[begin / length] = end - begin; });
      EXPECT_EQ(std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}), count);
    }
  }
  EXPECT_EQ(even_range_length(100000, 16384), 12544U);
}

}  // namespace
}  // namespace winnow::test
