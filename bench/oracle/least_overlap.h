#pragma once

#include "bench/oracle/polytope.h"

#include <vector>

namespace winnow::oracle {

/// Directions of length 1 from a to b along which two cores that share a point overlap least, best
/// first, and the gaps along them, which are <= 0.
struct LeastOverlap {
  struct Direction {
    Vector<Number> normal;
    Number gap;
  };
  /// All whose gap is within the slack of the best.
  std::vector<Direction> direction;
};

/// Tries every normal that a face of the difference of the cores can have. Coordinates are of the
/// order of 1; `slack` is at least 1e-9.
[[nodiscard]] LeastOverlap least_overlap(const Polytope& a, const Polytope& b, double slack);

}  // namespace winnow::oracle
