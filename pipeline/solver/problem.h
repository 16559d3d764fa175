#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/solver/core.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace winnow::solver {

/// A pair in one frame: origin at the position of a, axes of the world, lengths scaled by a power
/// of two so that the largest is about 1.
struct Problem {
  Core a;
  Core b;
  /// A length of the problem is the caller's times 2^-exponent.
  int exponent = 0;
  /// |c| + size of a + size of b: what errors are relative to.
  double size = 0.0;
  /// Columns +x, +y, +z of the caller's a, as directions from a to b: for ties.
  Mat tie_axes = Mat::Identity();

  /// What rounding does to any length of the pair, with room to spare.
  [[nodiscard]] double noise() const noexcept { return 32.0 * kEpsilon * size; }
};

/// The solver takes half-spaces second, and of other kinds the smaller first: true if a pair is
/// to be prepared, and solved, as (b, a).
[[nodiscard]] constexpr bool is_prepared_mirrored(ShapeKind a, ShapeKind b) noexcept {
  return a != b && (a == ShapeKind::half_space || (b != ShapeKind::half_space && a > b));
}

/// `mirrored`: the caller's a is this b.
void prepare(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
             const Pose& pose_b, bool mirrored, Problem& problem) noexcept;

/// What of two shapes a problem's exponent depends on, beside how far they are apart.
[[nodiscard]] double largest_length(const ShapeTables& tables, ShapeId a, ShapeId b) noexcept;

/// Makes of a problem the one that `prepare` would make with b at `between`, finite, from a, and
/// all else as it was. False, and unchanged, if it would have another exponent. `largest` is the
/// `largest_length` of the two.
[[nodiscard]] bool move(const Vec& between, double largest, Problem& problem) noexcept;

/// Multiplies by 2^-exponent, in two steps where that is no double.
class Scale {
 public:
  explicit Scale(int exponent) noexcept {
    constexpr int kLargest = 1000;
    const int second = std::min(exponent + kLargest, 0);
    factor_[0] = power_of_two(second - exponent);
    factor_[1] = power_of_two(-second);
  }
  [[nodiscard]] double operator()(double x) const noexcept { return x * factor_[0] * factor_[1]; }

 private:
  [[nodiscard]] static double power_of_two(int exponent) noexcept {
    constexpr int kNormal = 1022;
    if (std::abs(exponent) > kNormal) return std::ldexp(1.0, exponent);
    return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + kNormal + 1) << 52U);
  }

  double factor_[2];
};

/// x 2^exponent, at most the largest double if it is finite.
[[nodiscard]] double unscaled(const Problem& problem, double length) noexcept;

}  // namespace winnow::solver
