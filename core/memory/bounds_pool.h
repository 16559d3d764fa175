#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/filter.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include <winnow/core/volumes.h>
#include "core/memory/filter_columns.h"
#include "core/memory/volume_columns.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <span>
#include <utility>

namespace winnow {

/// Rows in a block: one 512-bit register of floats. Kernels test rows block by block.
inline constexpr std::size_t kBlockRows = 16;
[[nodiscard]] constexpr std::size_t blocks_of(std::size_t rows) noexcept {
  return (rows + kBlockRows - 1) / kBlockRows;
}

/// Bounding volumes as a structure of arrays: one float column per slab end (see `column_count`)
/// and a column of object ids, all 64-byte aligned. Rows are contiguous except for holes that
/// removals leave. Holes, and the padding behind the last row, contain an empty volume, which
/// overlaps nothing, and `kNoObject`. Stored ends are finite, so that they never overlap the
/// infinities of the padding. An infinite end is stored as +-FLT_MAX, which compares with all
/// stored ends as infinity does.
///
/// Filters are three more columns, which are empty until filters are used. Holes and padding then
/// have no layer and an empty mask.
class BoundsPool {
 public:
  BoundsPool(std::pmr::memory_resource* memory, Volume volume) noexcept
      : BoundsPool(memory, volume, std::make_index_sequence<kMaxColumns>{}) {}

  [[nodiscard]] Volume volume() const noexcept { return volume_; }
  [[nodiscard]] std::size_t columns() const noexcept { return column_count(volume_); }
  [[nodiscard]] std::size_t rows() const noexcept { return rows_; }
  [[nodiscard]] std::size_t blocks() const noexcept { return blocks_of(rows_); }
  [[nodiscard]] std::size_t capacity() const noexcept {
    return ids_.capacity() < 2 * kBlockRows ? 0 : ids_.capacity() - 2 * kBlockRows;
  }

  [[nodiscard]] float* column(std::size_t c) noexcept { return columns_[c].data(); }
  [[nodiscard]] const float* column(std::size_t c) const noexcept { return columns_[c].data(); }
  [[nodiscard]] ObjectId* ids() noexcept { return ids_.data(); }
  [[nodiscard]] const ObjectId* ids() const noexcept { return ids_.data(); }

  [[nodiscard]] bool has_filters() const noexcept { return has_filters_; }
  /// Filters indexed by row; null columns if filters are not used.
  [[nodiscard]] FilterColumns filters() const noexcept {
    if (!has_filters_) return {};
    return {filters_[kLayers].data(), filters_[kMask].data(), filters_[kEnvironment].data()};
  }
  /// Reserves room for filters of all rows that fit in the pool. Returns false, and changes
  /// nothing, if memory is refused.
  [[nodiscard]] bool reserve_filters() noexcept;
  /// Starts to use filters, with the default filter for every object; room must be reserved.
  /// O(rows).
  void begin_filters() noexcept;
  /// Sets the filter of a row. Requires that filters are used.
  void set_filter(std::size_t row, const ObjectFilter& filter) noexcept {
    filters_[kLayers][row] = filter.layers;
    filters_[kMask][row] = filter.mask;
    filters_[kEnvironment][row] = filter.environment;
  }

  /// Reserves room for `rows` rows and their padding: exactly on the first call, growing by half
  /// afterwards. Returns false if memory is refused.
  [[nodiscard]] bool reserve(std::size_t rows) noexcept;
  /// Reserves room for `rows` rows and their padding, and no more.
  [[nodiscard]] bool reserve_exact(std::size_t rows) noexcept;
  /// Prefaults the pages behind the rows.
  void touch() noexcept;

  /// Adds rows with uninitialised content; room must be reserved.
  void append(std::size_t count) noexcept { rows_ += count; }

  void drop_last() noexcept { --rows_; }

  void copy_row(std::size_t from, std::size_t to) noexcept;

  /// Makes a row a hole.
  void blank(std::size_t row) noexcept;

  /// Writes the padding: the rest of the last block and one more block, so that loads may run past
  /// the last row.
  void pad() noexcept;

  /// Makes new row i a copy of old row order[i], or a hole if order[i] is kNoObject. All columns
  /// pass through `spare`, which must have room for order.size() + 2 * kBlockRows elements.
  void reorder(std::span<const std::uint32_t> order, Column<float>& spare,
               const Execution& execution) noexcept;

  /// As `reorder`, for the rows from `begin` on only, on the calling thread.
  void reorder_tail(std::size_t begin, std::span<const std::uint32_t> order,
                    Column<float>& spare) noexcept;

  /// Removes all rows; memory is kept.
  void clear() noexcept { rows_ = 0; }
  /// Stops using filters; memory is kept.
  void end_filters() noexcept { has_filters_ = false; }
  void release() noexcept;
  /// Returns the bytes of volumes and ids.
  [[nodiscard]] Bytes bytes() const noexcept;
  [[nodiscard]] Bytes filter_bytes() const noexcept;

 private:
  enum FilterColumn : std::size_t { kLayers, kMask, kEnvironment, kFilterColumns };

  void reorder_ids(std::span<const std::uint32_t> order, Column<float>& spare,
                   const Execution& execution) noexcept;

  template <std::size_t... I>
  BoundsPool(std::pmr::memory_resource* memory, Volume volume, std::index_sequence<I...>) noexcept
      : columns_{((void)I, Column<float>(memory))...},
        ids_(memory),
        filters_{Column<std::uint32_t>(memory), Column<std::uint32_t>(memory),
                 Column<std::uint32_t>(memory)},
        volume_(volume) {}

  std::array<Column<float>, kMaxColumns> columns_;
  Column<ObjectId> ids_;
  std::array<Column<std::uint32_t>, kFilterColumns> filters_;
  std::size_t rows_ = 0;
  bool has_filters_ = false;
  Volume volume_;
};

[[nodiscard]] inline std::array<const float*, 6> box_columns(const BoundsPool& pool) noexcept {
  return {pool.column(0), pool.column(1), pool.column(2),
          pool.column(3), pool.column(4), pool.column(5)};
}

/// Returns the value of column `c` in an empty row: +infinity in a lower end, -infinity in an upper
/// end; an empty sphere has an infinite centre and radius 0.
[[nodiscard]] constexpr float empty_value(Volume volume, std::size_t c) noexcept {
  constexpr float inf = std::numeric_limits<float>::infinity();
  if (volume == Volume::sphere && c >= kCenterColumn) return c < kRadiusColumn ? inf : 0.0F;
  const std::size_t slabs = slab_count(volume);
  return c < 3 || (c >= 6 && c < 3 + slabs) ? inf : -inf;
}

}  // namespace winnow
