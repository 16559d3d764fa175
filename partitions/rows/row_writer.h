#pragma once

// How Rows takes volumes in bulk from any source. Included by the source files that offer a source,
// not by headers.

#include "partitions/rows/fat_volumes.h"
#include "partitions/rows/rows.h"

#include <algorithm>
#include <atomic>
#include <bit>

namespace winnow {

inline constexpr std::size_t kEntriesPerTask = 8192;

// Rows whose entries are brought together before they are looked at: a few cache lines per column.
inline constexpr std::size_t kRowsAtOnce = 256;

// How many entries ahead of their turn rows are fetched into the cache: each lies in as many cache
// lines as it has columns, anywhere in the pool.
inline constexpr std::size_t kFetchAhead = 12;

/// The columns of a pool as the sources want them.
struct PoolColumns {
  explicit PoolColumns(BoundsPool& pool) noexcept {
    for (std::size_t c = 0; c < pool.columns(); ++c) pointers[c] = pool.column(c);
  }
  float* pointers[kMaxColumns] = {};
};

/// Calls work(begin, end) over ranges of [0, count).
template <typename Work>
void for_ranges(const Execution& execution, std::size_t count, Work&& work) {
  execution.for_each((count + kEntriesPerTask - 1) / kEntriesPerTask, [&](std::size_t task) {
    work(task * kEntriesPerTask, std::min(count, (task + 1) * kEntriesPerTask));
  });
}

template <typename Source>
bool all_valid(const Source& source, std::size_t count, const Execution& execution) {
  std::atomic<bool> valid{true};
  for_ranges(execution, count, [&](std::size_t begin, std::size_t end) {
    bool ok = true;
    if constexpr (requires { source.valid_range(begin, end); }) {
      ok = source.valid_range(begin, end);
    } else {
      for (std::size_t i = begin; i < end; ++i) ok = ok && source.valid(i);
    }
    if (!ok) valid.store(false, std::memory_order_relaxed);
  });
  return valid.load();
}

/// True if a row's volume may stay as it is though the source offers another.
template <typename Source>
inline constexpr bool kMayStay = requires(const Source& source) {
  source.write_if_left(0, ColumnPointers{}, 0);
};

/// Calls use(source) with the source itself or, if volumes are stored larger, with one that makes
/// them so.
template <typename Source, typename Use>
Status Rows::with_margin(const Source& source, Use&& use) {
  if (margin_.is_none()) return use(source);
  return use(FatSource<Source>{source, margin_});
}

template <typename Source>
Status Rows::insert_from(const Source& source, std::size_t count, std::span<const ClientData> data,
                         std::span<Key> keys) {
  if (keys.size() != count || (!data.empty() && data.size() != count)) return Status::size_mismatch;
  if (count > kMaxObjects - keys_.size()) return Status::too_many_objects;
  if (!all_valid(source, count, execution_)) return Status::invalid_bounds;
  if (!make_room(keys_.size() + count)) return Status::out_of_memory;
  const std::size_t first = pool_.rows();
  pool_.append(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<std::uint32_t>(first + i);
    keys[i] = keys_.acquire(row, data.empty() ? 0 : data[i]);
    pool_.ids()[row] = keys[i].id;
    stale_.add(keys[i].id);
  }
  const PoolColumns columns(pool_);
  return with_margin(source, [&](const auto& volumes) {
    for_ranges(execution_, count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) volumes.write(i, columns.pointers, first + i);
    });
    changed_ = changed_ || count != 0;
    return Status::ok;
  });
}

template <typename Source>
Status Rows::update_from(const Source& source, std::size_t count, std::span<const Key> keys) {
  if (keys.size() != count) return Status::size_mismatch;
  std::atomic<bool> known{true};
  std::atomic<bool> ascending{true};
  for_ranges(execution_, count, [&](std::size_t begin, std::size_t end) {
    bool ok = true;
    bool up = true;
    for (std::size_t i = begin; i < end; ++i) {
      ok = ok && keys_.is_valid(keys[i]);
      up = up && (i == 0 || keys[i - 1].id < keys[i].id);
    }
    if (!ok) known.store(false, std::memory_order_relaxed);
    if (!up) ascending.store(false, std::memory_order_relaxed);
  });
  if (!known.load()) return Status::invalid_key;
  if (!all_valid(source, count, execution_)) return Status::invalid_bounds;
  if (count == 0) return Status::ok;
  return with_margin(source,
                     [&](const auto& volumes) { return write(volumes, keys, ascending.load()); });
}

template <typename Source>
Status Rows::update_one(const Source& source, Key key) {
  if (!source.valid(0)) return Status::invalid_bounds;
  return with_margin(source, [&](const auto& volumes) {
    const PoolColumns columns(pool_);
    const std::size_t row = keys_.row_of(key.id);
    if constexpr (requires { volumes.write_if_left(0, columns.pointers, row); }) {
      if (!volumes.write_if_left(0, columns.pointers, row)) return Status::ok;
    } else {
      volumes.write(0, columns.pointers, row);
    }
    stale_.add(key.id);
    changed_ = true;
    return Status::ok;
  });
}

inline void Rows::fetch_row(std::size_t row) const noexcept {
  for (std::size_t c = 0; c < pool_.columns(); ++c) __builtin_prefetch(pool_.column(c) + row, 1);
}

template <typename Source>
Status Rows::write(const Source& source, std::span<const Key> keys, bool ascending) {
  const PoolColumns columns(pool_);
  const std::size_t count = keys.size();
  // Nearly every row changes and entry i is object first + i.
  const bool by_rows = ascending && keys.back().id - keys.front().id + std::size_t{1} == count &&
                       2 * count > pool_.rows();
  if constexpr (kMayStay<Source>) {
    const std::size_t slots = by_rows ? pool_.rows() : count;
    if (!selection_.reserve_bits(slots)) return Status::out_of_memory;
    std::uint64_t* const left = selection_.bits.data();
    std::fill_n(left, bitmap_words(slots), 0);
    const auto one = [&](std::size_t i, std::size_t row, std::size_t slot) {
      const bool wrote = source.write_if_left(i, columns.pointers, row);
      left[slot >> 6U] |= std::uint64_t{wrote} << (slot & 63U);
    };
    if constexpr (Source::kVolume == Volume::aabb) {
      if (by_rows) {
        write_left_boxes(source, keys);
      } else {
        for_entries(source, keys, by_rows, ascending, one);
      }
    } else {
      for_entries(source, keys, by_rows, ascending, one);
    }
    note_left(keys, by_rows, slots);
    return Status::ok;
  } else {
    for_entries(source, keys, by_rows, ascending, [&](std::size_t i, std::size_t row, std::size_t) {
      source.write(i, columns.pointers, row);
    });
    if (count > stale_.limit()) {
      stale_.add_all();
    } else {
      for (const Key key : keys) stale_.add(key.id);
    }
    changed_ = true;
    return Status::ok;
  }
}

/// Of boxes that go by rows: writes those of rows [begin, end) that left their stored ones, and
/// sets their rows' bits in the selection. Most have not: that is found for 16 at a time.
template <typename Source>
void Rows::write_left_boxes(const Source& source, std::span<const Key> keys) {
  for_ranges(execution_, pool_.rows(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; row += kRowsAtOnce) {
      write_left(source, keys, row, std::min(end, row + kRowsAtOnce));
    }
  });
}
template <typename Source>
void Rows::write_left(const Source& source, std::span<const Key> keys, std::size_t begin,
                      std::size_t end) {
  const PoolColumns columns(pool_);
  const ObjectId* const ids = pool_.ids();
  alignas(64) float given[6][kRowsAtOnce];
  float* given_columns[6];
  const float* stored[6];
  for (std::size_t c = 0; c < 6; ++c) {
    given_columns[c] = given[c];
    stored[c] = columns.pointers[c] + begin;
  }
  std::size_t written = 0;
  if (source.source.packed()) {
    written = (end - begin) / kBlockRows * kBlockRows;
    source.source.write_rows(keys.front().id, ids + begin, given_columns, 0, written);
  }
  std::uint64_t asked[kRowsAtOnce / 64] = {};
  for (std::size_t k = 0; k < end - begin; ++k) {
    const std::size_t i = static_cast<ObjectId>(ids[begin + k] - keys.front().id);
    asked[k / 64] |= std::uint64_t{i < keys.size()} << (k % 64);
    if (k >= written && i < keys.size()) source.source.write(i, given_columns, k);
  }
  std::uint64_t within[kRowsAtOnce / 64] = {};
  box_input_kernels().within(given_columns, stored, end - begin, margin_.distance, margin_.share,
                             within);
  for (std::size_t w = 0; w < kRowsAtOnce / 64; ++w) {
    for (std::uint64_t out = asked[w] & ~within[w]; out != 0; out &= out - 1) {
      const std::size_t k = 64 * w + static_cast<std::size_t>(std::countr_zero(out));
      const std::size_t i = static_cast<ObjectId>(ids[begin + k] - keys.front().id);
      if (!source.write_if_left(i, columns.pointers, begin + k)) continue;
      selection_.bits.data()[begin / 64 + w] |= std::uint64_t{1} << (k % 64);
    }
  }
}

/// Notes the objects whose bits are set in the selection as changed: those of rows, or of entries.
inline void Rows::note_left(std::span<const Key> keys, bool by_rows, std::size_t slots) noexcept {
  bool any = false;
  for (std::size_t w = 0; w < bitmap_words(slots); ++w) {
    for (std::uint64_t bits = selection_.bits.data()[w]; bits != 0; bits &= bits - 1) {
      const std::size_t slot = 64 * w + static_cast<std::size_t>(std::countr_zero(bits));
      stale_.add(by_rows ? pool_.ids()[slot] : keys[slot].id);
      any = true;
    }
  }
  if (any) changed_ = true;
}

/// Calls visit(i, row, slot) for every entry i and its row. No two threads meet in 64 slots that
/// follow each other: slots are rows, if it goes by rows, else entries.
template <typename Source, typename Visit>
void Rows::for_entries(const Source& source, std::span<const Key> keys, bool by_rows,
                       bool ascending, const Visit& visit) {
  const ObjectId first = keys.front().id;
  const std::size_t count = keys.size();
  if (by_rows) {
    // Going by rows reads entries out of order but writes each column in order, which is a sixth of
    // the cache lines.
    for_ranges(execution_, pool_.rows(), [&](std::size_t begin, std::size_t end) {
      const ObjectId* const ids = pool_.ids();
      if constexpr (requires { source.packed(); }) {
        // Not visited but written in registers.
        const std::size_t whole = end - end % kBlockRows;
        if (source.packed()) {
          source.write_rows(first, ids, PoolColumns(pool_).pointers, begin, whole);
          begin = whole;
        }
      }
      for (std::size_t row = begin; row < end; ++row) {
        const std::size_t i = static_cast<ObjectId>(ids[row] - first);
        if (i < count) visit(i, row, row);
      }
    });
    return;
  }
  const auto go = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (i + kFetchAhead < end) fetch_row(keys_.row_of(keys[i + kFetchAhead].id));
      visit(i, keys_.row_of(keys[i].id), i);
    }
  };
  // Only ascending ids are known to be distinct; a repeated key must be written in order.
  if (ascending) {
    for_ranges(execution_, count, go);
  } else {
    go(0, count);
  }
}

}  // namespace winnow
