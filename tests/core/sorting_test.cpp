// The sorts of core/sort compared with std::stable_sort, on several numbers of threads: counting
// sort by bucket, radix sort by bits, and floats as sortable integers.

#include <gtest/gtest.h>
#include "core/sort/counting_sort.h"
#include "core/sort/radix_sort.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <vector>

#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr std::uint32_t kNone = CountingSort::kNone;

struct Sorted {
  std::vector<std::uint32_t> start;
  std::vector<std::uint32_t> order;
};

Sorted sort_by_counting(const std::vector<std::uint32_t>& bucket, std::size_t buckets,
                        int threads) {
  Sorted sorted;
  sorted.start.resize(buckets + 1);
  Threads arena(threads);
  arena.run([&] {
    const Execution execution = Execution::parallel();
    CountingSort sort(bucket, sorted.start, execution);
    sort.count();
    sorted.order.resize(sort.find_starts());
    sort.place(sorted.order.data());
  });
  return sorted;
}

TEST(CountingSort, counting_sort_is_stable_by_bucket) {
  const Sorted sorted = sort_by_counting({2, 0, kNone, 2, 0}, 4, 1);
  EXPECT_EQ(sorted.order, (std::vector<std::uint32_t>{1, 4, 0, 3}));
  EXPECT_EQ(sorted.start, (std::vector<std::uint32_t>{0, 2, 2, 4, 4}));
}

TEST(CountingSort, empty_input_gives_empty_output) {
  const Sorted sorted = sort_by_counting({}, 0, 1);
  EXPECT_TRUE(sorted.order.empty());
  EXPECT_EQ(sorted.start, std::vector<std::uint32_t>{0});
}

TEST(CountingSort, bucket_sizes_are_available_before_placing) {
  const std::vector<std::uint32_t> bucket{1, 1, kNone, 0, 1};
  std::vector<std::uint32_t> start(3);
  const Execution execution = Execution::serial();
  CountingSort sort(bucket, start, execution);
  sort.count();
  EXPECT_EQ(sort.size_of(0), 1U);
  EXPECT_EQ(sort.size_of(1), 3U);
}

TEST(CountingSort, order_does_not_depend_on_threads_or_buckets) {
  Random random(1);
  for (const std::size_t buckets : {1U, 3U, 300U, 60000U}) {
    for (const std::size_t used : {std::size_t{1}, (buckets + 1) / 2, buckets}) {
      std::vector<std::uint32_t> bucket(40000);
      for (std::uint32_t& b : bucket) {
        b = random.chance(0.1) ? kNone
                               : static_cast<std::uint32_t>(buckets - used + random.below(used));
      }
      std::vector<std::uint32_t> expected(bucket.size());
      std::iota(expected.begin(), expected.end(), 0U);
      std::erase_if(expected, [&](std::uint32_t row) { return bucket[row] == kNone; });
      std::ranges::stable_sort(expected, {}, [&](std::uint32_t row) { return bucket[row]; });
      for (const int threads : {1, 2, 3, 8, 20}) {
        const Sorted sorted = sort_by_counting(bucket, buckets, threads);
        ASSERT_EQ(sorted.order, expected);
        for (std::size_t b = 0; b < buckets; ++b) {
          for (std::uint32_t i = sorted.start[b]; i < sorted.start[b + 1]; ++i) {
            ASSERT_EQ(bucket[sorted.order[i]], b);
          }
        }
      }
    }
  }
}

TEST(RadixSort, keys_of_any_length_are_sorted_stably) {
  Random random(2);
  for (const unsigned bits : {0U, 1U, 11U, 12U, 17U, 23U, 32U}) {
    std::vector<std::uint64_t> items(30000);
    for (std::uint32_t i = 0; i < items.size(); ++i) {
      const std::uint64_t key = bits == 0 ? 0 : random.bits() >> (64U - bits);
      items[i] = key << 32U | i;
    }
    std::vector<std::uint64_t> expected = items;
    std::ranges::stable_sort(expected, {}, [](std::uint64_t item) { return item >> 32U; });
    for (const int threads : {1, 3}) {
      std::vector<std::uint64_t> from = items;
      std::vector<std::uint64_t> spare(items.size());
      Threads arena(threads);
      arena.run([&] {
        const std::uint64_t* const sorted =
            radix_sort(from.data(), spare.data(), from.size(), bits, Execution::parallel());
        EXPECT_TRUE(std::equal(expected.begin(), expected.end(), sorted)) << bits;
      });
    }
  }
}

TEST(RadixSort, only_the_given_bits_decide_the_order) {
  Random random(3);
  struct Digits {
    unsigned first;
    unsigned bits;
  };
  for (const Digits digits : {Digits{0, 64}, Digits{0, 48}, Digits{5, 30}, Digits{32, 28}}) {
    const unsigned first = digits.first;
    const unsigned bits = digits.bits;
    for (const std::size_t count : {0U, 1U, 700U, 20000U}) {
      std::vector<std::uint64_t> items(count);
      // Some bits are equal in all items, as the level bits of items on one level are.
      for (std::uint64_t& item : items) item = random.bits() & ~(std::uint64_t{0x3FFFF} << 20U);
      const std::uint64_t whole = ~std::uint64_t{0} >> (64U - bits);
      const auto key = [&](std::uint64_t item) { return item >> first & whole; };
      std::vector<std::uint64_t> expected = items;
      std::ranges::stable_sort(expected, {}, key);
      for (const int threads : {1, 3}) {
        std::vector<std::uint64_t> from = items;
        std::vector<std::uint64_t> spare(items.size());
        Threads arena(threads);
        arena.run([&] {
          const std::uint64_t* const sorted = radix_sort(from.data(), spare.data(), from.size(),
                                                         bits, Execution::parallel(), first);
          EXPECT_TRUE(std::equal(expected.begin(), expected.end(), sorted)) << first << ' ' << bits;
        });
      }
    }
  }
}

TEST(Sortable, sortable_orders_floats_and_is_invertible) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<float> ascending{-kInfinity, -3.5F,  -1e-40F, -0.0F,
                                     0.0F,       1e-40F, 2.0F,    kInfinity};
  for (std::size_t i = 0; i < ascending.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint32_t>(from_sortable(sortable(ascending[i]))),
              std::bit_cast<std::uint32_t>(ascending[i]));
    if (i > 0) {
      EXPECT_LT(sortable(ascending[i - 1]), sortable(ascending[i]));
    }
  }
}

}  // namespace
}  // namespace winnow::test
