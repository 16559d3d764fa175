#pragma once

// Boxes of inserts and updates, and the loops over their entries. Infinite ends become +-FLT_MAX
// (see BoundsPool). Included by source files, not by headers.

#include <winnow/core/box_view.h>
#include <winnow/core/execution.h>
#include <winnow/core/key.h>
#include <winnow/core/volume.h>
#include "core/memory/bounds_pool.h"
#include "core/sort/parallel_ranges.h"
#include "partitions/rows/box_input.kernel.h"
#include "partitions/rows/rows.h"

#include <algorithm>
#include <atomic>
#include <cfloat>
#include <cstddef>
#include <limits>
#include <span>

namespace winnow {

/// One pointer per column.
using ColumnPointers = float* const*;

/// Column pointers of a pool.
struct PoolColumns {
  explicit PoolColumns(BoundsPool& pool) noexcept {
    for (std::size_t c = 0; c < pool.columns(); ++c) pointers[c] = pool.column(c);
  }
  float* pointers[kMaxColumns] = {};
};

inline void write_slab(ColumnPointers columns, std::size_t low_column, std::size_t high_column,
                       std::size_t row, float low, float high) noexcept {
  columns[low_column][row] = std::max(low, -FLT_MAX);
  columns[high_column][row] = std::min(high, FLT_MAX);
}

inline constexpr std::size_t kEntriesPerTask = 8192;

// Prefetch distance, in entries, for boxes and rows that are read in arbitrary order.
inline constexpr std::size_t kFetchAhead = 12;

/// Calls work(begin, end) for ranges that cover [0, count), in parallel. Ranges begin at multiples
/// of 64, so that no two share a block of rows, or a word of a bitmap.
template <typename Work>
void for_ranges(const Execution& execution, std::size_t count, Work&& work) {
  for_each_even_range(execution, count, kEntriesPerTask, work);
}

/// True if all entries are legal.
template <typename Source>
[[nodiscard]] bool all_valid(const Source& source, const UpdateSubset& entries,
                             const Execution& execution) {
  std::atomic<bool> valid{true};
  for_ranges(execution, entries.count, [&](std::size_t begin, std::size_t end) {
    bool ok = true;
    if constexpr (requires { source.valid_entries(entries, begin, end); }) {
      ok = source.valid_entries(entries, begin, end);
    } else {
      for (std::size_t j = begin; j < end; ++j) ok = ok && source.valid(entries[j]);
    }
    if (!ok) valid.store(false, std::memory_order_relaxed);
  });
  return valid.load();
}

/// Maps a row to the entry of its object in an update; kNoObject if it has none.
struct EntryOfRow {
  EntryOfId entry_of_id;
  const ObjectId* id;  ///< by row

  [[nodiscard]] std::size_t operator[](std::size_t row) const noexcept {
    const ObjectId k = id[row] - entry_of_id.first;
    if (k >= entry_of_id.ids) return kNoObject;
    return entry_of_id.table == nullptr ? k : entry_of_id.table[k];
  }
};

/// Writes boxes into AABB columns.
struct BoxSource {
  static constexpr Volume kVolume = Volume::aabb;

  const BoxView& boxes;

  [[nodiscard]] bool valid(std::size_t i) const noexcept {
    constexpr float inf = std::numeric_limits<float>::infinity();
    const Aabb box = boxes[i];
    // Bitwise instead of short-circuit: nearly every box needs all tests.
    int ok = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const float lo = box.min[axis];
      const float hi = box.max[axis];
      ok &= static_cast<int>(lo <= hi) & static_cast<int>(lo < inf) & static_cast<int>(hi > -inf);
    }
    return ok != 0;
  }
  /// True if the boxes are consecutive groups of six floats (min xyz, max xyz).
  [[nodiscard]] bool packed() const noexcept {
    const float* const first = boxes.min[0];
    return boxes.stride == sizeof(Aabb) && boxes.min[1] == first + 1 && boxes.min[2] == first + 2 &&
           boxes.max[0] == first + 3 && boxes.max[1] == first + 4 && boxes.max[2] == first + 5;
  }
  /// True if entries [begin, end) are legal. Tests 16 packed boxes at a time.
  [[nodiscard]] bool valid_entries(const UpdateSubset& entries, std::size_t begin,
                                   std::size_t end) const noexcept {
    if (packed()) {
      const float* const floats = boxes.min[0];
      return entries.number == nullptr
                 ? box_input_kernels().legal(floats + 6 * begin, end - begin)
                 : box_input_kernels().legal_listed(floats, entries.number + begin, end - begin);
    }
    for (std::size_t j = begin; j < end; ++j) {
      if (!valid(entries[j])) return false;
    }
    return true;
  }
  /// Writes the rows of [begin, end) whose objects have an entry; `begin` and `end` are multiples
  /// of 16. Requires packed boxes.
  void write_rows(const EntryOfId& entry_of_id, const ObjectId* ids, ColumnPointers columns,
                  std::size_t begin, std::size_t end) const noexcept {
    box_input_kernels().write_rows(boxes.min[0], entry_of_id, ids, columns, begin, end);
  }
  /// Writes entries [begin, end) to the rows from `row` on. Requires packed boxes.
  void write_in_order(std::size_t begin, std::size_t end, ColumnPointers columns,
                      std::size_t row) const noexcept {
    box_input_kernels().write_in_order(boxes.min[0] + 6 * begin, end - begin, columns, row);
  }
  void write(std::size_t i, ColumnPointers columns, std::size_t row) const noexcept {
    const Aabb box = boxes[i];
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      write_slab(columns, a, 3 + a, row, box.min[axis], box.max[axis]);
    }
  }
};

/// The boxes of a sample of entries at even distances.
struct SampledBoxes {
  static constexpr std::size_t kSize = 64;
  float box[kSize][6];  ///< lower, then upper ends

  [[nodiscard]] static std::size_t entry(std::size_t k, std::size_t count) noexcept {
    return count * k / kSize;
  }
};

/// True if the update moves most objects far and in different directions (see `order_is_lost`).
template <typename Source>
bool Rows::loses_order(const Source& source, const UpdateSubset& entries) const noexcept {
  if (!may_lose_order(entries)) return false;
  SampledBoxes sample;
  float volume[kMaxColumns];
  float* columns[kMaxColumns];
  for (std::size_t c = 0; c < kMaxColumns; ++c) columns[c] = volume + c;
  for (std::size_t k = 0; k < SampledBoxes::kSize; ++k) {
    source.write(SampledBoxes::entry(k, entries.count), columns, 0);
    std::copy_n(volume, 6, sample.box[k]);
  }
  return order_is_lost(sample, entries.keys);
}

/// Calls visit(entry, its row, j) for the j-th entry; `visit` may set bit j of a bitmap (see
/// `for_ranges`).
template <typename Visit>
void Rows::for_entries(const UpdateSubset& entries, bool ascending, const Visit& visit) {
  const std::size_t count = entries.count;
  const auto go = [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      if (j + kFetchAhead < end) fetch_row(keys_.row_of(entries.key(j + kFetchAhead).id));
      visit(entries[j], keys_.row_of(entries.key(j).id), j);
    }
  };
  // Only ascending ids are certain to be distinct; entries of a repeated key must be written in
  // order.
  if (ascending) {
    for_ranges(execution_, count, go);
  } else {
    go(0, count);
  }
}

}  // namespace winnow
