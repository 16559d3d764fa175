#pragma once

#include <winnow/core/export.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Some entries of arrays that a caller keeps of all its objects, for a call that is about these
/// alone, so that nothing need be copied together. Nothing is copied to make one, and it must not
/// outlive what it looks at.
class Entries {
 public:
  /// By number, in any order.
  [[nodiscard]] static Entries listed(std::span<const std::uint32_t> numbers) noexcept {
    return {numbers, {}, false};
  }
  /// A bit each: entry i is meant if bit i % 64 of word i / 64 is set. A word for each 64 entries;
  /// bits behind the last entry are not looked at.
  [[nodiscard]] static Entries masked(std::span<const std::uint64_t> words) noexcept {
    return {{}, words, true};
  }

  /// Whether `words` says which entries are meant, or else `numbers`.
  [[nodiscard]] bool is_mask() const noexcept { return is_mask_; }
  /// Entries by number; empty for a mask.
  [[nodiscard]] std::span<const std::uint32_t> numbers() const noexcept { return numbers_; }
  /// A bit for each entry; empty for a list.
  [[nodiscard]] std::span<const std::uint64_t> words() const noexcept { return words_; }

 private:
  Entries(std::span<const std::uint32_t> numbers, std::span<const std::uint64_t> words,
          bool is_mask) noexcept
      : numbers_(numbers), words_(words), is_mask_(is_mask) {}

  std::span<const std::uint32_t> numbers_;
  std::span<const std::uint64_t> words_;
  bool is_mask_;
};

}  // namespace winnow
