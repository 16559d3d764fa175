// C binding of ContinuousCollision (continuous_collision.h).

#include <winnow/c/continuous_collision.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/columns.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"
#include "pipeline/c/binding/options.h"
#include "pipeline/c/binding/views.h"

namespace winnow::c {

bool read_options(const winnow_continuous_options* given, std::size_t count,
                  ContinuousOptions& options) noexcept {
  winnow_continuous_options own{};
  if (!read_sized(given, own) ||
      !read_choice(own.pairs, ContinuousPairs::bullets_and_fixed, options.pairs)) {
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

winnow_status winnow_continuous_collision_create(winnow_scene* scene, const winnow_memory* memory,
                                                 winnow_continuous_collision** ccd) {
  if (!are_given(scene, ccd)) return WINNOW_INVALID_ARGUMENT;
  return create(memory, ccd, scene->value);
}

void winnow_continuous_collision_destroy(winnow_continuous_collision* ccd) {
  destroy(ccd);
}

winnow_status winnow_continuous_collision_find_impacts(winnow_continuous_collision* ccd,
                                                       const winnow_key* keys, size_t count,
                                                       const winnow_pose_view* ends,
                                                       const winnow_continuous_options* options) {
  winnow::ContinuousOptions read;
  if (!are_given(ccd, ends) || !is_array(keys, count) || !read_options(options, count, read)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  if (count != ends->count) return WINNOW_SIZE_MISMATCH;
  winnow::PoseView view;
  const winnow::Status status = read_poses(ends, ccd->room, view);
  if (status != winnow::Status::ok) return answer(status);
  return answer(ccd->value.find_impacts(as_cpp_span(keys, count), view, read));
}

winnow_status winnow_continuous_collision_impacts(const winnow_continuous_collision* ccd,
                                                  const winnow_scene_impact** impacts,
                                                  size_t* count) {
  if (!are_given(ccd, impacts, count)) return WINNOW_INVALID_ARGUMENT;
  return_array(ccd->value.impacts(), impacts, count);
  return WINNOW_OK;
}

winnow_status winnow_continuous_collision_first(const winnow_continuous_collision* ccd,
                                                const uint32_t** first, size_t* count) {
  if (!are_given(ccd, first, count)) return WINNOW_INVALID_ARGUMENT;
  *first = column(ccd->value.first());
  *count = ccd->value.first().size();
  return WINNOW_OK;
}

winnow_status winnow_continuous_collision_footprint(const winnow_continuous_collision* ccd,
                                                    winnow_footprint* footprint) {
  if (ccd == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(ccd, ccd->value.footprint(), ccd->room.bytes(), footprint);
}
