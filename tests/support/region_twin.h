#pragma once

#include <winnow/core/region.h>

namespace winnow::test {

/// What an overlap query may say about one box.
struct RegionTruth {
  bool must = false;         ///< it has to be reported
  bool may = false;          ///< it may be reported
  bool must_inside = false;  ///< clearly inside: it has to be among those inside
  bool may_inside = false;   ///< inside, or outside by no more than rounding
};

/// The slow obvious twin. `must` is the answer of exact arithmetic, but for capsules, where it is
/// that of long double for what that can decide. An infinite end of the box counts as the largest
/// float.
[[nodiscard]] RegionTruth truth_of(const Region& region, const Aabb& box);

/// Distance between two boxes, in double: off by less than 1e-15 of itself.
[[nodiscard]] double distance(const Aabb& a, const Aabb& b);

}  // namespace winnow::test
