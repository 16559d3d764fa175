// Generated from pipeline/interface/volumes.toml; do not edit.
// clang-format off

#include <winnow/c/volumes.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_frustum_perspective(
    const float eye[3], const float forward[3], const float up[3], float vertical_fov, float aspect,
    float near_t, float far_t, winnow_frustum* frustum) {
  if (!(are_given(eye, forward, up, frustum))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (valid_frustum(Frustum::perspective(Vec3f(eye), Vec3f(forward), Vec3f(up), vertical_fov, aspect, near_t,
far_t))); }, frustum);
}

winnow_status winnow_frustum_from_matrix(
    const double clip_from_world[16], int32_t near_depth, winnow_frustum* frustum) {
  Frustum::NearDepth own_near_depth{};
  if (!(are_given(clip_from_world, frustum) && read(near_depth, own_near_depth))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (valid_frustum(Frustum::from_matrix(matrix_by_rows(clip_from_world), own_near_depth))); }, frustum);
}
