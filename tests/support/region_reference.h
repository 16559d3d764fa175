#pragma once

#include <winnow/core/regions.h>

namespace winnow::test {

/// The results that an overlap query may report for one box.
struct RegionTruth {
  bool must = false;         ///< must be reported
  bool may = false;          ///< may be reported
  bool must_inside = false;  ///< clearly inside: must be reported as inside
  bool may_inside = false;   ///< inside, or outside by no more than rounding
};

/// The reference implementation. Exact arithmetic decides `must`, except for capsules: there `must`
/// is false if the error of long double could change the result. For a frustum `must` is also false
/// if the box is outside its `bounds`. An infinite end of the box counts as the largest float.
[[nodiscard]] RegionTruth truth_of(const Region& region, const Aabb& box);

/// Returns the distance of two boxes in double, with a relative error below 1e-15.
[[nodiscard]] double distance(const Aabb& a, const Aabb& b);

}  // namespace winnow::test
