// Generated from pipeline/interface/time_of_impact.toml; do not edit.
// clang-format off

#include <winnow/c/time_of_impact.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_impact_result_create(
    const winnow_memory* memory, winnow_impact_result** result) {
  if (!(are_given(result))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, result);
}

void winnow_impact_result_destroy(winnow_impact_result* result) {
  destroy(result);
}

winnow_status winnow_impact_result_columns(
    const winnow_impact_result* result, winnow_impact_columns* columns) {
  if (!(are_given(result) && is_sized(columns))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(result)); }, columns);
}

winnow_status winnow_impact_result_footprint(
    const winnow_impact_result* result, winnow_footprint* footprint) {
  if (!(are_given(result) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(result, footprint);
}

winnow_status winnow_rigid_motion_between(
    const winnow_pose* start, const winnow_pose* end, winnow_rigid_motion* motion) {
  if (!(are_given(start, end, motion))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (valid_motion(RigidMotion::between((*as_cpp(start)), (*as_cpp(end))))); }, motion);
}

winnow_status winnow_rigid_motion_by_velocities(
    const winnow_pose* start, const double linear[3], const double angular[3], double duration,
    winnow_rigid_motion* motion) {
  if (!(are_given(start, linear, angular, motion))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (valid_motion(RigidMotion::by_velocities((*as_cpp(start)), Vec3d(linear), Vec3d(angular), duration))); }, motion);
}

winnow_status winnow_rigid_motion_at(
    const winnow_rigid_motion* motion, double time, winnow_pose* pose) {
  if (!(are_given(motion, pose))) return WINNOW_INVALID_ARGUMENT;
  if (!(time >= 0.0 && time <= 1.0)) return WINNOW_INVALID_ARGUMENT;
  if (!((*as_cpp(motion)).is_valid())) return WINNOW_INVALID_POSE;
  return give([&]() -> decltype(auto) { return ((*as_cpp(motion)).at(time)); }, pose);
}

winnow_status winnow_time_of_impact(
    const winnow_shape_pool* shapes, const winnow_moving_bodies* bodies,
    const winnow_body_pair* pairs, size_t count, const winnow_impact_options* options,
    winnow_impact_result* result) {
  MovingBodies own_bodies{};
  ImpactOptions own_options{};
  if (!(are_given(shapes, bodies, result) && read(bodies, own_bodies) && is_array(pairs, count) && read(options, own_options))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (time_of_impact(of(shapes), own_bodies, as_cpp_span(pairs, count), own_options, of(result))); });
}
