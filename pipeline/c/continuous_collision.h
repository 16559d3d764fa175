// Generated from pipeline/interface/continuous_collision.toml; do not edit.
// clang-format off
#pragma once

/// Times of impact of scene bodies that move between two frames (continuous collision detection).
/// Nothing in the scene is moved. Every body moves along its whole path: an impact does not stop
/// it.

#include <winnow/c/core.h>
#include <winnow/c/scene.h>
#include <winnow/c/time_of_impact.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Impacts of moving bodies, and scratch memory.
typedef struct winnow_continuous_collision winnow_continuous_collision;

/// Index of no impact.
#define WINNOW_NO_IMPACT 0xFFFFFFFFU

/// Which pairs are tested. At least one body of a pair moves.
typedef int32_t winnow_continuous_pairs;
enum {
  WINNOW_CONTINUOUS_ALL = 0,               ///< all pairs
  WINNOW_CONTINUOUS_FIXED = 1,             ///< all bodies against fixed bodies
  WINNOW_CONTINUOUS_BULLETS = 2,           ///< bullets against all bodies
  WINNOW_CONTINUOUS_BULLETS_AND_FIXED = 3  ///< union of the two before
};

/// Options of finding impacts. A null pointer, or zero members after `size`, mean the defaults of
/// C++.
typedef struct winnow_continuous_options {
  size_t size;                    ///< set by the caller to sizeof(winnow_continuous_options)
  winnow_continuous_pairs pairs;  ///< which pairs are tested
  uint8_t leave_out_touching;     ///< 0 or 1: skips pairs that share a point at the start
  uint8_t first_only;             ///< 0 or 1: finds only the first impact of each moving body
  double tolerance;               ///< see winnow_impact_options; 0 means 1e-6
  const uint8_t* bullets;  ///< 1 for each moving body that is a bullet, else 0; null if none is
} winnow_continuous_options;
#define WINNOW_CONTINUOUS_OPTIONS \
  {sizeof(winnow_continuous_options), WINNOW_CONTINUOUS_ALL, 0, 0, 1e-6, NULL}

/// An impact of two bodies.
typedef struct winnow_scene_impact {
  winnow_key a;        ///< body with the smaller id
  winnow_key b;        ///< body with the larger id
  uint64_t data_a;     ///< client data of a
  uint64_t data_b;     ///< client data of b
  uint32_t part_a;     ///< triangle or child of a; WINNOW_WHOLE_SHAPE for a convex body
  uint32_t part_b;     ///< triangle or child of b
  double time;         ///< in [0, 1], never later than the true time
  double gap;          ///< distance at that time
  double error_bound;  ///< the true gap is within gap +- error_bound
  double normal[3];    ///< unit vector from a to b, at that time
  double point[3];     ///< contact point of a at that time, in the world
} winnow_scene_impact;

/// Counters of the last call that found impacts.
typedef struct winnow_continuous_statistics {
  size_t size;          ///< set by the caller to sizeof(winnow_continuous_statistics)
  uint64_t boxes;       ///< boxes around paths of bodies, or around pieces of paths
  uint64_t body_pairs;  ///< pairs whose boxes overlap at some time
} winnow_continuous_statistics;

/// Works on a scene, which must outlive the object.
WINNOW_C_API winnow_status winnow_continuous_collision_create(
    winnow_scene* scene, const winnow_memory* memory, winnow_continuous_collision** ccd);

/// Destroys the continuous collision; does nothing for null.
WINNOW_C_API void winnow_continuous_collision_destroy(winnow_continuous_collision* ccd);

/// Moves the bodies from their current poses to `ends`; without orientations they do not rotate.
/// All other bodies are at rest. WINNOW_INVALID_KEY also if a key occurs twice; WINNOW_INVALID_POSE
/// for an end that is invalid or too far away. A failed call keeps the previous impacts, except
/// WINNOW_OUT_OF_MEMORY.
WINNOW_C_API winnow_status winnow_continuous_collision_find_impacts(
    winnow_continuous_collision* ccd, const winnow_key* keys, size_t count,
    const winnow_pose_view* ends, const winnow_continuous_options* options);

/// As above, for any motions, such as from velocities. Each body starts at the start of its motion.
WINNOW_C_API winnow_status winnow_continuous_collision_find_impacts_of_motions(
    winnow_continuous_collision* ccd, const winnow_key* keys, const winnow_rigid_motion* motions,
    size_t count, const winnow_continuous_options* options);

/// Returns the first impact of each pair, sorted by time, then by the ids of a and b; not copied,
/// valid until the next call that finds impacts.
WINNOW_C_API winnow_status winnow_continuous_collision_impacts(
    const winnow_continuous_collision* ccd, const winnow_scene_impact** impacts, size_t* count);

/// Returns, for each moving body, the index of its first impact; WINNOW_NO_IMPACT if it has none.
WINNOW_C_API winnow_status winnow_continuous_collision_first(
    const winnow_continuous_collision* ccd, const uint32_t** first, size_t* count);

/// Writes the counters of the last call that found impacts.
WINNOW_C_API winnow_status winnow_continuous_collision_statistics(
    const winnow_continuous_collision* ccd, winnow_continuous_statistics* statistics);

/// Writes the bytes of the continuous collision, by purpose.
WINNOW_C_API winnow_status winnow_continuous_collision_footprint(
    const winnow_continuous_collision* ccd, winnow_footprint* footprint);

#ifdef __cplusplus
}
#endif
