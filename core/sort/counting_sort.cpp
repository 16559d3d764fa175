#include "core/sort/counting_sort.h"

#include <algorithm>

namespace winnow {
namespace {

constexpr std::size_t kRowsPerChunk = 4096;
constexpr std::size_t kMostSortChunks = 8;

}  // namespace

CountingSort::CountingSort(std::span<const std::uint32_t> bucket, std::span<std::uint32_t> start,
                           std::span<std::uint32_t> spare, const Execution& execution) noexcept
    : bucket_(bucket),
      start_(start),
      spare_(spare),
      execution_(execution),
      buckets_(start.size() - 1) {
  // More counts than rows cost more than they save.
  const std::size_t room =
      std::min(spare.size(), bucket.size()) / std::max<std::size_t>(1, buckets_);
  chunks_ =
      std::min({kMostSortChunks, execution.concurrency(), bucket.size() / kRowsPerChunk, room + 1});
  chunks_ = std::max<std::size_t>(1, chunks_);
}

void CountingSort::count() noexcept {
  execution_.for_each(chunks_, [&](std::size_t chunk) {
    std::uint32_t* const counts = counts_of(chunk);
    std::fill_n(counts, buckets_, 0U);
    for (std::size_t row = first_row(chunk); row < first_row(chunk + 1); ++row) {
      if (bucket_[row] != kNone) ++counts[bucket_[row]];
    }
  });
}

std::uint32_t CountingSort::size_of(std::size_t bucket) const noexcept {
  std::uint32_t sum = 0;
  for (std::size_t chunk = 0; chunk < chunks_; ++chunk) sum += counts_of(chunk)[bucket];
  return sum;
}

std::uint32_t CountingSort::find_starts() noexcept {
  std::uint32_t sum = 0;
  for (std::size_t b = 0; b < buckets_; ++b) {
    for (std::size_t chunk = 0; chunk < chunks_; ++chunk) {
      std::uint32_t& at = counts_of(chunk)[b];
      const std::uint32_t rows = at;
      at = sum;
      sum += rows;
    }
  }
  start_[buckets_] = sum;
  return sum;
}

void CountingSort::place(std::uint32_t* order) noexcept {
  execution_.for_each(chunks_, [&](std::size_t chunk) {
    std::uint32_t* const next = counts_of(chunk);
    for (std::size_t row = first_row(chunk); row < first_row(chunk + 1); ++row) {
      if (bucket_[row] != kNone) order[next[bucket_[row]]++] = static_cast<std::uint32_t>(row);
    }
  });
  // Where the last chunk has come to in a bucket the next one begins.
  const std::uint32_t* const end = counts_of(chunks_ - 1);
  for (std::size_t b = buckets_; b-- > 1;) start_[b] = end[b - 1];
  start_[0] = 0;
}

}  // namespace winnow
