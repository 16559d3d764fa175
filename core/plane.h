#pragma once

#include <winnow/core/export.h>

#include <Eigen/Core>
#include <cmath>

namespace winnow {

/// The closed half-space of points p with normal . p + offset >= 0. The normal points inward and
/// has any finite length but zero.
struct Plane {
  /// Inward; finite, not zero.
  Eigen::Vector3f normal = Eigen::Vector3f::UnitX();
  float offset = 0.0F;  ///< finite; of the origin, along the normal, times its length

  /// True if a query takes this plane: finite, and its normal not zero.
  [[nodiscard]] bool is_valid() const noexcept {
    return normal.allFinite() && std::isfinite(offset) && (normal.array() != 0.0F).any();
  }
};

static_assert(sizeof(Plane) == 16 && alignof(Plane) == 4, "layout must not depend on build flags");

}  // namespace winnow
