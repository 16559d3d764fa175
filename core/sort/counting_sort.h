#pragma once

#include <winnow/core/column.h>

#include <cstddef>
#include <cstdint>

namespace winnow {

// A counting sort in three steps: `starts` holds the count of each bucket (and one more element);
// these become write positions, which move on as items are placed; at the end they are starts
// again.

/// Turns counts into first positions; returns their sum.
inline std::uint32_t positions_from_counts(Column<std::uint32_t>& starts) noexcept {
  std::uint32_t sum = 0;
  for (std::uint32_t& s : starts) {
    const std::uint32_t count = s;
    s = sum;
    sum += count;
  }
  return sum;
}

/// After placing, each position has moved on to its bucket's end, which is the next one's start.
inline void starts_from_positions(Column<std::uint32_t>& starts) noexcept {
  for (std::size_t c = starts.size() - 1; c > 0; --c) starts[c] = starts[c - 1];
  starts[0] = 0;
}

}  // namespace winnow
