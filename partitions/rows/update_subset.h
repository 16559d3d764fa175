#pragma once

#include <winnow/core/key.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// The entries of keys and volumes that an update processes: all of them, or a list of indices.
struct UpdateSubset {
  std::span<const Key> keys;
  std::size_t count = 0;
  const std::uint32_t* number = nullptr;  ///< null: all

  /// Entries without keys.
  explicit UpdateSubset(std::size_t all) noexcept : count(all) {}
  UpdateSubset(std::span<const Key> all) noexcept  // NOLINT(google-explicit-constructor)
      : keys(all), count(all.size()) {}
  UpdateSubset(std::span<const Key> all, std::span<const std::uint32_t> numbers) noexcept
      : keys(all), count(numbers.size()), number(numbers.data()) {}

  [[nodiscard]] std::size_t operator[](std::size_t j) const noexcept {
    return number == nullptr ? j : number[j];
  }
  [[nodiscard]] Key key(std::size_t j) const noexcept { return keys[(*this)[j]]; }

  /// Shorter runs are handled entry by entry, because a call per run costs more.
  static constexpr std::size_t kLongRun = 16;

  /// Returns the end, at most `end`, of the longest run of consecutive indices that starts at the
  /// j-th entry.
  [[nodiscard]] std::size_t run_end(std::size_t j, std::size_t end) const noexcept {
    if (number == nullptr) return end;
    std::size_t next = j + 1;
    while (next < end && number[next] - number[j] == next - j) ++next;
    return next;
  }
};

}  // namespace winnow
