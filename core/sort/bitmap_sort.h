#pragma once

#include <winnow/core/column.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Words of a bitmap for values below `limit`, of which 32 bits can be read from any value on.
[[nodiscard]] constexpr std::size_t bitmap_words(std::size_t limit) noexcept {
  return limit / 64 + 2;
}

/// Sorts values below `limit` and drops repeats; returns how many are left. `words` must hold
/// `bitmap_words(limit)` and is left as the bitmap of the values. O(values + limit / 64).
inline std::size_t sort_unique(std::span<std::uint32_t> values, std::size_t limit,
                               Column<std::uint64_t>& words) noexcept {
  const std::size_t needed = bitmap_words(limit);
  std::fill_n(words.data(), needed, 0);
  for (const std::uint32_t v : values) words[v >> 6U] |= std::uint64_t{1} << (v & 63U);
  std::size_t count = 0;
  for (std::size_t w = 0; w < needed; ++w) {
    for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1) {
      values[count++] =
          static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(std::countr_zero(bits));
    }
  }
  return count;
}

}  // namespace winnow
