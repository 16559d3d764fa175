#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>

namespace winnow::bench {

/// A reserved range of virtual addresses. The system commits a page when it is first written.
class AddressRange {
 public:
  /// Throws std::bad_alloc if the system cannot reserve `bytes`.
  explicit AddressRange(std::size_t bytes) : bytes_(bytes) {
    void* const range = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE,
                               MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (range == MAP_FAILED) throw std::bad_alloc();
    begin_ = static_cast<std::byte*>(range);
  }
  AddressRange(const AddressRange&) = delete;
  AddressRange& operator=(const AddressRange&) = delete;
  ~AddressRange() { ::munmap(begin_, bytes_); }

  [[nodiscard]] std::byte* begin() const noexcept { return begin_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
  /// Returns all pages to the system; they read as zero and fault again on the next write.
  void forget() noexcept { ::madvise(begin_, bytes_, MADV_DONTNEED); }

 private:
  std::size_t bytes_;
  std::byte* begin_ = nullptr;
};

}  // namespace winnow::bench
