#pragma once

#include "pipeline/solver/core.h"
#include "pipeline/solver/gjk.h"

namespace winnow::solver {

/// What is known of the depth of two cores that overlap.
struct DepthBounds {
  /// No less; that along `axis` (unit, from a to b) is no less than the depth.
  double lower = 0.0;
  Vec axis = Vec::Zero();
};

/// Penetration depth by a polytope inside the Minkowski difference that is grown where it is
/// nearest to the origin (van den Bergen, "Proximity queries and penetration depth computation on
/// 3D game objects", 2001). The nearest face of the inner polytope bounds the depth from below, the
/// support along a face's normal from above: the result is proved as far as the gap between them.
/// Ends when the gap is at most `tolerance`, when faces can grow no more, or when there is no room
/// for more (some two thousand faces, on the stack).
///
/// `simplex` contains the origin, up to rounding; it is completed to a tetrahedron. Cores whose
/// difference is flat have depth 0 along its normal. `noise`: as in gjk.
[[nodiscard]] DepthBounds expand(const Core& a, const Core& b, const Simplex& simplex, double noise,
                                 double tolerance) noexcept;

}  // namespace winnow::solver
