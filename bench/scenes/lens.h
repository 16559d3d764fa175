#pragma once

#include <winnow/pipeline/shapes.h>

#include <cmath>

namespace winnow::bench {

/// The intersection of two balls with centres at z = -middle and z = middle, 0 <= middle < radius.
/// No library has this shape, but many accept user shapes defined by a support function.
struct Lens {
  double radius = 1.0;
  double middle = 0.5;
};

/// Returns the distance of the farthest points, which are on the rim, from the origin.
[[nodiscard]] inline double rim_of(const Lens& lens) noexcept {
  return std::sqrt((lens.radius - lens.middle) * (lens.radius + lens.middle));
}

/// Computes the support point in a direction of any nonzero length.
inline void farthest_of_lens(const Lens& lens, const double direction[3],
                             double point[3]) noexcept {
  const double square = direction[0] * direction[0] + direction[1] * direction[1];
  const double length = std::sqrt(square + direction[2] * direction[2]);
  const bool on_rim = lens.radius * std::abs(direction[2]) < lens.middle * length;
  const double across = std::sqrt(square);
  const double reach = on_rim ? (across > 0.0 ? rim_of(lens) / across : 0.0) : lens.radius / length;
  point[0] = direction[0] * reach;
  point[1] = direction[1] * reach;
  // The upper surface belongs to the lower ball.
  point[2] = on_rim ? 0.0 : direction[2] * reach - std::copysign(lens.middle, direction[2]);
}

/// Returns a user shape that refers to `lens`, which must outlive it.
[[nodiscard]] inline SupportShape shape_of(const Lens& lens) noexcept {
  SupportShape shape;
  shape.function = [](const void* context, const double direction[3], double point[3]) {
    farthest_of_lens(*static_cast<const Lens*>(context), direction, point);
  };
  shape.context = &lens;
  // Slightly larger, to cover rounding errors of the support function.
  shape.radius = rim_of(lens) * (1.0 + 1e-15);
  return shape;
}

}  // namespace winnow::bench
