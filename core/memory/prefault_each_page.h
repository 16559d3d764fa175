#pragma once

#include <cstddef>

namespace winnow {

/// Writes a zero to every page of a memory range, which may begin anywhere in a page; `page` is the
/// size of a page in bytes.
inline void prefault_each_page(void* begin, std::size_t bytes, std::size_t page) noexcept {
  // A compiler would remove non-volatile writes that are never read.
  auto* const memory = static_cast<volatile unsigned char*>(begin);
  for (std::size_t at = 0; at < bytes; at += page) memory[at] = 0;
  if (bytes != 0) memory[bytes - 1] = 0;
}

}  // namespace winnow
