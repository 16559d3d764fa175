#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {

/// Bound on the relative error of the functions below.
inline constexpr double kBoxMeasureError = 0x1p-48;

/// Lower bound on the time t in [0, limit] at which the moving box [min, max] + t * direction first
/// overlaps the box [low, high]; infinite if it does not.
[[nodiscard]] inline double moving_box_time(const double min[3], const double max[3],
                                            const double direction[3], double limit,
                                            const double low[3], const double high[3]) noexcept {
  double entry = 0.0;
  double exit = limit;
  for (int axis = 0; axis < 3; ++axis) {
    const double near = low[axis] - max[axis];
    const double far = high[axis] - min[axis];
    const double d = direction[axis];
    if (d == 0.0) {
      if (near > 0.0 || far < 0.0) return std::numeric_limits<double>::infinity();
      continue;
    }
    const double a = near / d;
    const double b = far / d;
    // Infinities can make NaN; as the second operand of min or max it is ignored.
    entry = std::max(entry, std::min(a, b) * (1.0 - kBoxMeasureError));
    exit = std::min(exit, std::max(a, b) * (1.0 + kBoxMeasureError));
  }
  return entry <= exit ? entry : std::numeric_limits<double>::infinity();
}

/// Lower bound on the distance of two boxes.
[[nodiscard]] inline double box_gap(const double min[3], const double max[3], const double low[3],
                                    const double high[3]) noexcept {
  double gap[3];
  for (int axis = 0; axis < 3; ++axis) {
    gap[axis] = std::max({0.0, min[axis] - high[axis], low[axis] - max[axis]});
  }
  return std::hypot(gap[0], gap[1], gap[2]) * (1.0 - kBoxMeasureError);
}

}  // namespace winnow
