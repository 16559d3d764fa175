#pragma once

#include <winnow/core/export.h>

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Kind of bounding volume that a partition stores and tests.
enum class Volume : std::uint8_t {
  aabb,    ///< a box along the axes: Aabb
  sphere,  ///< a ball: Sphere
  kdop14,  ///< Kdop<14>: a box with cut corners
  kdop18,  ///< Kdop<18>: a box with cut edges
  kdop26,  ///< Kdop<26>: both
};

/// Float columns a volume takes: the lower and the upper ends of its box, then the lower and the
/// upper ends of its further slabs; of a sphere its centre and radius.
[[nodiscard]] constexpr std::size_t column_count(Volume volume) noexcept {
  switch (volume) {
    case Volume::aabb:
      return 6;
    case Volume::sphere:
      return 10;
    case Volume::kdop14:
      return 14;
    case Volume::kdop18:
      return 18;
    case Volume::kdop26:
      return 26;
  }
  return 6;
}

inline constexpr std::size_t kMaxColumns = 26;  ///< The most that any volume takes.

/// Columns of a sphere's centre and radius: behind those of its box.
inline constexpr std::size_t kCenterColumn = 6;
inline constexpr std::size_t kRadiusColumn = 9;  ///< Of the radius.

/// Slabs of a volume: a sphere has its box's.
[[nodiscard]] constexpr std::size_t slab_count(Volume volume) noexcept {
  return volume == Volume::sphere ? 3 : column_count(volume) / 2;
}

/// Columns of the ends of slab `s` of `slabs`: those of the box come first.
[[nodiscard]] constexpr std::size_t low_column(std::size_t, std::size_t s) noexcept {
  return s < 3 ? s : s + 3;
}
/// That of the slab's upper end.
[[nodiscard]] constexpr std::size_t high_column(std::size_t slabs, std::size_t s) noexcept {
  return s < 3 ? s + 3 : slabs + s;
}

}  // namespace winnow
