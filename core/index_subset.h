#pragma once

#include <winnow/core/export.h>

#include <cstdint>
#include <span>

namespace winnow {

/// A subset of the entries of per-object arrays, for calls that process only this subset: the
/// caller need not copy these entries into smaller arrays. It copies nothing and must not outlive
/// the span that it was made from.
class IndexSubset {
 public:
  /// Selects entries by index, in any order.
  [[nodiscard]] static IndexSubset listed(std::span<const std::uint32_t> indices) noexcept {
    return {indices, {}, false};
  }
  /// Selects entries by a bit mask with one 64-bit integer per 64 entries: entry i is selected if
  /// bit i % 64 of words[i / 64] is set. Bits behind the last entry are ignored.
  [[nodiscard]] static IndexSubset masked(std::span<const std::uint64_t> words) noexcept {
    return {{}, words, true};
  }

  /// True if `words` selects the entries, false if `indices` does.
  [[nodiscard]] bool is_mask() const noexcept { return is_mask_; }
  /// Returns the indices of the selected entries; empty for a mask.
  [[nodiscard]] std::span<const std::uint32_t> indices() const noexcept { return indices_; }
  /// Returns the bit mask of the selected entries; empty for a list.
  [[nodiscard]] std::span<const std::uint64_t> words() const noexcept { return words_; }

 private:
  IndexSubset(std::span<const std::uint32_t> indices, std::span<const std::uint64_t> words,
              bool is_mask) noexcept
      : indices_(indices), words_(words), is_mask_(is_mask) {}

  std::span<const std::uint32_t> indices_;
  std::span<const std::uint64_t> words_;
  bool is_mask_;
};

}  // namespace winnow
