#pragma once

/// Times of impact of shapes that move and turn. <winnow/pipeline/time_of_impact.h> and
/// rigid_motion.h document each call under the same name.

#include <winnow/c/core.h>
#include <winnow/c/narrow_phase.h>
#include <winnow/c/shapes.h>
#include <winnow/c/volumes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// A motion over time 0 to 1.
typedef struct winnow_rigid_motion {
  winnow_pose start;
  double travel[3];
  double turn[3];  ///< rotation axis times angle in radians, in world axes
} winnow_rigid_motion;
/// This function and the next two return WINNOW_INVALID_POSE for an invalid motion.
WINNOW_C_API winnow_status winnow_rigid_motion_between(const winnow_pose* start,
                                                       const winnow_pose* end,
                                                       winnow_rigid_motion* motion);
WINNOW_C_API winnow_status winnow_rigid_motion_by_velocities(const winnow_pose* start,
                                                             const double linear[3],
                                                             const double angular[3],
                                                             double duration,
                                                             winnow_rigid_motion* motion);
/// `time` is in [0, 1].
WINNOW_C_API winnow_status winnow_rigid_motion_at(const winnow_rigid_motion* motion, double time,
                                                  winnow_pose* pose);

/// Body i has shape shapes[i] and moves by motions[i].
typedef struct winnow_moving_bodies {
  const winnow_shape_id* shapes;
  const winnow_rigid_motion* motions;
  size_t count;
} winnow_moving_bodies;

/// A null pointer, or zero members after `size`, mean the defaults of C++.
typedef struct winnow_impact_options {
  size_t size;       ///< set by the caller to sizeof(winnow_impact_options)
  double tolerance;  ///< 0 means 1e-6
  /// Pool of the meshes, height fields and compounds, or null.
  const winnow_composite_pool* composites;
  winnow_execution execution;
} winnow_impact_options;
#define WINNOW_IMPACT_OPTIONS                    \
  {                                              \
    sizeof(winnow_impact_options), 1e-6, NULL, { \
      WINNOW_EXECUTION_DEFAULT, {                \
        NULL, NULL, 0                            \
      }                                          \
    }                                            \
  }

typedef struct winnow_impact_result winnow_impact_result;
WINNOW_C_API winnow_status winnow_impact_result_create(const winnow_memory* memory,
                                                       winnow_impact_result** result);
WINNOW_C_API void winnow_impact_result_destroy(winnow_impact_result* result);

/// Results as columns, not copied: one entry per pair, in the order of the pairs. Valid until the
/// result is used again or destroyed. Empty columns are null.
typedef struct winnow_impact_columns {
  size_t size;  ///< set by the caller to sizeof(winnow_impact_columns)
  size_t answers;
  const uint8_t* status;  ///< winnow_status of each pair
  const uint8_t* hit;     ///< not 0 if the pair has an impact
  const double* time;     ///< in [0, 1], never later than the true time; 1 if there is no impact
  const double* gap;
  const double* error_bound;
  const double* normal[3];
  const double* point[3];
  const uint32_t* part_a;
  const uint32_t* part_b;
} winnow_impact_columns;
WINNOW_C_API winnow_status winnow_impact_result_columns(const winnow_impact_result* result,
                                                        winnow_impact_columns* columns);
WINNOW_C_API winnow_status winnow_impact_result_footprint(const winnow_impact_result* result,
                                                          winnow_footprint* footprint);

/// `options` may be null. An error of one pair is reported in its status. If the call fails,
/// `result` is empty.
WINNOW_C_API winnow_status winnow_time_of_impact(const winnow_shape_pool* shapes,
                                                 const winnow_moving_bodies* bodies,
                                                 const winnow_body_pair* pairs, size_t count,
                                                 const winnow_impact_options* options,
                                                 winnow_impact_result* result);

#ifdef __cplusplus
}
#endif
