#pragma once

#include <winnow/core/execution.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Stable sort of rows by the bucket that each is in. Where a row comes to lie does not depend on
/// the number of threads.
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
  struct Buckets {
    std::size_t first;
    std::size_t end;
  };
  [[nodiscard]] Buckets equal_rows(std::size_t owner) const noexcept;

  const std::span<const std::uint32_t> bucket_;
  const std::span<std::uint32_t> start_;
  const Execution& execution_;
  const std::size_t buckets_;
  const std::size_t owners_;
};

}  // namespace winnow
