#pragma once

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Kind of bounding volume that a partition stores and tests.
enum class Volume : std::uint8_t { aabb, sphere, kdop14, kdop18, kdop26 };

/// Float columns a volume takes: the lower ends of its slabs, then the upper ends; a sphere has
/// centre and radius.
[[nodiscard]] constexpr std::size_t column_count(Volume volume) noexcept {
  switch (volume) {
    case Volume::aabb:
      return 6;
    case Volume::sphere:
      return 4;
    case Volume::kdop14:
      return 14;
    case Volume::kdop18:
      return 18;
    case Volume::kdop26:
      return 26;
  }
  return 6;
}

inline constexpr std::size_t kMaxColumns = 26;

}  // namespace winnow
