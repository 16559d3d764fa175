#pragma once

#include <winnow/core/export.h>
#include <winnow/core/vec3.h>

#include <cmath>

namespace winnow {

/// The closed half-space of points p with normal . p + offset >= 0. The normal points inward and
/// has any finite length but zero.
struct Plane {
  /// Inward; finite, not zero.
  Vec3f normal = {1.0F, 0.0F, 0.0F};
  float offset = 0.0F;  ///< finite; of the origin, along the normal, times its length

  /// True if a query takes this plane: finite, and its normal not zero.
  [[nodiscard]] bool is_valid() const noexcept {
    return normal.all_finite() && std::isfinite(offset) && !normal.is_zero();
  }
};

static_assert(sizeof(Plane) == 16 && alignof(Plane) == 4, "layout must not depend on build flags");

}  // namespace winnow
