#pragma once

#include "bench/common/address_range.h"

#include <cstddef>
#include <memory_resource>
#include <new>

namespace winnow::bench {

/// One range of addresses, handed out from its beginning to its end. What was written to once costs
/// no page faults when it is handed out again, until it is given back to the system.
class ReusedMemory final : public std::pmr::memory_resource {
 public:
  /// Throws std::bad_alloc if there are no such addresses.
  explicit ReusedMemory(std::size_t bytes) : range_(bytes) {}

  /// Hands out everything again. Nothing that was allocated may be alive.
  void rewind() noexcept { used_ = 0; }
  /// The same, with pages that nobody has written to.
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
