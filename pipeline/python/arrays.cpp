// The cache of memory blocks for large results. See arrays.h.

#include "pipeline/python/arrays.h"

#include <cstdlib>
#include <mutex>
#include <new>

namespace winnow::python {
namespace {

/// Unused blocks, the oldest first.
class WaitingBlocks {
 public:
  struct Block {
    void* memory;
    std::size_t bytes;
  };

  /// Returns the smallest block that is large enough, but at most about twice as large; a null
  /// block if there is none.
  [[nodiscard]] Block take(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    auto best = waiting_.end();
    for (auto at = waiting_.begin(); at != waiting_.end(); ++at) {
      const bool fits = at->bytes >= bytes && at->bytes / 2 <= bytes;
      if (fits && (best == waiting_.end() || at->bytes < best->bytes)) best = at;
    }
    if (best == waiting_.end()) return {nullptr, 0};
    const Block taken = *best;
    waiting_.erase(best);
    held_ -= taken.bytes;
    return taken;
  }
  void put(Block block) noexcept {
    const std::lock_guard lock(mutex_);
    if (block.bytes > kMaxBytes || !has_room_) {
      std::free(block.memory);
      return;
    }
    while (waiting_.size() == kMaxBlocks || held_ + block.bytes > kMaxBytes) {
      std::free(waiting_.front().memory);
      held_ -= waiting_.front().bytes;
      waiting_.erase(waiting_.begin());
    }
    waiting_.push_back(block);
    held_ += block.bytes;
  }
  void reserve() {
    const std::lock_guard lock(mutex_);
    if (has_room_) return;
    waiting_.reserve(kMaxBlocks);
    has_room_ = true;
  }

 private:
  static constexpr std::size_t kMaxBlocks = 16;
  static constexpr std::size_t kMaxBytes = std::size_t{128} << 20U;

  std::mutex mutex_;
  std::vector<Block> waiting_;
  std::size_t held_ = 0;
  bool has_room_ = false;
};

// Never destroyed: arrays may outlive all other objects of the module.
WaitingBlocks& waiting_blocks() {
  static auto* const blocks = new WaitingBlocks;
  return *blocks;
}

}  // namespace

std::pair<void*, py::capsule> BlockCache::take(std::size_t bytes) {
  using Block = WaitingBlocks::Block;
  waiting_blocks().reserve();
  auto held = std::make_unique<Block>(waiting_blocks().take(bytes));
  if (held->memory == nullptr) *held = {std::malloc(bytes), bytes};
  if (held->memory == nullptr) throw std::bad_alloc();
  void* const memory = held->memory;
  py::capsule owner(held.get(), [](void* p) {
    const std::unique_ptr<Block> back(static_cast<Block*>(p));
    waiting_blocks().put(*back);
  });
  static_cast<void>(held.release());
  return {memory, std::move(owner)};
}

}  // namespace winnow::python
