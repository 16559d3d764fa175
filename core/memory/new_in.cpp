#include "core/memory/new_in.h"

namespace winnow {

void* allocate_or_null(std::pmr::memory_resource* memory, std::size_t bytes,
                       std::size_t alignment) noexcept {
  try {
    return memory->allocate(bytes, alignment);
  } catch (...) {
    return nullptr;
  }
}

}  // namespace winnow
