#pragma once

// A pose consists of plain arrays, because kernel sources include this header, and may include only
// headers of plain structs; see simd/kernels/kernels.h.

#include <winnow/core/export.h>

namespace winnow {

/// Position and orientation of a body: maps x to position + R(orientation) x. Position and
/// orientation are in double, so that poses from a file or a solver are used unchanged. The narrow
/// phase computes with differences of positions, so its accuracy does not depend on the distance
/// from the world's origin.
struct Pose {
  double position[3] = {0.0, 0.0, 0.0};  ///< of the shape's origin, in world coordinates
  /// Quaternion w, x, y, z of any finite length except zero; R is the rotation of the normalised
  /// quaternion.
  double orientation[4] = {1.0, 0.0, 0.0, 0.0};

  /// Returns a pose at a position, without rotation.
  [[nodiscard]] static constexpr Pose at(double x, double y, double z) noexcept {
    return {{x, y, z}, {1.0, 0.0, 0.0, 0.0}};
  }

  /// Returns true if all numbers are finite and the quaternion is not zero.
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
