#pragma once

// The digest, its random numbers, and the works that are digested.

#include <winnow/winnow.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace winnow::test {

/// FNV-1a over 64-bit numbers.
class Digest {
 public:
  void add(std::uint64_t value) { hash_ = (hash_ ^ value) * 0x100000001B3ULL + (value >> 32U); }
  /// Adds a double; zeros of either sign are equal. Tests the bits: value + 0 would be -0 for -0 if
  /// the host rounds down, and 0 for a denormal number if the host flushes them.
  void add(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    add(bits << 1U == 0 ? std::uint64_t{0} : bits);
  }
  /// Adds the numbers of pairs that each method computed: a change of the method changes the time,
  /// even if the results are equal.
  void add(const NarrowStatistics& s) {
    for (const std::uint64_t number :
         {s.pairs, s.recomputed, s.without_lanes, s.exact, s.bounded}) {
      add(number);
    }
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325ULL;
};

/// Random numbers that are exact in every floating-point mode.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15ULL;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(bits() % count); }
  /// Returns a multiple of 2^-16 in [-range, range); the range is a power of two.
  double coordinate(int range) {
    const auto steps = static_cast<std::int64_t>(bits() % (std::uint64_t{1} << 20U)) - (1 << 19);
    return static_cast<double>(steps) * range * 0x1p-19;
  }
  Pose pose(int range) {
    Pose pose;
    for (double& x : pose.position) x = coordinate(range);
    for (double& q : pose.orientation) q = coordinate(1);
    return pose;
  }

 private:
  std::uint64_t state_;
};

/// A computation whose results are digested.
struct Work {
  std::string name;
  std::function<void(const Execution&, Digest&)> run;
};

/// Collisions, motions and casts of bodies of every kind and with special poses.
[[nodiscard]] std::vector<Work> shape_works();
/// Partitions whose objects are inserted, removed and moved, with their work counters.
[[nodiscard]] std::vector<Work> refresh_works();
/// All works: the above, and pairs, queries, shapes and scenes.
[[nodiscard]] std::vector<Work> all_work();

}  // namespace winnow::test
