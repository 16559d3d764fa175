#pragma once

#include "pipeline/composites/shape_distance.h"

namespace winnow {

/// Computes the penetration depth of two overlapping shapes of which one is a solid: sets the
/// distance, its error bound, the normal, the points and the parts of `answer`.
///
/// The depth is the length of a translation of b along the normal after which the shapes are apart.
/// It is found by moving b out along candidate directions, the normals of the overlapping surfaces
/// first, and by turning the shortest way towards the normal of the last contact that it leaves,
/// until it is shortest (as PolyDepth does: Je, Tang, Lee, Lee, Kim 2012). The error bound is the
/// difference to a lower bound: if a ball of radius r is inside one shape, and its centre is at the
/// signed distance d from the other shape, each translation that parts the shapes is at least r - d
/// long.
///
/// `pair` must overlap and contain no half-space. Returns false if sums of coordinates overflow.
[[nodiscard]] bool find_solid_depth(const SubShapeQuery& parts, const Pairing& pair,
                                    ShapeDistance& answer) noexcept;

}  // namespace winnow
