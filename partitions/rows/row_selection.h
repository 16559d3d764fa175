#pragma once

#include "core/memory/columns.h"
#include "core/sort/bitmap_sort.h"

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Some of the rows, or blocks, of a partition: a list, and a bitmap of the same.
struct RowSelection {
  explicit RowSelection(std::pmr::memory_resource* memory) noexcept : list(memory), bits(memory) {}

  /// Empties the list and makes room for `most` entries. False if memory is refused.
  [[nodiscard]] bool start(std::size_t most) noexcept {
    list.clear();
    return list.grow(most);
  }
  /// Adds to the list, where room was made.
  void add(std::size_t entry) noexcept { (void)list.push_back(static_cast<std::uint32_t>(entry)); }
  /// Room for a bitmap of entries below `limit`. False if memory is refused.
  [[nodiscard]] bool reserve_bits(std::size_t limit) noexcept {
    return bits.grow(bitmap_words(limit));
  }
  /// Sorts the list, whose entries are below `limit`, drops repeats, and makes the bitmap of it,
  /// for which room was made. O(entries + limit / 64).
  void sort(std::size_t limit) noexcept { list.set_size(sort_unique(entries(), limit, bits)); }

  [[nodiscard]] std::span<std::uint32_t> entries() noexcept { return {list.data(), list.size()}; }

  void release() noexcept { release_columns(list, bits); }
  [[nodiscard]] Bytes bytes() const noexcept { return bytes_of(list, bits); }

  Column<std::uint32_t> list;
  Column<std::uint64_t> bits;
};

}  // namespace winnow
