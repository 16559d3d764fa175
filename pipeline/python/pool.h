#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace winnow::python {

/// Buffers for results. A buffer that no array refers to any more is reused, with its memory.
template <typename Buffer>
class Pool : public std::enable_shared_from_this<Pool<Buffer>> {
 public:
  /// Returns a buffer that has no other owner. Any thread may take and release one.
  [[nodiscard]] std::shared_ptr<Buffer> take() {
    std::unique_ptr<Buffer> buffer;
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        buffer = std::move(free_.back());
        free_.pop_back();
      }
    }
    if (!buffer) buffer = std::make_unique<Buffer>();
    Buffer* const taken = buffer.get();
    std::shared_ptr<Buffer> result(taken,
                                   [pool = this->shared_from_this()](Buffer* b) { pool->put(b); });
    static_cast<void>(buffer.release());
    return result;
  }

  /// Frees the unused buffers.
  void release() {
    const std::lock_guard lock(mutex_);
    free_.clear();
  }

 private:
  /// Limit of unused buffers; any more are freed.
  static constexpr std::size_t kMaxUnused = 4;

  void put(Buffer* buffer) noexcept {
    std::unique_ptr<Buffer> back(buffer);
    const std::lock_guard lock(mutex_);
    try {
      if (free_.size() < kMaxUnused) free_.push_back(std::move(back));
    } catch (const std::bad_alloc&) {
      // The buffer is freed instead.
    }
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<Buffer>> free_;
};

}  // namespace winnow::python
