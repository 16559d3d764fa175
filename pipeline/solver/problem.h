#pragma once

// The input of the solver: two cores in one frame, scaled so that no intermediate result overflows
// or underflows.

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/solver/core.h"

namespace winnow::solver {

/// A pair in one frame: the origin is the position of a, the axes are the world's, and lengths are
/// scaled by a power of two so that the largest is about 1.
struct Problem {
  Core a;
  Core b;
  /// A length in the problem is the caller's length times 2^-exponent.
  int exponent = 0;
  /// The sum |b.center| + size of a + size of b; errors are relative to it.
  double size = 0.0;
  /// The columns are +x, +y, +z of the caller's a, as directions from a to b; break_ties uses them.
  Mat tie_axes = Mat::Identity();

  /// A generous bound of the rounding error of any length of the pair. The support functions of
  /// user shapes are exact to a few roundings, too (SupportShape).
  [[nodiscard]] double noise() const noexcept { return 32.0 * kEpsilon * size; }
};

/// True if a pair must be prepared and solved as (b, a): half-spaces come second, and of two other
/// kinds the smaller comes first.
[[nodiscard]] constexpr bool is_prepared_mirrored(ShapeKind a, ShapeKind b) noexcept {
  return a != b && (a == ShapeKind::half_space || (b != ShapeKind::half_space && a > b));
}

/// Fills in a problem. `mirrored`: the caller's a is this b.
void prepare(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
             const Pose& pose_b, bool mirrored, Problem& problem) noexcept;

/// Returns the largest length of two shapes. Together with their distance it determines a problem's
/// exponent.
[[nodiscard]] double largest_length(const ShapeTables& tables, ShapeId a, ShapeId b) noexcept;

/// Moves b to the finite offset `between` from a: the problem is then as if `prepare` had made it,
/// all else unchanged. Returns false and changes nothing if the exponent would differ. `largest` is
/// the `largest_length` of the two shapes.
[[nodiscard]] bool move(const Vec& between, double largest, Problem& problem) noexcept;

/// Returns length * 2^exponent, clamped to the finite range; a length that is not finite is
/// returned as it is.
[[nodiscard]] double unscaled(const Problem& problem, double length) noexcept;

}  // namespace winnow::solver
