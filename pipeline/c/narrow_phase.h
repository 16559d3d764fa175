// Generated from pipeline/interface/narrow_phase.toml; do not edit.
// clang-format off
#pragma once

/// Overlaps, distances and contacts of pairs of convex shapes, each with a guaranteed error bound.

#include <winnow/c/core.h>
#include <winnow/c/shapes.h>
#include <winnow/c/volumes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Results of a narrow phase.
typedef struct winnow_narrow_result winnow_narrow_result;

/// Scratch memory that is reused between calls. Use one per thread.
typedef struct winnow_narrow_phase winnow_narrow_phase;

/// How much is computed for each pair.
typedef int32_t winnow_contact_level;
enum {
  WINNOW_LEVEL_PAIRS = 0,     ///< pairs of bodies whose boxes overlap; only for scenes
  WINNOW_LEVEL_BOOLEAN = 1,   ///< pairs that share a point
  WINNOW_LEVEL_DISTANCE = 2,  ///< also distance or depth, normal and closest points
  WINNOW_LEVEL_MANIFOLD = 3   ///< also contact points, in place of closest points
};

/// Required accuracy of the results.
typedef int32_t winnow_narrow_tier;
enum {
  /// Errors of at most 4e-7 of the sizes, usually 1e-15; the sign of the distance is exact.
  WINNOW_TIER_ROBUST = 0,
  WINNOW_TIER_REFERENCE = 1  ///< computes every pair with the scalar reference implementation
};

/// Indices of two bodies that may touch.
typedef struct winnow_body_pair {
  uint32_t a;
  uint32_t b;
} winnow_body_pair;

/// Consecutive results whose shapes have the same two kinds.
typedef struct winnow_run {
  uint8_t kind_a;  ///< a winnow_shape_kind
  uint8_t kind_b;  ///< a winnow_shape_kind, not below kind_a
  uint32_t first;  ///< first result of the run
  uint32_t count;  ///< number of results
} winnow_run;

/// Results as columns, not copied, valid until the result is used again or destroyed. A column that
/// its level does not have is null. An empty column may be null.
typedef struct winnow_narrow_columns {
  size_t size;                 ///< set by the caller to sizeof(winnow_narrow_columns)
  winnow_contact_level level;  ///< level of the call
  size_t answers;              ///< number of results
  const uint32_t* pair_of;     ///< index of the input pair of result i
  const winnow_run* runs;      ///< together all results
  size_t run_count;            ///< number of runs
  /// Level boolean: not 0 if the shapes share a point. At higher levels, test distance <= 0.
  const uint8_t* overlap;
  /// Minus the penetration depth if the shapes overlap; <= 0 exactly if they share a point.
  const double* distance;
  const double* error_bound;  ///< the true distance is within distance +- error_bound
  const double* normal[3];    ///< unit vector from a to b
  /// Level distance: the closest (or deepest) point of a, relative to the position of a.
  const double* point[3];
  /// Level manifold: the points of result i are [contact_first[i], contact_first[i] +
  /// contact_count[i]).
  const uint32_t* contact_first;
  const uint32_t* contact_count;  ///< 0 to 4
  size_t contacts;                ///< number of points of all results
  const float* position[3];       ///< halfway between the surfaces, relative to the position of a
  const float* depth;             ///< positive where the bodies overlap
  const uint64_t* feature;        ///< equal features in two frames are the same point
} winnow_narrow_columns;

/// Body i has shape shapes[i] at pose i.
typedef struct winnow_bodies {
  const winnow_shape_id* shapes;  ///< one per body
  size_t count;                   ///< number of shapes
  winnow_pose_view poses;         ///< one per body
} winnow_bodies;

/// Options of a narrow phase. A null pointer, or zero members after `size`, mean the defaults of
/// C++.
typedef struct winnow_narrow_options {
  size_t size;                 ///< set by the caller to sizeof(winnow_narrow_options)
  winnow_contact_level level;  ///< 0 means manifold
  winnow_narrow_tier tier;     ///< how exact results must be
  double contact_margin;  ///< pairs whose gap is at most this get contact points. Finite, >= 0.
  winnow_execution execution;     ///< how work is run in parallel
  const double* contact_margins;  ///< null, or a margin for each pair, used instead
} winnow_narrow_options;
#define WINNOW_NARROW_OPTIONS \
  {sizeof(winnow_narrow_options), WINNOW_LEVEL_MANIFOLD, WINNOW_TIER_ROBUST, 0.0, {0, {NULL, NULL, \
  0}}, NULL}

/// Counters of the last call.
typedef struct winnow_narrow_statistics {
  size_t size;             ///< set by the caller to sizeof(winnow_narrow_statistics)
  uint64_t pairs;          ///< pairs computed
  uint64_t recomputed;     ///< pairs that the SIMD lanes could not certify and the solver computed
  uint64_t without_lanes;  ///< pairs that were not tried in lanes
  uint64_t exact;          ///< pairs whose sign was computed in exact arithmetic
  uint64_t bounded;        ///< searches of the solver that did not close their bounds
} winnow_narrow_statistics;

/// One contact point of a pair.
typedef struct winnow_contact_point {
  float position[3];  ///< halfway between the surfaces, relative to the position of body a
  float depth;        ///< positive if the bodies overlap there
  uint64_t feature;   ///< equal features in two frames are the same point
} winnow_contact_point;

/// Result for one pair. Level boolean sets only `overlap`; level distance sets all but the
/// contacts; level manifold sets all but `point`.
typedef struct winnow_pair_answer {
  double distance;         ///< minus the penetration depth if the shapes overlap
  double error_bound;      ///< the true distance is within distance +- error_bound
  double normal[3];        ///< unit vector from a to b
  double point[3];         ///< closest (or deepest) point of a, relative to the position of a
  bool overlap;            ///< true if the shapes share a point
  uint32_t contact_count;  ///< number of contact points
  winnow_contact_point contacts[4];  ///< the points
} winnow_pair_answer;

/// Creates an empty result.
WINNOW_C_API winnow_status winnow_narrow_result_create(
    const winnow_memory* memory, winnow_narrow_result** result);

/// Destroys the narrow result; does nothing for null.
WINNOW_C_API void winnow_narrow_result_destroy(winnow_narrow_result* result);

/// Writes the columns of the last call.
WINNOW_C_API winnow_status winnow_narrow_result_columns(
    const winnow_narrow_result* result, winnow_narrow_columns* columns);

/// Writes the bytes of the narrow result, by purpose.
WINNOW_C_API winnow_status winnow_narrow_result_footprint(
    const winnow_narrow_result* result, winnow_footprint* footprint);

/// Creates a narrow phase.
WINNOW_C_API winnow_status winnow_narrow_phase_create(
    const winnow_memory* memory, winnow_narrow_phase** narrow);

/// Destroys the narrow phase; does nothing for null.
WINNOW_C_API void winnow_narrow_phase_destroy(winnow_narrow_phase* narrow);

/// Computes all pairs. WINNOW_INVALID_ARGUMENT for an invalid option or a body index out of range;
/// WINNOW_SIZE_MISMATCH; WINNOW_INVALID_KEY for a shape that the pool does not contain;
/// WINNOW_INVALID_POSE. After an error of bodies or pairs `result` is empty.
WINNOW_C_API winnow_status winnow_narrow_phase_collide(
    winnow_narrow_phase* narrow, const winnow_shape_pool* shapes, const winnow_bodies* bodies,
    const winnow_body_pair* pairs, size_t count, const winnow_narrow_options* options,
    winnow_narrow_result* result);

/// Returns the index of the body that made the last call fail; 0xFFFFFFFF if there is none.
WINNOW_C_API winnow_status winnow_narrow_phase_bad_body(
    const winnow_narrow_phase* narrow, uint32_t* body);

/// Writes the counters of the last call.
WINNOW_C_API winnow_status winnow_narrow_phase_statistics(
    const winnow_narrow_phase* narrow, winnow_narrow_statistics* statistics);

/// Writes the bytes of the narrow phase, by purpose.
WINNOW_C_API winnow_status winnow_narrow_phase_footprint(
    const winnow_narrow_phase* narrow, winnow_footprint* footprint);

/// Computes one pair without a narrow phase object and without allocating. May be called from any
/// number of threads. Errors as for winnow_narrow_phase_collide.
WINNOW_C_API winnow_status winnow_collide(
    const winnow_shape_pool* shapes, winnow_shape_id a, const winnow_pose* pose_a,
    winnow_shape_id b, const winnow_pose* pose_b, const winnow_narrow_options* options,
    winnow_pair_answer* answer);

#ifdef __cplusplus
}
#endif
