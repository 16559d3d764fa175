#pragma once

#include <winnow/core/memory.h>

#include <cstddef>

namespace winnow {

/// Columns below this many bytes may have spare capacity; avoiding it is not worth another
/// allocation.
inline constexpr std::size_t kSmallColumn = std::size_t{1} << 16U;

/// As Column::resize, for columns whose size hardly changes from frame to frame: grows the capacity
/// by a sixteenth instead of a half, or to `count` if that is more, so that less memory stays
/// unused. Small columns grow by a half.
template <typename T>
[[nodiscard]] bool resize_tightly(Column<T>& column, std::size_t count) noexcept {
  if (column.capacity() * sizeof(T) < kSmallColumn) return column.resize(count);
  const std::size_t little_more = column.capacity() + column.capacity() / 16;
  if (count > column.capacity() && !(count < little_more && column.reserve(little_more)) &&
      !column.reserve(count)) {
    return false;
  }
  return column.resize(count);
}

}  // namespace winnow
