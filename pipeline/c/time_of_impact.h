// Generated from pipeline/interface/time_of_impact.toml; do not edit.
// clang-format off
#pragma once

/// Times of impact of shapes that move and turn. A time of impact is never late: before it the
/// shapes are apart.

#include <winnow/c/core.h>
#include <winnow/c/narrow_phase.h>
#include <winnow/c/shapes.h>
#include <winnow/c/volumes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Results of winnow_time_of_impact.
typedef struct winnow_impact_result winnow_impact_result;

/// Motion over time 0 to 1: constant velocity along a line, and rotation at a constant rate about a
/// fixed axis. At time t the position is start.position + t * travel. At most about 160,000 turns.
typedef struct winnow_rigid_motion {
  winnow_pose start;  ///< pose at time 0
  double travel[3];   ///< displacement from time 0 to time 1
  double turn[3];     ///< rotation axis times angle in radians, in world axes
} winnow_rigid_motion;
#define WINNOW_RIGID_MOTION \
  {{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}

/// Body i has shape shapes[i] and moves by motions[i].
typedef struct winnow_moving_bodies {
  const winnow_shape_id* shapes;       ///< one per body
  const winnow_rigid_motion* motions;  ///< one per body
  size_t count;                        ///< number of bodies
} winnow_moving_bodies;

/// Options of times of impact. A null pointer, or zero members after `size`, mean the defaults of
/// C++.
typedef struct winnow_impact_options {
  size_t size;  ///< set by the caller to sizeof(winnow_impact_options)
  /// Largest gap at the time of impact, relative to the size of the smaller shape, in (0, 1]; 0
  /// means 1e-6.
  double tolerance;
  /// Pool of the meshes, height fields and compounds, or null.
  const winnow_composite_pool* composites;
  winnow_execution execution;  ///< how work is run in parallel
} winnow_impact_options;
#define WINNOW_IMPACT_OPTIONS {sizeof(winnow_impact_options), 1e-6, NULL, {0, {NULL, NULL, 0}}}

/// Results as columns, not copied: one entry per pair, in the order of the pairs. Valid until the
/// result is used again or destroyed. Empty columns are null.
typedef struct winnow_impact_columns {
  size_t size;     ///< set by the caller to sizeof(winnow_impact_columns)
  size_t answers;  ///< number of pairs
  /// Winnow_status of each pair; unless it is WINNOW_OK the other columns contain zeros.
  const uint8_t* status;
  const uint8_t* hit;  ///< not 0 if the pair has an impact
  const double* time;  ///< in [0, 1], never later than the true time; 1 if there is no impact
  /// Distance at that time; minus the penetration depth of shapes that overlap at the start.
  const double* gap;
  const double* error_bound;  ///< the true distance is within gap +- error_bound
  const double* normal[3];    ///< unit vector from a to b at that time
  const double* point[3];  ///< contact point of a, relative to the position of body a at that time
  const uint32_t* part_a;  ///< triangle or child of a; WINNOW_WHOLE_SHAPE for a convex shape
  const uint32_t* part_b;  ///< triangle or child of b
} winnow_impact_columns;

/// Creates an empty result.
WINNOW_C_API winnow_status winnow_impact_result_create(
    const winnow_memory* memory, winnow_impact_result** result);

/// Destroys the impact result; does nothing for null.
WINNOW_C_API void winnow_impact_result_destroy(winnow_impact_result* result);

/// Writes the columns of the last call.
WINNOW_C_API winnow_status winnow_impact_result_columns(
    const winnow_impact_result* result, winnow_impact_columns* columns);

/// Writes the bytes of the impact result, by purpose.
WINNOW_C_API winnow_status winnow_impact_result_footprint(
    const winnow_impact_result* result, winnow_footprint* footprint);

/// Computes the motion from one pose to another by the shorter rotation, at most half a turn.
/// WINNOW_INVALID_POSE for an invalid motion.
WINNOW_C_API winnow_status winnow_rigid_motion_between(
    const winnow_pose* start, const winnow_pose* end, winnow_rigid_motion* motion);

/// Computes the motion at constant velocities for a duration, in lengths and radians per unit of
/// `duration`, in world axes. The rotation may exceed a full turn. WINNOW_INVALID_POSE for an
/// invalid motion.
WINNOW_C_API winnow_status winnow_rigid_motion_by_velocities(
    const winnow_pose* start, const double linear[3], const double angular[3], double duration,
    winnow_rigid_motion* motion);

/// Computes the pose at a time in [0, 1]. WINNOW_INVALID_POSE for an invalid motion.
WINNOW_C_API winnow_status winnow_rigid_motion_at(
    const winnow_rigid_motion* motion, double time, winnow_pose* pose);

/// Finds the time at which the shapes of each pair first touch. Shapes that share a point at the
/// start touch at time 0. An error of one pair is reported in its status. WINNOW_INVALID_ARGUMENT
/// for an invalid tolerance or a body index out of range: then `result` is empty.
WINNOW_C_API winnow_status winnow_time_of_impact(
    const winnow_shape_pool* shapes, const winnow_moving_bodies* bodies,
    const winnow_body_pair* pairs, size_t count, const winnow_impact_options* options,
    winnow_impact_result* result);

#ifdef __cplusplus
}
#endif
