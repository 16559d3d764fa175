#pragma once

/// Overlaps, distances and contacts of pairs of convex shapes. <winnow/pipeline/narrow_phase.h> and
/// narrow_result.h document each call under the same name.

#include <winnow/c/core.h>
#include <winnow/c/shapes.h>
#include <winnow/c/volumes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// How much is computed for each pair.
typedef int32_t winnow_contact_level;
enum {
  WINNOW_LEVEL_PAIRS = 0,  ///< only for scenes
  WINNOW_LEVEL_BOOLEAN = 1,
  WINNOW_LEVEL_DISTANCE = 2,
  WINNOW_LEVEL_MANIFOLD = 3
};

/// Required accuracy of the results.
typedef int32_t winnow_narrow_tier;
enum { WINNOW_TIER_ROBUST = 0, WINNOW_TIER_REFERENCE = 1 };

/// Indices of two bodies that may touch.
typedef struct winnow_body_pair {
  uint32_t a;
  uint32_t b;
} winnow_body_pair;

/// Consecutive results whose shapes have the same two kinds.
typedef struct winnow_run {
  uint8_t kind_a;  ///< a winnow_shape_kind
  uint8_t kind_b;
  uint32_t first;
  uint32_t count;
} winnow_run;

typedef struct winnow_narrow_result winnow_narrow_result;
WINNOW_C_API winnow_status winnow_narrow_result_create(const winnow_memory* memory,
                                                       winnow_narrow_result** result);
WINNOW_C_API void winnow_narrow_result_destroy(winnow_narrow_result* result);

/// Results as columns, not copied, valid until the result is used again or destroyed. A column that
/// its level does not have is null. An empty column may be null.
typedef struct winnow_narrow_columns {
  size_t size;  ///< set by the caller to sizeof(winnow_narrow_columns)
  winnow_contact_level level;
  size_t answers;
  const uint32_t* pair_of;  ///< index of the input pair of result i
  const winnow_run* runs;
  size_t run_count;
  /// Level boolean: not 0 if the shapes share a point. At higher levels, test distance <= 0.
  const uint8_t* overlap;
  const double* distance;
  const double* error_bound;
  const double* normal[3];
  const double* point[3];  ///< only at level distance
  /// Level manifold: the points of result i are [contact_first[i], contact_first[i] +
  /// contact_count[i]).
  const uint32_t* contact_first;
  const uint32_t* contact_count;
  size_t contacts;
  const float* position[3];
  const float* depth;
  const uint64_t* feature;
} winnow_narrow_columns;
WINNOW_C_API winnow_status winnow_narrow_result_columns(const winnow_narrow_result* result,
                                                        winnow_narrow_columns* columns);
WINNOW_C_API winnow_status winnow_narrow_result_footprint(const winnow_narrow_result* result,
                                                          winnow_footprint* footprint);

/// Body i has shape shapes[i] at pose i.
typedef struct winnow_bodies {
  const winnow_shape_id* shapes;
  size_t count;
  winnow_pose_view poses;
} winnow_bodies;

/// A null pointer, or zero members after `size`, mean the defaults of C++.
typedef struct winnow_narrow_options {
  size_t size;                 ///< set by the caller to sizeof(winnow_narrow_options)
  winnow_contact_level level;  ///< 0: manifold
  winnow_narrow_tier tier;
  double contact_margin;
  winnow_execution execution;
} winnow_narrow_options;
#define WINNOW_NARROW_OPTIONS                                                        \
  {                                                                                  \
    sizeof(winnow_narrow_options), WINNOW_LEVEL_MANIFOLD, WINNOW_TIER_ROBUST, 0.0, { \
      WINNOW_EXECUTION_DEFAULT, {                                                    \
        NULL, NULL, 0                                                                \
      }                                                                              \
    }                                                                                \
  }

/// Scratch memory that is reused between calls. Use one per thread.
typedef struct winnow_narrow_phase winnow_narrow_phase;
WINNOW_C_API winnow_status winnow_narrow_phase_create(const winnow_memory* memory,
                                                      winnow_narrow_phase** narrow);
WINNOW_C_API void winnow_narrow_phase_destroy(winnow_narrow_phase* narrow);
/// `options` may be null. If a call fails because of invalid bodies or pairs, `result` is empty.
WINNOW_C_API winnow_status winnow_narrow_phase_collide(winnow_narrow_phase* narrow,
                                                       const winnow_shape_pool* shapes,
                                                       const winnow_bodies* bodies,
                                                       const winnow_body_pair* pairs, size_t count,
                                                       const winnow_narrow_options* options,
                                                       winnow_narrow_result* result);
/// Returns the index of the body that made the last call fail.
WINNOW_C_API winnow_status winnow_narrow_phase_bad_body(const winnow_narrow_phase* narrow,
                                                        uint32_t* body);

typedef struct winnow_narrow_statistics {
  size_t size;  ///< set by the caller to sizeof(winnow_narrow_statistics)
  uint64_t pairs;
  uint64_t recomputed;
  uint64_t without_lanes;
  uint64_t exact;
  uint64_t bounded;
} winnow_narrow_statistics;
WINNOW_C_API winnow_status winnow_narrow_phase_statistics(const winnow_narrow_phase* narrow,
                                                          winnow_narrow_statistics* statistics);
WINNOW_C_API winnow_status winnow_narrow_phase_footprint(const winnow_narrow_phase* narrow,
                                                         winnow_footprint* footprint);

/// One contact point of a pair.
typedef struct winnow_contact_point {
  float position[3];
  float depth;
  uint64_t feature;
} winnow_contact_point;

/// Result for one pair. Level boolean sets only `overlap`; level distance sets all but the
/// contacts; level manifold sets all but `point`.
typedef struct winnow_pair_answer {
  double distance;
  double error_bound;
  double normal[3];
  double point[3];
  bool overlap;
  uint32_t contact_count;
  winnow_contact_point contacts[4];
} winnow_pair_answer;

/// Computes one pair without a narrow phase object and without allocating. May be called from any
/// number of threads. `options` may be null.
WINNOW_C_API winnow_status winnow_collide(const winnow_shape_pool* shapes, winnow_shape_id a,
                                          const winnow_pose* pose_a, winnow_shape_id b,
                                          const winnow_pose* pose_b,
                                          const winnow_narrow_options* options,
                                          winnow_pair_answer* answer);

#ifdef __cplusplus
}
#endif
