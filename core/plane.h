#pragma once

#include <winnow/core/export.h>
#include <winnow/core/vec3.h>

#include <cmath>

namespace winnow {

/// The closed half-space of all points p with normal . p + offset >= 0. The normal points inward
/// and may have any finite length except zero.
struct Plane {
  /// Inward normal; finite, not zero.
  Vec3f normal = {1.0F, 0.0F, 0.0F};
  float offset = 0.0F;  ///< signed distance of the origin times the normal's length; finite

  /// Returns true if a query accepts this plane: all finite, and its normal not zero.
  [[nodiscard]] bool is_valid() const noexcept {
    return normal.all_finite() && std::isfinite(offset) && !normal.is_zero();
  }
};

static_assert(sizeof(Plane) == 16 && alignof(Plane) == 4, "layout must not depend on build flags");

}  // namespace winnow
