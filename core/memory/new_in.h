#pragma once

#include <winnow/core/column.h>

#include <memory_resource>
#include <new>
#include <utility>

namespace winnow {

/// An object whose memory comes from a resource; null if that refuses. Its constructor must not
/// throw.
template <typename T, typename... Arguments>
[[nodiscard]] T* new_in(std::pmr::memory_resource* memory, Arguments&&... arguments) noexcept {
  void* const place = try_allocate(*memory, sizeof(T), alignof(T));
  return place == nullptr ? nullptr : ::new (place) T(std::forward<Arguments>(arguments)...);
}

/// Ends an object made by `new_in` from the same resource; null does nothing.
template <typename T>
void delete_in(std::pmr::memory_resource* memory, T* object) noexcept {
  if (object == nullptr) return;
  object->~T();
  memory->deallocate(object, sizeof(T), alignof(T));
}

}  // namespace winnow
