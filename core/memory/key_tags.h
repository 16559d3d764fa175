#pragma once

#include <cstdint>
#include <utility>

namespace winnow {

/// Numbers that tell the keys of one table from those of all others: none that lives in this
/// process has the same, and what becomes free is given out again as late as may be. Where more
/// than kMost are taken at a time, some tables share one. From any thread; O(1) unless nearly all
/// are taken.
class KeyTags {
 public:
  static constexpr unsigned kBits = 17;
  static constexpr std::uint32_t kMost = (1U << kBits) - 1;

  KeyTags() noexcept;
  ~KeyTags();
  KeyTags(const KeyTags&) = delete;
  KeyTags& operator=(const KeyTags&) = delete;

  /// The latest, 1 to kMost.
  [[nodiscard]] std::uint32_t latest() const noexcept { return latest_; }
  /// Takes one more and keeps the others. False, and no change, if none is free.
  [[nodiscard]] bool renew() noexcept;
  /// Takes this one, which becomes the latest, and keeps the others. False, and no change, if
  /// another table has it. O(those that it has).
  [[nodiscard]] bool claim(std::uint32_t tag) noexcept;
  void swap(KeyTags& other) noexcept {
    std::swap(latest_, other.latest_);
    std::swap(is_own_, other.is_own_);
  }

 private:
  std::uint32_t latest_;
  bool is_own_ = true;
};

}  // namespace winnow
