#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace winnow::test {

/// Returns the seed of every randomised test: the environment variable WINNOW_SEED, or 1.
[[nodiscard]] std::uint64_t base_seed();

/// Returns `count` scaled by the environment variable WINNOW_TEST_SCALE (a factor in [0.01, 100];
/// slow builds set a small one), at least 1.
[[nodiscard]] std::size_t scaled(std::size_t count);

/// Returns true if tests run below full scale.
[[nodiscard]] bool is_reduced();

/// Returns true if tests run below half of their scale, as slow builds do.
[[nodiscard]] bool is_quick();

/// SplitMix64 (Steele, Lea, Flood: "Fast splittable pseudorandom number generators", 2014): the
/// numbers are equal on every machine and standard library.
class Random {
 public:
  explicit Random(std::uint64_t stream) : state_(base_seed() * 0x9E3779B97F4A7C15ULL + stream) {}

  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15ULL;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }
  /// Returns a number in [0, 1).
  double unit() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * unit(); }
  /// Returns a number in [0, count).
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(bits() % count); }
  bool chance(double probability) { return unit() < probability; }
  /// Returns exp of a uniform number between the logarithms.
  double log_uniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }

 private:
  std::uint64_t state_;
};

}  // namespace winnow::test
