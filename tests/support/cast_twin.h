#pragma once

#include <winnow/core/cast.h>

#include <Eigen/Core>

namespace winnow::test {

/// What a cast may be told about one box.
struct CastTruth {
  bool must = false;  ///< it is hit, so it has to be reported
  bool may = false;   ///< it is hit, or missed by no more than the interface allows
  // If `may`: the first touch lies between these, which are apart by what the interface allows.
  double earliest = 0.0;
  double latest = 0.0;
};

/// The slow obvious twin. Of rays and boxes `must` is the answer of exact arithmetic; of spheres
/// and capsules that of long double, but for what it cannot decide. An infinite end of the box
/// counts as the largest float.
[[nodiscard]] CastTruth truth_of(const Cast& cast, const Aabb& box);

/// True if `t` is the first touch, rounded down to a float.
[[nodiscard]] bool is_first_touch(float t, const CastTruth& truth);

/// The box with infinite ends replaced by the largest float.
[[nodiscard]] Aabb finite(Aabb box);

/// Size of the coordinates of a box, infinite ones left out.
[[nodiscard]] double magnitude(const Aabb& box);

/// The square of the distance between the segment from a to b and a box.
[[nodiscard]] long double segment_box_square(const Eigen::Vector3<long double>& a,
                                             const Eigen::Vector3<long double>& b, const Aabb& box);

}  // namespace winnow::test
