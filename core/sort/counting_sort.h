#pragma once

#include <winnow/core/execution.h>
#include "core/sort/scatter_by_owner.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Stable sort of rows by bucket. The result does not depend on the number of threads. If there are
/// at most 256 buckets, each thread counts and places a range of rows. If there are more, each
/// thread owns some buckets.
class CountingSort {
 public:
  static constexpr std::uint32_t kNone = ~0U;

  /// `bucket` contains the bucket of each row, or kNone for rows that are left out. `start` has one
  /// element more than there are buckets.
  CountingSort(std::span<const std::uint32_t> bucket, std::span<std::uint32_t> start,
               const Execution& execution) noexcept;

  /// Counts the rows in each bucket. O(rows * threads + buckets).
  void count() noexcept;
  /// Returns the number of rows that `count` found in a bucket.
  [[nodiscard]] std::uint32_t size_of(std::size_t bucket) const noexcept { return start_[bucket]; }

  /// Replaces the counts in `start` by the beginnings of the buckets; returns the number of rows in
  /// all buckets.
  std::uint32_t find_starts() noexcept;
  /// Writes the rows in sorted order. `order` must have room for the number that `find_starts`
  /// returned. Call once, after `find_starts`.
  void place(std::uint32_t* order) noexcept;

 private:
  static constexpr std::size_t kFewBuckets = 256;
  struct BucketRange {
    std::size_t first;
    std::size_t end;
  };
  using Counts = std::array<std::uint32_t, kFewBuckets>;

  [[nodiscard]] bool has_few() const noexcept { return buckets_ <= kFewBuckets; }
  template <typename Body>
  void for_each_row_range(Body&& body) const;
  void count_few() noexcept;
  void place_few(std::uint32_t* order) noexcept;
  void place_many(std::uint32_t* order) noexcept;
  [[nodiscard]] BucketRange buckets_of_owner(std::size_t owner) const noexcept;

  const std::span<const std::uint32_t> bucket_;
  const std::span<std::uint32_t> start_;
  const Execution& execution_;
  const std::size_t buckets_;
  const std::size_t threads_;
  std::array<Counts, kMaxOwners> counts_;  // one per range of rows
};

}  // namespace winnow
