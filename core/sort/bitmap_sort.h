#pragma once

#include <winnow/core/memory.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Returns the number of 64-bit integers in a bitmap for values below `limit`. It includes padding:
/// callers may read 32 bits from the bit of any value on.
[[nodiscard]] constexpr std::size_t bitmap_words(std::size_t limit) noexcept {
  return limit / 64 + 2;
}

/// Sorts values below `limit` and removes duplicates; returns how many remain. `words` must contain
/// `bitmap_words(limit)` zeros, and contains zeros again on return. O(values + limit / 64), or
/// O(values log values) if there are fewer than about limit / 1024 values.
inline std::size_t sort_unique(std::span<std::uint32_t> values, std::size_t limit,
                               Column<std::uint64_t>& words) noexcept {
  const std::size_t needed = bitmap_words(limit);
  if (16 * values.size() < needed) {
    std::sort(values.begin(), values.end());
    return static_cast<std::size_t>(std::unique(values.begin(), values.end()) - values.begin());
  }
  for (const std::uint32_t v : values) words[v >> 6U] |= std::uint64_t{1} << (v & 63U);
  std::size_t count = 0;
  for (std::size_t w = 0; w < needed; ++w) {
    for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1) {
      values[count++] =
          static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(std::countr_zero(bits));
    }
    words[w] = 0;
  }
  return count;
}

}  // namespace winnow
