// C binding of rigid motions and times of impact (time_of_impact.h).

#include <winnow/c/time_of_impact.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/columns.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"
#include "pipeline/c/binding/options.h"

namespace winnow::c {

bool read_options(const winnow_impact_options* given, ImpactOptions& options) noexcept {
  winnow_impact_options own{};
  if (!read_sized(given, own) || !read_execution(own.execution, options.execution)) return false;
  take_given(own.tolerance, options.tolerance);
  if (own.composites != nullptr) options.composites = &own.composites->value;
  return true;
}

namespace {

[[nodiscard]] winnow_status made(const RigidMotion& motion, winnow_rigid_motion* out) noexcept {
  if (!motion.is_valid()) return WINNOW_INVALID_POSE;
  *as_cpp(out) = motion;
  return WINNOW_OK;
}

[[nodiscard]] winnow_impact_columns columns_of(const ImpactResult& result) noexcept {
  static_assert(sizeof(Status) == sizeof(std::uint8_t));
  winnow_impact_columns shown{};
  shown.answers = result.size();
  shown.status = reinterpret_cast<const std::uint8_t*>(column(result.status()));
  shown.hit = column(result.hit());
  shown.time = column(result.time());
  shown.gap = column(result.gap());
  shown.error_bound = column(result.error_bound());
  for (int axis = 0; axis < 3; ++axis) {
    shown.normal[axis] = column(result.normal(axis));
    shown.point[axis] = column(result.point(axis));
  }
  shown.part_a = column(result.part_a());
  shown.part_b = column(result.part_b());
  return shown;
}

}  // namespace
}  // namespace winnow::c

using namespace winnow::c;

winnow_status winnow_rigid_motion_between(const winnow_pose* start, const winnow_pose* end,
                                          winnow_rigid_motion* motion) {
  if (!are_given(start, end, motion)) return WINNOW_INVALID_ARGUMENT;
  return made(winnow::RigidMotion::between(*as_cpp(start), *as_cpp(end)), motion);
}

winnow_status winnow_rigid_motion_by_velocities(const winnow_pose* start, const double linear[3],
                                                const double angular[3], double duration,
                                                winnow_rigid_motion* motion) {
  if (!are_given(start, motion) || !are_given(linear, angular)) return WINNOW_INVALID_ARGUMENT;
  const double ways[2][3] = {{linear[0], linear[1], linear[2]},
                             {angular[0], angular[1], angular[2]}};
  return made(winnow::RigidMotion::by_velocities(*as_cpp(start), ways[0], ways[1], duration),
              motion);
}

winnow_status winnow_rigid_motion_at(const winnow_rigid_motion* motion, double time,
                                     winnow_pose* pose) {
  if (!are_given(motion, pose) || !(time >= 0.0 && time <= 1.0)) return WINNOW_INVALID_ARGUMENT;
  if (!as_cpp(motion)->is_valid()) return WINNOW_INVALID_POSE;
  *as_cpp(pose) = as_cpp(motion)->at(time);
  return WINNOW_OK;
}

winnow_status winnow_impact_result_create(const winnow_memory* memory,
                                          winnow_impact_result** result) {
  return create(memory, result);
}

void winnow_impact_result_destroy(winnow_impact_result* result) {
  destroy(result);
}

winnow_status winnow_impact_result_columns(const winnow_impact_result* result,
                                           winnow_impact_columns* columns) {
  if (result == nullptr || !is_sized(columns)) return WINNOW_INVALID_ARGUMENT;
  write_sized(columns_of(result->value), *columns);
  return WINNOW_OK;
}

winnow_status winnow_impact_result_footprint(const winnow_impact_result* result,
                                             winnow_footprint* footprint) {
  if (result == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(result, result->value.footprint(), {}, footprint);
}

winnow_status winnow_time_of_impact(const winnow_shape_pool* shapes,
                                    const winnow_moving_bodies* bodies,
                                    const winnow_body_pair* pairs, size_t count,
                                    const winnow_impact_options* options,
                                    winnow_impact_result* result) {
  winnow::ImpactOptions read;
  if (!are_given(shapes, bodies, result) || !is_array(pairs, count) ||
      !is_array(bodies->shapes, bodies->count) || !is_array(bodies->motions, bodies->count) ||
      !read_options(options, read)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  const winnow::MovingBodies all{{shape_ids(bodies->shapes), bodies->count},
                                 as_cpp_span(bodies->motions, bodies->count)};
  return answer(
      winnow::time_of_impact(shapes->value, all, as_cpp_span(pairs, count), read, result->value));
}
