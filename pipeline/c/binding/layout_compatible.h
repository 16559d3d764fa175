#pragma once

// C structs whose layout equals the layout of a C++ struct: their arrays are passed without a copy.
// The macros check size, alignment and the offsets of some members at compile time.

#include <winnow/c/continuous_collision.h>
#include <winnow/c/narrow_phase.h>
#include <winnow/c/partition.h>
#include <winnow/c/scene.h>
#include <winnow/c/scene_queries.h>
#include <winnow/c/sensors.h>
#include <winnow/c/shapes.h>
#include <winnow/c/time_of_impact.h>
#include <winnow/c/volumes.h>
#include <winnow/core/aabb.h>
#include <winnow/core/capsule.h>
#include <winnow/core/frustum.h>
#include <winnow/core/hits.h>
#include <winnow/core/key.h>
#include <winnow/core/object_filter.h>
#include <winnow/core/oriented_box.h>
#include <winnow/core/pair_buffer.h>
#include <winnow/core/pair_events.h>
#include <winnow/core/plane.h>
#include <winnow/core/pose.h>
#include <winnow/core/sphere.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/narrow_result.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/sensors.h>
#include <winnow/pipeline/shapes.h>

#include <cstddef>
#include <span>
#include <type_traits>

namespace winnow::c {

/// True if a C struct and a C++ struct have the same layout.
template <typename OfC, typename OfCpp>
inline constexpr bool kIsLayoutCompatible = std::is_same_v<OfC, OfCpp>;

#define WINNOW_IS_LAYOUT_COMPATIBLE(OfC, OfCpp)                                  \
  static_assert(sizeof(OfC) == sizeof(OfCpp) && alignof(OfC) == alignof(OfCpp)); \
  template <>                                                                    \
  inline constexpr bool kIsLayoutCompatible<OfC, OfCpp> = true;
#define WINNOW_LAYOUT_COMPATIBLE(OfC, OfCpp)                        \
  WINNOW_IS_LAYOUT_COMPATIBLE(OfC, OfCpp)                           \
  [[nodiscard]] inline OfCpp* as_cpp(OfC* p) noexcept {             \
    return reinterpret_cast<OfCpp*>(p);                             \
  }                                                                 \
  [[nodiscard]] inline const OfCpp* as_cpp(const OfC* p) noexcept { \
    return reinterpret_cast<const OfCpp*>(p);                       \
  }
#define WINNOW_SAME_OFFSET(OfC, OfCpp, member) \
  static_assert(offsetof(OfC, member) == offsetof(OfCpp, member))

WINNOW_LAYOUT_COMPATIBLE(winnow_key, Key)
WINNOW_LAYOUT_COMPATIBLE(winnow_object_filter, ObjectFilter)
WINNOW_LAYOUT_COMPATIBLE(winnow_aabb, Aabb)
WINNOW_LAYOUT_COMPATIBLE(winnow_sphere, Sphere)
WINNOW_LAYOUT_COMPATIBLE(winnow_capsule, Capsule)
WINNOW_LAYOUT_COMPATIBLE(winnow_plane, Plane)
WINNOW_LAYOUT_COMPATIBLE(winnow_frustum, Frustum)
WINNOW_LAYOUT_COMPATIBLE(winnow_pose, Pose)
WINNOW_IS_LAYOUT_COMPATIBLE(winnow_pair, Pair)
WINNOW_LAYOUT_COMPATIBLE(winnow_key_pair, KeyPair)
WINNOW_IS_LAYOUT_COMPATIBLE(winnow_client_data_pair, ClientDataPair)
WINNOW_SAME_OFFSET(winnow_client_data_pair, ClientDataPair, second);
WINNOW_LAYOUT_COMPATIBLE(winnow_body_pair, BodyPair)
WINNOW_IS_LAYOUT_COMPATIBLE(winnow_hull_face, HullFace)
WINNOW_SAME_OFFSET(winnow_hull_face, HullFace, first);

WINNOW_LAYOUT_COMPATIBLE(winnow_hit, Hit)
WINNOW_SAME_OFFSET(winnow_hit, Hit, data);
WINNOW_SAME_OFFSET(winnow_hit, Hit, t);

WINNOW_LAYOUT_COMPATIBLE(winnow_compound_child, CompoundChild)
WINNOW_SAME_OFFSET(winnow_compound_child, CompoundChild, pose);

WINNOW_LAYOUT_COMPATIBLE(winnow_body_definition, BodyDefinition)
WINNOW_SAME_OFFSET(winnow_body_definition, BodyDefinition, pose);
WINNOW_SAME_OFFSET(winnow_body_definition, BodyDefinition, state);
WINNOW_SAME_OFFSET(winnow_body_definition, BodyDefinition, filter);
WINNOW_SAME_OFFSET(winnow_body_definition, BodyDefinition, data);
WINNOW_SAME_OFFSET(winnow_body_definition, BodyDefinition, offsets);
WINNOW_SAME_OFFSET(winnow_body_definition, BodyDefinition, layer);

WINNOW_LAYOUT_COMPATIBLE(winnow_pair_answer, PairAnswer)
WINNOW_SAME_OFFSET(winnow_pair_answer, PairAnswer, point);
WINNOW_SAME_OFFSET(winnow_pair_answer, PairAnswer, overlap);
WINNOW_SAME_OFFSET(winnow_pair_answer, PairAnswer, contact_count);
WINNOW_SAME_OFFSET(winnow_pair_answer, PairAnswer, contacts);
WINNOW_IS_LAYOUT_COMPATIBLE(winnow_contact_point, ContactPoint)
WINNOW_SAME_OFFSET(winnow_contact_point, ContactPoint, feature);

WINNOW_IS_LAYOUT_COMPATIBLE(winnow_run, ContactRun)
WINNOW_SAME_OFFSET(winnow_run, ContactRun, first);
WINNOW_IS_LAYOUT_COMPATIBLE(winnow_run, NarrowRun)
WINNOW_IS_LAYOUT_COMPATIBLE(winnow_ended_contact, EndedContact)
WINNOW_SAME_OFFSET(winnow_ended_contact, EndedContact, data_a);

WINNOW_LAYOUT_COMPATIBLE(winnow_shape_ray, ShapeRay)
WINNOW_LAYOUT_COMPATIBLE(winnow_scene_hit, SceneHit)
WINNOW_SAME_OFFSET(winnow_scene_hit, SceneHit, part);
WINNOW_SAME_OFFSET(winnow_scene_hit, SceneHit, t);
WINNOW_SAME_OFFSET(winnow_scene_hit, SceneHit, point);

WINNOW_IS_LAYOUT_COMPATIBLE(winnow_scene_overlap, SceneOverlap)
WINNOW_SAME_OFFSET(winnow_scene_overlap, SceneOverlap, part);

WINNOW_LAYOUT_COMPATIBLE(winnow_scene_distance, SceneDistance)
WINNOW_SAME_OFFSET(winnow_scene_distance, SceneDistance, part);
WINNOW_SAME_OFFSET(winnow_scene_distance, SceneDistance, distance);
WINNOW_SAME_OFFSET(winnow_scene_distance, SceneDistance, point_b);

WINNOW_LAYOUT_COMPATIBLE(winnow_set_distance, SetDistance)
WINNOW_SAME_OFFSET(winnow_set_distance, SetDistance, data_a);
WINNOW_SAME_OFFSET(winnow_set_distance, SetDistance, to);

WINNOW_LAYOUT_COMPATIBLE(winnow_sensor_definition, SensorDefinition)
WINNOW_SAME_OFFSET(winnow_sensor_definition, SensorDefinition, filter);
WINNOW_SAME_OFFSET(winnow_sensor_definition, SensorDefinition, carrier);
WINNOW_SAME_OFFSET(winnow_sensor_definition, SensorDefinition, data);
WINNOW_IS_LAYOUT_COMPATIBLE(winnow_sensed_body, SensedBody)
WINNOW_SAME_OFFSET(winnow_sensed_body, SensedBody, body_data);
WINNOW_SAME_OFFSET(winnow_sensed_body, SensedBody, event);
WINNOW_IS_LAYOUT_COMPATIBLE(winnow_left_sensor, ExitedBody)
WINNOW_SAME_OFFSET(winnow_left_sensor, ExitedBody, body_data);

WINNOW_IS_LAYOUT_COMPATIBLE(winnow_scene_impact, SceneImpact)
WINNOW_SAME_OFFSET(winnow_scene_impact, SceneImpact, part_b);
WINNOW_SAME_OFFSET(winnow_scene_impact, SceneImpact, error_bound);
WINNOW_SAME_OFFSET(winnow_scene_impact, SceneImpact, point);

WINNOW_LAYOUT_COMPATIBLE(winnow_rigid_motion, RigidMotion)
WINNOW_SAME_OFFSET(winnow_rigid_motion, RigidMotion, travel);
WINNOW_SAME_OFFSET(winnow_rigid_motion, RigidMotion, turn);

#undef WINNOW_LAYOUT_COMPATIBLE
#undef WINNOW_IS_LAYOUT_COMPATIBLE
#undef WINNOW_SAME_OFFSET

/// In C, an id is a plain number.
static_assert(sizeof(winnow_shape_id) == sizeof(ShapeId));
[[nodiscard]] inline const ShapeId* shape_ids(const winnow_shape_id* ids) noexcept {
  return reinterpret_cast<const ShapeId*>(ids);
}

/// In C the axes are consecutive rows; in C++ they are the columns of a matrix.
[[nodiscard]] inline OrientedBox oriented_box_of(const winnow_oriented_box& given) noexcept {
  OrientedBox box;
  box.center = Vec3f(given.center);
  box.half = Vec3f(given.half);
  for (int i = 0; i < 3; ++i) box.axes.set_column(i, Vec3f(given.axes[i]));
  return box;
}

/// Returns a C array as a span of the C++ struct.
template <typename T>
[[nodiscard]] auto as_cpp_span(T* first, std::size_t count) noexcept {
  return std::span(as_cpp(first), count);
}

/// Returns a C++ array as an array of the C struct.
template <typename T, typename OfC>
void return_array(std::span<const T> values, const OfC** first, std::size_t* count) noexcept {
  static_assert(kIsLayoutCompatible<OfC, T>);
  *first = reinterpret_cast<const OfC*>(values.data());
  *count = values.size();
}

}  // namespace winnow::c
