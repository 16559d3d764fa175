#pragma once

#include <winnow/pipeline/shapes.h>

namespace winnow::bench {

/// The intersection of two balls with centres at z = -middle and z = middle, 0 <= middle < radius.
/// No library has this shape, but many accept user shapes defined by a support function.
struct Lens {
  double radius = 1.0;
  double middle = 0.5;
};

/// Computes the support point in a direction of any nonzero length.
void farthest_of_lens(const Lens& lens, const double direction[3], double point[3]) noexcept;
/// Returns a user shape that refers to `lens`, which must outlive it.
[[nodiscard]] SupportShape shape_of(const Lens& lens) noexcept;
/// Returns the distance of the farthest points, which are on the rim, from the origin.
[[nodiscard]] double rim_of(const Lens& lens) noexcept;

}  // namespace winnow::bench
