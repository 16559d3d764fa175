// Generated from pipeline/interface/continuous_collision.toml; do not edit.
// clang-format off

#include <winnow/c/continuous_collision.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_continuous_collision_create(
    winnow_scene* scene, const winnow_memory* memory, winnow_continuous_collision** ccd) {
  if (!(are_given(scene, ccd))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, ccd, of(scene));
}

void winnow_continuous_collision_destroy(winnow_continuous_collision* ccd) {
  destroy(ccd);
}

winnow_status winnow_continuous_collision_find_impacts(
    winnow_continuous_collision* ccd, const winnow_key* keys, size_t count,
    const winnow_pose_view* ends, const winnow_continuous_options* options) {
  ContinuousOptions own_options{};
  if (!(are_given(ccd, ends) && is_array(keys, count) && read(options, own_options, count))) return WINNOW_INVALID_ARGUMENT;
  PoseView own_ends;
  if (const Status bad = read_view(*ends, ccd->room, own_ends); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(ccd).find_impacts(as_cpp_span(keys, count), own_ends, own_options)); });
}

winnow_status winnow_continuous_collision_find_impacts_of_motions(
    winnow_continuous_collision* ccd, const winnow_key* keys, const winnow_rigid_motion* motions,
    size_t count, const winnow_continuous_options* options) {
  ContinuousOptions own_options{};
  if (!(are_given(ccd) && is_array(keys, count) && is_array(motions, count) && read(options, own_options, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(ccd).find_impacts(as_cpp_span(keys, count), as_cpp_span(motions, count), own_options)); });
}

winnow_status winnow_continuous_collision_impacts(
    const winnow_continuous_collision* ccd, const winnow_scene_impact** impacts, size_t* count) {
  if (!(are_given(ccd, impacts, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(ccd).impacts()); }, impacts, count);
}

winnow_status winnow_continuous_collision_first(
    const winnow_continuous_collision* ccd, const uint32_t** first, size_t* count) {
  if (!(are_given(ccd, first, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(ccd).first()); }, first, count);
}

winnow_status winnow_continuous_collision_statistics(
    const winnow_continuous_collision* ccd, winnow_continuous_statistics* statistics) {
  if (!(are_given(ccd) && is_sized(statistics))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(ccd).statistics()); }, statistics);
}

winnow_status winnow_continuous_collision_footprint(
    const winnow_continuous_collision* ccd, winnow_footprint* footprint) {
  if (!(are_given(ccd) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(ccd, footprint);
}
