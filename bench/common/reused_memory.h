#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <memory_resource>
#include <new>

namespace winnow::bench {

/// One range of addresses, handed out from its beginning to its end. What was written to once costs
/// no page faults when it is handed out again, until it is given back to the system.
class ReusedMemory final : public std::pmr::memory_resource {
 public:
  /// Throws std::bad_alloc if there are no such addresses. Pages are there once they are written
  /// to.
  explicit ReusedMemory(std::size_t bytes) : bytes_(bytes) {
    void* const range = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE,
                               MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (range == MAP_FAILED) throw std::bad_alloc();
    begin_ = static_cast<std::byte*>(range);
  }
  ReusedMemory(const ReusedMemory&) = delete;
  ReusedMemory& operator=(const ReusedMemory&) = delete;
  ~ReusedMemory() override { ::munmap(begin_, bytes_); }

  /// Hands out everything again. Nothing that was allocated may be alive.
  void rewind() noexcept { used_ = 0; }
  /// The same, with pages that nobody has written to.
  void rewind_untouched() noexcept {
    ::madvise(begin_, bytes_, MADV_DONTNEED);
    used_ = 0;
  }

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    const std::size_t at = (used_ + alignment - 1) / alignment * alignment;
    if (bytes > bytes_ || at > bytes_ - bytes) throw std::bad_alloc();
    used_ = at + bytes;
    return begin_ + at;
  }
  void do_deallocate(void* /*memory*/, std::size_t /*bytes*/, std::size_t /*alignment*/) override {}
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }

  std::size_t bytes_;
  std::byte* begin_ = nullptr;
  std::size_t used_ = 0;
};

}  // namespace winnow::bench
