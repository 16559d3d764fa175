#pragma once

#include <winnow/pipeline/feature_impacts.h>

namespace winnow::test {

/// What is true of two features in motion, by exact arithmetic alone: no touch before `from`; and,
/// if `touch`, one in [from, to], if `apart`, none at all. Neither where it could not be settled.
struct ExactImpact {
  bool touch = false;
  bool apart = false;
  double from = 0.0;
  double to = 1.0;
};

/// Cuts the step in halves until each is settled: by a plane through the origin that exactly has
/// all corners of the polygon of differences on one side at both ends; or by a volume of opposite
/// signs at both ends while the origin, seen along a fixed direction, is inside of the polygon
/// throughout. At most 2^-halvings of the step is left unsettled.
[[nodiscard]] ExactImpact exact_impact(FeaturePair kind, const std::array<Vec3d, 4>& start,
                                       const std::array<Vec3d, 4>& end, int halvings = 44);

/// The distance of the features at a time, about as exact as a double.
[[nodiscard]] double feature_distance(FeaturePair kind, const std::array<Vec3d, 4>& start,
                                      const std::array<Vec3d, 4>& end, double time);

}  // namespace winnow::test
