#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/shapes.h>

#include <cstdint>

namespace winnow {

struct SolverCounts {
  std::uint64_t pairs = 0;
  /// Pairs whose sign double could not decide, which were passed to exact arithmetic.
  std::uint64_t exact = 0;
  /// Iterations that reached their bound and fell back to enumeration.
  std::uint64_t bounded = 0;

  SolverCounts& operator+=(const SolverCounts& other) noexcept {
    pairs += other.pairs;
    exact += other.exact;
    bounded += other.bounded;
    return *this;
  }
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
