#pragma once

#include <winnow/pipeline/impacts.h>

namespace winnow {

/// Two features of meshes in linear motion. The differences of their points span a polygon: p - f0,
/// p - f1, p - f2 for a vertex p and a face f; a0 - b0, a1 - b0, a1 - b1, a0 - b1 for edges a and
/// b. The features touch when the polygon contains the origin. Each number has an error of at most
/// half an ulp.
struct FeatureMotion {
  int corners = 0;
  Vec3d corner[2][4];  ///< at the start and at the end, in order around the polygon
  // The columns of the determinant that is zero at the times at which the features are coplanar: a
  // corner and two edges.
  Vec3d across[2];
  Vec3d edge[2][2];  ///< [first or second edge][start or end]
  Vec3d reach;       ///< the largest magnitude of a corner's coordinate, at either end
  double separation = 0.0;
};

/// Reads the points of two features. Returns false if a coordinate is not finite or a difference
/// overflows. If the largest number is not between kMinScaled and kMaxScaled, scales all numbers
/// and the separation by a power of two.
[[nodiscard]] bool read_motion(FeaturePair kind, const std::array<Vec3d, 4>& start,
                               const std::array<Vec3d, 4>& end, double separation,
                               FeatureMotion& motion) noexcept;

/// Finds the first impact. Options must be within their ranges.
[[nodiscard]] FeatureImpact first_impact(const FeatureMotion& motion,
                                         const FeatureImpactOptions& options) noexcept;

}  // namespace winnow
