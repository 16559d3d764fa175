#pragma once

/// Bodies with shapes and poses, and their contacts. <winnow/pipeline/scene.h> and contacts.h
/// document each call under the same name.

#include <winnow/c/core.h>
#include <winnow/c/narrow_phase.h>
#include <winnow/c/partition.h>
#include <winnow/c/shapes.h>
#include <winnow/c/volumes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The set of a scene that a body belongs to.
enum { WINNOW_BODY_STATE_FIXED = 0, WINNOW_BODY_STATE_DYNAMIC = 1, WINNOW_BODY_STATE_SLEEPING = 2 };
#define WINNOW_BODY_STATES 3

/// A null pointer, or zero members after `size`, mean the defaults of C++.
typedef struct winnow_scene_options {
  size_t size;  ///< set by the caller to sizeof(winnow_scene_options)
  const winnow_memory* memory;
  winnow_execution execution;
  winnow_structure_kind structures[WINNOW_BODY_STATES];
  double contact_margin;
  winnow_narrow_tier tier;
  uint8_t contact_reduction;  ///< 0 or 1
  double cache_tolerance;
  size_t build_budget;
  /// Pool of the meshes, compounds and height fields, or null. Must outlive the scene.
  const winnow_composite_pool* composites;
} winnow_scene_options;
#define WINNOW_SCENE_OPTIONS                                                                    \
  {                                                                                             \
    sizeof(winnow_scene_options), NULL, {WINNOW_EXECUTION_DEFAULT, {NULL, NULL, 0}},            \
        {{WINNOW_LINEAR_BVH, 0.0F}, {WINNOW_LINEAR_BVH, 0.0F}, {WINNOW_LINEAR_BVH, 0.0F}}, 0.0, \
        WINNOW_TIER_ROBUST, 0, 0.0, 0, NULL                                                     \
  }

typedef struct winnow_scene winnow_scene;
/// `shapes` must outlive the scene.
WINNOW_C_API winnow_status winnow_scene_create(const winnow_shape_pool* shapes,
                                               const winnow_scene_options* options,
                                               winnow_scene** scene);
WINNOW_C_API void winnow_scene_destroy(winnow_scene* scene);

/// Distances from the surface of a body at which its contacts begin (`contact`) and at which it
/// rests (`rest`). `contact` >= 0 and >= `rest`.
typedef struct winnow_contact_offsets {
  double contact;
  double rest;
} winnow_contact_offsets;

/// A body to add.
typedef struct winnow_body_definition {
  winnow_shape_id shape;
  winnow_pose pose;
  uint8_t state;
  winnow_object_filter filter;
  uint64_t data;
  winnow_contact_offsets offsets;
  uint16_t layer;  ///< below 4096
} winnow_body_definition;
#define WINNOW_BODY_DEFINITION                                                           \
  {                                                                                      \
    WINNOW_NO_SHAPE, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}, WINNOW_BODY_STATE_DYNAMIC, \
        {1U, 0xFFFFFFFFU, 0U}, 0, {0.0, 0.0}, 0                                          \
  }

WINNOW_C_API winnow_status winnow_scene_add(winnow_scene* scene,
                                            const winnow_body_definition* bodies, size_t count,
                                            winnow_key* keys);
WINNOW_C_API winnow_status winnow_scene_remove(winnow_scene* scene, const winnow_key* keys,
                                               size_t count);
WINNOW_C_API winnow_status winnow_scene_clear(winnow_scene* scene);
WINNOW_C_API winnow_status winnow_scene_move(winnow_scene* scene, const winnow_key* keys,
                                             size_t count, const winnow_pose_view* poses);
WINNOW_C_API winnow_status winnow_scene_set_body_state(winnow_scene* scene, const winnow_key* keys,
                                                       size_t count, uint8_t state);
WINNOW_C_API winnow_status winnow_scene_set_shape(winnow_scene* scene, winnow_key key,
                                                  winnow_shape_id shape);
WINNOW_C_API winnow_status winnow_scene_set_filter(winnow_scene* scene, winnow_key key,
                                                   const winnow_object_filter* filter);

/// Makes pairs of bodies ignore each other, or collide again.
WINNOW_C_API winnow_status winnow_scene_set_ignored(winnow_scene* scene,
                                                    const winnow_key_pair* pairs, size_t count,
                                                    bool ignored);
WINNOW_C_API winnow_status winnow_scene_is_ignored(const winnow_scene* scene, winnow_key a,
                                                   winnow_key b, bool* ignored);

WINNOW_C_API winnow_status winnow_scene_size(const winnow_scene* scene, size_t* size);
WINNOW_C_API winnow_status winnow_scene_size_of(const winnow_scene* scene, uint8_t state,
                                                size_t* size);
WINNOW_C_API winnow_status winnow_scene_contains(const winnow_scene* scene, winnow_key key,
                                                 bool* contains);
WINNOW_C_API winnow_status winnow_scene_body(const winnow_scene* scene, winnow_key key,
                                             winnow_body_definition* body);
/// Returns the null key for an id that no body has.
WINNOW_C_API winnow_status winnow_scene_key_of(const winnow_scene* scene, uint32_t id,
                                               winnow_key* key);

WINNOW_C_API winnow_status winnow_scene_refresh(winnow_scene* scene);
/// Returns the point of the world to which the boxes of the partitions are relative.
WINNOW_C_API winnow_status winnow_scene_origin(const winnow_scene* scene, double origin[3]);
/// Returns the read-only partition of a set, valid as long as the scene; null while the set has
/// none. Its client data are body ids.
WINNOW_C_API winnow_status winnow_scene_partition(winnow_scene* scene, uint8_t state,
                                                  const winnow_partition** partition);
/// `options` may be null.
WINNOW_C_API winnow_status winnow_scene_debug_draw(const winnow_scene* scene,
                                                   const winnow_debug_draw* draw,
                                                   const winnow_debug_draw_options* options);

// --- contacts -------------------------------------------------------------------------------

/// Results of `winnow_scene_collide`. They also keep the previous results, to report events.
typedef struct winnow_contacts winnow_contacts;
WINNOW_C_API winnow_status winnow_contacts_create(const winnow_memory* memory,
                                                  winnow_contacts** contacts);
WINNOW_C_API void winnow_contacts_destroy(winnow_contacts* contacts);
WINNOW_C_API winnow_status winnow_contacts_clear(winnow_contacts* contacts);
WINNOW_C_API winnow_status winnow_contacts_footprint(const winnow_contacts* contacts,
                                                     winnow_footprint* footprint);

/// State of a pair relative to the previous call that filled the contacts.
enum { WINNOW_EVENT_BEGUN = 0, WINNOW_EVENT_PERSISTED = 1 };

typedef struct winnow_ended_contact {
  winnow_key a;
  winnow_key b;
  uint64_t data_a;
  uint64_t data_b;
} winnow_ended_contact;

#define WINNOW_WHOLE_SHAPE 0xFFFFFFFFU

/// Contacts as columns, not copied, valid until the contacts are filled again, cleared or
/// destroyed. A column that its level does not have is null. An empty column may be null.
typedef struct winnow_contact_columns {
  size_t size;  ///< set by the caller to sizeof(winnow_contact_columns)
  winnow_contact_level level;
  /// Pairs of bodies, grouped by the kinds of their shapes.
  size_t pairs;
  const winnow_key* a;
  const winnow_key* b;
  const uint64_t* data_a;
  const uint64_t* data_b;
  const uint8_t* event;
  const winnow_run* runs;
  size_t run_count;
  const winnow_ended_contact* ended;
  size_t ended_count;
  /// Number of pairs that kept their previous manifolds.
  size_t cached_pairs;
  /// The manifolds of pair i are [manifold_first[i], manifold_first[i + 1]).
  const uint32_t* manifold_first;
  size_t manifolds;
  const uint32_t* part_a;
  const uint32_t* part_b;
  const double* distance;
  const double* error_bound;
  const double* normal[3];
  const double* point[3];  ///< only at level distance
  /// Level manifold: the points of manifold m are [point_first[m], point_first[m + 1]), relative to
  /// the position of body a.
  const uint32_t* point_first;
  size_t points;
  const float* position[3];
  const float* depth;
  const uint64_t* feature;
} winnow_contact_columns;
WINNOW_C_API winnow_status winnow_contacts_columns(const winnow_contacts* contacts,
                                                   winnow_contact_columns* columns);

WINNOW_C_API winnow_status winnow_scene_collide(winnow_scene* scene, winnow_contact_level level,
                                                winnow_contacts* contacts);

// --- room, bytes and counters ---------------------------------------------------------------

/// Numbers of bodies, pairs and contacts that memory is reserved for.
typedef struct winnow_scene_room {
  size_t size;  ///< set by the caller to sizeof(winnow_scene_room)
  size_t bodies[WINNOW_BODY_STATES];
  size_t pairs;
  winnow_contact_level level;
  size_t touching;
  size_t manifolds;
  size_t points;
} winnow_scene_room;
#define WINNOW_SCENE_ROOM \
  { sizeof(winnow_scene_room), {0, 0, 0}, 0, WINNOW_LEVEL_MANIFOLD, 0, 0, 0 }
WINNOW_C_API winnow_status winnow_scene_reserve(winnow_scene* scene, const winnow_scene_room* room,
                                                winnow_pages pages);
WINNOW_C_API winnow_status winnow_scene_reserve_contacts(const winnow_scene* scene,
                                                         winnow_contacts* contacts,
                                                         const winnow_scene_room* room,
                                                         winnow_pages pages);

/// Bytes by part. The sum of `reserved` equals the bytes allocated from the scene's memory.
typedef struct winnow_scene_bytes {
  size_t size;  ///< set by the caller to sizeof(winnow_scene_bytes)
  winnow_bytes bodies;
  winnow_bytes partitions[WINNOW_BODY_STATES];
  winnow_bytes pairs;
  winnow_bytes mid_phase;
  winnow_bytes narrow_phase;
} winnow_scene_bytes;
WINNOW_C_API winnow_status winnow_scene_footprint(const winnow_scene* scene,
                                                  winnow_scene_bytes* footprint);

/// Counters of the last collide, not timings.
typedef struct winnow_scene_counts {
  size_t size;  ///< set by the caller to sizeof(winnow_scene_counts)
  uint64_t boxes_updated;
  uint64_t body_pairs;
  uint64_t cached_pairs;
  uint64_t primitive_pairs;
  uint64_t convex_pairs;  ///< narrow phase, pairs of convex bodies
  uint64_t convex_recomputed;
  uint64_t convex_exact;
  uint64_t part_pairs;  ///< narrow phase, pairs of parts
  uint64_t part_recomputed;
  uint64_t part_exact;
  uint64_t rejected_by_spheres;  ///< body_pairs skipped because their bounding spheres are disjoint
} winnow_scene_counts;
WINNOW_C_API winnow_status winnow_scene_statistics(const winnow_scene* scene,
                                                   winnow_scene_counts* statistics);

#ifdef __cplusplus
}
#endif
