#pragma once

#include "core/memory/columns.h"
#include "core/sort/bitmap_sort.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// A selection of rows or blocks: a list, and a bitmap that is all zero except while a function
/// uses it. Functions that set bits clear them again (`mark` and `unmark`).
struct RowSelection {
  explicit RowSelection(std::pmr::memory_resource* memory) noexcept : list(memory), bits(memory) {}

  /// Empties the list and makes room for `most` entries. False if memory is refused.
  [[nodiscard]] bool start(std::size_t most) noexcept {
    list.clear();
    return list.grow(most);
  }
  /// Requires room for the entry.
  void add(std::size_t entry) noexcept { (void)list.push_back(static_cast<std::uint32_t>(entry)); }
  /// Makes room for a bitmap of entries below `limit`. False if memory is refused.
  [[nodiscard]] bool reserve_bits(std::size_t limit) noexcept {
    const std::size_t words = bitmap_words(limit);
    if (!bits.grow(words)) return false;
    if (words <= bits.size()) return true;
    std::fill(bits.end(), bits.data() + words, 0);
    bits.set_size(words);
    return true;
  }
  /// Sorts the list and drops duplicates. Entries are below `limit`, for which `reserve_bits` was
  /// called. O(entries + limit / 64), or O(entries log entries) for few entries (see
  /// `sort_unique`).
  void sort(std::size_t limit) noexcept { list.set_size(sort_unique(entries(), limit, bits)); }
  /// Sets the bits of the entries. Requires room.
  void mark() noexcept {
    for (const std::uint32_t entry : list) bits[entry >> 6U] |= std::uint64_t{1} << (entry & 63U);
  }
  /// Clears these bits. O(entries).
  void unmark() noexcept {
    for (const std::uint32_t entry : list) bits[entry >> 6U] = 0;
  }

  [[nodiscard]] std::span<std::uint32_t> entries() noexcept { return {list.data(), list.size()}; }

  void release() noexcept { release_columns(list, bits); }
  [[nodiscard]] Bytes bytes() const noexcept { return bytes_of(list, bits); }

  Column<std::uint32_t> list;
  Column<std::uint64_t> bits;
};

}  // namespace winnow
