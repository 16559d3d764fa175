#pragma once

// The scalar narrow phase: solve_pair. problem.h has its input, core_distance.h the distance of the
// cores, manifold.h the contacts; exact/exact_overlap.h decides signs.

#include <winnow/core/pose.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/shapes.h>

#include <cstdint>

namespace winnow {

struct SolverCounts {
  /// Pairs whose sign double could not decide, which were passed to exact arithmetic.
  std::uint64_t exact = 0;
  /// Times that a search did not close its bounds: GJK reached its limit of iterations, features
  /// had to be enumerated, or EPA left a gap. A pair may count several times.
  std::uint64_t bounded = 0;
};

/// Solves any pair of valid shapes at valid poses, one pair at a time, in double; exact arithmetic
/// decides the sign if double cannot. This is tier `reference`; tier `robust` calls it for the
/// pairs that the SIMD kernels cannot certify. Always terminates and never returns NaN.
///
/// The distance is the distance of the cores minus the roundings. If the shapes overlap, it is
/// minus the penetration depth: the length of the shortest translation of b that leaves the shapes
/// touching. If the closest direction is not unique (coincident centers), the first of +x, -x, +y,
/// -y, +z, -z of the frame of a that is a closest direction is taken. Two half-spaces that do not
/// face each other overlap without bound: the distance is minus the largest double, the error bound
/// infinite.
[[nodiscard]] PairAnswer solve_pair(const ShapeTables& tables, ShapeId a, const Pose& pose_a,
                                    ShapeId b, const Pose& pose_b, ContactLevel level,
                                    double margin, SolverCounts& counts) noexcept;

/// Turns the answer about (b, a) into the answer about (a, b).
void mirror(const Pose& pose_a, const Pose& pose_b, PairAnswer& answer) noexcept;

}  // namespace winnow
