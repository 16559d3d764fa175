#pragma once

#include <winnow/core/execution.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Stable sort of rows by the bucket that each is in. Threads count and place a chunk of the rows
/// each; where a row comes to lie does not depend on how many chunks there are.
class CountingSort {
 public:
  static constexpr std::uint32_t kNone = ~0U;

  /// `bucket` holds the bucket of each row, or kNone for rows to be left out. `start` has one
  /// element more than there are buckets. `spare` is what more chunks than one can count in.
  CountingSort(std::span<const std::uint32_t> bucket, std::span<std::uint32_t> start,
               std::span<std::uint32_t> spare, const Execution& execution) noexcept;

  /// Counts the rows in each bucket. O(rows + chunks * buckets).
  void count() noexcept;
  /// How many `count` found.
  [[nodiscard]] std::uint32_t size_of(std::size_t bucket) const noexcept;

  /// Makes of the counts where buckets begin, in `start`; returns how many rows are in buckets.
  std::uint32_t find_starts() noexcept;
  /// Writes the rows in their order; room is what `find_starts` says. Once, after it.
  void place(std::uint32_t* order) noexcept;

 private:
  [[nodiscard]] std::uint32_t* counts_of(std::size_t chunk) const noexcept {
    return chunk == 0 ? start_.data() : spare_.data() + (chunk - 1) * buckets_;
  }
  [[nodiscard]] std::size_t first_row(std::size_t chunk) const noexcept {
    return bucket_.size() * chunk / chunks_;
  }

  const std::span<const std::uint32_t> bucket_;
  const std::span<std::uint32_t> start_;
  const std::span<std::uint32_t> spare_;
  const Execution& execution_;
  const std::size_t buckets_;
  std::size_t chunks_ = 1;
};

}  // namespace winnow
