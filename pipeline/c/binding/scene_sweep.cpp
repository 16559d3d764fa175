// C binding of SceneSweep (scene_sweep.h).

#include <winnow/c/scene_sweep.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/columns.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"
#include "pipeline/c/binding/options.h"
#include "pipeline/c/binding/views.h"

namespace winnow::c {

bool read_options(const winnow_sweep_options* given, std::size_t count,
                  SweepOptions& options) noexcept {
  winnow_sweep_options own{};
  if (!read_sized(given, own) ||
      !read_choice(own.pairs, SweepPairs::bullets_and_fixed, options.pairs)) {
    return false;
  }
  if (own.bullets != nullptr) options.bullets = {own.bullets, count};
  take_given(own.tolerance, options.tolerance);
  options.touching = own.leave_out_touching == 0;
  options.first_only = own.first_only != 0;
  return true;
}

}  // namespace winnow::c

using namespace winnow::c;

static_assert(WINNOW_NO_IMPACT == winnow::kNoImpact);

winnow_status winnow_scene_sweep_create(winnow_scene* scene, const winnow_memory* memory,
                                        winnow_scene_sweep** sweep) {
  if (!are_given(scene, sweep)) return WINNOW_INVALID_ARGUMENT;
  return create(memory, sweep, scene->value);
}

void winnow_scene_sweep_destroy(winnow_scene_sweep* sweep) {
  destroy(sweep);
}

winnow_status winnow_scene_sweep_sweep(winnow_scene_sweep* sweep, const winnow_key* keys,
                                       size_t count, const winnow_pose_view* ends,
                                       const winnow_sweep_options* options) {
  winnow::SweepOptions read;
  if (!are_given(sweep, ends) || !is_array(keys, count) || !read_options(options, count, read)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  if (count != ends->count) return WINNOW_SIZE_MISMATCH;
  winnow::PoseView view;
  const winnow::Status status = read_poses(ends, sweep->room, view);
  if (status != winnow::Status::ok) return answer(status);
  return answer(sweep->value.sweep(as_cpp_span(keys, count), view, read));
}

winnow_status winnow_scene_sweep_impacts(const winnow_scene_sweep* sweep,
                                         const winnow_scene_impact** impacts, size_t* count) {
  if (!are_given(sweep, impacts, count)) return WINNOW_INVALID_ARGUMENT;
  return_array(sweep->value.impacts(), impacts, count);
  return WINNOW_OK;
}

winnow_status winnow_scene_sweep_first(const winnow_scene_sweep* sweep, const uint32_t** first,
                                       size_t* count) {
  if (!are_given(sweep, first, count)) return WINNOW_INVALID_ARGUMENT;
  *first = column(sweep->value.first());
  *count = sweep->value.first().size();
  return WINNOW_OK;
}

winnow_status winnow_scene_sweep_footprint(const winnow_scene_sweep* sweep,
                                           winnow_footprint* footprint) {
  if (sweep == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(sweep, sweep->value.footprint(), sweep->room.bytes(), footprint);
}
