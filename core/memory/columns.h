#pragma once

// Operations on several columns of an object at once.

#include <winnow/core/memory.h>

namespace winnow {

template <typename... T>
void release_columns(Column<T>&... columns) noexcept {
  (columns.release(), ...);
}

template <typename... T>
void touch_columns(Column<T>&... columns) noexcept {
  (columns.touch(), ...);
}

template <typename... T>
[[nodiscard]] Bytes bytes_of(const Column<T>&... columns) noexcept {
  Bytes sum;
  ((sum += columns.bytes()), ...);
  return sum;
}

}  // namespace winnow
