#pragma once

#include <cstdint>
#include <utility>

namespace winnow {

/// Tags that distinguish the keys of one table from the keys of all others in the process. A freed
/// tag is reused as late as possible. If tables need more than kMaxTags tags at the same time, some
/// tables share a tag. Thread-safe; O(1) unless nearly all tags are taken.
class PartitionTagPool {
 public:
  static constexpr unsigned kBits = 17;
  static constexpr std::uint32_t kMaxTags = (1U << kBits) - 1;

  PartitionTagPool() noexcept;
  ~PartitionTagPool();
  PartitionTagPool(const PartitionTagPool&) = delete;
  PartitionTagPool& operator=(const PartitionTagPool&) = delete;

  /// Returns the latest tag, 1 to kMaxTags.
  [[nodiscard]] std::uint32_t latest() const noexcept { return latest_; }
  /// Takes one more tag and keeps the others. Returns false, and changes nothing, if none is free.
  [[nodiscard]] bool renew() noexcept;
  /// Makes this tag the latest one and keeps the others. Returns false, and changes nothing, if
  /// another table has it, if it is not between 1 and kMaxTags, or if this table shares its tag.
  /// O(tags of this table).
  [[nodiscard]] bool claim(std::uint32_t tag) noexcept;
  void swap(PartitionTagPool& other) noexcept {
    std::swap(latest_, other.latest_);
    std::swap(is_own_, other.is_own_);
  }

 private:
  std::uint32_t latest_;
  bool is_own_ = true;
};

}  // namespace winnow
