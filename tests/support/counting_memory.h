#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <memory_resource>

#include "core/threads/mutex.h"
#include "tests/support/platform.h"

#if WINNOW_TEST_THREADS
#include <thread>
#endif

namespace winnow::test {

/// A memory resource that counts to the byte, reports blocks that are freed with another size or
/// alignment, and refuses requests on demand. Thread-safe.
class CountingMemory final : public std::pmr::memory_resource {
 public:
  CountingMemory() = default;
  CountingMemory(const CountingMemory&) = delete;
  CountingMemory& operator=(const CountingMemory&) = delete;
  /// Reports a test failure if a block was never freed.
  ~CountingMemory() override;

  /// Returns the allocated bytes that are not yet freed.
  [[nodiscard]] std::size_t outstanding() const;
  /// Returns the number of requests so far, including refused ones.
  [[nodiscard]] std::size_t requests() const;
  [[nodiscard]] std::size_t refusals() const;
  /// Returns the number of requests from threads other than the one that constructed this object.
  [[nodiscard]] std::size_t requests_from_elsewhere() const;

  /// Grants `count` more requests and refuses all later ones.
  void refuse_after(std::size_t count);
  /// Grants `count` more requests, refuses one, grants the rest.
  void refuse_one_after(std::size_t count);
  /// Refuses requests that would bring more than `bytes` into use.
  void refuse_beyond(std::size_t bytes);
  void grant_all();

 private:
  struct Block {
    std::size_t bytes;
    std::size_t alignment;
  };
  static constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

  void* do_allocate(std::size_t bytes, std::size_t alignment) override;
  void do_deallocate(void* block, std::size_t bytes, std::size_t alignment) override;
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override;

  mutable Mutex mutex_;
  std::map<void*, Block> blocks_;
  std::size_t outstanding_ = 0;
  std::size_t requests_ = 0;
  std::size_t refusals_ = 0;
  std::size_t requests_from_elsewhere_ = 0;
  std::size_t refuse_from_ = kNever;
  std::size_t refuse_to_ = kNever;
  std::size_t limit_ = kNever;
#if WINNOW_TEST_THREADS
  std::thread::id owner_ = std::this_thread::get_id();
#endif
};

}  // namespace winnow::test
