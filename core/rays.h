#pragma once

// Rays, and volumes that move along a line.

#include <winnow/core/export.h>
#include <winnow/core/point_view.h>
#include <winnow/core/regions.h>
#include <winnow/core/vectors.h>
#include <winnow/core/volumes.h>

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <variant>

namespace winnow {

namespace detail {

/// Returns true if `direction` is finite and not zero, and 0 <= min_t <= max_t with min_t finite.
[[nodiscard]] inline bool is_valid_path(const Vec3f& direction, float min_t, float max_t) noexcept {
  const bool moves = direction.all_finite() && !direction.is_zero();
  return moves && min_t >= 0.0F && std::isfinite(min_t) && min_t <= max_t;
}

}  // namespace detail

/// The points origin + t * direction for t in [min_t, max_t]. The direction may have any finite
/// length except zero. t is in units of this length: a distance if the direction is a unit vector.
struct Ray {
  /// Point at t = 0.
  Vec3f origin;
  /// Displacement while t grows by 1.
  Vec3f direction = {1.0F, 0.0F, 0.0F};
  float min_t = 0.0F;  ///< start; finite, >= 0
  /// End; >= min_t, may be infinite.
  float max_t = std::numeric_limits<float>::infinity();

  /// Returns true if a query accepts this ray: finite origin, finite direction that is not zero, 0
  /// <= min_t <= max_t, min_t finite.
  [[nodiscard]] bool is_valid() const noexcept {
    return origin.all_finite() && detail::is_valid_path(direction, min_t, max_t);
  }
};

static_assert(sizeof(Ray) == 32 && alignof(Ray) == 4, "layout must not depend on build flags");

/// Non-owning view of rays in the caller's memory: column pointers and one stride in bytes. It
/// copies nothing and must not outlive that memory.
struct RayBatch {
  std::array<const float*, 3> origin{};     ///< of the first ray: x, y, z
  std::array<const float*, 3> direction{};  ///< of the first ray: x, y, z
  const float* min_t = nullptr;             ///< null means 0 for all
  const float* max_t = nullptr;             ///< null means infinity for all
  std::size_t count = 0;                    ///< number of rays
  std::size_t stride = sizeof(float);       ///< bytes from one ray to the next

  RayBatch() = default;

  /// Views any contiguous container of rays.
  template <std::convertible_to<std::span<const Ray>> Rays>
  RayBatch(const Rays& container) noexcept {  // NOLINT(google-explicit-constructor)
    const std::span<const Ray> rays = container;
    if (rays.empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      origin[axis] = rays.data()->origin.data() + axis;
      direction[axis] = rays.data()->direction.data() + axis;
    }
    min_t = &rays.data()->min_t;
    max_t = &rays.data()->max_t;
    count = rays.size();
    stride = sizeof(Ray);
  }

  /// Views columns of `rays` floats each, `stride_bytes` apart.
  RayBatch(std::array<const float*, 3> origins, std::array<const float*, 3> directions,
           std::size_t rays, const float* min_ts = nullptr, const float* max_ts = nullptr,
           std::size_t stride_bytes = sizeof(float)) noexcept
      : origin(origins),
        direction(directions),
        min_t(min_ts),
        max_t(max_ts),
        count(rays),
        stride(stride_bytes) {}

  /// Returns a copy of ray i; i must be below `count`.
  [[nodiscard]] Ray operator[](std::size_t i) const noexcept {
    Ray ray;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ray.origin[axis] = detail::strided(origin[axis], i, stride);
      ray.direction[axis] = detail::strided(direction[axis], i, stride);
    }
    if (min_t != nullptr) ray.min_t = detail::strided(min_t, i, stride);
    if (max_t != nullptr) ray.max_t = detail::strided(max_t, i, stride);
    return ray;
  }
};

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
           detail::is_valid_path(direction, min_t, max_t);
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
    return sphere.is_valid() && detail::is_valid_path(direction, min_t, max_t);
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
    return capsule.is_valid() && detail::is_valid_path(direction, min_t, max_t);
  }
};

/// A shape that moves along a line; each alternative converts to it implicitly.
using Cast = std::variant<Ray, BoxCast, SphereCast, CapsuleCast>;

}  // namespace winnow
