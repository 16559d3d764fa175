// C binding of NarrowPhase and its results (narrow_phase.h).

#include <winnow/c/narrow_phase.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/columns.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"
#include "pipeline/c/binding/options.h"
#include "pipeline/c/binding/views.h"

namespace winnow::c {

bool read_options(const winnow_narrow_options* given, NarrowOptions& options) noexcept {
  winnow_narrow_options own{};
  ContactLevel level{};
  if (!read_sized(given, own) || !read_execution(own.execution, options.execution) ||
      !read_choice(own.level, ContactLevel::manifold, level) ||
      !read_choice(own.tier, NarrowTier::reference, options.tier)) {
    return false;
  }
  take_given(level, options.level);
  options.contact_margin = own.contact_margin;
  return true;
}

namespace {

[[nodiscard]] winnow_narrow_columns columns_of(const NarrowResult& result) noexcept {
  winnow_narrow_columns shown{};
  shown.level = static_cast<winnow_contact_level>(result.level());
  shown.answers = result.size();
  shown.pair_of = result.order().data();
  return_array(result.runs(), &shown.runs, &shown.run_count);
  shown.overlap = column(result.overlap());
  shown.distance = column(result.distance());
  shown.error_bound = column(result.error_bound());
  for (int axis = 0; axis < 3; ++axis) {
    shown.normal[axis] = column(result.normal(axis));
    shown.point[axis] = column(result.point(axis));
  }
  shown.contact_first = column(result.contact_first());
  shown.contact_count = column(result.contact_count());
  shown.contacts = result.contacts();
  show_points(result.contact_columns(), shown);
  return shown;
}

}  // namespace
}  // namespace winnow::c

using namespace winnow::c;

winnow_status winnow_narrow_result_create(const winnow_memory* memory,
                                          winnow_narrow_result** result) {
  return create(memory, result);
}

void winnow_narrow_result_destroy(winnow_narrow_result* result) {
  destroy(result);
}

winnow_status winnow_narrow_result_columns(const winnow_narrow_result* result,
                                           winnow_narrow_columns* columns) {
  if (result == nullptr || !is_sized(columns)) return WINNOW_INVALID_ARGUMENT;
  write_sized(columns_of(result->value), *columns);
  return WINNOW_OK;
}

winnow_status winnow_narrow_result_footprint(const winnow_narrow_result* result,
                                             winnow_footprint* footprint) {
  if (result == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(result, result->value.footprint(), {}, footprint);
}

winnow_status winnow_narrow_phase_create(const winnow_memory* memory,
                                         winnow_narrow_phase** narrow) {
  return create(memory, narrow);
}

void winnow_narrow_phase_destroy(winnow_narrow_phase* narrow) {
  destroy(narrow);
}

winnow_status winnow_narrow_phase_collide(winnow_narrow_phase* narrow,
                                          const winnow_shape_pool* shapes,
                                          const winnow_bodies* bodies,
                                          const winnow_body_pair* pairs, size_t count,
                                          const winnow_narrow_options* options,
                                          winnow_narrow_result* result) {
  winnow::NarrowOptions read;
  if (!are_given(narrow, shapes, bodies, result) || !is_array(pairs, count) ||
      !is_array(bodies->shapes, bodies->count) || !read_options(options, read)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  winnow::Bodies all{{shape_ids(bodies->shapes), bodies->count}, {}};
  const winnow::Status status = read_poses(&bodies->poses, narrow->room, all.poses);
  if (status != winnow::Status::ok) return answer(status);
  return answer(
      narrow->value.collide(shapes->value, all, as_cpp_span(pairs, count), read, result->value));
}

winnow_status winnow_narrow_phase_bad_body(const winnow_narrow_phase* narrow, uint32_t* body) {
  if (!are_given(narrow, body)) return WINNOW_INVALID_ARGUMENT;
  *body = narrow->value.bad_body();
  return WINNOW_OK;
}

winnow_status winnow_narrow_phase_statistics(const winnow_narrow_phase* narrow,
                                             winnow_narrow_statistics* statistics) {
  if (narrow == nullptr || !is_sized(statistics)) return WINNOW_INVALID_ARGUMENT;
  const winnow::NarrowStatistics& own = narrow->value.statistics();
  write_sized({0, own.pairs, own.recomputed, own.without_lanes, own.exact, own.bounded},
              *statistics);
  return WINNOW_OK;
}

winnow_status winnow_narrow_phase_footprint(const winnow_narrow_phase* narrow,
                                            winnow_footprint* footprint) {
  if (narrow == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(narrow, narrow->value.footprint(), narrow->room.bytes(), footprint);
}

winnow_status winnow_collide(const winnow_shape_pool* shapes, winnow_shape_id a,
                             const winnow_pose* pose_a, winnow_shape_id b,
                             const winnow_pose* pose_b, const winnow_narrow_options* options,
                             winnow_pair_answer* answer) {
  winnow::NarrowOptions read;
  if (!are_given(shapes, pose_a, pose_b, answer) || !read_options(options, read)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return winnow::c::answer(winnow::collide(shapes->value, {a}, *as_cpp(pose_a), {b},
                                           *as_cpp(pose_b), read, *as_cpp(answer)));
}
