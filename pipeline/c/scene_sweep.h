#pragma once

/// Times of impact of scene bodies that move between two frames. <winnow/pipeline/scene_sweep.h>
/// documents each call under the same name.

#include <winnow/c/core.h>
#include <winnow/c/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Which pairs are tested. At least one body of a pair moves.
enum {
  WINNOW_SWEEP_ALL = 0,
  WINNOW_SWEEP_FIXED = 1,
  WINNOW_SWEEP_BULLETS = 2,
  WINNOW_SWEEP_BULLETS_AND_FIXED = 3
};
typedef int32_t winnow_sweep_pairs;

/// A null pointer, or zero members after `size`, mean the defaults of C++.
typedef struct winnow_sweep_options {
  size_t size;  ///< set by the caller to sizeof(winnow_sweep_options)
  winnow_sweep_pairs pairs;
  uint8_t leave_out_touching;  ///< 0 or 1: skips pairs that share a point at the start
  uint8_t first_only;          ///< 0 or 1
  double tolerance;            ///< 0 means 1e-6
  /// 1 for each moving body that is a bullet, else 0; null if none is.
  const uint8_t* bullets;
} winnow_sweep_options;
#define WINNOW_SWEEP_OPTIONS \
  { sizeof(winnow_sweep_options), WINNOW_SWEEP_ALL, 0, 0, 1e-6, NULL }

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

typedef struct winnow_scene_sweep winnow_scene_sweep;
/// `scene` must outlive the sweep.
WINNOW_C_API winnow_status winnow_scene_sweep_create(winnow_scene* scene,
                                                     const winnow_memory* memory,
                                                     winnow_scene_sweep** sweep);
WINNOW_C_API void winnow_scene_sweep_destroy(winnow_scene_sweep* sweep);

/// Moves the bodies from their current poses to `ends`. `options` may be null.
WINNOW_C_API winnow_status winnow_scene_sweep_sweep(winnow_scene_sweep* sweep,
                                                    const winnow_key* keys, size_t count,
                                                    const winnow_pose_view* ends,
                                                    const winnow_sweep_options* options);
/// Returns the impacts, not copied, valid until the next sweep.
WINNOW_C_API winnow_status winnow_scene_sweep_impacts(const winnow_scene_sweep* sweep,
                                                      const winnow_scene_impact** impacts,
                                                      size_t* count);
/// Returns, for each moving body, the index of its first impact; WINNOW_NO_IMPACT if it has none.
WINNOW_C_API winnow_status winnow_scene_sweep_first(const winnow_scene_sweep* sweep,
                                                    const uint32_t** first, size_t* count);
WINNOW_C_API winnow_status winnow_scene_sweep_footprint(const winnow_scene_sweep* sweep,
                                                        winnow_footprint* footprint);

#ifdef __cplusplus
}
#endif
