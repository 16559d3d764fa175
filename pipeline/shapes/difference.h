#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {

/// to - from, rounded, and what was lost: to - from = difference + rest, unless that overflows.
struct Difference {
  double difference[3];
  double rest[3];
};

[[nodiscard]] inline Difference difference(const double to[3], const double from[3]) noexcept {
  Difference result{};
  constexpr double kMost = std::numeric_limits<double>::max();
  for (int i = 0; i < 3; ++i) {
    // The error of a difference is a double (Knuth, TAOCP vol. 2, 4.2.2, theorem B).
    const double d = to[i] - from[i];
    const double back = d - to[i];
    const double rest = (to[i] - (d - back)) + (-from[i] - back);
    result.difference[i] = std::clamp(d, -kMost, kMost);
    result.rest[i] = std::isfinite(rest) ? rest : 0.0;
  }
  return result;
}

}  // namespace winnow
