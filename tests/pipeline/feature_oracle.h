#pragma once

#include <winnow/pipeline/impacts.h>

namespace winnow::test {

/// Facts about two moving features, proved in exact arithmetic. They do not touch before `from`. If
/// `touch` is set, they touch in [from, to]; if `apart` is set, they never touch. If neither could
/// be proved, neither is set.
struct ExactImpact {
  bool touch = false;
  bool apart = false;
  double from = 0.0;
  double to = 1.0;
};

/// Bisects the step, earlier halves first, until an interval is settled in one of two ways. The
/// features do not touch in it if a plane through the origin has all corners of the polygon of
/// differences strictly on one side at both ends. They touch in it if the signed volume does not
/// keep its sign while the origin, seen along a fixed direction, stays inside the polygon. The
/// search ends at the first interval with a touch, or at the first interval of length 2^-halvings
/// that is not settled.
[[nodiscard]] ExactImpact exact_impact(FeaturePair kind, const std::array<Vec3d, 4>& start,
                                       const std::array<Vec3d, 4>& end, int halvings = 44);

/// Returns the distance of the features at a time, to about double precision.
[[nodiscard]] double feature_distance(FeaturePair kind, const std::array<Vec3d, 4>& start,
                                      const std::array<Vec3d, 4>& end, double time);

}  // namespace winnow::test
