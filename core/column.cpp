#include <winnow/core/column.h>

#include "core/memory/guarded.h"
#include "core/memory/touch_each_page.h"

namespace winnow {
namespace {

constexpr std::size_t kLine = Column<std::byte>::kAlignment;

/// Size of an allocation in bytes; the size of an element need not divide a line.
std::size_t whole_lines(std::size_t count, std::size_t element) noexcept {
  return (count * element + kLine - 1) / kLine * kLine;
}

}  // namespace

void* try_allocate(std::pmr::memory_resource& memory, std::size_t bytes,
                   std::size_t alignment) noexcept {
  return guarded([&] { return memory.allocate(bytes, alignment); }, static_cast<void*>(nullptr));
}

void touch_pages(void* begin, std::size_t bytes) noexcept {
  constexpr std::size_t kSmallestPage = 4096;  // on all supported systems
  touch_each_page(begin, bytes, kSmallestPage);
}

ColumnRoom move_to_room(std::pmr::memory_resource& memory, ColumnRoom old, std::size_t size,
                        std::size_t count, std::size_t element) noexcept {
  if (count > Column<std::byte>::kMost / element) return {};
  const std::size_t bytes = whole_lines(count, element);
  void* const fresh = try_allocate(memory, bytes, kLine);
  if (fresh == nullptr) return {};
  if (size != 0) std::memcpy(fresh, old.data, size * element);
  release_room(memory, old, element);
  return {fresh, bytes / element};
}

ColumnRoom grow_room(std::pmr::memory_resource& memory, ColumnRoom old, std::size_t size,
                     std::size_t count, std::size_t element) noexcept {
  const std::size_t half_more = old.capacity + old.capacity / 2;
  if (count < half_more) {
    const ColumnRoom room = move_to_room(memory, old, size, half_more, element);
    if (room.data != nullptr) return room;
  }
  return move_to_room(memory, old, size, count, element);
}

void release_room(std::pmr::memory_resource& memory, ColumnRoom room,
                  std::size_t element) noexcept {
  if (room.data == nullptr) return;
  memory.deallocate(room.data, whole_lines(room.capacity, element), kLine);
}

}  // namespace winnow
