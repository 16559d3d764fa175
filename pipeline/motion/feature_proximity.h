#pragma once

#include <winnow/pipeline/deformable_mesh.h>

namespace winnow {

/// Computes the nearest points of two features, their distance and weights; leaves the feature
/// numbers unchanged.
void find_nearest_points(FeaturePair kind, const std::array<Vec3d, 4>& points,
                         MeshProximity& result) noexcept;

}  // namespace winnow
