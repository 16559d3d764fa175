#pragma once

#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/core/vectors.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/shape_rays.h>
#include "bench/common/json.h"

namespace winnow::bench {

/// Reads a shape, adds it to the pool and reads its "pose"; missing parts of the pose are the
/// identity. Returns `invalid_argument` if a member is missing or of the wrong type, a hull has no
/// point or the type is unknown; else the pool's status if it rejects the shape; else
/// `invalid_pose` if the pose is invalid. `id` and `pose` are valid only if the status is `ok`.
[[nodiscard]] Status read_shape(const Json& value, ShapePool& pool, ShapeId& id, Pose& pose);

/// As `read_shape`, for a shape that may also be composite, and is then added to `composites`:
/// {"type": "mesh", "v": points, "triangles": three numbers each, "solid", "one_sided"},
/// {"type": "height_field", "heights": rows of numbers, "spacing": two numbers, or 1, "one_sided"},
/// {"type": "compound", "children": shapes with poses}.
[[nodiscard]] Status read_any_shape(const Json& value, ShapePool& pool, CompositePool& composites,
                                    ShapeId& id, Pose& pose);

/// Returns whether a shape is a mesh, a height field or a compound.
[[nodiscard]] bool is_composite(const Json& value);

/// Returns whether a shape has an "end_pose".
[[nodiscard]] bool has_end_pose(const Json& value);

/// As `read_any_shape`, for a shape that moves from "pose" to "end_pose" and rotates the shorter
/// way. Missing parts of "end_pose" are copied from "pose"; without it the shape does not move.
[[nodiscard]] Status read_moving_shape(const Json& value, ShapePool& pool,
                                       CompositePool& composites, ShapeId& id, RigidMotion& motion);

/// Reads {"origin", "direction", "min_t", "max_t"}; without max_t the ray is infinite. Returns
/// `invalid_argument` if a member is missing or of the wrong type.
[[nodiscard]] Status read_ray(const Json& value, ShapeRay& ray);

/// Reads a number, or "nan", "inf" or "-inf". Returns false for anything else.
[[nodiscard]] bool read_number(const Json& value, double& out);

/// Reads a number as `read_number` does, or a string in C's hexadecimal notation.
[[nodiscard]] bool read_exact_number(const Json& value, double& out);

/// Converts a number to JSON, which has no infinities or NaN: they become "inf", "-inf" and "nan".
[[nodiscard]] Json number_to_json(double value);
/// Converts a vector to an array of three numbers.
[[nodiscard]] Json vector_to_json(const Vec3d& value);

}  // namespace winnow::bench
