#pragma once

// The columns in which a partition stores bounding volumes.

#include <winnow/core/volumes.h>

#include <cstddef>

namespace winnow {

/// Returns the number of float columns of a volume: the lower and the upper ends of its box, then
/// the lower and the upper ends of the other slabs of a k-DOP, or the centre and radius of a
/// sphere.
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

inline constexpr std::size_t kMaxColumns = 26;  ///< Largest number of columns of a volume.

/// First of the three columns of a sphere's centre, behind the columns of its box.
inline constexpr std::size_t kCenterColumn = 6;
inline constexpr std::size_t kRadiusColumn = 9;  ///< Column of a sphere's radius.

/// Returns the number of slabs of a volume; a sphere has the three slabs of its box.
[[nodiscard]] constexpr std::size_t slab_count(Volume volume) noexcept {
  return volume == Volume::sphere ? 3 : column_count(volume) / 2;
}

/// Returns the column of the lower end of slab `s`; the columns of the box come first.
[[nodiscard]] constexpr std::size_t low_column(std::size_t, std::size_t s) noexcept {
  return s < 3 ? s : s + 3;
}
/// Returns the column of the upper end of slab `s` of `slabs`.
[[nodiscard]] constexpr std::size_t high_column(std::size_t slabs, std::size_t s) noexcept {
  return s < 3 ? s + 3 : slabs + s;
}

}  // namespace winnow
