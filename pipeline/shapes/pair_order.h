#pragma once

// The order of the two shapes of a pair, the index of a pair of kinds, and the conversion of a
// result for (b, a) into one for (a, b).

#include <winnow/core/volumes.h>
#include <winnow/pipeline/shapes.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/numbers/rounding.h"

namespace winnow {

/// Kernels take the shape with the smaller kind first. A mirrored pair is computed as (b, a) and
/// its result is mirrored back.
[[nodiscard]] constexpr bool is_mirrored(ShapeId a, ShapeId b) noexcept {
  return a.kind_index() > b.kind_index();
}

/// Indices of pairs of kinds, convex and composite, with kind a <= kind b, in lexicographic order
/// of (a, b).
struct KindPairs {
  static constexpr std::uint32_t kCount = kShapeKinds * (kShapeKinds + 1) / 2;

  [[nodiscard]] static constexpr std::uint32_t index(std::uint32_t a, std::uint32_t b) noexcept {
    return a * (2 * kShapeKinds - 1 - a) / 2 + b;
  }
  [[nodiscard]] static constexpr std::uint32_t index(ShapeKind a, ShapeKind b) noexcept {
    return index(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
  }
  [[nodiscard]] static constexpr std::uint32_t index(ShapeId a, ShapeId b) noexcept {
    return index(a.kind_index(), b.kind_index());
  }
  [[nodiscard]] static constexpr std::uint32_t first(std::uint32_t index) noexcept {
    std::uint32_t a = 0;
    while (a + 1 < kShapeKinds && KindPairs::index(a + 1, a + 1) <= index) ++a;
    return a;
  }
  [[nodiscard]] static constexpr std::uint32_t second(std::uint32_t index) noexcept {
    const std::uint32_t a = first(index);
    return index - KindPairs::index(a, 0);
  }
};

/// Swaps the feature of a (upper half) and the feature of b (lower half).
[[nodiscard]] constexpr std::uint64_t mirrored_feature(std::uint64_t feature) noexcept {
  return feature << 32U | feature >> 32U;
}

/// Converts a coordinate relative to body a into one relative to body b; `apart` is b's position
/// minus a's. Clamped to the finite floats.
[[nodiscard]] inline float mirrored_position(float x, double apart) noexcept {
  return finite_float(static_cast<double>(x) - apart);
}

/// Computes a coordinate of b's witness point relative to body b: `x` is the coordinate of a's
/// witness point relative to body a, `way` the vector from a's point to b's, `apart` b's position
/// minus a's. Clamped to the finite doubles.
[[nodiscard]] inline double mirrored_point(double x, double way, double apart) noexcept {
  static constexpr double kMaxDouble = std::numeric_limits<double>::max();
  const auto finite = [](double v) { return std::clamp(v, -kMaxDouble, kMaxDouble); };
  return finite(finite(x + way) - finite(apart));
}

}  // namespace winnow
