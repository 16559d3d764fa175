#pragma once

/// Bodies with shapes and poses, and what touches what. What each call does stands at the same name
/// of <winnow/pipeline/scene.h> and contacts.h.

#include <winnow/c/core.h>
#include <winnow/c/narrow_phase.h>
#include <winnow/c/partition.h>
#include <winnow/c/shapes.h>
#include <winnow/c/volumes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Which set of a scene a body is in.
enum { WINNOW_MOTION_FIXED = 0, WINNOW_MOTION_DYNAMIC = 1, WINNOW_MOTION_SLEEPING = 2 };
#define WINNOW_MOTIONS 3

/// Null, and zeros behind `size`, stand for what C++ has by default.
typedef struct winnow_scene_options {
  size_t size;  ///< sizeof(winnow_scene_options), of the caller
  const winnow_memory* memory;
  winnow_execution execution;
  winnow_structure_kind structures[WINNOW_MOTIONS];
  double margin;
  winnow_narrow_tier tier;
  uint8_t contact_reduction;  ///< 0 or 1
  double carry_over;
  size_t build_budget;
  /// What holds meshes, compounds and height fields, or null. Must outlive the scene.
  const winnow_composite_pool* composites;
} winnow_scene_options;
#define WINNOW_SCENE_OPTIONS                                                                    \
  {                                                                                             \
    sizeof(winnow_scene_options), NULL, {WINNOW_EXECUTION_DEFAULT, {NULL, NULL, 0}},            \
        {{WINNOW_LINEAR_BVH, 0.0F}, {WINNOW_LINEAR_BVH, 0.0F}, {WINNOW_LINEAR_BVH, 0.0F}}, 0.0, \
        WINNOW_TIER_ROBUST, 0, 0.0, 0, NULL                                                     \
  }

typedef struct winnow_scene winnow_scene;
/// `shapes` must outlive it.
WINNOW_C_API winnow_status winnow_scene_create(const winnow_shape_pool* shapes,
                                               const winnow_scene_options* options,
                                               winnow_scene** scene);
WINNOW_C_API void winnow_scene_destroy(winnow_scene* scene);

/// Where contacts of a body begin, and where it rests: lengths. `contact` >= 0 and >= `rest`.
typedef struct winnow_contact_offsets {
  double contact;
  double rest;
} winnow_contact_offsets;

/// A body as it is added.
typedef struct winnow_body_definition {
  winnow_shape_id shape;
  winnow_pose pose;
  uint8_t motion;
  winnow_object_filter filter;
  uint64_t data;
  winnow_contact_offsets offsets;
  uint16_t layer;  ///< below 4096
} winnow_body_definition;
#define WINNOW_BODY_DEFINITION                                                       \
  {                                                                                  \
    WINNOW_NO_SHAPE, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}, WINNOW_MOTION_DYNAMIC, \
        {1U, 0xFFFFFFFFU, 0U}, 0, {0.0, 0.0}, 0                                      \
  }

WINNOW_C_API winnow_status winnow_scene_add(winnow_scene* scene,
                                            const winnow_body_definition* bodies, size_t count,
                                            winnow_key* keys);
WINNOW_C_API winnow_status winnow_scene_remove(winnow_scene* scene, const winnow_key* keys,
                                               size_t count);
WINNOW_C_API winnow_status winnow_scene_clear(winnow_scene* scene);
WINNOW_C_API winnow_status winnow_scene_move(winnow_scene* scene, const winnow_key* keys,
                                             size_t count, const winnow_pose_view* poses);
WINNOW_C_API winnow_status winnow_scene_set_motion(winnow_scene* scene, const winnow_key* keys,
                                                   size_t count, uint8_t motion);
WINNOW_C_API winnow_status winnow_scene_set_shape(winnow_scene* scene, winnow_key key,
                                                  winnow_shape_id shape);
WINNOW_C_API winnow_status winnow_scene_set_filter(winnow_scene* scene, winnow_key key,
                                                   const winnow_object_filter* filter);

/// Pairs of bodies that never meet, or meet again.
WINNOW_C_API winnow_status winnow_scene_set_ignored(winnow_scene* scene,
                                                    const winnow_key_pair* pairs, size_t count,
                                                    bool ignored);
WINNOW_C_API winnow_status winnow_scene_is_ignored(const winnow_scene* scene, winnow_key a,
                                                   winnow_key b, bool* ignored);

WINNOW_C_API winnow_status winnow_scene_size(const winnow_scene* scene, size_t* size);
WINNOW_C_API winnow_status winnow_scene_size_of(const winnow_scene* scene, uint8_t motion,
                                                size_t* size);
WINNOW_C_API winnow_status winnow_scene_contains(const winnow_scene* scene, winnow_key key,
                                                 bool* contains);
WINNOW_C_API winnow_status winnow_scene_body(const winnow_scene* scene, winnow_key key,
                                             winnow_body_definition* body);
/// The null key for an id that no body has.
WINNOW_C_API winnow_status winnow_scene_key_of(const winnow_scene* scene, uint32_t id,
                                               winnow_key* key);

WINNOW_C_API winnow_status winnow_scene_refresh(winnow_scene* scene);
/// A point of the world from which the boxes of the partitions are measured.
WINNOW_C_API winnow_status winnow_scene_origin(const winnow_scene* scene, double origin[3]);
/// The partition of a set, to be asked, not changed; null while it has none. Valid as long as the
/// scene. Its client data are bodies' ids.
WINNOW_C_API winnow_status winnow_scene_partition(winnow_scene* scene, uint8_t motion,
                                                  const winnow_partition** partition);
/// `options` may be null.
WINNOW_C_API winnow_status winnow_scene_debug_draw(const winnow_scene* scene,
                                                   const winnow_debug_draw* draw,
                                                   const winnow_debug_draw_options* options);

// --- contacts -------------------------------------------------------------------------------

/// What `winnow_scene_collide` found. Remembers it, so that events can be told.
typedef struct winnow_contacts winnow_contacts;
WINNOW_C_API winnow_status winnow_contacts_create(const winnow_memory* memory,
                                                  winnow_contacts** contacts);
WINNOW_C_API void winnow_contacts_destroy(winnow_contacts* contacts);
WINNOW_C_API winnow_status winnow_contacts_clear(winnow_contacts* contacts);
WINNOW_C_API winnow_status winnow_contacts_footprint(const winnow_contacts* contacts,
                                                     winnow_footprint* footprint);

/// What became of a pair since the contacts were last filled.
enum { WINNOW_EVENT_BEGUN = 0, WINNOW_EVENT_PERSISTED = 1 };

typedef struct winnow_ended_contact {
  winnow_key a;
  winnow_key b;
  uint64_t data_a;
  uint64_t data_b;
} winnow_ended_contact;

#define WINNOW_WHOLE_SHAPE 0xFFFFFFFFU

/// Contacts where they lie, valid until they are filled again, cleared or destroyed. Columns that
/// the level has not are null, and so may be those that are empty.
typedef struct winnow_contact_columns {
  size_t size;  ///< sizeof(winnow_contact_columns), of the caller
  winnow_contact_level level;
  /// Pairs of bodies, by the kinds of their shapes.
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
  /// How many pairs kept the manifolds they had.
  size_t carried;
  /// Manifolds of pair i: [manifold_first[i], manifold_first[i + 1]).
  const uint32_t* manifold_first;
  size_t manifolds;
  const uint32_t* part_a;
  const uint32_t* part_b;
  const double* distance;
  const double* error_bound;
  const double* normal[3];
  const double* point[3];  ///< level distance
  /// Level manifold: points of manifold m are [point_first[m], point_first[m + 1]), relative to the
  /// position of body a.
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

/// How much a scene is to have room for.
typedef struct winnow_scene_room {
  size_t size;  ///< sizeof(winnow_scene_room), of the caller
  size_t bodies[WINNOW_MOTIONS];
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

/// Bytes by part. The sum of `reserved` equals what is outstanding at the memory of the scene.
typedef struct winnow_scene_bytes {
  size_t size;  ///< sizeof(winnow_scene_bytes), of the caller
  winnow_bytes bodies;
  winnow_bytes partitions[WINNOW_MOTIONS];
  winnow_bytes pairs;
  winnow_bytes mid_phase;
  winnow_bytes narrow_phase;
} winnow_scene_bytes;
WINNOW_C_API winnow_status winnow_scene_footprint(const winnow_scene* scene,
                                                  winnow_scene_bytes* footprint);

/// Counters of the last collide, never timings.
typedef struct winnow_scene_counts {
  size_t size;  ///< sizeof(winnow_scene_counts), of the caller
  uint64_t boxes_updated;
  uint64_t body_pairs;
  uint64_t carried;
  uint64_t primitive_pairs;
  uint64_t convex_pairs;  ///< narrow phase, pairs of convex bodies
  uint64_t convex_recomputed;
  uint64_t convex_exact;
  uint64_t part_pairs;  ///< narrow phase, pairs of parts
  uint64_t part_recomputed;
  uint64_t part_exact;
  uint64_t balls_apart;  ///< of body_pairs, not asked about since balls around them are apart
} winnow_scene_counts;
WINNOW_C_API winnow_status winnow_scene_statistics(const winnow_scene* scene,
                                                   winnow_scene_counts* statistics);

#ifdef __cplusplus
}
#endif
