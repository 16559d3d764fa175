#pragma once

#include <winnow/core/export.h>

#include <cstddef>
#include <memory_resource>

namespace winnow {

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
  LargePages(const LargePages&) = delete;
  LargePages& operator=(const LargePages&) = delete;

  /// Returns the bytes of all slabs.
  [[nodiscard]] std::size_t held_bytes() const noexcept;
  /// Returns the bytes of the used blocks in slabs, rounded up to whole cache lines.
  [[nodiscard]] std::size_t used_bytes() const noexcept;

 private:
  class Slabs;

  [[nodiscard]] bool is_large(std::size_t bytes, std::size_t alignment) const noexcept;
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

}  // namespace winnow
