#pragma once

/// Times of impact of scene bodies that move between two frames.
/// <winnow/pipeline/continuous_collision.h> documents each call under the same name.

#include <winnow/c/core.h>
#include <winnow/c/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Which pairs are tested. At least one body of a pair moves.
enum {
  WINNOW_CONTINUOUS_ALL = 0,
  WINNOW_CONTINUOUS_FIXED = 1,
  WINNOW_CONTINUOUS_BULLETS = 2,
  WINNOW_CONTINUOUS_BULLETS_AND_FIXED = 3
};
typedef int32_t winnow_continuous_pairs;

/// A null pointer, or zero members after `size`, mean the defaults of C++.
typedef struct winnow_continuous_options {
  size_t size;  ///< set by the caller to sizeof(winnow_continuous_options)
  winnow_continuous_pairs pairs;
  uint8_t leave_out_touching;  ///< 0 or 1: skips pairs that share a point at the start
  uint8_t first_only;          ///< 0 or 1
  double tolerance;            ///< 0 means 1e-6
  /// 1 for each moving body that is a bullet, else 0; null if none is.
  const uint8_t* bullets;
} winnow_continuous_options;
#define WINNOW_CONTINUOUS_OPTIONS \
  { sizeof(winnow_continuous_options), WINNOW_CONTINUOUS_ALL, 0, 0, 1e-6, NULL }

/// An impact of two bodies.
typedef struct winnow_scene_impact {
  winnow_key a;
  winnow_key b;
  uint64_t data_a;
  uint64_t data_b;
  uint32_t part_a;
  uint32_t part_b;
  double time;  ///< in [0, 1], never later than the true time
  double gap;
  double error_bound;
  double normal[3];
  double point[3];
} winnow_scene_impact;

#define WINNOW_NO_IMPACT 0xFFFFFFFFU

typedef struct winnow_continuous_collision winnow_continuous_collision;
/// `scene` must outlive the object.
WINNOW_C_API winnow_status winnow_continuous_collision_create(winnow_scene* scene,
                                                              const winnow_memory* memory,
                                                              winnow_continuous_collision** ccd);
WINNOW_C_API void winnow_continuous_collision_destroy(winnow_continuous_collision* ccd);

/// Moves the bodies from their current poses to `ends`. `options` may be null.
WINNOW_C_API winnow_status winnow_continuous_collision_find_impacts(
    winnow_continuous_collision* ccd, const winnow_key* keys, size_t count,
    const winnow_pose_view* ends, const winnow_continuous_options* options);
/// Returns the impacts, not copied, valid until the next call that finds impacts.
WINNOW_C_API winnow_status winnow_continuous_collision_impacts(
    const winnow_continuous_collision* ccd, const winnow_scene_impact** impacts, size_t* count);
/// Returns, for each moving body, the index of its first impact; WINNOW_NO_IMPACT if it has none.
WINNOW_C_API winnow_status winnow_continuous_collision_first(const winnow_continuous_collision* ccd,
                                                             const uint32_t** first, size_t* count);
WINNOW_C_API winnow_status winnow_continuous_collision_footprint(
    const winnow_continuous_collision* ccd, winnow_footprint* footprint);

#ifdef __cplusplus
}
#endif
