#pragma once

#include "bench/oracle/polytope.h"

namespace winnow::oracle {

/// The widest gap between two cores over all directions: their distance or, if it is not positive,
/// minus the depth by which they overlap.
struct WidestGap {
  Number width = 0;
  Vector<Number> normal;  ///< its direction, of unit length, from a to b
  /// True if no direction more than 0.1 degrees away has a gap within the slack of the widest.
  bool unique = false;
};

/// Tests every direction in which features of the cores can face each other. Coordinates must be of
/// the order of 1.
[[nodiscard]] WidestGap widest_gap(const Polytope& a, const Polytope& b, double slack);

}  // namespace winnow::oracle
