#pragma once

#include <winnow/core/export.h>

#include <cstddef>
#include <memory_resource>

namespace winnow {

/// Memory on pages of 2 MB, where the system has such. Who writes to fresh memory waits for each of
/// its pages, some 0.1 to 10 us for one of 4 KB: the first frame of 100,000 objects can wait for
/// pages ten times as long as it computes. Large pages are 512 times fewer and take far less
/// together, and addresses on them are looked up in fewer steps. Blocks follow each other by whole
/// cache lines, so that columns of one length do not fall on the same sets of a cache.
///
/// Large blocks lie in *slabs*, runs of large pages that the system is asked for, 32 MB or one
/// block at the most; other blocks come from another resource. All pages of a block are there when
/// it is handed out, whether they will be used or not: threads that are the first to write to a
/// page at once may wait for each other for milliseconds. When a slab becomes empty, empty ones are
/// given back as long as more bytes are free than in use and 8 MB. O(free ranges) each. Any number
/// of threads may use it at once. Linux has large pages where
/// /sys/kernel/mm/transparent_hugepage/enabled says `madvise` or `always`, and otherwise slabs are
/// of ordinary ones, which come when they are first written to; on other systems all blocks come
/// from the other resource.
class WINNOW_API LargePages final : public std::pmr::memory_resource {
 public:
  /// Bytes of a page, of which slabs are multiples.
  static constexpr std::size_t kPage = std::size_t{2} << 20U;
  /// Bytes from which on a block is a large one.
  static constexpr std::size_t kLargeBlock = std::size_t{32} << 10U;

  /// Allocates a few hundred bytes from `small_blocks`, which must outlive it.
  explicit LargePages(
      std::pmr::memory_resource* small_blocks = std::pmr::new_delete_resource()) noexcept;
  /// Every block of it must have been given back.
  ~LargePages() override;
  LargePages(const LargePages&) = delete;
  LargePages& operator=(const LargePages&) = delete;

  /// Bytes of all slabs.
  [[nodiscard]] std::size_t held_bytes() const noexcept;
  /// Bytes of the large blocks in use, in whole cache lines.
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
  Slabs* slabs_;  // null where there are none
};

/// Where objects of winnow take their memory from if they are not told: the standard library's
/// default resource, if the program has set one (`std::pmr::set_default_resource`) or the system
/// has no large pages, and else such pages that the whole process shares. Tools that look for
/// errors watch over the blocks of `new`: with the environment variable WINNOW_LARGE_PAGES=0, or
/// built with the address or memory sanitizer, winnow takes the default resource in any case.
[[nodiscard]] WINNOW_API std::pmr::memory_resource* default_memory() noexcept;

}  // namespace winnow
