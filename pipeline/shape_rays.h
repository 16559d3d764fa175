#pragma once

#include <winnow/core/export.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/shapes.h>

#include <array>
#include <cstddef>
#include <limits>
#include <span>

namespace winnow {

/// origin + t * direction, 0 <= t <= max_t, in double and in the axes of the world. The direction
/// is finite and not zero, of any length (t is in its units). Without max_t a ray has no end, as in
/// a batch.
struct ShapeRay {
  double origin[3] = {0.0, 0.0, 0.0};                      ///< finite
  double direction[3] = {1.0, 0.0, 0.0};                   ///< finite, not zero
  double max_t = std::numeric_limits<double>::infinity();  ///< >= 0
};

/// Rays where the caller keeps them: column pointers and one stride in bytes. Nothing is copied to
/// make one, and it must not outlive the memory it looks at.
struct ShapeRayBatch {
  std::array<const double*, 3> origin{};     ///< of the first ray; x, y, z
  std::array<const double*, 3> direction{};  ///< of the first ray; x, y, z
  const double* max_t = nullptr;             ///< null: infinity for all
  std::size_t count = 0;                     ///< rays
  std::size_t stride = sizeof(double);       ///< bytes from one ray to the next

  ShapeRayBatch() = default;
  /// An array of rays.
  ShapeRayBatch(std::span<const ShapeRay> rays) noexcept  // NOLINT(google-explicit-constructor)
      : count(rays.size()), stride(sizeof(ShapeRay)) {
    if (rays.empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      origin[axis] = rays.data()->origin + axis;
      direction[axis] = rays.data()->direction + axis;
    }
    max_t = &rays.data()->max_t;
  }
  /// Columns of `rays` numbers each.
  ShapeRayBatch(std::array<const double*, 3> origins, std::array<const double*, 3> directions,
                std::size_t rays, const double* max_ts = nullptr,
                std::size_t stride_bytes = sizeof(double)) noexcept
      : origin(origins), direction(directions), max_t(max_ts), count(rays), stride(stride_bytes) {}

  /// Ray i, copied out; i is below `count`.
  [[nodiscard]] ShapeRay operator[](std::size_t i) const noexcept {
    ShapeRay ray;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ray.origin[axis] = at(origin[axis], i);
      ray.direction[axis] = at(direction[axis], i);
    }
    ray.max_t = max_t != nullptr ? at(max_t, i) : std::numeric_limits<double>::infinity();
    return ray;
  }

 private:
  [[nodiscard]] double at(const double* column, std::size_t i) const noexcept {
    return *reinterpret_cast<const double*>(reinterpret_cast<const std::byte*>(column) +
                                            i * stride);
  }
};

/// Where a ray enters a shape, if it does.
struct ShapeHit {
  bool hit = false;  ///< false: the rest is as it was made
  /// The smallest t at which the ray is in the shape: 0 if it begins inside.
  double t = 0.0;
  /// Unit, outward, against the ray. Where the ray begins inside: minus its direction, normalised.
  /// On an edge: that of a face that contains it.
  double normal[3] = {0.0, 0.0, 0.0};
};

/// Where a ray enters a shape. Closed: grazing is a hit, and so is a ray in the plane of a flat
/// shape that meets it, both as far as double can tell. Triangles are two-sided. `invalid_key` for
/// an id that the tables do not have, `invalid_argument` for a bad ray, `invalid_pose` for a bad
/// pose; `hit` is left alone then. Rays that begin far away lose nothing by it. Errors of t are a
/// few 1e-16 of the coordinates relative to the shape, over the sine of the angle to the surface.
/// O(1); hulls O(faces).
WINNOW_API Status cast_ray(const ShapeTables& tables, ShapeId shape, const Pose& pose,
                           const ShapeRay& ray, ShapeHit& hit) noexcept;

}  // namespace winnow
