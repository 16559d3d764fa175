#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/sphere.h>
#include <winnow/core/vec3.h>

#include <cmath>

namespace winnow {

/// All points within `radius` of the segment from `a` to `b`; closed. Equal ends make a ball, a
/// radius of zero a segment.
struct Capsule {
  /// One end of the segment.
  Vec3f a;
  /// Its other end, which may be the same.
  Vec3f b;
  float radius = 0.0F;  ///< distance from the segment up to which points belong to it; finite, >= 0

  /// True if a query takes this capsule: finite ends, finite radius >= 0.
  [[nodiscard]] bool is_valid() const noexcept {
    return a.all_finite() && b.all_finite() && std::isfinite(radius) && radius >= 0.0F;
  }

  /// The smallest float box that contains the capsule.
  [[nodiscard]] Aabb bounds() const noexcept {
    Aabb box = Sphere{a, radius}.bounds();
    box.merge(Sphere{b, radius}.bounds());
    return box;
  }
};

static_assert(sizeof(Capsule) == 28 && alignof(Capsule) == 4,
              "layout must not depend on build flags");

}  // namespace winnow
