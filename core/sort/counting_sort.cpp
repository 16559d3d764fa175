#include "core/sort/counting_sort.h"

#include <algorithm>
#include <array>

#include "core/sort/own_rows.h"

namespace winnow {

CountingSort::CountingSort(std::span<const std::uint32_t> bucket, std::span<std::uint32_t> start,
                           const Execution& execution) noexcept
    : bucket_(bucket),
      start_(start),
      execution_(execution),
      buckets_(start.size() - 1),
      owners_(owners_of_rows(bucket.size(), execution)) {}

void CountingSort::count() noexcept {
  std::ranges::fill(start_, 0U);
  for_rows_by_target(bucket_, buckets_, execution_,
                     [&](std::uint32_t, std::uint32_t bucket) { ++start_[bucket]; });
}

std::uint32_t CountingSort::find_starts() noexcept {
  std::uint32_t sum = 0;
  for (std::uint32_t& start : start_.first(buckets_)) {
    const std::uint32_t rows = start;
    start = sum;
    sum += rows;
  }
  start_[buckets_] = sum;
  return sum;
}

// Buckets of about as many rows as those of every other owner.
CountingSort::Buckets CountingSort::equal_rows(std::size_t owner) const noexcept {
  const auto first_of = [&](std::size_t i) -> std::size_t {
    if (i == owners_) return buckets_;
    const std::size_t rows = std::size_t{start_[buckets_]} * i / owners_;
    return std::ranges::lower_bound(start_.first(buckets_), rows) - start_.begin();
  };
  return {first_of(owner), first_of(owner + 1)};
}

void CountingSort::place(std::uint32_t* order) noexcept {
  std::array<Buckets, kMostOwners> share;
  for (std::size_t i = 0; i < owners_; ++i) share[i] = equal_rows(i);
  execution_.for_each(owners_, [&](std::size_t owner) {
    const auto [first, end] = share[owner];
    if (first == end) return;
    const std::uint32_t begin = start_[first];
    for_own_rows(bucket_, first, end, owners_,
                 [&](std::uint32_t row, std::uint32_t bucket) { order[start_[bucket]++] = row; });
    // Where the last row of a bucket went the next one begins.
    std::copy_backward(start_.begin() + first, start_.begin() + end - 1, start_.begin() + end);
    start_[first] = begin;
  });
}

}  // namespace winnow
