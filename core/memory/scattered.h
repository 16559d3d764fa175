#pragma once

#include <cstdint>

namespace winnow {

/// Hash function, a bijection: the finalizer of SplitMix64 (Steele, Lea, Flood, "Fast splittable
/// pseudorandom number generators", OOPSLA 2014). Every input bit affects all output bits.
[[nodiscard]] constexpr std::uint64_t scattered(std::uint64_t x) noexcept {
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

}  // namespace winnow
