#pragma once

#include <winnow/pipeline/deformable_mesh.h>

namespace winnow {

/// The nearest points of two features, their distance and weights; the numbers of the features
/// stay.
void find_nearest_points(FeaturePair kind, const std::array<Vec3d, 4>& points,
                         MeshProximity& result) noexcept;

}  // namespace winnow
