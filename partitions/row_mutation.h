#pragma once

// Bulk insert and update of RowPartition from any source of volumes. Included by the source files
// that offer a source, not by headers.

#include <winnow/partitions/row_partition.h>

#include <algorithm>
#include <atomic>

namespace winnow {

inline constexpr std::size_t kEntriesPerTask = 8192;

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

template <typename Source>
Status RowPartition::insert_from(const Source& source, std::size_t count,
                                 std::span<const ClientData> data, std::span<Key> keys) {
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
  for_ranges(execution_, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) source.write(i, columns.pointers, first + i);
  });
  if (count != 0) dirty_.store(true, std::memory_order_relaxed);
  return Status::ok;
}

template <typename Source>
Status RowPartition::update_from(const Source& source, std::size_t count,
                                 std::span<const Key> keys) {
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
  write_rows(source, keys, ascending.load());
  if (count > stale_.limit()) {
    stale_.add_all();
  } else {
    for (const Key key : keys) stale_.add(key.id);
  }
  dirty_.store(true, std::memory_order_relaxed);
  return Status::ok;
}

inline void RowPartition::fetch_row(std::size_t row) const noexcept {
  for (std::size_t c = 0; c < pool_.columns(); ++c) __builtin_prefetch(pool_.column(c) + row, 1);
}

template <typename Source>
void RowPartition::write_rows(const Source& source, std::span<const Key> keys, bool ascending) {
  const PoolColumns columns(pool_);
  const ObjectId first = keys.front().id;
  const std::size_t count = keys.size();
  if (ascending && keys.back().id - first + std::size_t{1} == count && 2 * count > pool_.rows()) {
    // Nearly every row changes and entry i is object first + i: going by rows reads entries out of
    // order but writes each column in order, which is a sixth of the cache lines.
    for_ranges(execution_, pool_.rows(), [&](std::size_t begin, std::size_t end) {
      const ObjectId* const ids = pool_.ids();
      if constexpr (requires { source.packed(); }) {
        const std::size_t whole = end - end % BoundsPool::kBlock;
        if (source.packed()) {
          source.write_rows(first, ids, columns.pointers, begin, whole);
          begin = whole;
        }
      }
      for (std::size_t row = begin; row < end; ++row) {
        const std::size_t i = static_cast<ObjectId>(ids[row] - first);
        if (i < count) source.write(i, columns.pointers, row);
      }
    });
    return;
  }
  const auto write = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (i + kFetchAhead < end) fetch_row(keys_.row_of(keys[i + kFetchAhead].id));
      source.write(i, columns.pointers, keys_.row_of(keys[i].id));
    }
  };
  // Only ascending ids are known to be distinct; a repeated key must be written in order.
  if (ascending) {
    for_ranges(execution_, count, write);
  } else {
    write(0, count);
  }
}

}  // namespace winnow
