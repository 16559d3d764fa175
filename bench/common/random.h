#pragma once

#include <winnow/core/vectors.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

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
  /// Uniform in the box with these corners.
  constexpr Vec3d in(const Vec3d& low, const Vec3d& high) noexcept {
    return {in(low.x(), high.x()), in(low.y(), high.y()), in(low.z(), high.z())};
  }
  /// Uniform in the cube [low, high)^3.
  constexpr Vec3d in_cube(double low, double high) noexcept {
    return in(Vec3d::constant(low), Vec3d::constant(high));
  }

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

  /// Puts the values in random order.
  template <typename Values>
  constexpr void shuffle(Values& values) noexcept {
    for (std::size_t i = values.size(); i > 1; --i) {
      std::swap(values[i - 1], values[below(static_cast<std::uint32_t>(i))]);
    }
  }
  /// Swaps `count` random values to the front.
  template <typename Values>
  constexpr void draw_front(Values& values, std::size_t count) noexcept {
    for (std::size_t i = 0; i < count; ++i) {
      std::swap(values[i], values[i + below(static_cast<std::uint32_t>(values.size() - i))]);
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace winnow::bench
