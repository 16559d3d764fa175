#pragma once

// Plain arrays on purpose: kernel files read poses too, and they include no Eigen.

#include <winnow/core/export.h>

namespace winnow {

/// Where a body is: x -> position + R(orientation) x. Position and orientation are in double, so
/// that poses read from a file or a solver are taken as they are; answers are computed from the
/// difference of positions and do not depend on where in the world they are asked.
struct Pose {
  double position[3] = {0.0, 0.0, 0.0};  ///< of the shape's own origin, in the world
  /// Quaternion w, x, y, z of any finite length but zero; R is that of the normalised quaternion.
  double orientation[4] = {1.0, 0.0, 0.0, 0.0};

  /// At a place, not turned.
  [[nodiscard]] static constexpr Pose at(double x, double y, double z) noexcept {
    return {{x, y, z}, {1.0, 0.0, 0.0, 0.0}};
  }

  /// True if all numbers are finite and the quaternion is not zero.
  [[nodiscard]] bool is_valid() const noexcept {
    double sum = 0.0;
    double turn = 0.0;
    for (const double p : position) sum += p - p;
    for (const double q : orientation) {
      sum += q - q;
      turn = turn > q ? turn : q;
      turn = turn > -q ? turn : -q;
    }
    return sum == 0.0 && turn > 0.0;
  }
};

static_assert(sizeof(Pose) == 56 && alignof(Pose) == 8, "layout must not depend on build flags");

}  // namespace winnow
