#pragma once

#include <winnow/core/export.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/shapes.h>

namespace winnow {

/// origin + t * direction, 0 <= t <= max_t, in double and in the axes of the world. The direction
/// is finite and not zero, of any length (t is in its units); max_t may be infinite.
struct ShapeRay {
  double origin[3] = {0.0, 0.0, 0.0};
  double direction[3] = {1.0, 0.0, 0.0};
  double max_t = 1.0;
};

struct ShapeHit {
  bool hit = false;
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
