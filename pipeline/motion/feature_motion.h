#pragma once

#include <winnow/pipeline/feature_impacts.h>

namespace winnow {

/// Two features of meshes in linear motion. Their points' differences span a polygon: p - f0,
/// p - f1, p - f2 of a vertex p and a face f; a0 - b0, a1 - b0, a1 - b1, a0 - b1 of edges a and b.
/// Each number is off by half a unit in its last place at most.
struct FeatureMotion {
  int corners = 0;
  double corner[2][4][3];  ///< at the start and at the end, in order around the polygon
  // What spans the volume: a corner and two edges.
  double across[2][3];
  double edge[2][2][3];  ///< [first or second edge][start or end]
  double reach[3];       ///< the largest magnitude of a corner's coordinate, at either end
  double separation = 0.0;
};

/// False if a coordinate is not finite or a difference overflows. What is very large or small is
/// scaled by a power of two, the separation with it.
[[nodiscard]] bool read_motion(FeaturePair kind, const std::array<Vec3d, 4>& start,
                               const std::array<Vec3d, 4>& end, double separation,
                               FeatureMotion& motion) noexcept;

/// Options within their ranges.
[[nodiscard]] FeatureImpact first_impact(const FeatureMotion& motion,
                                         const FeatureImpactOptions& options) noexcept;

}  // namespace winnow
