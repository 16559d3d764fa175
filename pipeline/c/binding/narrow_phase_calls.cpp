// Generated from pipeline/interface/narrow_phase.toml; do not edit.
// clang-format off

#include <winnow/c/narrow_phase.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_narrow_result_create(
    const winnow_memory* memory, winnow_narrow_result** result) {
  if (!(are_given(result))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, result);
}

void winnow_narrow_result_destroy(winnow_narrow_result* result) {
  destroy(result);
}

winnow_status winnow_narrow_phase_create(
    const winnow_memory* memory, winnow_narrow_phase** narrow) {
  if (!(are_given(narrow))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, narrow);
}

void winnow_narrow_phase_destroy(winnow_narrow_phase* narrow) {
  destroy(narrow);
}

winnow_status winnow_narrow_result_columns(
    const winnow_narrow_result* result, winnow_narrow_columns* columns) {
  if (!(are_given(result) && is_sized(columns))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(result)); }, columns);
}

winnow_status winnow_narrow_phase_collide(
    winnow_narrow_phase* narrow, const winnow_shape_pool* shapes, const winnow_bodies* bodies,
    const winnow_body_pair* pairs, size_t count, const winnow_narrow_options* options,
    winnow_narrow_result* result) {
  NarrowOptions own_options{};
  if (!(are_given(narrow, shapes, bodies, result) && is_array(pairs, count) && read(options, own_options, count))) return WINNOW_INVALID_ARGUMENT;
  Bodies own_bodies;
  if (const Status bad = read_view(*bodies, narrow->room, own_bodies); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(narrow).collide(of(shapes), own_bodies, as_cpp_span(pairs, count), own_options, of(result))); });
}

winnow_status winnow_narrow_phase_bad_body(const winnow_narrow_phase* narrow, uint32_t* body) {
  if (!(are_given(narrow, body))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(narrow).bad_body()); }, body);
}

winnow_status winnow_narrow_phase_statistics(
    const winnow_narrow_phase* narrow, winnow_narrow_statistics* statistics) {
  if (!(are_given(narrow) && is_sized(statistics))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(narrow).statistics()); }, statistics);
}

winnow_status winnow_narrow_result_footprint(
    const winnow_narrow_result* result, winnow_footprint* footprint) {
  if (!(are_given(result) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(result, footprint);
}

winnow_status winnow_narrow_phase_footprint(
    const winnow_narrow_phase* narrow, winnow_footprint* footprint) {
  if (!(are_given(narrow) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(narrow, footprint);
}

winnow_status winnow_collide(
    const winnow_shape_pool* shapes, winnow_shape_id a, const winnow_pose* pose_a,
    winnow_shape_id b, const winnow_pose* pose_b, const winnow_narrow_options* options,
    winnow_pair_answer* answer) {
  NarrowOptions own_options{};
  if (!(are_given(shapes, pose_a, pose_b, answer) && read(options, own_options, 1))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (collide(of(shapes), ShapeId{a}, (*as_cpp(pose_a)), ShapeId{b}, (*as_cpp(pose_b)), own_options, *as_cpp(answer))); }, answer);
}
