#pragma once

#include <winnow/core/key.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// The entries that an update is about, of keys and of volumes: all of them, or those of a list.
struct EntryList {
  std::span<const Key> keys;
  std::size_t count = 0;
  const std::uint32_t* number = nullptr;  ///< null: all

  /// Of volumes alone.
  explicit EntryList(std::size_t all) noexcept : count(all) {}
  EntryList(std::span<const Key> all) noexcept  // NOLINT(google-explicit-constructor)
      : keys(all), count(all.size()) {}
  EntryList(std::span<const Key> all, std::span<const std::uint32_t> numbers) noexcept
      : keys(all), count(numbers.size()), number(numbers.data()) {}

  [[nodiscard]] std::size_t operator[](std::size_t j) const noexcept {
    return number == nullptr ? j : number[j];
  }
  [[nodiscard]] Key key(std::size_t j) const noexcept { return keys[(*this)[j]]; }

  /// Runs shorter than this are looked at entry by entry: a call per run costs more.
  static constexpr std::size_t kLongRun = 16;

  /// The end of the longest run from the j-th entry on, up to the `end`-th, of entries that follow
  /// each other.
  [[nodiscard]] std::size_t run_end(std::size_t j, std::size_t end) const noexcept {
    if (number == nullptr) return end;
    std::size_t next = j + 1;
    while (next < end && number[next] - number[j] == next - j) ++next;
    return next;
  }
};

}  // namespace winnow
