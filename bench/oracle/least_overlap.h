#pragma once

#include "bench/oracle/polytope.h"

#include <vector>

namespace winnow::oracle {

/// Unit directions from a to b along which two cores that share a point overlap least, best first,
/// and the gaps along them, which are <= 0.
struct LeastOverlap {
  struct Direction {
    Vector<Number> normal;
    Number gap;
  };
  /// All directions whose gap is within the slack of the best.
  std::vector<Direction> direction;
};

/// Tests every normal that a face of the Minkowski difference of the cores can have. Coordinates
/// must be of the order of 1, `slack` at least 1e-9.
[[nodiscard]] LeastOverlap least_overlap(const Polytope& a, const Polytope& b, double slack);

}  // namespace winnow::oracle
