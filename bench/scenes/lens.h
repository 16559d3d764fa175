#pragma once

#include <winnow/pipeline/shapes.h>

namespace winnow::bench {

/// What two balls share whose middles are at z = -middle and z = middle, 0 <= middle < radius. No
/// library has it as a shape, but many take sets that are told by their farthest points.
struct Lens {
  double radius = 1.0;
  double middle = 0.5;
};

/// The point that is farthest along a direction of any length but 0.
void farthest_of_lens(const Lens& lens, const double direction[3], double point[3]) noexcept;
/// `lens` outlives the shape.
[[nodiscard]] SupportShape shape_of(const Lens& lens) noexcept;
/// The distance of its farthest points, those of its rim, from its middle.
[[nodiscard]] double rim_of(const Lens& lens) noexcept;

}  // namespace winnow::bench
