#pragma once

// C structs whose layout equals the layout of a C++ struct, so that arrays pass without a copy. The
// macros check the layouts at compile time.

#include <winnow/c/narrow_phase.h>
#include <winnow/c/partition.h>
#include <winnow/c/scene.h>
#include <winnow/c/scene_queries.h>
#include <winnow/c/scene_sweep.h>
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
#include <winnow/pipeline/narrow_result.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/scene_sweep.h>
#include <winnow/pipeline/sensors.h>
#include <winnow/pipeline/shapes.h>

#include <cstddef>
#include <span>
#include <type_traits>

namespace winnow::c {

/// True if a C struct and a C++ struct have the same layout.
template <typename OfC, typename OfCpp>
inline constexpr bool kAreTwins = std::is_same_v<OfC, OfCpp>;

#define WINNOW_ARE_TWINS(OfC, OfCpp)                                             \
  static_assert(sizeof(OfC) == sizeof(OfCpp) && alignof(OfC) == alignof(OfCpp)); \
  template <>                                                                    \
  inline constexpr bool kAreTwins<OfC, OfCpp> = true;
#define WINNOW_TWINS(OfC, OfCpp)                                  \
  WINNOW_ARE_TWINS(OfC, OfCpp)                                    \
  [[nodiscard]] inline OfCpp* twin(OfC* p) noexcept {             \
    return reinterpret_cast<OfCpp*>(p);                           \
  }                                                               \
  [[nodiscard]] inline const OfCpp* twin(const OfC* p) noexcept { \
    return reinterpret_cast<const OfCpp*>(p);                     \
  }
#define WINNOW_TWIN_MEMBERS(OfC, OfCpp, member) \
  static_assert(offsetof(OfC, member) == offsetof(OfCpp, member))

WINNOW_TWINS(winnow_key, Key)
WINNOW_TWINS(winnow_object_filter, ObjectFilter)
WINNOW_TWINS(winnow_aabb, Aabb)
WINNOW_TWINS(winnow_sphere, Sphere)
WINNOW_TWINS(winnow_capsule, Capsule)
WINNOW_TWINS(winnow_plane, Plane)
WINNOW_TWINS(winnow_frustum, Frustum)
WINNOW_TWINS(winnow_pose, Pose)
WINNOW_ARE_TWINS(winnow_pair, Pair)
WINNOW_TWINS(winnow_key_pair, KeyPair)
WINNOW_ARE_TWINS(winnow_client_data_pair, ClientDataPair)
WINNOW_TWIN_MEMBERS(winnow_client_data_pair, ClientDataPair, second);
WINNOW_TWINS(winnow_body_pair, BodyPair)
WINNOW_ARE_TWINS(winnow_hull_face, HullFace)
WINNOW_TWIN_MEMBERS(winnow_hull_face, HullFace, first);

WINNOW_TWINS(winnow_hit, Hit)
WINNOW_TWIN_MEMBERS(winnow_hit, Hit, data);
WINNOW_TWIN_MEMBERS(winnow_hit, Hit, t);

WINNOW_TWINS(winnow_compound_child, CompoundChild)
WINNOW_TWIN_MEMBERS(winnow_compound_child, CompoundChild, pose);

WINNOW_TWINS(winnow_body_definition, BodyDefinition)
WINNOW_TWIN_MEMBERS(winnow_body_definition, BodyDefinition, pose);
WINNOW_TWIN_MEMBERS(winnow_body_definition, BodyDefinition, motion);
WINNOW_TWIN_MEMBERS(winnow_body_definition, BodyDefinition, filter);
WINNOW_TWIN_MEMBERS(winnow_body_definition, BodyDefinition, data);
WINNOW_TWIN_MEMBERS(winnow_body_definition, BodyDefinition, offsets);
WINNOW_TWIN_MEMBERS(winnow_body_definition, BodyDefinition, layer);

WINNOW_TWINS(winnow_pair_answer, PairAnswer)
WINNOW_TWIN_MEMBERS(winnow_pair_answer, PairAnswer, point);
WINNOW_TWIN_MEMBERS(winnow_pair_answer, PairAnswer, overlap);
WINNOW_TWIN_MEMBERS(winnow_pair_answer, PairAnswer, contact_count);
WINNOW_TWIN_MEMBERS(winnow_pair_answer, PairAnswer, contacts);
WINNOW_ARE_TWINS(winnow_contact_point, ContactPoint)
WINNOW_TWIN_MEMBERS(winnow_contact_point, ContactPoint, feature);

WINNOW_ARE_TWINS(winnow_run, ContactRun)
WINNOW_TWIN_MEMBERS(winnow_run, ContactRun, first);
WINNOW_ARE_TWINS(winnow_run, NarrowRun)
WINNOW_ARE_TWINS(winnow_ended_contact, EndedContact)
WINNOW_TWIN_MEMBERS(winnow_ended_contact, EndedContact, data_a);

WINNOW_TWINS(winnow_shape_ray, ShapeRay)
WINNOW_TWINS(winnow_scene_hit, SceneHit)
WINNOW_TWIN_MEMBERS(winnow_scene_hit, SceneHit, part);
WINNOW_TWIN_MEMBERS(winnow_scene_hit, SceneHit, t);
WINNOW_TWIN_MEMBERS(winnow_scene_hit, SceneHit, point);

WINNOW_ARE_TWINS(winnow_scene_overlap, SceneOverlap)
WINNOW_TWIN_MEMBERS(winnow_scene_overlap, SceneOverlap, part);

WINNOW_TWINS(winnow_scene_distance, SceneDistance)
WINNOW_TWIN_MEMBERS(winnow_scene_distance, SceneDistance, part);
WINNOW_TWIN_MEMBERS(winnow_scene_distance, SceneDistance, distance);
WINNOW_TWIN_MEMBERS(winnow_scene_distance, SceneDistance, point_b);

WINNOW_TWINS(winnow_set_distance, SetDistance)
WINNOW_TWIN_MEMBERS(winnow_set_distance, SetDistance, data_a);
WINNOW_TWIN_MEMBERS(winnow_set_distance, SetDistance, to);

WINNOW_TWINS(winnow_sensor_definition, SensorDefinition)
WINNOW_TWIN_MEMBERS(winnow_sensor_definition, SensorDefinition, filter);
WINNOW_TWIN_MEMBERS(winnow_sensor_definition, SensorDefinition, carrier);
WINNOW_TWIN_MEMBERS(winnow_sensor_definition, SensorDefinition, data);
WINNOW_ARE_TWINS(winnow_sensed_body, SensedBody)
WINNOW_TWIN_MEMBERS(winnow_sensed_body, SensedBody, body_data);
WINNOW_TWIN_MEMBERS(winnow_sensed_body, SensedBody, event);
WINNOW_ARE_TWINS(winnow_left_sensor, LeftSensor)
WINNOW_TWIN_MEMBERS(winnow_left_sensor, LeftSensor, body_data);

WINNOW_ARE_TWINS(winnow_scene_impact, SceneImpact)
WINNOW_TWIN_MEMBERS(winnow_scene_impact, SceneImpact, part_b);
WINNOW_TWIN_MEMBERS(winnow_scene_impact, SceneImpact, error_bound);
WINNOW_TWIN_MEMBERS(winnow_scene_impact, SceneImpact, point);

WINNOW_TWINS(winnow_rigid_motion, RigidMotion)
WINNOW_TWIN_MEMBERS(winnow_rigid_motion, RigidMotion, travel);
WINNOW_TWIN_MEMBERS(winnow_rigid_motion, RigidMotion, turn);

#undef WINNOW_TWINS
#undef WINNOW_ARE_TWINS
#undef WINNOW_TWIN_MEMBERS

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
[[nodiscard]] auto twins(T* first, std::size_t count) noexcept {
  return std::span(twin(first), count);
}

/// Returns a C++ array as an array of the C struct.
template <typename T, typename OfC>
void show(std::span<const T> values, const OfC** first, std::size_t* count) noexcept {
  static_assert(kAreTwins<OfC, T>);
  *first = reinterpret_cast<const OfC*>(values.data());
  *count = values.size();
}

}  // namespace winnow::c
