#include "core/sort/counting_sort.h"

#include <algorithm>
#include <utility>

namespace winnow {

CountingSort::CountingSort(std::span<const std::uint32_t> bucket, std::span<std::uint32_t> start,
                           const Execution& execution) noexcept
    : bucket_(bucket),
      start_(start),
      execution_(execution),
      buckets_(start.size() - 1),
      threads_(owner_count(bucket.size(), execution)) {}

// Calls body(index, first row, end) for the range of rows of each thread.
template <typename Body>
void CountingSort::for_each_row_range(Body&& body) const {
  execution_.for_each(threads_, [&](std::size_t i) {
    body(i, bucket_.size() * i / threads_, bucket_.size() * (i + 1) / threads_);
  });
}

void CountingSort::count() noexcept {
  std::ranges::fill(start_, 0U);
  if (has_few()) return count_few();
  for_rows_by_target(bucket_, buckets_, execution_,
                     [&](std::uint32_t, std::uint32_t bucket) { ++start_[bucket]; });
}

void CountingSort::count_few() noexcept {
  for_each_row_range([&](std::size_t range, std::size_t first, std::size_t end) {
    // Consecutive rows are often in one bucket. With four arrays of counts, an increment does not
    // depend on the one before.
    std::array<Counts, 4> counts;
    for (Counts& some : counts) std::fill_n(some.begin(), buckets_, 0U);
    for (std::size_t row = first; row < end; ++row) {
      if (bucket_[row] != kNone) ++counts[row % counts.size()][bucket_[row]];
    }
    for (std::size_t b = 0; b < buckets_; ++b) {
      counts_[range][b] = counts[0][b] + counts[1][b] + counts[2][b] + counts[3][b];
    }
  });
  for (std::size_t b = 0; b < buckets_; ++b) {
    for (std::size_t i = 0; i < threads_; ++i) start_[b] += counts_[i][b];
  }
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

void CountingSort::place(std::uint32_t* order) noexcept {
  if (has_few()) return place_few(order);
  place_many(order);
}

// Within a bucket, the rows of a range follow the rows of the range before.
void CountingSort::place_few(std::uint32_t* order) noexcept {
  for (std::size_t b = 0; b < buckets_; ++b) {
    std::uint32_t next = start_[b];
    for (std::size_t i = 0; i < threads_; ++i) next += std::exchange(counts_[i][b], next);
  }
  for_each_row_range([&](std::size_t range, std::size_t first, std::size_t end) {
    Counts& next = counts_[range];
    if (buckets_ == 1) {
      // With one bucket, the next position is in a register instead of in an array of counters.
      std::uint32_t* to = order + next[0];
      for (std::size_t row = first; row < end; ++row) {
        if (bucket_[row] != kNone) *to++ = static_cast<std::uint32_t>(row);
      }
      return;
    }
    for (std::size_t row = first; row < end; ++row) {
      if (bucket_[row] != kNone) order[next[bucket_[row]]++] = static_cast<std::uint32_t>(row);
    }
  });
}

// Returns the range of buckets of an owner. All owners get about equally many rows.
CountingSort::BucketRange CountingSort::buckets_of_owner(std::size_t owner) const noexcept {
  const auto first_of = [&](std::size_t i) -> std::size_t {
    if (i == threads_) return buckets_;
    const std::size_t rows = std::size_t{start_[buckets_]} * i / threads_;
    return static_cast<std::size_t>(std::ranges::lower_bound(start_.first(buckets_), rows) -
                                    start_.begin());
  };
  return {first_of(owner), first_of(owner + 1)};
}

void CountingSort::place_many(std::uint32_t* order) noexcept {
  std::array<BucketRange, kMaxOwners> share;
  for (std::size_t i = 0; i < threads_; ++i) share[i] = buckets_of_owner(i);
  execution_.for_each(threads_, [&](std::size_t owner) {
    const auto [first, end] = share[owner];
    if (first == end) return;
    const std::uint32_t begin = start_[first];
    for_rows_of_owner(bucket_, first, end, threads_, [&](std::uint32_t row, std::uint32_t bucket) {
      order[start_[bucket]++] = row;
    });
    // After placing, start_[b] is the end of bucket b, which is the beginning of bucket b + 1.
    std::copy_backward(start_.data() + first, start_.data() + end - 1, start_.data() + end);
    start_[first] = begin;
  });
}

}  // namespace winnow
