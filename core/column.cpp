#include <winnow/core/column.h>

namespace winnow {

void* try_allocate(std::pmr::memory_resource& memory, std::size_t bytes,
                   std::size_t alignment) noexcept {
  try {
    return memory.allocate(bytes, alignment);
  } catch (...) {
    return nullptr;
  }
}

}  // namespace winnow
