#pragma once

// Inserts and updates of rows: the entries that a call gives (UpdateSubset), how boxes are read
// (BoxSource), and the steps (RowInput). PartitionState calls RowInput. Infinite ends become
// +-FLT_MAX (see BoundsPool). Included by source files, not by headers.

#include <winnow/core/execution.h>
#include <winnow/core/key.h>
#include <winnow/core/volumes.h>
#include "core/memory/bounds_pool.h"
#include "core/memory/volume_columns.h"
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

/// The entries of keys and volumes that an update processes: all of them, or a list of indices.
struct UpdateSubset {
  std::span<const Key> keys;
  std::size_t count = 0;
  const std::uint32_t* entry = nullptr;  ///< indices of the entries; null: all

  /// Entries without keys.
  explicit UpdateSubset(std::size_t all) noexcept : count(all) {}
  explicit UpdateSubset(std::span<const Key> all) noexcept : keys(all), count(all.size()) {}
  UpdateSubset(std::span<const Key> all, std::span<const std::uint32_t> indices) noexcept
      : keys(all), count(indices.size()), entry(indices.data()) {}

  [[nodiscard]] std::size_t operator[](std::size_t j) const noexcept {
    return entry == nullptr ? j : entry[j];
  }
  [[nodiscard]] Key key(std::size_t j) const noexcept { return keys[(*this)[j]]; }

  /// Shorter runs are handled entry by entry, because a call per run costs more.
  static constexpr std::size_t kLongRun = 16;

  /// Returns the end, at most `end`, of the longest run of consecutive indices that starts at the
  /// j-th entry.
  [[nodiscard]] std::size_t run_end(std::size_t j, std::size_t end) const noexcept {
    if (entry == nullptr) return end;
    std::size_t next = j + 1;
    while (next < end && entry[next] - entry[j] == next - j) ++next;
    return next;
  }
};

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
      return entries.entry == nullptr
                 ? box_input_kernels().legal(floats + 6 * begin, end - begin)
                 : box_input_kernels().legal_listed(floats, entries.entry + begin, end - begin);
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

class RowInput;

/// How boxes are converted into the stored volume. All functions are null if boxes are stored as
/// given. A program links only the code of the tables that it names.
struct VolumeInput {
  Volume volume;
  Status (*insert)(RowInput&, const BoxView&, std::span<const ClientData>, std::span<Key>);
  Status (*update)(RowInput&, const UpdateSubset&, const BoxView&);
  Status (*update_one)(RowInput&, Key, const BoxView&);
};

/// Inserts objects into rows and updates them. If boxes are not stored as given, VolumeUpdate
/// (volume_update.cpp) does the same for spheres, k-DOPs and fat volumes.
class RowInput {
 public:
  /// Input of boxes that are stored as given, without a margin.
  [[nodiscard]] static const VolumeInput& boxes_as_given() noexcept;
  /// Input of a volume, with or without a margin; null for an invalid volume. Links all volumes.
  [[nodiscard]] static const VolumeInput* of(Volume volume, const FatMargin& fat_margin) noexcept;

  explicit RowInput(Rows& rows) noexcept : rows_(rows) {}

  Status insert(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys);
  Status update(const UpdateSubset& entries, const BoxView& boxes);
  Status update(Key key, const Aabb& box);
  /// As above with spheres or k-DOPs; `unsupported_volume` if another volume is stored.
  template <typename V>
  Status insert(std::span<const V> volumes, std::span<const ClientData> data, std::span<Key> keys);
  template <typename V>
  Status update(std::span<const Key> keys, std::span<const V> volumes);

  /// Returns the status that an update with these boxes would have. Sets `ascending` if the ids
  /// strictly ascend.
  [[nodiscard]] Status check(const UpdateSubset& entries, const BoxView& boxes,
                             bool& ascending) const;
  /// Gives every row the box at the index of its object's id, if there is one.
  void write_by_id(const BoxView& boxes) noexcept;

 protected:
  // Insert.
  [[nodiscard]] Status check_insert(std::size_t count, std::span<const ClientData> data,
                                    std::span<Key> keys) const noexcept;
  [[nodiscard]] Status begin_insert(std::size_t count, std::span<const ClientData> data,
                                    std::span<Key> keys, std::size_t& first);
  /// Writes volume i, its id and its filter to row first + i, for i in [begin, end).
  template <typename Source>
  void write_new(const Source& source, std::span<const Key> keys, std::size_t first,
                 std::size_t begin, std::size_t end) noexcept;

  // Update.
  [[nodiscard]] Status check_keys(std::size_t volumes, const UpdateSubset& entries,
                                  bool& ascending) const;
  [[nodiscard]] bool writes_by_rows(const UpdateSubset& entries, bool ascending,
                                    EntryOfId& entry_of_id);
  /// Writes valid volumes, and notes their objects as changed.
  template <typename Source>
  void write(const Source& source, const UpdateSubset& entries, bool ascending);
  /// Writes every row whose object has an entry.
  template <typename Source>
  void write_by_rows(const Source& source, const EntryOfRow& entry_of);
  template <typename Visit>
  void for_entries(const UpdateSubset& entries, bool ascending, const Visit& visit);
  [[nodiscard]] bool order_is_lost(const SampledBoxes& sample,
                                   std::span<const Key> keys) const noexcept;
  template <typename Source>
  [[nodiscard]] bool loses_order(const Source& source, const UpdateSubset& entries) const noexcept;
  void note_stale(const UpdateSubset& entries) noexcept;

  Rows& rows_;
};

/// True if the update moves most objects far and in different directions (see `order_is_lost`).
/// With few rows the order does not matter.
template <typename Source>
bool RowInput::loses_order(const Source& source, const UpdateSubset& entries) const noexcept {
  constexpr std::size_t kFewRows = 256;
  if (entries.entry != nullptr || entries.count != rows_.keys_.size() || !rows_.regions_.built ||
      !(rows_.order_reach_ > 0.0F) || entries.count < kFewRows) {
    return false;
  }
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

/// Calls visit(entry, its row, j) for the j-th entry. `visit` may set bit j of
/// a bitmap (see for_ranges).
template <typename Visit>
void RowInput::for_entries(const UpdateSubset& entries, bool ascending, const Visit& visit) {
  const std::size_t count = entries.count;
  const KeyTable& keys = rows_.keys_;
  const auto go = [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      if (j + kFetchAhead < end) rows_.fetch_row(keys.row_of(entries.key(j + kFetchAhead).id));
      visit(entries[j], keys.row_of(entries.key(j).id), j);
    }
  };
  // Only ascending ids are certain to be distinct; entries of a repeated key must be written in
  // order.
  if (ascending) {
    for_ranges(rows_.execution_, count, go);
  } else {
    go(0, count);
  }
}

template <typename Source>
void RowInput::write(const Source& source, const UpdateSubset& entries, bool ascending) {
  note_stale(entries);
  EntryOfId entry_of_id{};
  if (!writes_by_rows(entries, ascending, entry_of_id)) {
    const PoolColumns columns(rows_.pool_);
    for_entries(entries, ascending, [&](std::size_t i, std::size_t row, std::size_t) {
      source.write(i, columns.pointers, row);
    });
  } else if (loses_order(source, entries)) {
    // The next refresh builds in any case, so all objects get new rows in the order of the keys,
    // which are written without a search.
    rows_.pool_.clear();
    rows_.pool_.append(entries.count);
    for_ranges(rows_.execution_, entries.count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        rows_.keys_.set_row(entries.keys[i].id, static_cast<std::uint32_t>(i));
      }
      write_new(source, entries.keys, 0, begin, end);
    });
    rows_.invalidate_order();
  } else {
    write_by_rows(source, {entry_of_id, rows_.pool_.ids()});
  }
}

// Packed boxes are written 16 rows at a time.
template <typename Source>
void RowInput::write_by_rows(const Source& source, const EntryOfRow& entry_of) {
  const PoolColumns columns(rows_.pool_);
  for_ranges(rows_.execution_, rows_.pool_.rows(), [&](std::size_t begin, std::size_t end) {
    if constexpr (requires { source.packed(); }) {
      if (source.packed()) {
        const std::size_t whole = end - end % kBlockRows;
        source.write_rows(entry_of.entry_of_id, entry_of.id, columns.pointers, begin, whole);
        begin = whole;
      }
    }
    for (std::size_t row = begin; row < end; ++row) {
      if constexpr (requires { source.fetch(begin); }) {
        const std::size_t ahead = row + kFetchAhead < end ? entry_of[row + kFetchAhead] : kNoObject;
        if (ahead != kNoObject) source.fetch(ahead);
      }
      const std::size_t i = entry_of[row];
      if (i != kNoObject) source.write(i, columns.pointers, row);
    }
  });
}

template <typename Source>
void RowInput::write_new(const Source& source, std::span<const Key> keys, std::size_t first,
                         std::size_t begin, std::size_t end) noexcept {
  const PoolColumns columns(rows_.pool_);
  for (std::size_t i = begin; i < end; ++i) rows_.pool_.ids()[first + i] = keys[i].id;
  for (std::size_t i = begin; i < end && rows_.pool_.has_filters(); ++i) {
    rows_.pool_.set_filter(first + i, rows_.filters_.of(keys[i].id));
  }
  if constexpr (requires { source.packed(); }) {
    if (source.packed()) return source.write_in_order(begin, end, columns.pointers, first + begin);
  }
  for (std::size_t i = begin; i < end; ++i) source.write(i, columns.pointers, first + i);
}

}  // namespace winnow
