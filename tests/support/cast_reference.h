#pragma once

#include <winnow/core/rays.h>

#include <Eigen/Core>

namespace winnow::test {

/// The results that a cast may report for one box.
struct CastTruth {
  bool must = false;  ///< hit: must be reported
  bool may = false;   ///< hit, or missed by no more than the interface allows
  // If `may` is true, the first touch is between these times. A cast may return any time between
  // them.
  double earliest = 0.0;
  double latest = 0.0;
};

/// The reference implementation. For rays and boxes `must` is decided by exact arithmetic. For
/// spheres and capsules it is decided by long double: it is false if the error of long double could
/// change the result. An infinite end of the box counts as the largest float.
[[nodiscard]] CastTruth truth_of(const Cast& cast, const Aabb& box);

/// Returns true if `t` is the first touch, rounded down to a float.
[[nodiscard]] bool is_first_touch(float t, const CastTruth& truth);

/// Returns the box with infinite ends replaced by the largest float.
[[nodiscard]] Aabb finite(Aabb box);

/// Returns the magnitude of the coordinates of a box, without infinite ones.
[[nodiscard]] double magnitude(const Aabb& box);

/// Returns the squared distance of the segment from a to b and a box.
[[nodiscard]] long double segment_box_square(const Eigen::Vector3<long double>& a,
                                             const Eigen::Vector3<long double>& b, const Aabb& box);

}  // namespace winnow::test
