#pragma once

#include <cstddef>

namespace winnow {

/// Writes to every page of memory, wherever in a page it begins; `page` is the bytes of one.
inline void touch_each_page(void* begin, std::size_t bytes, std::size_t page) noexcept {
  // Nobody reads what is written: a compiler would leave it out.
  auto* const memory = static_cast<volatile unsigned char*>(begin);
  for (std::size_t at = 0; at < bytes; at += page) memory[at] = 0;
  if (bytes != 0) memory[bytes - 1] = 0;
}

}  // namespace winnow
