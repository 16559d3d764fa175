#pragma once

#include <winnow/core/cast.h>

#include <Eigen/Core>

namespace winnow::test {

/// The results that a cast may report for one box.
struct CastTruth {
  bool must = false;  ///< hit: must be reported
  bool may = false;   ///< hit, or missed by no more than the interface allows
  // If `may`: the first touch is between these times, whose difference the interface allows.
  double earliest = 0.0;
  double latest = 0.0;
};

/// The reference implementation. For rays and boxes `must` is the result of exact arithmetic, for
/// spheres and capsules of long double, except for cases that it cannot decide. An infinite end of
/// the box counts as the largest float.
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
