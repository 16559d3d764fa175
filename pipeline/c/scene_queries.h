// Generated from pipeline/interface/scene_queries.toml; do not edit.
// clang-format off
#pragma once

/// Queries against the exact shapes of a scene: rays, casts, overlaps, distances and nearest
/// bodies. Call winnow_scene_refresh first, and again after every change of bodies and every
/// in-place change of composite shapes; otherwise queries return WINNOW_INVALID_ARGUMENT.

#include <winnow/c/core.h>
#include <winnow/c/scene.h>
#include <winnow/c/shapes.h>
#include <winnow/c/time_of_impact.h>
#include <winnow/c/volumes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Scratch memory and results of queries: use one object per thread. Returned arrays are valid
/// until its next query.
typedef struct winnow_scene_queries winnow_scene_queries;

/// Default tolerance of casts, a length along the path.
#define WINNOW_CAST_TOLERANCE 1e-6

/// Which pairs of bodies a query of two bodies or of two sets considers.
typedef int32_t winnow_pair_rules;
enum {
  WINNOW_PAIR_RULES_SCENE = 0,  ///< pairs that winnow_scene_collide would form
  WINNOW_PAIR_RULES_NONE = 1    ///< any two bodies
};

/// Hit of a ray or a moving shape with a body; the null key if there is none.
typedef struct winnow_scene_hit {
  winnow_key key;  ///< the body
  uint64_t data;   ///< its client data
  uint32_t part;   ///< triangle or child that is hit; WINNOW_WHOLE_SHAPE for a convex body
  /// Of a ray: where it enters the shape; of a moving shape: the time of impact, never late.
  double t;
  double normal[3];  ///< unit normal of the body's surface, against the motion
  double point[3];   ///< point of contact, in the world
} winnow_scene_hit;

/// Columns of rays.
typedef struct winnow_shape_ray_batch {
  const void* origin[3];     ///< x, y, z
  const void* direction[3];  ///< x, y, z
  const void* min_t;         ///< null means 0
  const void* max_t;         ///< null means infinity
  size_t count;              ///< number of rays
  size_t stride;             ///< bytes from one ray to the next; 0 means no gaps
  winnow_number number;      ///< of all columns
} winnow_shape_ray_batch;

/// Columns to write, with one entry per ray; each may be null. A ray without a hit gets the null
/// key, 0, WINNOW_WHOLE_SHAPE, infinity and zeros.
typedef struct winnow_scene_hit_columns {
  winnow_key* key;    ///< bodies
  uint64_t* data;     ///< their client data
  uint32_t* part;     ///< triangles or children that are hit
  double* t;          ///< see winnow_scene_hit
  double* normal[3];  ///< x, y, z
  double* point[3];   ///< x, y, z, in the world
} winnow_scene_hit_columns;

/// A point at which a ray crosses the surface of a body.
typedef struct winnow_scene_crossing {
  winnow_key key;  ///< the body
  uint64_t data;   ///< its client data
  uint32_t part;   ///< triangle or child that is crossed; WINNOW_WHOLE_SHAPE for a convex body
  double t;        ///< parameter of the point, in units of the direction
  /// The ray leaves a convex shape, or comes from the back of a triangle, from which its corners
  /// are clockwise.
  bool exits;
  /// Unit normal that points out of a convex shape, or away from the front of a triangle.
  double normal[3];
  double point[3];  ///< in the world
  /// Weights of the corners of a triangle, whose sum is 1; 0 for convex shapes.
  double barycentric[3];
} winnow_scene_crossing;

/// A shape that moves along a line without turning. Convex or composite, but not a half-space.
typedef struct winnow_shape_cast {
  winnow_shape_id shape;  ///< from the scene's pools
  winnow_pose pose;       ///< at t = 0
  double direction[3];    ///< displacement per unit of t; finite, not zero
  double max_t;           ///< finite, >= 0
} winnow_shape_cast;
#define WINNOW_SHAPE_CAST \
  {WINNOW_NO_SHAPE, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}, {1.0, 0.0, 0.0}, 1.0}

/// A shape that translates and rotates. Convex or composite, but not a half-space.
typedef struct winnow_motion_cast {
  winnow_shape_id shape;       ///< from the scene's pools
  winnow_rigid_motion motion;  ///< from time 0 to time 1
  /// 0 or 1: a body that the shape touches at the start is hit at t = 0 only if the shape gets
  /// deeper into it.
  uint8_t from_touch;
} winnow_motion_cast;
#define WINNOW_MOTION_CAST \
  {WINNOW_NO_SHAPE, {{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}, \
  0}

/// A body that a shape overlaps.
typedef struct winnow_scene_overlap {
  winnow_key key;  ///< the body
  uint64_t data;   ///< its client data
  uint32_t part;   ///< one of its parts that overlap
} winnow_scene_overlap;

/// The closest (or deepest) points of two bodies, or of a point and a body, and their distance.
typedef struct winnow_scene_distance {
  winnow_key key;      ///< the second body
  uint64_t data;       ///< its client data
  uint32_t part_a;     ///< closest part of the first body
  uint32_t part;       ///< closest part of the second body
  double distance;     ///< minus the penetration depth if the bodies overlap
  double error_bound;  ///< the true distance is within distance +- error_bound
  double normal[3];    ///< unit vector from the first body (or the point) to the second body
  double point_a[3];   ///< closest point of the first body, in the world
  double point_b[3];   ///< closest point of the second body, in the world
} winnow_scene_distance;

/// The closest pair of two sets of bodies. `a` is the null key if there is none.
typedef struct winnow_set_distance {
  winnow_key a;              ///< body of the first set
  uint64_t data_a;           ///< its client data
  winnow_scene_distance to;  ///< distance from `a` to the body of the second set
} winnow_set_distance;

/// Creates queries on a scene, which must outlive them.
WINNOW_C_API winnow_status winnow_scene_queries_create(
    const winnow_scene* scene, const winnow_memory* memory, winnow_scene_queries** queries);

/// Destroys the scene queries; does nothing for null.
WINNOW_C_API void winnow_scene_queries_destroy(winnow_scene_queries* queries);

/// Finds the hit of least t; a hit with the null key if there is none.
WINNOW_C_API winnow_status winnow_scene_queries_closest(
    winnow_scene_queries* queries, const winnow_shape_ray* ray, const winnow_scene_filter* filter,
    winnow_scene_hit* hit);

/// Finds any one hit; a hit with the null key if there is none.
WINNOW_C_API winnow_status winnow_scene_queries_any(
    winnow_scene_queries* queries, const winnow_shape_ray* ray, const winnow_scene_filter* filter,
    winnow_scene_hit* hit);

/// Finds the first hit on every body that the ray hits, sorted by t.
WINNOW_C_API winnow_status winnow_scene_queries_all(
    winnow_scene_queries* queries, const winnow_shape_ray* ray, const winnow_scene_filter* filter,
    const winnow_scene_hit** hits, size_t* count);

/// Finds the hit of least t of each ray. One invalid ray makes the call fail. If memory is refused,
/// some rays' columns may have been written.
WINNOW_C_API winnow_status winnow_scene_queries_closest_rays(
    winnow_scene_queries* queries, const winnow_shape_ray_batch* rays,
    const winnow_scene_filter* filter, const winnow_scene_hit_columns* hits);

/// Finds any one hit of each ray.
WINNOW_C_API winnow_status winnow_scene_queries_any_rays(
    winnow_scene_queries* queries, const winnow_shape_ray_batch* rays,
    const winnow_scene_filter* filter, const winnow_scene_hit_columns* hits);

/// Finds the first hit on every body that each ray hits. The hits of ray i are hits[first[i]] up
/// to, but not including, hits[first[i + 1]].
WINNOW_C_API winnow_status winnow_scene_queries_all_rays(
    winnow_scene_queries* queries, const winnow_shape_ray_batch* rays,
    const winnow_scene_filter* filter, const winnow_scene_hit** hits, const size_t** first);

/// Finds every point at which the ray crosses the surface of a body, sorted by t: where it enters
/// and leaves convex shapes, and each triangle of a mesh or field, from either side. A ray that
/// starts in a convex shape only leaves it.
WINNOW_C_API winnow_status winnow_scene_queries_crossings(
    winnow_scene_queries* queries, const winnow_shape_ray* ray, const winnow_scene_filter* filter,
    const winnow_scene_crossing** points, size_t* count);

/// Finds the first body that the moving shape touches. t is never later than the true time, and
/// earlier by at most `tolerance` (a length along the path, finite, >= 0) plus rounding; 0 if the
/// shapes overlap at the start. WINNOW_UNSUPPORTED for a half-space.
WINNOW_C_API winnow_status winnow_scene_queries_closest_cast(
    winnow_scene_queries* queries, const winnow_shape_cast* cast, const winnow_scene_filter* filter,
    double tolerance, winnow_scene_hit* hit);

/// Finds the first hit on every body, sorted by t.
WINNOW_C_API winnow_status winnow_scene_queries_all_cast(
    winnow_scene_queries* queries, const winnow_shape_cast* cast, const winnow_scene_filter* filter,
    double tolerance, const winnow_scene_hit** hits, size_t* count);

/// Like winnow_scene_queries_closest_cast, but a body that the shape touches at the start is hit at
/// t = 0 only if the shape gets deeper into it. If the shape slides along the body or leaves it,
/// the hit is with whatever the shape hits later.
WINNOW_C_API winnow_status winnow_scene_queries_closest_cast_from_touch(
    winnow_scene_queries* queries, const winnow_shape_cast* cast, const winnow_scene_filter* filter,
    double tolerance, winnow_scene_hit* hit);

/// Like winnow_scene_queries_all_cast, for the hits of
/// winnow_scene_queries_closest_cast_from_touch.
WINNOW_C_API winnow_status winnow_scene_queries_all_cast_from_touch(
    winnow_scene_queries* queries, const winnow_shape_cast* cast, const winnow_scene_filter* filter,
    double tolerance, const winnow_scene_hit** hits, size_t* count);

/// Finds the first body that the shape touches while it translates and rotates; t is a time in [0,
/// 1], never later than the true one. At that time the gap is at most `tolerance`, relative to the
/// size of the shapes. WINNOW_UNSUPPORTED for a half-space; WINNOW_INVALID_POSE for an invalid
/// motion.
WINNOW_C_API winnow_status winnow_scene_queries_closest_motion(
    winnow_scene_queries* queries, const winnow_motion_cast* cast,
    const winnow_scene_filter* filter, double tolerance, winnow_scene_hit* hit);

/// Finds the first hit of the translating and rotating shape on every body, sorted by t.
WINNOW_C_API winnow_status winnow_scene_queries_all_motion(
    winnow_scene_queries* queries, const winnow_motion_cast* cast,
    const winnow_scene_filter* filter, double tolerance, const winnow_scene_hit** hits,
    size_t* count);

/// Finds every body that shares a point with the shape at this pose, sorted by id. The test is
/// exact.
WINNOW_C_API winnow_status winnow_scene_queries_overlap(
    winnow_scene_queries* queries, winnow_shape_id shape, const winnow_pose* pose,
    const winnow_scene_filter* filter, const winnow_scene_overlap** bodies, size_t* count);

/// Finds every body within distance `limit` of the shape at this pose (finite; 0 finds the bodies
/// that overlap it, with their depths), sorted by distance. The shape is the first body of the
/// answers.
WINNOW_C_API winnow_status winnow_scene_queries_distances(
    winnow_scene_queries* queries, winnow_shape_id shape, const winnow_pose* pose, double limit,
    const winnow_scene_filter* filter, const winnow_scene_distance** bodies, size_t* count);

/// Finds the closest (or deepest) points of two bodies. The key of the answer is null if the rules
/// exclude the pair, or if the distance exceeds `limit`. Set `limit` to INFINITY for no limit.
WINNOW_C_API winnow_status winnow_scene_queries_distance(
    winnow_scene_queries* queries, winnow_key a, winnow_key b, double limit,
    winnow_pair_rules rules, winnow_scene_distance* answer);

/// Finds the bodies nearest to a point, at most `count`, within distance `radius`, sorted by
/// distance. Inside a solid the distance is negative.
WINNOW_C_API winnow_status winnow_scene_queries_nearest(
    winnow_scene_queries* queries, const double point[3], size_t count, double radius,
    const winnow_scene_filter* filter, const winnow_scene_distance** bodies, size_t* found);

/// Finds the two bodies of two sets that are closest (or overlap the deepest). The key `a` of the
/// answer is null if the rules exclude all pairs, or if all distances exceed `limit`.
WINNOW_C_API winnow_status winnow_scene_queries_least_distance(
    winnow_scene_queries* queries, const winnow_key* a, size_t count_a, const winnow_key* b,
    size_t count_b, double limit, winnow_pair_rules rules, winnow_set_distance* answer);

/// Finds the pairs (body of a, body of b) that share a point, in the order of the sets, at most
/// `most` of them.
WINNOW_C_API winnow_status winnow_scene_queries_overlaps(
    winnow_scene_queries* queries, const winnow_key* a, size_t count_a, const winnow_key* b,
    size_t count_b, size_t most, winnow_pair_rules rules, const winnow_key_pair** pairs,
    size_t* count);

/// Finds the first pair (body of a, body of b) whose distance is at most `contact_margin`; two null
/// keys if there is none.
WINNOW_C_API winnow_status winnow_scene_queries_any_contact(
    winnow_scene_queries* queries, const winnow_key* a, size_t count_a, const winnow_key* b,
    size_t count_b, double contact_margin, winnow_pair_rules rules, winnow_key_pair* pair);

/// Finds the first such pair among all bodies of the scene.
WINNOW_C_API winnow_status winnow_scene_queries_any_contact_in_scene(
    winnow_scene_queries* queries, double contact_margin, winnow_pair_rules rules,
    winnow_key_pair* pair);

/// Writes the bytes of the scene queries, by purpose.
WINNOW_C_API winnow_status winnow_scene_queries_footprint(
    const winnow_scene_queries* queries, winnow_footprint* footprint);

#ifdef __cplusplus
}
#endif
