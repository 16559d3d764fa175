#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/shapes.h>

#include <cstdint>

namespace winnow {

/// What the solver did, for statistics.
struct SolverCounts {
  std::uint64_t pairs = 0;
  /// Pairs whose sign double could not tell: decided in exact arithmetic.
  std::uint64_t exact = 0;
  /// Iterations that met their bound and fell back to enumeration.
  std::uint64_t bounded = 0;

  SolverCounts& operator+=(const SolverCounts& other) noexcept {
    pairs += other.pairs;
    exact += other.exact;
    bounded += other.bounded;
    return *this;
  }
};

/// Any pair of valid shapes at valid poses, one at a time, in double and, where that cannot tell
/// the sign, in exact arithmetic: the tier `reference`, and where the lanes of the tier `robust`
/// send what they cannot certify. Never NaN, always ends.
///
/// The distance is that of the cores less the roundings; where the shapes overlap it is minus the
/// penetration depth: the length of the shortest translation of b that leaves them touching. Shapes
/// whose closest direction is not unique (coincident centres) take the first of +x, +y, +z and
/// their opposites, in the frame of a, that is one of the closest. Two half-spaces that do not face
/// each other overlap without end: the distance is minus the largest double, the bound infinite.
[[nodiscard]] PairAnswer solve_pair(const ShapeTables& tables, ShapeId a, const Pose& pose_a,
                                    ShapeId b, const Pose& pose_b, ContactLevel level,
                                    double margin, SolverCounts& counts) noexcept;

/// The answer about (b, a) becomes that about (a, b).
void mirror(const Pose& pose_a, const Pose& pose_b, PairAnswer& answer) noexcept;

}  // namespace winnow
