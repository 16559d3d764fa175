#pragma once

// Which shape of a pair comes first, how pairs of kinds are numbered, and what the answer about a
// pair (a, b) is as one about (b, a).

#include <winnow/core/rounding.h>
#include <winnow/pipeline/shapes.h>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace winnow {

/// Pairs are answered with the shape of the smaller kind first. One given the other way round is
/// mirrored: it is answered as (b, a), and the answer is mirrored back.
[[nodiscard]] constexpr bool is_mirrored(ShapeId a, ShapeId b) noexcept {
  return a.kind_index() > b.kind_index();
}

/// The numbers of pairs of kinds, convex and composite, that of a not above that of b: they rise
/// with a and, of one a, with b.
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

/// The feature of a in the upper half and that of b in the lower one change places.
[[nodiscard]] constexpr std::uint64_t mirrored_feature(std::uint64_t feature) noexcept {
  return feature << 32U | feature >> 32U;
}

/// A coordinate of a point relative to body a, relative to body b, which is `apart` farther; at
/// most the largest float.
[[nodiscard]] inline float mirrored_position(float x, double apart) noexcept {
  return finite_float(static_cast<double>(x) - apart);
}

/// A coordinate of the point of b relative to body b, which is `apart` farther, from that of a
/// relative to body a and the way from there to it; at most the largest double.
[[nodiscard]] inline double mirrored_point(double x, double way, double apart) noexcept {
  static constexpr double kMost = std::numeric_limits<double>::max();
  const auto finite = [](double v) { return std::clamp(v, -kMost, kMost); };
  return finite(finite(x + way) - finite(apart));
}

}  // namespace winnow
