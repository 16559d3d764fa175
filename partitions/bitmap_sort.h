#pragma once

#include <winnow/core/column.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Words of scratch that `sort_unique` wants for values below `limit`.
[[nodiscard]] constexpr std::size_t bitmap_words(std::size_t limit) noexcept {
  return limit / 64 + 1;
}

/// Sorts values below `limit` and drops repeats; returns how many are left. O(values + limit / 64)
/// by a bitmap, O(values log values) where that is less. `words` must hold `bitmap_words(limit)`.
inline std::size_t sort_unique(std::span<std::uint32_t> values, std::size_t limit,
                               Column<std::uint64_t>& words) noexcept {
  const std::size_t needed = bitmap_words(limit);
  if (values.size() * 8 < needed) {
    std::sort(values.begin(), values.end());
    return static_cast<std::size_t>(std::unique(values.begin(), values.end()) - values.begin());
  }
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
