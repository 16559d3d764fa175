#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include <winnow/core/key.h>
#include <winnow/core/object_filter.h>
#include <winnow/core/volume.h>
#include "core/memory/filter_columns.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <span>
#include <utility>

namespace winnow {

/// Rows in a block: one 512-bit register of floats, and the unit in which rows are tested.
inline constexpr std::size_t kBlockRows = 16;
[[nodiscard]] constexpr std::size_t blocks_of(std::size_t rows) noexcept {
  return (rows + kBlockRows - 1) / kBlockRows;
}

/// Bounding volumes in a structure of arrays: one float column per slab end (see `column_count`)
/// and a column of object ids, all 64-byte aligned. Rows are dense but for holes that a removal
/// leaves; a hole and the padding behind the last row hold an empty volume, which overlaps nothing,
/// and `kNoObject`. Stored ends are finite (an infinite one becomes +-FLT_MAX, which no comparison
/// can tell from infinity), so that the padding's infinities touch nothing.
///
/// Filters are three further columns, which hold nothing until they come into use. A hole and the
/// padding then are in no layer and want none.
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
  /// By row.
  [[nodiscard]] FilterColumns filters() const noexcept {
    if (!has_filters_) return {};
    return {filters_[kLayers].data(), filters_[kMask].data(), filters_[kEnvironment].data()};
  }
  /// Room for filters of as many rows as there is room for. False, and unchanged, if memory is
  /// refused.
  [[nodiscard]] bool reserve_filters() noexcept;
  /// Filters come into use, with the default in every row. Room was made. O(rows).
  void begin_filters() noexcept;
  /// Filters must be in use.
  void set_filter(std::size_t row, const ObjectFilter& filter) noexcept {
    filters_[kLayers][row] = filter.layers;
    filters_[kMask][row] = filter.mask;
    filters_[kEnvironment][row] = filter.environment;
  }

  /// Room for `rows` rows and their padding. Exact on the first call, growing by half afterwards.
  [[nodiscard]] bool reserve(std::size_t rows) noexcept;
  /// Room for `rows` rows and their padding, no more.
  [[nodiscard]] bool reserve_exact(std::size_t rows) noexcept;
  /// Writes to the pages behind the rows.
  void touch() noexcept;

  /// Adds rows with their contents uninitialised; room must have been reserved.
  void append(std::size_t count) noexcept { rows_ += count; }

  /// Takes the last row away.
  void drop_last() noexcept { --rows_; }

  /// Row `to` becomes what row `from` is.
  void copy_row(std::size_t from, std::size_t to) noexcept;

  /// Empties one row.
  void blank(std::size_t row) noexcept;

  /// Empties the rest of the last block and one block behind it, so that loads may run over.
  void pad() noexcept;

  /// New row i becomes a copy of old row order[i], or empty where order[i] is kNoObject. All
  /// columns go through `spare`, which must have room for order.size() + 2 * kBlockRows elements.
  void reorder(std::span<const std::uint32_t> order, Column<float>& spare,
               const Execution& execution) noexcept;

  /// The same for the rows from `begin` on alone, on the calling thread.
  void reorder_tail(std::size_t begin, std::span<const std::uint32_t> order,
                    Column<float>& spare) noexcept;

  /// No rows are left; memory is kept.
  void clear() noexcept { rows_ = 0; }
  /// Filters are in use no more; memory is kept.
  void end_filters() noexcept { has_filters_ = false; }
  void release() noexcept;
  /// Of volumes and ids.
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

/// The columns of boxes, for kernels.
[[nodiscard]] inline std::array<const float*, 6> box_columns(const BoundsPool& pool) noexcept {
  return {pool.column(0), pool.column(1), pool.column(2),
          pool.column(3), pool.column(4), pool.column(5)};
}

/// What an empty row holds in column `c` of a volume: +infinity in a lower end, -infinity in an
/// upper one; an empty sphere is infinitely far away and has radius 0.
[[nodiscard]] constexpr float empty_value(Volume volume, std::size_t c) noexcept {
  constexpr float inf = std::numeric_limits<float>::infinity();
  if (volume == Volume::sphere && c >= kCenterColumn) return c < kRadiusColumn ? inf : 0.0F;
  const std::size_t slabs = slab_count(volume);
  return c < 3 || (c >= 6 && c < 3 + slabs) ? inf : -inf;
}

}  // namespace winnow
