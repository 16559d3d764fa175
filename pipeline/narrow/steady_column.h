#pragma once

#include <winnow/core/column.h>

#include <cstddef>

namespace winnow {

/// A column of so many bytes is small: what stands empty in it is not worth another allocation.
inline constexpr std::size_t kSmallColumn = std::size_t{1} << 16U;

/// As Column::resize, for what is about as large in every frame: grows by a sixteenth, where halves
/// would stand empty in all columns from the second frame on; by a half while it is small.
template <typename T>
[[nodiscard]] bool resize_steadily(Column<T>& column, std::size_t count) noexcept {
  if (column.capacity() * sizeof(T) < kSmallColumn) return column.resize(count);
  const std::size_t little_more = column.capacity() + column.capacity() / 16;
  if (count > column.capacity() && !(count < little_more && column.reserve(little_more)) &&
      !column.reserve(count)) {
    return false;
  }
  return column.resize(count);
}

}  // namespace winnow
