#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>

namespace winnow::bench {

/// A range of addresses; the system gives memory to the pages that are written to.
class AddressRange {
 public:
  /// Throws std::bad_alloc if there are no such addresses.
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
  /// As if nobody had written to any page.
  void forget() noexcept { ::madvise(begin_, bytes_, MADV_DONTNEED); }

 private:
  std::size_t bytes_;
  std::byte* begin_ = nullptr;
};

}  // namespace winnow::bench
