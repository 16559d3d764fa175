#pragma once

#include <winnow/core/execution.h>

#include <bit>
#include <cstddef>
#include <cstdint>

namespace winnow {

/// Maps a float to an unsigned number of the same order; -0 comes before 0.
[[nodiscard]] inline std::uint32_t sortable(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

/// Inverse of `sortable`.
[[nodiscard]] inline float from_sortable(std::uint32_t bits) noexcept {
  return std::bit_cast<float>((bits & 0x80000000U) != 0 ? bits & 0x7FFFFFFFU : ~bits);
}

/// Sorts (key << first_bit | value) stably by the lowest `bits` bits of the key: a
/// least-significant-digit radix sort with up to 11 bits per pass. `items` and `spare` have `count`
/// elements each; returns the one that contains the result. O(count * bits / 11). The result does
/// not depend on the number of threads.
[[nodiscard]] std::uint64_t* radix_sort(std::uint64_t* items, std::uint64_t* spare,
                                        std::size_t count, unsigned bits,
                                        const Execution& execution,
                                        unsigned first_bit = 32) noexcept;

}  // namespace winnow
