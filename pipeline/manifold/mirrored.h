#pragma once

// What the contacts of a pair (a, b) are as those of (b, a).

#include <winnow/core/rounding.h>

#include <cstdint>

namespace winnow {

/// The feature of a in the upper half and that of b in the lower one change places.
[[nodiscard]] constexpr std::uint64_t mirrored_feature(std::uint64_t feature) noexcept {
  return feature << 32U | feature >> 32U;
}

/// A coordinate of a point relative to body a, relative to body b, which is `apart` farther; at
/// most the largest float.
[[nodiscard]] inline float mirrored_position(float x, double apart) noexcept {
  return finite_float(static_cast<double>(x) - apart);
}

}  // namespace winnow
