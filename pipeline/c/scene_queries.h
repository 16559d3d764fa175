#pragma once

/// Queries against the exact shapes of a scene. <winnow/pipeline/scene_queries.h> documents each
/// call under the same name, and when the scene must be refreshed before it.

#include <winnow/c/core.h>
#include <winnow/c/scene.h>
#include <winnow/c/shapes.h>
#include <winnow/c/volumes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Scratch memory and results of queries: use one object per thread. Returned arrays are valid
/// until its next query. The scene must outlive it.
typedef struct winnow_scene_queries winnow_scene_queries;
WINNOW_C_API winnow_status winnow_scene_queries_create(const winnow_scene* scene,
                                                       const winnow_memory* memory,
                                                       winnow_scene_queries** queries);
WINNOW_C_API void winnow_scene_queries_destroy(winnow_scene_queries* queries);

/// Hit of a ray or a moving shape with a body; the null key if there is none.
typedef struct winnow_scene_hit {
  winnow_key key;
  uint64_t data;
  uint32_t part;
  double t;
  double normal[3];
  double point[3];
} winnow_scene_hit;

WINNOW_C_API winnow_status winnow_scene_queries_closest(winnow_scene_queries* queries,
                                                        const winnow_shape_ray* ray,
                                                        const winnow_filter* filter,
                                                        winnow_scene_hit* hit);
WINNOW_C_API winnow_status winnow_scene_queries_any(winnow_scene_queries* queries,
                                                    const winnow_shape_ray* ray,
                                                    const winnow_filter* filter,
                                                    winnow_scene_hit* hit);
WINNOW_C_API winnow_status winnow_scene_queries_all(winnow_scene_queries* queries,
                                                    const winnow_shape_ray* ray,
                                                    const winnow_filter* filter,
                                                    const winnow_scene_hit** hits, size_t* count);

/// Columns of rays. A null `max_t` means infinity.
typedef struct winnow_shape_ray_batch {
  const void* origin[3];
  const void* direction[3];
  const void* max_t;
  size_t count;
  size_t stride;
  winnow_number number;
} winnow_shape_ray_batch;

/// Columns to write; each may be null.
typedef struct winnow_scene_hit_columns {
  winnow_key* key;
  uint64_t* data;
  uint32_t* part;
  double* t;
  double* normal[3];
  double* point[3];
} winnow_scene_hit_columns;

WINNOW_C_API winnow_status winnow_scene_queries_closest_rays(winnow_scene_queries* queries,
                                                             const winnow_shape_ray_batch* rays,
                                                             const winnow_filter* filter,
                                                             const winnow_scene_hit_columns* hits);
WINNOW_C_API winnow_status winnow_scene_queries_any_rays(winnow_scene_queries* queries,
                                                         const winnow_shape_ray_batch* rays,
                                                         const winnow_filter* filter,
                                                         const winnow_scene_hit_columns* hits);
/// The hits of ray i are hits[first[i]] up to, but not including, hits[first[i + 1]].
WINNOW_C_API winnow_status winnow_scene_queries_all_rays(winnow_scene_queries* queries,
                                                         const winnow_shape_ray_batch* rays,
                                                         const winnow_filter* filter,
                                                         const winnow_scene_hit** hits,
                                                         const size_t** first);

/// A shape that moves along a line without turning. Convex or composite, but not a half-space.
typedef struct winnow_shape_cast {
  winnow_shape_id shape;
  winnow_pose pose;
  double direction[3];
  double max_t;
} winnow_shape_cast;
#define WINNOW_SHAPE_CAST \
  { WINNOW_NO_SHAPE, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}, {1.0, 0.0, 0.0}, 1.0 }
#define WINNOW_CAST_TOLERANCE 1e-6

WINNOW_C_API winnow_status winnow_scene_queries_closest_cast(winnow_scene_queries* queries,
                                                             const winnow_shape_cast* cast,
                                                             const winnow_filter* filter,
                                                             double tolerance,
                                                             winnow_scene_hit* hit);
WINNOW_C_API winnow_status winnow_scene_queries_all_cast(
    winnow_scene_queries* queries, const winnow_shape_cast* cast, const winnow_filter* filter,
    double tolerance, const winnow_scene_hit** hits, size_t* count);
/// Like the two functions without `_from_touch`, but a body that the shape touches at the start is
/// hit at t = 0 only if the shape gets deeper into it. If the shape slides along the body or leaves
/// it, the hit is with whatever the shape hits later.
WINNOW_C_API winnow_status winnow_scene_queries_closest_cast_from_touch(
    winnow_scene_queries* queries, const winnow_shape_cast* cast, const winnow_filter* filter,
    double tolerance, winnow_scene_hit* hit);
WINNOW_C_API winnow_status winnow_scene_queries_all_cast_from_touch(
    winnow_scene_queries* queries, const winnow_shape_cast* cast, const winnow_filter* filter,
    double tolerance, const winnow_scene_hit** hits, size_t* count);

/// A body that a shape overlaps.
typedef struct winnow_scene_overlap {
  winnow_key key;
  uint64_t data;
  uint32_t part;
} winnow_scene_overlap;
WINNOW_C_API winnow_status winnow_scene_queries_overlap(
    winnow_scene_queries* queries, winnow_shape_id shape, const winnow_pose* pose,
    const winnow_filter* filter, const winnow_scene_overlap** bodies, size_t* count);

/// Which pairs of bodies a query of two bodies or of two sets considers; see PairRules.
typedef int32_t winnow_pair_rules;
enum {
  WINNOW_PAIR_RULES_SCENE = 0,  ///< pairs that winnow_scene_collide would form
  WINNOW_PAIR_RULES_NONE = 1    ///< any two bodies
};

/// The closest (or deepest) points of two bodies, and their distance.
typedef struct winnow_scene_distance {
  winnow_key key;
  uint64_t data;
  uint32_t part_a;
  uint32_t part;
  double distance;
  double error_bound;
  double normal[3];
  double point_a[3];
  double point_b[3];
} winnow_scene_distance;
/// Set `limit` to INFINITY for no limit.
WINNOW_C_API winnow_status winnow_scene_queries_distance(winnow_scene_queries* queries,
                                                         winnow_key a, winnow_key b, double limit,
                                                         winnow_pair_rules rules,
                                                         winnow_scene_distance* answer);
WINNOW_C_API winnow_status winnow_scene_queries_nearest(winnow_scene_queries* queries,
                                                        const double point[3], size_t count,
                                                        double radius, const winnow_filter* filter,
                                                        const winnow_scene_distance** bodies,
                                                        size_t* found);

/// The closest pair of two sets of bodies. `a` is the null key if there is none.
typedef struct winnow_set_distance {
  winnow_key a;
  uint64_t data_a;
  winnow_scene_distance to;
} winnow_set_distance;
WINNOW_C_API winnow_status winnow_scene_queries_least_distance(
    winnow_scene_queries* queries, const winnow_key* a, size_t count_a, const winnow_key* b,
    size_t count_b, double limit, winnow_pair_rules rules, winnow_set_distance* answer);
/// Finds at most `most` pairs (body of a, body of b).
WINNOW_C_API winnow_status winnow_scene_queries_overlaps(winnow_scene_queries* queries,
                                                         const winnow_key* a, size_t count_a,
                                                         const winnow_key* b, size_t count_b,
                                                         size_t most, winnow_pair_rules rules,
                                                         const winnow_key_pair** pairs,
                                                         size_t* count);
/// Finds the first pair (body of a, body of b) whose distance is at most `contact_margin`; two null
/// keys if there is none.
WINNOW_C_API winnow_status winnow_scene_queries_any_contact(
    winnow_scene_queries* queries, const winnow_key* a, size_t count_a, const winnow_key* b,
    size_t count_b, double contact_margin, winnow_pair_rules rules, winnow_key_pair* pair);
/// Finds the first such pair among all bodies of the scene.
WINNOW_C_API winnow_status winnow_scene_queries_any_contact_in_scene(winnow_scene_queries* queries,
                                                                     double contact_margin,
                                                                     winnow_pair_rules rules,
                                                                     winnow_key_pair* pair);
WINNOW_C_API winnow_status winnow_scene_queries_footprint(const winnow_scene_queries* queries,
                                                          winnow_footprint* footprint);

#ifdef __cplusplus
}
#endif
