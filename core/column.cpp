#include <winnow/core/column.h>

#include "core/memory/guarded.h"

namespace winnow {

void* try_allocate(std::pmr::memory_resource& memory, std::size_t bytes,
                   std::size_t alignment) noexcept {
  return guarded([&] { return memory.allocate(bytes, alignment); }, static_cast<void*>(nullptr));
}

void touch_pages(void* begin, std::size_t bytes) noexcept {
  constexpr std::size_t kSmallestPage = 4096;  // of any system
  // Nobody reads what is written: a compiler would leave it out.
  auto* const memory = static_cast<volatile unsigned char*>(begin);
  for (std::size_t at = 0; at < bytes; at += kSmallestPage) memory[at] = 0;
  if (bytes != 0) memory[bytes - 1] = 0;
}

}  // namespace winnow
