#pragma once

#include <winnow/core/memory.h>

#include <cstddef>
#include <memory_resource>

namespace winnow::bench {

/// Forwards to `upstream` and counts outstanding bytes and allocations. Not synchronized:
/// partitions allocate from one thread only.
class CountingResource final : public std::pmr::memory_resource {
 public:
  explicit CountingResource(std::pmr::memory_resource* upstream = default_memory()) noexcept
      : upstream_(upstream) {}

  [[nodiscard]] std::size_t outstanding() const noexcept { return outstanding_; }
  [[nodiscard]] std::size_t peak() const noexcept { return peak_; }
  /// Starts a new measurement of the peak at the bytes outstanding now.
  void forget_peak() noexcept { peak_ = outstanding_; }
  [[nodiscard]] std::size_t allocations() const noexcept { return allocations_; }

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    void* memory = upstream_->allocate(bytes, alignment);
    outstanding_ += bytes;
    if (outstanding_ > peak_) peak_ = outstanding_;
    ++allocations_;
    return memory;
  }

  void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override {
    upstream_->deallocate(memory, bytes, alignment);
    outstanding_ -= bytes;
  }

  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }

  std::pmr::memory_resource* upstream_;
  std::size_t outstanding_ = 0;
  std::size_t peak_ = 0;
  std::size_t allocations_ = 0;
};

}  // namespace winnow::bench
