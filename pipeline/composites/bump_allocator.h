#pragma once

#include <atomic>
#include <cstdint>

namespace winnow::mid {

/// Hands out blocks of 32-bit integers to tasks, from memory that is reserved before the tasks
/// start. If the memory is exhausted, only counts blocks, so that the caller can reserve enough and
/// repeat. The number of blocks does not depend on the order of tasks, only the positions of blocks
/// do.
class BumpAllocator {
 public:
  static constexpr std::uint32_t kBlock = 256;

  [[nodiscard]] static constexpr std::uint64_t blocks_for(std::uint64_t words) noexcept {
    return (words + kBlock - 1) / kBlock;
  }

  BumpAllocator(std::uint32_t* words, std::uint64_t blocks) noexcept
      : words_(words), blocks_(blocks) {}

  /// Returns consecutive blocks for `words` integers, or null if not enough blocks remain.
  [[nodiscard]] std::uint32_t* take(std::uint64_t words) noexcept {
    const std::uint64_t count = blocks_for(words);
    const std::uint64_t first = next_.fetch_add(count, std::memory_order_relaxed);
    return first + count <= blocks_ ? words_ + first * kBlock : nullptr;
  }
  [[nodiscard]] std::uint64_t requested() const noexcept {
    return next_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] bool was_enough() const noexcept { return requested() <= blocks_; }

  [[nodiscard]] std::uint32_t index_of(const std::uint32_t* block) const noexcept {
    return static_cast<std::uint32_t>(static_cast<std::size_t>(block - words_) / kBlock);
  }

 private:
  std::uint32_t* words_;
  std::uint64_t blocks_;
  std::atomic<std::uint64_t> next_{0};
};

/// Appends the integers of one task to a linked list of blocks: each block begins with the index of
/// the next block.
class WordWriter {
 public:
  explicit WordWriter(BumpAllocator& arena) noexcept : arena_(arena) {}

  void put(std::uint32_t word) noexcept {
    if (fill_ == BumpAllocator::kBlock) turn();
    if (block_ != nullptr) block_[fill_] = word;
    ++fill_;
    ++size_;
  }
  [[nodiscard]] std::uint32_t first_block() const noexcept { return first_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

 private:
  void turn() noexcept {
    std::uint32_t* const fresh = arena_.take(BumpAllocator::kBlock);
    if (fresh != nullptr) {
      (block_ != nullptr ? *block_ : first_) = arena_.index_of(fresh);
    }
    block_ = fresh;
    fill_ = 1;
  }

  BumpAllocator& arena_;
  std::uint32_t* block_ = nullptr;
  std::uint32_t first_ = 0;
  std::uint32_t fill_ = BumpAllocator::kBlock;
  std::uint64_t size_ = 0;
};

/// Reads the integers that a WordWriter wrote.
class WordReader {
 public:
  WordReader(const std::uint32_t* words, std::uint32_t first_block) noexcept
      : words_(words), next_(first_block) {}

  [[nodiscard]] std::uint32_t get() noexcept {
    if (fill_ == BumpAllocator::kBlock) {
      block_ = words_ + std::uint64_t{next_} * BumpAllocator::kBlock;
      next_ = block_[0];
      fill_ = 1;
    }
    return block_[fill_++];
  }

 private:
  const std::uint32_t* words_;
  const std::uint32_t* block_ = nullptr;
  std::uint32_t next_;
  std::uint32_t fill_ = BumpAllocator::kBlock;
};

}  // namespace winnow::mid
