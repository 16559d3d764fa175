#pragma once

// Memory of the caller's resource: Column, the growable array in which winnow stores all its rows,
// pairs and hits; LargePages, the default resource; and Footprint, the bytes of an object by
// purpose.

#include <winnow/core/export.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory_resource>
#include <type_traits>
#include <utility>

namespace winnow {

/// Bytes of one purpose: `used` is live content, `reserved` is allocated from the memory resource.
struct Bytes {
  std::size_t used = 0;      ///< bytes with content
  std::size_t reserved = 0;  ///< bytes allocated, with content or not

  /// Adds both members.
  Bytes& operator+=(const Bytes& other) noexcept {
    used += other.used;
    reserved += other.reserved;
    return *this;
  }
  /// True if both members are equal.
  friend bool operator==(const Bytes&, const Bytes&) noexcept = default;
};

/// Bytes by purpose. The sum of `reserved` equals, to the byte, the memory outstanding at the
/// memory resource; the object itself (its sizeof) is not included.
struct Footprint {
  Bytes bounds;       ///< bounding-volume columns
  Bytes keys;         ///< slots, generations and row maps
  Bytes client_data;  ///< client data of all objects
  Bytes structure;    ///< cells, nodes and sort orders of the partition
  Bytes scratch;      ///< buffers kept from frame to frame
  Bytes results;      ///< pairs, hits, contacts and other results

  /// Returns the sum over all purposes.
  [[nodiscard]] Bytes total() const noexcept {
    Bytes sum;
    for (const Bytes* part : {&bounds, &keys, &client_data, &structure, &scratch, &results}) {
      sum += *part;
    }
    return sum;
  }
};

/// Memory resource on pages of 2 MB, if the system has them. The first write to each page of fresh
/// memory causes a page fault. Large pages cause 512 times fewer faults than pages of 4 KB and need
/// fewer steps of address translation. bench/measure/cold_frames.cpp measures the effect on first
/// frames. Blocks are multiples of a cache line, not of a page, so that columns of one length do
/// not compete for the same sets of a cache.
///
/// Large blocks are part of *slabs*, runs of large pages that are mapped from the system. A new
/// slab has room for the block, and at least for half the size of all slabs, up to 32 MB. Other
/// blocks come from another resource. The allocation writes to all pages of a block, whether they
/// will be used or not, because threads that write first to pages at the same time block each
/// other. When a slab becomes empty, empty slabs are returned to the system as long as the free
/// bytes in slabs exceed both the used bytes and 8 MB. Allocation and deallocation take O(free
/// ranges). Thread-safe. Linux has large pages if /sys/kernel/mm/transparent_hugepage/enabled
/// selects `madvise` or `always`. Otherwise slabs consist of ordinary pages, which become present
/// on the first write to each. On other systems all blocks come from the other resource.
class WINNOW_API LargePages final : public std::pmr::memory_resource {
 public:
  /// Bytes of a large page; slabs are multiples of it.
  static constexpr std::size_t kPage = std::size_t{2} << 20U;
  /// Smallest size, in bytes, of blocks that are taken from slabs.
  static constexpr std::size_t kLargeBlock = std::size_t{32} << 10U;

  /// Creates a resource without slabs. Blocks that are not taken from slabs, and the lists of slabs
  /// and of free ranges, come from `small_blocks`, which must outlive it.
  explicit LargePages(
      std::pmr::memory_resource* small_blocks = std::pmr::new_delete_resource()) noexcept;
  /// Returns all slabs to the system; all blocks must have been deallocated before.
  ~LargePages() override;
  LargePages& operator=(LargePages&&) = delete;  // neither copied nor moved

  /// Returns the bytes of all slabs.
  [[nodiscard]] std::size_t held_bytes() const noexcept;
  /// Returns the bytes of the used blocks in slabs, rounded up to whole cache lines.
  [[nodiscard]] std::size_t used_bytes() const noexcept;

 private:
  class Slabs;

  void* do_allocate(std::size_t bytes, std::size_t alignment) override;
  void do_deallocate(void* block, std::size_t bytes, std::size_t alignment) override;
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }

  std::pmr::memory_resource* small_blocks_;
  Slabs* slabs_;  // null if the system has no slabs
};

/// Returns the memory resource that objects of winnow use by default. It is the standard library's
/// default resource if the program has set one (`std::pmr::set_default_resource`) or if the system
/// has no large pages, and otherwise a LargePages resource that the whole process shares. Error
/// checkers watch the blocks of `new`: if the environment variable WINNOW_LARGE_PAGES is 0, or in
/// builds with the address or memory sanitizer, it is always the standard library's.
[[nodiscard]] WINNOW_API std::pmr::memory_resource* default_memory() noexcept;

/// Whether a reservation also writes to each page of the new memory (prefaulting). The first real
/// use then causes no page faults.
enum class Pages : std::uint8_t {
  untouched,   ///< only allocated
  prefaulted,  ///< allocated, and written to once per page
};

namespace detail {

/// Returns `memory.allocate(bytes, alignment)`, or null if the resource throws.
[[nodiscard]] WINNOW_API void* try_allocate(std::pmr::memory_resource& memory, std::size_t bytes,
                                            std::size_t alignment) noexcept;

/// Writes a zero to every page of memory whose content is not needed.
WINNOW_API void prefault_pages(void* begin, std::size_t bytes) noexcept;

/// The memory of a column: its address and its capacity.
struct ColumnBlock {
  void* data = nullptr;      ///< null if nothing is allocated
  std::size_t capacity = 0;  ///< in elements
};

/// Allocates room for at least `count` elements of `element` bytes each, in whole 64-byte lines,
/// moves the first `size` elements of `old` to it and frees `old`. If the resource refuses, returns
/// null data and leaves `old` as it was. O(size).
[[nodiscard]] WINNOW_API ColumnBlock reallocate_block(std::pmr::memory_resource& memory,
                                                      ColumnBlock old, std::size_t size,
                                                      std::size_t count,
                                                      std::size_t element) noexcept;

/// As `reallocate_block`, but tries first to grow the capacity by half if that is more than
/// `count`.
[[nodiscard]] WINNOW_API ColumnBlock grow_block(std::pmr::memory_resource& memory, ColumnBlock old,
                                                std::size_t size, std::size_t count,
                                                std::size_t element) noexcept;

/// Frees the memory of a column; does nothing if its data is null.
WINNOW_API void free_block(std::pmr::memory_resource& memory, ColumnBlock room,
                           std::size_t element) noexcept;

}  // namespace detail

/// One column of a structure of arrays. Its memory is 64-byte aligned and a whole number of 64-byte
/// lines. If the memory resource refuses, functions return false instead of throwing.
/// `std::pmr::vector` requests only alignof(T) from its resource, hence this type. Elements from
/// `size()` up to `capacity()` are uninitialised.
template <typename T>
class Column {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Alignment in bytes: a cache line, and a register of the widest instruction set.
  static constexpr std::size_t kAlignment = 64;
  /// Largest number of elements whose size in bytes, rounded up to whole lines, fits in
  /// std::size_t.
  static constexpr std::size_t kMaxSize = (~std::size_t{0} - kAlignment + 1) / sizeof(T);

  /// Creates an empty column. Every allocation comes from `memory`, which must outlive the column.
  explicit Column(std::pmr::memory_resource* memory) noexcept : memory_(memory) {}
  /// Takes the elements and the memory resource of `other`, which becomes empty.
  Column(Column&& other) noexcept
      : memory_(other.memory_),
        data_(std::exchange(other.data_, nullptr)),
        size_(std::exchange(other.size_, 0)),
        capacity_(std::exchange(other.capacity_, 0)) {}
  ~Column() { detail::free_block(*memory_, room(), sizeof(T)); }

  /// Returns a pointer to the first element; null if nothing is allocated.
  [[nodiscard]] T* data() noexcept { return data_; }
  /// Returns a pointer to the first element; null if nothing is allocated.
  [[nodiscard]] const T* data() const noexcept { return data_; }
  /// Returns the number of elements.
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// Returns the number of elements that fit in the allocated memory.
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
  /// True if the size is 0.
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  /// Element i; i must be below `capacity()`, which is not checked.
  [[nodiscard]] T& operator[](std::size_t i) noexcept { return data_[i]; }
  /// Element i; i must be below `capacity()`, which is not checked.
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data_[i]; }
  /// Iterators over the elements.
  /// @{
  [[nodiscard]] T* begin() noexcept { return data_; }
  [[nodiscard]] T* end() noexcept { return data_ + size_; }
  [[nodiscard]] const T* begin() const noexcept { return data_; }
  [[nodiscard]] const T* end() const noexcept { return data_ + size_; }
  /// @}

  /// Ensures room for at least `count` elements, rounded up to whole lines. Returns false, and
  /// changes nothing, if the resource refuses.
  [[nodiscard]] bool reserve(std::size_t count) noexcept {
    return count <= capacity_ ||
           adopt(detail::reallocate_block(*memory_, room(), size_, count, sizeof(T)));
  }

  /// As above; with `Pages::prefaulted`, also writes to all pages behind the last element.
  [[nodiscard]] bool reserve(std::size_t count, Pages pages) noexcept {
    if (!reserve(count)) return false;
    if (pages == Pages::prefaulted) touch();
    return true;
  }

  /// Writes to the pages behind the last element.
  void touch() noexcept {
    detail::prefault_pages(data_ + size_, capacity_bytes() - size_ * sizeof(T));
  }

  /// As `reserve`, but grows by at least half if the resource allows, so that repeated growth costs
  /// O(1) per element.
  [[nodiscard]] bool grow(std::size_t count) noexcept {
    return count <= capacity_ ||
           adopt(detail::grow_block(*memory_, room(), size_, count, sizeof(T)));
  }

  /// Reduces the capacity to `count` elements, or to `size()` if that is more, rounded up to whole
  /// lines. Returns false, and changes nothing, if the resource refuses.
  [[nodiscard]] bool shrink(std::size_t count) noexcept {
    const std::size_t kept = count < size_ ? size_ : count;
    if (kept >= capacity_) return true;
    if (kept != 0) return adopt(detail::reallocate_block(*memory_, room(), size_, kept, sizeof(T)));
    release();
    return true;
  }

  /// Sets the size without allocating; the memory must be reserved. New elements are uninitialised.
  void set_size(std::size_t count) noexcept { size_ = count; }

  /// Sets the size, and allocates if necessary; new elements are uninitialised. Returns false, and
  /// changes nothing, if the resource refuses.
  [[nodiscard]] bool resize(std::size_t count) noexcept {
    if (!grow(count)) return false;
    size_ = count;
    return true;
  }

  /// Appends an element. Returns false, and changes nothing, if memory is refused. O(1) except for
  /// growth.
  [[nodiscard]] bool push_back(const T& value) noexcept {
    if (size_ == capacity_ && !grow(size_ + 1)) return false;
    data_[size_++] = value;
    return true;
  }

  /// Sets the size to 0; memory is kept.
  void clear() noexcept { size_ = 0; }

  /// Removes all elements and frees the memory.
  void release() noexcept {
    detail::free_block(*memory_, room(), sizeof(T));
    data_ = nullptr;
    size_ = capacity_ = 0;
  }

  /// Exchanges contents with a column of the same memory resource.
  void swap(Column& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  /// Returns the memory resource of all allocations.
  [[nodiscard]] std::pmr::memory_resource* memory() const noexcept { return memory_; }
  /// Returns the bytes of the elements and the bytes allocated.
  [[nodiscard]] Bytes bytes() const noexcept { return {size_ * sizeof(T), capacity_bytes()}; }

 private:
  // Allocations are whole lines, and sizeof(T) need not divide a line.
  [[nodiscard]] std::size_t capacity_bytes() const noexcept {
    return (capacity_ * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
  }

  [[nodiscard]] detail::ColumnBlock room() const noexcept { return {data_, capacity_}; }
  /// Adopts the room; returns false, and changes nothing, if its data is null.
  [[nodiscard]] bool adopt(detail::ColumnBlock room) noexcept {
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
