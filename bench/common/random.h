#pragma once

#include <bit>
#include <cstdint>

namespace winnow::bench {

/// The finaliser of SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number
/// generators", OOPSLA 2014): a bijection of 64-bit values.
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t x) noexcept {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31U);
}

/// Mixes the bits of a number into a hash.
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t hash, double number) noexcept {
  return mix(hash ^ std::bit_cast<std::uint64_t>(number));
}

/// SplitMix64. Uses only integers and operations that IEEE 754 rounds correctly, so that results
/// are the same on every machine; <random> distributions and libm functions differ between
/// machines.
class Random {
 public:
  explicit constexpr Random(std::uint64_t seed) noexcept : state_(mix(seed)) {}

  constexpr std::uint64_t next() noexcept {
    const std::uint64_t value = mix(state_);
    state_ += 0x9E3779B97F4A7C15ULL;
    return value;
  }

  /// Uniform in [0, 1).
  constexpr double unit() noexcept { return static_cast<double>(next() >> 11U) * 0x1p-53; }

  /// Uniform in [low, high).
  constexpr double in(double low, double high) noexcept { return low + unit() * (high - low); }

  /// Uniform in 0 .. count-1; the bias of 2^-32 * count does not matter here.
  constexpr std::uint32_t below(std::uint32_t count) noexcept {
    return static_cast<std::uint32_t>(((next() >> 32U) * count) >> 32U);
  }

  /// Approximately standard normal: the sum of twelve uniforms minus 6, thus within [-6, 6).
  constexpr double normal() noexcept {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += unit();
    return sum;
  }

 private:
  std::uint64_t state_;
};

}  // namespace winnow::bench
