#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/capsule.h>
#include <winnow/core/ray.h>
#include <winnow/core/sphere.h>
#include <winnow/core/vec3.h>

#include <limits>
#include <variant>

namespace winnow {

/// A box moved by t * direction for t in [min_t, max_t], without turning.
struct BoxCast {
  Aabb box;  ///< where it stands at t = 0
  /// By which it moves while t grows by 1; finite, not zero.
  Vec3f direction = {1.0F, 0.0F, 0.0F};
  float min_t = 0.0F;  ///< begin of the sweep; finite, >= 0
  /// End of the sweep; >= min_t, may be infinite.
  float max_t = std::numeric_limits<float>::infinity();

  /// True if a query takes it: finite box with min <= max, and a valid direction and range.
  [[nodiscard]] bool is_valid() const noexcept {
    return box.min.all_finite() && box.max.all_finite() && box.is_valid() &&
           is_valid_sweep(direction, min_t, max_t);
  }
};

/// A ball moved by t * direction for t in [min_t, max_t].
struct SphereCast {
  Sphere sphere;  ///< where it stands at t = 0
  /// By which it moves while t grows by 1; finite, not zero.
  Vec3f direction = {1.0F, 0.0F, 0.0F};
  float min_t = 0.0F;  ///< begin of the sweep; finite, >= 0
  /// End of the sweep; >= min_t, may be infinite.
  float max_t = std::numeric_limits<float>::infinity();

  /// True if a query takes it: a valid sphere and a valid sweep.
  [[nodiscard]] bool is_valid() const noexcept {
    return sphere.is_valid() && is_valid_sweep(direction, min_t, max_t);
  }
};

/// A capsule moved by t * direction for t in [min_t, max_t], without turning.
struct CapsuleCast {
  Capsule capsule;  ///< where it stands at t = 0
  /// By which it moves while t grows by 1; finite, not zero.
  Vec3f direction = {1.0F, 0.0F, 0.0F};
  float min_t = 0.0F;  ///< begin of the sweep; finite, >= 0
  /// End of the sweep; >= min_t, may be infinite.
  float max_t = std::numeric_limits<float>::infinity();

  /// True if a query takes it: a valid capsule and a valid sweep.
  [[nodiscard]] bool is_valid() const noexcept {
    return capsule.is_valid() && is_valid_sweep(direction, min_t, max_t);
  }
};

/// Anything that can be swept along a line; every one of these converts to it.
using Cast = std::variant<Ray, BoxCast, SphereCast, CapsuleCast>;

}  // namespace winnow
