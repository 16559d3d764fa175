#pragma once

#include "pipeline/solver/core.h"
#include "pipeline/solver/gjk.h"

namespace winnow::solver {

struct DepthBounds {
  /// A lower bound of the depth; 0 if none is proven. The depth along `axis` (unit, from a to b) is
  /// an upper bound.
  double lower = 0.0;
  Vec axis = Vec::Zero();
};

/// Computes bounds of the penetration depth by the expanding polytope algorithm: a polytope inside
/// the Minkowski difference grows at its face nearest to the origin (van den Bergen, "Proximity
/// queries and penetration depth computation on 3D game objects", 2001). The nearest face bounds
/// the depth from below, the support along a face's normal from above. Ends when the gap between
/// the bounds is at most `tolerance`, when no face can grow, or when the fixed arrays are full
/// (about two thousand faces, on the stack).
///
/// `simplex` contains the origin, up to rounding; it is completed to a tetrahedron. If the
/// difference of the cores is flat, the depth is 0 along its normal. `noise`: as GjkLimits::noise.
[[nodiscard]] DepthBounds expand_polytope(const Core& a, const Core& b, const GjkSimplex& simplex,
                                          double noise, double tolerance) noexcept;

}  // namespace winnow::solver
