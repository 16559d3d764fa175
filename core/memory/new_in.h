#pragma once

#include <winnow/core/memory.h>

#include <memory_resource>
#include <new>
#include <utility>

namespace winnow {

/// Creates an object in memory of a resource; returns null if the resource refuses. The constructor
/// must not throw.
template <typename T, typename... Arguments>
[[nodiscard]] T* new_in(std::pmr::memory_resource* memory, Arguments&&... arguments) noexcept {
  void* const place = detail::try_allocate(*memory, sizeof(T), alignof(T));
  return place == nullptr ? nullptr : ::new (place) T(std::forward<Arguments>(arguments)...);
}

/// Destroys an object that `new_in` created with the same resource; ignores null.
template <typename T>
void delete_in(std::pmr::memory_resource* memory, T* object) noexcept {
  if (object == nullptr) return;
  object->~T();
  memory->deallocate(object, sizeof(T), alignof(T));
}

}  // namespace winnow
