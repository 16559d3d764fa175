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
/// How far objects of a level may drift, as a share of the longest edge of the level.
inline constexpr double kSlackOfEdge = 0.2;

inline constexpr std::size_t kMaxLevels = 16;

/// Counts objects by octaves of size, descending from the largest, and joins octaves into levels.
class SizeClasses {
 public:
  /// Octaves for sizes of up to 1e12 : 1. If sizes span more, the octaves with the most objects are
  /// classes. Objects of size 0 are in the last class.
  static constexpr std::size_t kClasses = 41;

  /// Counts the rows of a pool by their octaves; estimates the positions of a class's objects from
  /// a sample. O(n).
  SizeClasses(const BoundsPool& pool, std::span<const std::uint32_t> octave,
              const Execution& execution) noexcept;

  /// The number of objects that have a class.
  [[nodiscard]] std::size_t objects() const noexcept { return objects_; }
  [[nodiscard]] std::size_t levels() const noexcept { return levels_; }
  /// Returns the level of an octave, or `levels()` if it has no class. Level 0 has the smallest
  /// objects.
  [[nodiscard]] std::size_t level_of(std::uint32_t octave) const noexcept;

 private:
  struct SizeClass {
    std::size_t count = 0;
    std::array<double, 3> edge{};    // sum, then mean
    std::array<double, 3> place{};   // sum of lower bounds
    std::array<double, 3> square{};  // sum of squared lower bounds
    std::array<double, 3> range{};   // range over which the objects are spread
  };
  struct ClassSample;
  struct ClassGroup;
  using OctaveCounts = std::array<std::size_t, kOctaves>;
  [[nodiscard]] std::size_t class_of(std::size_t octave) const noexcept;
  void choose_octaves(const OctaveCounts& count) noexcept;
  void measure(const BoundsPool& pool, std::span<const std::uint32_t> octave,
               const Execution& execution) noexcept;
  [[nodiscard]] ClassGroup group_of(std::size_t first, std::size_t last) const noexcept;
  [[nodiscard]] double cost(const ClassGroup& fine, const ClassGroup& coarse) const noexcept;
  void join() noexcept;

  std::array<SizeClass, kClasses> class_;
  std::array<std::uint8_t, kClasses> level_{};
  std::size_t objects_ = 0;
  std::size_t levels_ = 0;
  std::size_t top_octave_ = 0;
};

/// Returns the edge of a cube that contains `target` objects if `count` objects are spread evenly
/// over the ranges. Ignores axes whose range is shorter than that edge.
[[nodiscard]] double edge_for(double target, double count,
                              const std::array<double, 3>& range) noexcept;

}  // namespace winnow
