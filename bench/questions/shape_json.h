#pragma once

#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/shape_rays.h>
#include "bench/common/json.h"

namespace winnow::bench {

/// A shape of a file of questions: it is added to the pool, and `pose` is what the member of that
/// name says (the identity where it or a part of it is missing). `invalid_argument` where a member
/// is missing or of the wrong type, a hull has no point or the type is unknown; else what the pool
/// says of the shape; else `invalid_pose`. Unless `ok`, `id` and `pose` mean nothing.
[[nodiscard]] Status read_shape(const Json& value, ShapePool& pool, ShapeId& id, Pose& pose);

/// True of a shape that says where it goes.
[[nodiscard]] bool has_end_pose(const Json& value);

/// The same with a motion from "pose" to "end_pose" by the shorter way around; what the latter does
/// not say is as at the start, and without it the shape stands. It may be composite as well, and is
/// added to `composites`: {"type": "mesh", "v": points, "triangles": three numbers each},
/// {"type": "height_field", "heights": rows of numbers, "spacing": two numbers, or 1},
/// {"type": "compound", "children": shapes with poses}.
[[nodiscard]] Status read_moving_shape(const Json& value, ShapePool& pool,
                                       CompositePool& composites, ShapeId& id, RigidMotion& motion);

/// {"origin", "direction", "max_t"}; without max_t the ray has no end. `invalid_argument` where a
/// member is missing or of the wrong type.
[[nodiscard]] Status read_ray(const Json& value, ShapeRay& ray);

/// A number, or "nan", "inf" or "-inf". False for anything else.
[[nodiscard]] bool read_number(const Json& value, double& out);

/// A number as JSON can say it: infinities and NaN become "inf", "-inf" and "nan".
[[nodiscard]] Json number_to_json(double value);

}  // namespace winnow::bench
