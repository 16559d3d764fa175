#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/sphere.h>
#include <winnow/core/vec3.h>

#include <cmath>

namespace winnow {

/// All points within `radius` of the segment from `a` to `b`; closed. If `a` equals `b` the capsule
/// is a ball; if the radius is zero it is a segment.
struct Capsule {
  /// First end of the segment; finite.
  Vec3f a;
  /// Second end of the segment; finite, may be equal to `a`.
  Vec3f b;
  float radius = 0.0F;  ///< finite, >= 0

  /// Returns true if a query accepts this capsule: finite ends, finite radius >= 0.
  [[nodiscard]] bool is_valid() const noexcept {
    return a.all_finite() && b.all_finite() && std::isfinite(radius) && radius >= 0.0F;
  }

  /// Returns the smallest float box that contains the capsule.
  [[nodiscard]] Aabb bounds() const noexcept {
    Aabb box = Sphere{a, radius}.bounds();
    box.merge(Sphere{b, radius}.bounds());
    return box;
  }
};

static_assert(sizeof(Capsule) == 28 && alignof(Capsule) == 4,
              "layout must not depend on build flags");

}  // namespace winnow
