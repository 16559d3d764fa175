#pragma once

#include <winnow/core/execution.h>

#include <bit>
#include <cstddef>
#include <cstdint>

namespace winnow {

/// Order-preserving map of floats to unsigned; -0 comes before 0.
[[nodiscard]] inline std::uint32_t sortable(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

/// What `sortable` was made of.
[[nodiscard]] inline float from_sortable(std::uint32_t bits) noexcept {
  return std::bit_cast<float>((bits & 0x80000000U) != 0 ? bits & 0x7FFFFFFFU : ~bits);
}

/// Stable sort of (key << first_bit | value) by the lowest `bits` bits of the key: a
/// least-significant-digit radix sort of up to 11 bits per pass. `items` and `spare` hold `count`
/// each; returns the one of the two that holds the result. O(count * bits / 11); the same result on
/// any number of threads.
[[nodiscard]] std::uint64_t* radix_sort(std::uint64_t* items, std::uint64_t* spare,
                                        std::size_t count, unsigned bits,
                                        const Execution& execution,
                                        unsigned first_bit = 32) noexcept;

}  // namespace winnow
