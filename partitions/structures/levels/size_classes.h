#pragma once

#include <winnow/core/execution.h>
#include "core/memory/bounds_pool.h"
#include "partitions/structures/levels/level_rows.kernel.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

inline constexpr double kRowsOfBlock = 16.0;
/// How far objects of a level may drift, in the longest edges there.
inline constexpr double kSlackOfEdge = 0.2;

inline constexpr std::size_t kMostLevels = 16;

/// Sizes of a scene's objects in octaves, counted down from the largest, and how these are joined
/// into levels.
class SizeClasses {
 public:
  /// Sizes of 1 : 1e12. Where there are more, those that hold the most objects have classes. What
  /// has no size at all is in the last.
  static constexpr std::size_t kClasses = 41;

  /// Counts the rows of a pool, of which the octaves are known; where the objects of a class lie
  /// it takes from a sample. O(n).
  SizeClasses(const BoundsPool& pool, std::span<const std::uint32_t> octave,
              const Execution& execution) noexcept;

  /// Objects that have a class.
  [[nodiscard]] std::size_t objects() const noexcept { return objects_; }
  [[nodiscard]] std::size_t levels() const noexcept { return levels_; }
  /// The level for an object of an octave; `levels()` if it has no class. Level 0 has the smallest.
  [[nodiscard]] std::size_t level_of(std::uint32_t octave) const noexcept;

 private:
  struct Class {
    std::size_t count = 0;
    std::array<double, 3> edge{};    // sum, later mean
    std::array<double, 3> place{};   // sum of lower ends
    std::array<double, 3> square{};  // sum of their squares
    std::array<double, 3> range{};   // over which they are spread
  };
  struct Sample;
  struct Group;
  using Counts = std::array<std::size_t, kOctaves>;
  [[nodiscard]] std::size_t class_of(std::size_t octave) const noexcept;
  void choose_octaves(const Counts& count) noexcept;
  void measure(const BoundsPool& pool, std::span<const std::uint32_t> octave,
               const Execution& execution) noexcept;
  [[nodiscard]] Group group_of(std::size_t first, std::size_t last) const noexcept;
  [[nodiscard]] double cost(const Group& fine, const Group& coarse) const noexcept;
  void join() noexcept;

  std::array<Class, kClasses> class_;
  std::array<std::uint8_t, kClasses> level_{};
  std::size_t objects_ = 0;
  std::size_t levels_ = 0;
  std::size_t top_octave_ = 0;
};

/// Edge of the cube that holds `wanted` of `count` objects spread evenly over ranges. Axes along
/// which they are spread over less than that edge do not count.
[[nodiscard]] double edge_for(double wanted, double count,
                              const std::array<double, 3>& range) noexcept;

}  // namespace winnow
