#include <winnow/core/memory.h>

#include "core/memory/catch_bad_alloc.h"
#include "core/memory/prefault_each_page.h"

#include <cstring>

namespace winnow {
namespace {

constexpr std::size_t kLine = Column<std::byte>::kAlignment;

/// Returns the bytes of `count` elements, rounded up to whole lines.
std::size_t whole_lines(std::size_t count, std::size_t element) noexcept {
  return (count * element + kLine - 1) / kLine * kLine;
}

}  // namespace

namespace detail {

void* try_allocate(std::pmr::memory_resource& memory, std::size_t bytes,
                   std::size_t alignment) noexcept {
  return catch_bad_alloc([&] { return memory.allocate(bytes, alignment); },
                         static_cast<void*>(nullptr));
}

void prefault_pages(void* begin, std::size_t bytes) noexcept {
  constexpr std::size_t kSmallestPage = 4096;  // on all supported systems
  prefault_each_page(begin, bytes, kSmallestPage);
}

ColumnBlock reallocate_block(std::pmr::memory_resource& memory, ColumnBlock old, std::size_t size,
                             std::size_t count, std::size_t element) noexcept {
  if (count > Column<std::byte>::kMaxSize / element) return {};
  const std::size_t bytes = whole_lines(count, element);
  void* const fresh = try_allocate(memory, bytes, kLine);
  if (fresh == nullptr) return {};
  if (size != 0) std::memcpy(fresh, old.data, size * element);
  free_block(memory, old, element);
  return {fresh, bytes / element};
}

ColumnBlock grow_block(std::pmr::memory_resource& memory, ColumnBlock old, std::size_t size,
                       std::size_t count, std::size_t element) noexcept {
  const std::size_t half_more = old.capacity + old.capacity / 2;
  if (count < half_more) {
    const ColumnBlock room = reallocate_block(memory, old, size, half_more, element);
    if (room.data != nullptr) return room;
  }
  return reallocate_block(memory, old, size, count, element);
}

void free_block(std::pmr::memory_resource& memory, ColumnBlock room, std::size_t element) noexcept {
  if (room.data == nullptr) return;
  memory.deallocate(room.data, whole_lines(room.capacity, element), kLine);
}

}  // namespace detail

}  // namespace winnow
