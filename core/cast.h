#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/capsule.h>
#include <winnow/core/ray.h>
#include <winnow/core/sphere.h>
#include <winnow/core/vec3.h>

#include <limits>
#include <variant>

namespace winnow {

/// A box that moves by t * direction for t in [min_t, max_t] and does not rotate.
struct BoxCast {
  Aabb box;  ///< the box at t = 0
  /// Displacement while t grows by 1; finite, not zero.
  Vec3f direction = {1.0F, 0.0F, 0.0F};
  float min_t = 0.0F;  ///< start of the path; finite, >= 0
  /// End of the path; >= min_t, may be infinite.
  float max_t = std::numeric_limits<float>::infinity();

  /// Returns true if a query accepts this cast: finite box with min <= max, valid direction and
  /// range.
  [[nodiscard]] bool is_valid() const noexcept {
    return box.min.all_finite() && box.max.all_finite() && box.is_valid() &&
           is_valid_path(direction, min_t, max_t);
  }
};

/// A ball that moves by t * direction for t in [min_t, max_t].
struct SphereCast {
  Sphere sphere;  ///< the ball at t = 0
  /// Displacement while t grows by 1; finite, not zero.
  Vec3f direction = {1.0F, 0.0F, 0.0F};
  float min_t = 0.0F;  ///< start of the path; finite, >= 0
  /// End of the path; >= min_t, may be infinite.
  float max_t = std::numeric_limits<float>::infinity();

  /// Returns true if a query accepts this cast: a valid sphere and a valid path.
  [[nodiscard]] bool is_valid() const noexcept {
    return sphere.is_valid() && is_valid_path(direction, min_t, max_t);
  }
};

/// A capsule that moves by t * direction for t in [min_t, max_t] and does not rotate.
struct CapsuleCast {
  Capsule capsule;  ///< the capsule at t = 0
  /// Displacement while t grows by 1; finite, not zero.
  Vec3f direction = {1.0F, 0.0F, 0.0F};
  float min_t = 0.0F;  ///< start of the path; finite, >= 0
  /// End of the path; >= min_t, may be infinite.
  float max_t = std::numeric_limits<float>::infinity();

  /// Returns true if a query accepts this cast: a valid capsule and a valid path.
  [[nodiscard]] bool is_valid() const noexcept {
    return capsule.is_valid() && is_valid_path(direction, min_t, max_t);
  }
};

/// A shape that moves along a line; each alternative converts to it implicitly.
using Cast = std::variant<Ray, BoxCast, SphereCast, CapsuleCast>;

}  // namespace winnow
