#pragma once

#include <winnow/core/execution.h>
#include "core/sort/own_rows.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Stable sort of rows by the bucket that each is in. Where a row comes to lie does not depend on
/// the number of threads. Few buckets are long: threads count and place a stretch of the rows each.
/// Of many buckets each thread has some to itself.
class CountingSort {
 public:
  static constexpr std::uint32_t kNone = ~0U;

  /// `bucket` holds the bucket of each row, or kNone for rows to be left out. `start` has one
  /// element more than there are buckets.
  CountingSort(std::span<const std::uint32_t> bucket, std::span<std::uint32_t> start,
               const Execution& execution) noexcept;

  /// Counts the rows in each bucket. O(rows * threads + buckets).
  void count() noexcept;
  /// How many `count` found.
  [[nodiscard]] std::uint32_t size_of(std::size_t bucket) const noexcept { return start_[bucket]; }

  /// Makes of the counts where buckets begin, in `start`; returns how many rows are in buckets.
  std::uint32_t find_starts() noexcept;
  /// Writes the rows in their order; room is what `find_starts` says. Once, after it.
  void place(std::uint32_t* order) noexcept;

 private:
  static constexpr std::size_t kFewBuckets = 256;
  struct Buckets {
    std::size_t first;
    std::size_t end;
  };
  using Counts = std::array<std::uint32_t, kFewBuckets>;

  [[nodiscard]] bool has_few() const noexcept { return buckets_ <= kFewBuckets; }
  template <typename Body>
  void for_each_stretch(Body&& body) const;
  void count_few() noexcept;
  void place_few(std::uint32_t* order) noexcept;
  void place_many(std::uint32_t* order) noexcept;
  [[nodiscard]] Buckets equal_rows(std::size_t owner) const noexcept;

  const std::span<const std::uint32_t> bucket_;
  const std::span<std::uint32_t> start_;
  const Execution& execution_;
  const std::size_t buckets_;
  const std::size_t threads_;
  std::array<Counts, kMostOwners> counts_;  // of stretches
};

}  // namespace winnow
