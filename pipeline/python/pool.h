#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace winnow::python {

/// Buffers of results that go round: one that no array shows any more is filled again, so that a
/// frame like an earlier one needs no memory.
template <typename Buffer>
class Pool : public std::enable_shared_from_this<Pool<Buffer>> {
 public:
  /// One that nobody else has. May be taken and let go of by any thread.
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

  /// Gives the memory of those that wait back.
  void release() {
    const std::lock_guard lock(mutex_);
    free_.clear();
  }

 private:
  /// More than a program shows at a time would only keep memory.
  static constexpr std::size_t kMost = 4;

  void put(Buffer* buffer) noexcept {
    std::unique_ptr<Buffer> back(buffer);
    const std::lock_guard lock(mutex_);
    try {
      if (free_.size() < kMost) free_.push_back(std::move(back));
    } catch (const std::bad_alloc&) {
      // It is given back instead.
    }
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<Buffer>> free_;
};

}  // namespace winnow::python
