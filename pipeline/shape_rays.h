#pragma once

#include <winnow/core/export.h>
#include <winnow/core/point_view.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/core/vectors.h>
#include <winnow/pipeline/shapes.h>

#include <array>
#include <cstddef>
#include <limits>
#include <span>

namespace winnow {

/// A ray: origin + t * direction for min_t <= t <= max_t, in double, in world axes. The direction
/// may have any length; t is in its units. Without max_t the ray is infinite, also in a batch. A
/// min_t above 0 skips what is nearer, such as the surface that the ray starts on.
struct ShapeRay {
  Vec3d origin{};                                          ///< finite
  Vec3d direction = {1.0, 0.0, 0.0};                       ///< finite, not zero
  double min_t = 0.0;                                      ///< finite, >= 0
  double max_t = std::numeric_limits<double>::infinity();  ///< >= min_t
};

/// Rays in the caller's memory: column pointers and one stride in bytes. Nothing is copied, so the
/// object must not outlive the memory.
struct ShapeRayBatch {
  std::array<const double*, 3> origin{};     ///< of the first ray; x, y, z
  std::array<const double*, 3> direction{};  ///< of the first ray; x, y, z
  const double* min_t = nullptr;             ///< null: 0 for all
  const double* max_t = nullptr;             ///< null: infinity for all
  std::size_t count = 0;                     ///< number of rays
  std::size_t stride = sizeof(double);       ///< bytes from one ray to the next

  ShapeRayBatch() = default;
  /// Views an array of rays.
  ShapeRayBatch(std::span<const ShapeRay> rays) noexcept  // NOLINT(google-explicit-constructor)
      : count(rays.size()), stride(sizeof(ShapeRay)) {
    if (rays.empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      origin[axis] = rays.data()->origin.data() + axis;
      direction[axis] = rays.data()->direction.data() + axis;
    }
    min_t = &rays.data()->min_t;
    max_t = &rays.data()->max_t;
  }
  /// Views columns of `rays` numbers each.
  ShapeRayBatch(std::array<const double*, 3> origins, std::array<const double*, 3> directions,
                std::size_t rays, const double* min_ts = nullptr, const double* max_ts = nullptr,
                std::size_t stride_bytes = sizeof(double)) noexcept
      : origin(origins),
        direction(directions),
        min_t(min_ts),
        max_t(max_ts),
        count(rays),
        stride(stride_bytes) {}

  /// Returns a copy of ray i; i is below `count`.
  [[nodiscard]] ShapeRay operator[](std::size_t i) const noexcept {
    ShapeRay ray;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ray.origin[axis] = detail::strided(origin[axis], i, stride);
      ray.direction[axis] = detail::strided(direction[axis], i, stride);
    }
    if (min_t != nullptr) ray.min_t = detail::strided(min_t, i, stride);
    if (max_t != nullptr) ray.max_t = detail::strided(max_t, i, stride);
    return ray;
  }
};

/// Entry of a ray into a shape, if there is one.
struct ShapeHit {
  bool hit = false;  ///< false: the other members keep their defaults
  /// The smallest t at which the ray is inside the shape; min_t if it starts inside.
  double t = 0.0;
  /// Outward unit normal, against the ray. If the ray starts inside: minus its direction,
  /// normalised. On an edge: the normal of one of its faces.
  Vec3d normal{};
};

/// Finds the point at which a ray enters a shape. Shapes are closed sets: a ray that grazes the
/// surface hits, and so does a ray in the plane of a flat shape, both as far as double resolves.
/// Triangles are two-sided. `invalid_key` for an id that the tables do not contain,
/// `invalid_argument` for an invalid ray, `invalid_pose` for an invalid pose. A distant origin does
/// not reduce the precision: errors of t are a few 1e-16 of the coordinates relative to the shape,
/// divided by the sine of the angle to the surface. O(1); O(faces) for hulls.
WINNOW_API Answer<ShapeHit> cast_ray(const ShapeTables& tables, ShapeId shape, const Pose& pose,
                                     const ShapeRay& ray) noexcept;

}  // namespace winnow
