#pragma once

#include "bench/common/address_range.h"

#include <cstddef>
#include <memory_resource>
#include <new>

namespace winnow::bench {

/// A bump allocator over one range of addresses. Memory that was written before causes no page
/// faults when it is handed out again after `rewind`.
class ReusedMemory final : public std::pmr::memory_resource {
 public:
  /// Throws std::bad_alloc if the system cannot reserve `bytes`.
  explicit ReusedMemory(std::size_t bytes) : range_(bytes) {}

  /// Makes all memory available again. No allocation may be alive.
  void rewind() noexcept { used_ = 0; }
  /// As `rewind`, but also returns the pages to the system, so that they fault again.
  void rewind_untouched() noexcept {
    range_.forget();
    used_ = 0;
  }

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    const std::size_t at = (used_ + alignment - 1) / alignment * alignment;
    if (bytes > range_.bytes() || at > range_.bytes() - bytes) throw std::bad_alloc();
    used_ = at + bytes;
    return range_.begin() + at;
  }
  void do_deallocate(void* /*memory*/, std::size_t /*bytes*/, std::size_t /*alignment*/) override {}
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }

  AddressRange range_;
  std::size_t used_ = 0;
};

}  // namespace winnow::bench
