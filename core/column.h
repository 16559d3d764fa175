#pragma once

#include <winnow/core/export.h>
#include <winnow/core/footprint.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory_resource>
#include <new>
#include <type_traits>
#include <utility>

namespace winnow {

/// `memory.allocate(bytes, alignment)`, or null if the resource throws.
[[nodiscard]] WINNOW_API void* try_allocate(std::pmr::memory_resource& memory, std::size_t bytes,
                                            std::size_t alignment) noexcept;

/// Whether memory that is made ready is written to as well, once on each page: who uses it first
/// then waits for no page of the system.
enum class Pages : std::uint8_t {
  untouched,  ///< asked for alone
  touched,    ///< and written to
};

/// Writes to every page of memory that holds nothing yet.
WINNOW_API void touch_pages(void* begin, std::size_t bytes) noexcept;

/// The memory of a column: where its elements lie, and how many there is room for.
struct ColumnRoom {
  void* data = nullptr;      ///< null while nothing was allocated
  std::size_t capacity = 0;  ///< in elements
};

/// Room for at least `count` elements of `element` bytes, in whole lines. The first `size` elements
/// of the old room are moved there, and it is given back. Null data, and the old room as it was, if
/// the resource refuses. O(size).
[[nodiscard]] WINNOW_API ColumnRoom move_to_room(std::pmr::memory_resource& memory, ColumnRoom old,
                                                 std::size_t size, std::size_t count,
                                                 std::size_t element) noexcept;

/// The same room, half as large again at least if the resource does not refuse that.
[[nodiscard]] WINNOW_API ColumnRoom grow_room(std::pmr::memory_resource& memory, ColumnRoom old,
                                              std::size_t size, std::size_t count,
                                              std::size_t element) noexcept;

/// Gives a room back, if it is one.
WINNOW_API void release_room(std::pmr::memory_resource& memory, ColumnRoom room,
                             std::size_t element) noexcept;

/// One column of a structure of arrays: 64-byte aligned, its memory a whole number of 64-byte
/// lines, growth reported instead of thrown. `std::pmr::vector` asks its resource only for
/// alignof(T), hence this type. Elements past `size()` up to `capacity()` are uninitialised.
template <typename T>
class Column {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Bytes; a cache line, and a register of the widest instruction set.
  static constexpr std::size_t kAlignment = 64;
  /// Elements whose bytes, in whole lines, can be counted.
  static constexpr std::size_t kMost = (~std::size_t{0} - kAlignment + 1) / sizeof(T);

  /// An empty column. Every allocation comes from `memory`, which must outlive it.
  explicit Column(std::pmr::memory_resource* memory) noexcept : memory_(memory) {}
  /// Takes over the elements and the resource; `other` is left empty.
  Column(Column&& other) noexcept
      : memory_(other.memory_),
        data_(std::exchange(other.data_, nullptr)),
        size_(std::exchange(other.size_, 0)),
        capacity_(std::exchange(other.capacity_, 0)) {}
  Column(const Column&) = delete;
  Column& operator=(const Column&) = delete;
  Column& operator=(Column&&) = delete;
  ~Column() { release_room(*memory_, room(), sizeof(T)); }

  /// The first element; null while nothing was allocated.
  [[nodiscard]] T* data() noexcept { return data_; }
  /// The first element; null while nothing was allocated.
  [[nodiscard]] const T* data() const noexcept { return data_; }
  /// Elements in use.
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// Elements that there is room for.
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
  /// True without elements in use, whatever the capacity.
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  /// Element i, below `capacity()`; nothing is checked.
  [[nodiscard]] T& operator[](std::size_t i) noexcept { return data_[i]; }
  /// Element i, below `capacity()`; nothing is checked.
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data_[i]; }
  /// The first element in use.
  [[nodiscard]] T* begin() noexcept { return data_; }
  /// Behind the last element in use.
  [[nodiscard]] T* end() noexcept { return data_ + size_; }
  /// The first element in use.
  [[nodiscard]] const T* begin() const noexcept { return data_; }
  /// Behind the last element in use.
  [[nodiscard]] const T* end() const noexcept { return data_ + size_; }

  /// Room for at least `count` elements, no more than the next full line. False, and unchanged, if
  /// the resource refuses.
  [[nodiscard]] bool reserve(std::size_t count) noexcept {
    return count <= capacity_ || take(move_to_room(*memory_, room(), size_, count, sizeof(T)));
  }

  /// The same; touched, if it shall be, is all room behind the last element.
  [[nodiscard]] bool reserve(std::size_t count, Pages pages) noexcept {
    if (!reserve(count)) return false;
    if (pages == Pages::touched) touch();
    return true;
  }

  /// Writes to the pages behind the last element.
  void touch() noexcept { touch_pages(data_ + size_, capacity_bytes() - size_ * sizeof(T)); }

  /// As `reserve`, but grows by half at least, so that repeated growth costs O(1) per element.
  [[nodiscard]] bool grow(std::size_t count) noexcept {
    return count <= capacity_ || take(grow_room(*memory_, room(), size_, count, sizeof(T)));
  }

  /// Room for `count` elements but not for fewer than are in use, and no more than the next full
  /// line. False, and unchanged, if the resource refuses.
  [[nodiscard]] bool shrink(std::size_t count) noexcept {
    const std::size_t kept = count < size_ ? size_ : count;
    if (kept >= capacity_) return true;
    if (kept != 0) return take(move_to_room(*memory_, room(), size_, kept, sizeof(T)));
    release();
    return true;
  }

  /// Sets the size; the room must have been reserved. New elements are uninitialised.
  void set_size(std::size_t count) noexcept { size_ = count; }

  /// Resizes and, on growth, leaves the new elements uninitialised.
  [[nodiscard]] bool resize(std::size_t count) noexcept {
    if (!grow(count)) return false;
    size_ = count;
    return true;
  }

  /// Adds an element. False, and unchanged, if memory is refused. O(1) but for growth.
  [[nodiscard]] bool push_back(const T& value) noexcept {
    if (size_ == capacity_ && !grow(size_ + 1)) return false;
    data_[size_++] = value;
    return true;
  }

  /// No elements are in use any more; memory is kept.
  void clear() noexcept { size_ = 0; }

  /// Gives the memory back.
  void release() noexcept {
    release_room(*memory_, room(), sizeof(T));
    data_ = nullptr;
    size_ = capacity_ = 0;
  }

  /// Exchanges contents with a column of the same memory resource.
  void swap(Column& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  /// Where its memory comes from.
  [[nodiscard]] std::pmr::memory_resource* memory() const noexcept { return memory_; }
  /// Bytes of elements in use, and of all that it holds.
  [[nodiscard]] Bytes bytes() const noexcept { return {size_ * sizeof(T), capacity_bytes()}; }

 private:
  // The request was a whole number of lines and sizeof(T) need not divide a line.
  [[nodiscard]] std::size_t capacity_bytes() const noexcept {
    return (capacity_ * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
  }

  [[nodiscard]] ColumnRoom room() const noexcept { return {data_, capacity_}; }
  /// False, and unchanged, if it is none.
  [[nodiscard]] bool take(ColumnRoom room) noexcept {
    if (room.data == nullptr) return false;
    data_ = static_cast<T*>(room.data);
    capacity_ = room.capacity;
    return true;
  }

  std::pmr::memory_resource* memory_;
  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace winnow
