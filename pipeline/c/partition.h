#pragma once

/// Partitions of bounding volumes, and their result buffers. <winnow/partitions/partition.h>
/// documents each call, its errors and its cost under the same name.

#include <winnow/c/core.h>
#include <winnow/c/volumes.h>

#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct winnow_partition winnow_partition;

// --- buffers of results ---------------------------------------------------------------------
// Result buffers belong to the caller, are reused from frame to frame, and are used by one thread
// at a time. Returned arrays are not copied: they are valid until the buffer is used again or
// destroyed.

/// Ids of two objects that may touch.
typedef struct winnow_pair {
  uint32_t first;
  uint32_t second;
} winnow_pair;

typedef struct winnow_pair_buffer winnow_pair_buffer;
WINNOW_C_API winnow_status winnow_pair_buffer_create(const winnow_memory* memory,
                                                     winnow_pair_buffer** buffer);
WINNOW_C_API void winnow_pair_buffer_destroy(winnow_pair_buffer* buffer);
WINNOW_C_API winnow_status winnow_pair_buffer_pairs(const winnow_pair_buffer* buffer,
                                                    const winnow_pair** pairs, size_t* count);
WINNOW_C_API winnow_status winnow_pair_buffer_reserve(winnow_pair_buffer* buffer, size_t count,
                                                      winnow_pages pages);
WINNOW_C_API winnow_status winnow_pair_buffer_assign(winnow_pair_buffer* buffer,
                                                     const winnow_pair_buffer* other);
WINNOW_C_API winnow_status winnow_pair_buffer_clear(winnow_pair_buffer* buffer);
WINNOW_C_API winnow_status winnow_pair_buffer_release(winnow_pair_buffer* buffer);
WINNOW_C_API winnow_status winnow_pair_buffer_footprint(const winnow_pair_buffer* buffer,
                                                        winnow_footprint* footprint);

/// Keys of two objects.
typedef struct winnow_key_pair {
  winnow_key first;
  winnow_key second;
} winnow_key_pair;

/// Client data of two objects, as given when they were inserted.
typedef struct winnow_client_data_pair {
  uint64_t first;
  uint64_t second;
} winnow_client_data_pair;

typedef struct winnow_pair_events winnow_pair_events;
WINNOW_C_API winnow_status winnow_pair_events_create(const winnow_memory* memory,
                                                     winnow_pair_events** events);
/// Creates events that also report client data; see PairEventsOptions::client_data.
WINNOW_C_API winnow_status winnow_pair_events_create_with_client_data(const winnow_memory* memory,
                                                                      winnow_pair_events** events);
WINNOW_C_API void winnow_pair_events_destroy(winnow_pair_events* events);
WINNOW_C_API winnow_status winnow_pair_events_begun(const winnow_pair_events* events,
                                                    const winnow_key_pair** pairs, size_t* count);
WINNOW_C_API winnow_status winnow_pair_events_ended(const winnow_pair_events* events,
                                                    const winnow_key_pair** pairs, size_t* count);
/// Return the client data of the pairs that `begun` and `ended` return, in the same order. Empty if
/// the events were created without client data.
WINNOW_C_API winnow_status winnow_pair_events_begun_data(const winnow_pair_events* events,
                                                         const winnow_client_data_pair** data,
                                                         size_t* count);
WINNOW_C_API winnow_status winnow_pair_events_ended_data(const winnow_pair_events* events,
                                                         const winnow_client_data_pair** data,
                                                         size_t* count);
WINNOW_C_API winnow_status winnow_pair_events_persisting(const winnow_pair_events* events,
                                                         size_t* count);
WINNOW_C_API winnow_status winnow_pair_events_clear(winnow_pair_events* events);
WINNOW_C_API winnow_status winnow_pair_events_footprint(const winnow_pair_events* events,
                                                        winnow_footprint* footprint);

/// Object found by a ray, a cast or a nearest query; the null key, 0 and infinity if none was
/// found.
typedef struct winnow_hit {
  winnow_key key;
  uint64_t data;
  float t;
} winnow_hit;

typedef struct winnow_hit_buffer winnow_hit_buffer;
WINNOW_C_API winnow_status winnow_hit_buffer_create(const winnow_memory* memory,
                                                    winnow_hit_buffer** buffer);
WINNOW_C_API void winnow_hit_buffer_destroy(winnow_hit_buffer* buffer);
WINNOW_C_API winnow_status winnow_hit_buffer_hits(const winnow_hit_buffer* buffer,
                                                  const winnow_hit** hits, size_t* count);
WINNOW_C_API winnow_status winnow_hit_buffer_queries(const winnow_hit_buffer* buffer,
                                                     size_t* count);
/// Returns the hits of one query of a batch.
WINNOW_C_API winnow_status winnow_hit_buffer_of(const winnow_hit_buffer* buffer, size_t query,
                                                const winnow_hit** hits, size_t* count);
WINNOW_C_API winnow_status winnow_hit_buffer_reserve(winnow_hit_buffer* buffer, size_t count);
WINNOW_C_API winnow_status winnow_hit_buffer_clear(winnow_hit_buffer* buffer);
WINNOW_C_API winnow_status winnow_hit_buffer_footprint(const winnow_hit_buffer* buffer,
                                                       winnow_footprint* footprint);

typedef struct winnow_overlap_buffer winnow_overlap_buffer;
WINNOW_C_API winnow_status winnow_overlap_buffer_create(const winnow_memory* memory,
                                                        winnow_overlap_buffer** buffer);
WINNOW_C_API void winnow_overlap_buffer_destroy(winnow_overlap_buffer* buffer);
/// Returns the ids of the overlapping objects: first `inside` objects whose boxes are contained in
/// the region, then all other objects.
WINNOW_C_API winnow_status winnow_overlap_buffer_ids(const winnow_overlap_buffer* buffer,
                                                     const uint32_t** ids, size_t* count,
                                                     size_t* inside);
WINNOW_C_API winnow_status winnow_overlap_buffer_reserve(winnow_overlap_buffer* buffer,
                                                         size_t count);
WINNOW_C_API winnow_status winnow_overlap_buffer_clear(winnow_overlap_buffer* buffer);
WINNOW_C_API winnow_status winnow_overlap_buffer_footprint(const winnow_overlap_buffer* buffer,
                                                           winnow_footprint* footprint);

// --- a partition ----------------------------------------------------------------------------

/// Data structure of a partition. A struct of zeros means linear_bvh.
typedef struct winnow_structure_kind {
  int32_t structure;
  float parameter;  ///< `loose` of the loose trees; 0 means the default of the structure
} winnow_structure_kind;
enum {
  WINNOW_LINEAR_BVH = 0,
  WINNOW_AUTOMATIC = 1,
  WINNOW_SWEEP_AND_PRUNE = 2,
  WINNOW_HIERARCHICAL_GRID = 3,
  WINNOW_FLAT_GRID = 4,
  WINNOW_STATIC_BVH = 5,
  WINNOW_LOOSE_OCTREE = 6,
  WINNOW_LOOSE_QUADTREE = 7,
  WINNOW_BOUNDS_N_SQUARED = 8,
  WINNOW_N_SQUARED = 9
};
/// Returns the name of a structure, such as "LinearBvh"; empty if it is invalid.
WINNOW_C_API const char* winnow_structure_name(winnow_structure_kind structure);
WINNOW_C_API winnow_status winnow_structure_named(const char* name,
                                                  winnow_structure_kind* structure);

typedef int32_t winnow_volume;
enum {
  WINNOW_VOLUME_AABB = 0,
  WINNOW_VOLUME_SPHERE = 1,
  WINNOW_VOLUME_KDOP14 = 2,
  WINNOW_VOLUME_KDOP18 = 3,
  WINNOW_VOLUME_KDOP26 = 4
};

/// How much stored volumes are enlarged on every side (fat AABBs).
typedef struct winnow_fat_margin {
  float distance;
  float share;
} winnow_fat_margin;

/// A null pointer, or zero members after `size`, mean the defaults of C++.
typedef struct winnow_partition_options {
  size_t size;  ///< set by the caller to sizeof(winnow_partition_options)
  const winnow_memory* memory;
  winnow_execution execution;
  winnow_volume volume;
  winnow_fat_margin fat_margin;
  size_t build_budget;
} winnow_partition_options;
#define WINNOW_PARTITION_OPTIONS                                                         \
  {                                                                                      \
    sizeof(winnow_partition_options), NULL, {WINNOW_EXECUTION_DEFAULT, {NULL, NULL, 0}}, \
        WINNOW_VOLUME_AABB, {0.0F, 0.0F}, 0                                              \
  }

WINNOW_C_API winnow_status winnow_partition_create(winnow_structure_kind structure,
                                                   const winnow_partition_options* options,
                                                   winnow_partition** partition);
WINNOW_C_API void winnow_partition_destroy(winnow_partition* partition);

WINNOW_C_API winnow_status winnow_partition_structure(const winnow_partition* partition,
                                                      winnow_structure_kind* structure);
WINNOW_C_API winnow_status winnow_partition_set_structure(winnow_partition* partition,
                                                          winnow_structure_kind structure);

/// The structure that `automatic` has chosen, the reason, and the measured features of the scene.
typedef struct winnow_structure_choice {
  size_t size;  ///< set by the caller to sizeof(winnow_structure_choice)
  winnow_structure_kind structure;
  const char* reason;  ///< a few words; a constant string
  uint64_t changes;
  size_t objects;
  double room[3];
  double size_spread;
  double crowding;
  double pairs;
} winnow_structure_choice;
WINNOW_C_API winnow_status winnow_partition_choice(const winnow_partition* partition,
                                                   winnow_structure_choice* choice);

WINNOW_C_API winnow_status winnow_partition_is_exact(const winnow_partition* partition,
                                                     bool* is_exact);
WINNOW_C_API winnow_status winnow_partition_volume(const winnow_partition* partition,
                                                   winnow_volume* volume);
WINNOW_C_API winnow_status winnow_partition_fat_margin(const winnow_partition* partition,
                                                       winnow_fat_margin* fat_margin);

/// Inserts one object per box and writes its key to `keys`. `data` is null (all zero) or has one
/// value per box.
WINNOW_C_API winnow_status winnow_partition_insert(winnow_partition* partition,
                                                   const winnow_box_view* boxes,
                                                   const uint64_t* data, winnow_key* keys);

/// A subset of the entries of the caller's `keys` and `boxes`: a list of indices, or, if `words` is
/// not null, a bit mask with 64 entries per word.
typedef struct winnow_entries {
  const uint32_t* numbers;
  const uint64_t* words;
  size_t count;  ///< number of indices or of words
} winnow_entries;

/// Gives new boxes to the listed entries, or to all if `entries` is null.
WINNOW_C_API winnow_status winnow_partition_update(winnow_partition* partition,
                                                   const winnow_key* keys, size_t count,
                                                   const winnow_box_view* boxes,
                                                   const winnow_entries* entries);
WINNOW_C_API winnow_status winnow_partition_insert_spheres(winnow_partition* partition,
                                                           const winnow_sphere* spheres,
                                                           size_t count, const uint64_t* data,
                                                           winnow_key* keys);
WINNOW_C_API winnow_status winnow_partition_update_spheres(winnow_partition* partition,
                                                           const winnow_key* keys,
                                                           const winnow_sphere* spheres,
                                                           size_t count);
/// Each k-DOP is k floats: the k/2 lower bounds of its slabs, then the k/2 upper bounds.
WINNOW_C_API winnow_status winnow_partition_insert_kdops(winnow_partition* partition, uint32_t k,
                                                         const float* kdops, size_t count,
                                                         const uint64_t* data, winnow_key* keys);
WINNOW_C_API winnow_status winnow_partition_update_kdops(winnow_partition* partition, uint32_t k,
                                                         const winnow_key* keys, const float* kdops,
                                                         size_t count);
WINNOW_C_API winnow_status winnow_partition_remove(winnow_partition* partition,
                                                   const winnow_key* keys, size_t count);
WINNOW_C_API winnow_status winnow_partition_clear(winnow_partition* partition);
WINNOW_C_API winnow_status winnow_partition_release_memory(winnow_partition* partition);
WINNOW_C_API winnow_status winnow_partition_reserve(winnow_partition* partition, size_t objects,
                                                    winnow_pages pages);
WINNOW_C_API winnow_status winnow_partition_reserve_pairs(const winnow_partition* partition,
                                                          winnow_pair_buffer* out, size_t pairs,
                                                          winnow_pages pages);
/// If `with_pairs` is set, memory for the pairs is reserved too: set it if no pair buffer is used.
WINNOW_C_API winnow_status winnow_partition_reserve_events(const winnow_partition* partition,
                                                           winnow_pair_events* out, size_t pairs,
                                                           bool with_pairs, winnow_pages pages);

WINNOW_C_API winnow_status winnow_partition_size(const winnow_partition* partition, size_t* size);
WINNOW_C_API winnow_status winnow_partition_contains(const winnow_partition* partition,
                                                     winnow_key key, bool* contains);
WINNOW_C_API winnow_status winnow_partition_bounds(const winnow_partition* partition,
                                                   winnow_key key, winnow_aabb* box);
/// Writes one box per key. If any key is stale, writes nothing.
WINNOW_C_API winnow_status winnow_partition_bounds_of(const winnow_partition* partition,
                                                      const winnow_key* keys, winnow_aabb* boxes,
                                                      size_t count);
WINNOW_C_API winnow_status winnow_partition_client_data(const winnow_partition* partition,
                                                        winnow_key key, uint64_t* data);
/// Returns the null key for an id that no object has.
WINNOW_C_API winnow_status winnow_partition_key_of(const winnow_partition* partition, uint32_t id,
                                                   winnow_key* key);
WINNOW_C_API winnow_status winnow_partition_set_filter(winnow_partition* partition,
                                                       const winnow_key* keys,
                                                       const winnow_object_filter* filters,
                                                       size_t count);
WINNOW_C_API winnow_status winnow_partition_filter(const winnow_partition* partition,
                                                   winnow_key key, winnow_object_filter* filter);

WINNOW_C_API winnow_status winnow_partition_refresh(const winnow_partition* partition);

/// A null pointer, or zero members after `size`, mean all pairs in the fast order, found
/// incrementally.
typedef struct winnow_pair_options {
  size_t size;  ///< set by the caller to sizeof(winnow_pair_options)
  winnow_order order;
  uint8_t anew;  ///< 0 or 1: finds all pairs again instead of updating from the objects that moved
  /// Null, or a callback that accepts or rejects each pair; see winnow_filter for its rules.
  bool (*accept)(void* context, uint32_t first, uint32_t second);
  void* context;
} winnow_pair_options;
#define WINNOW_PAIR_OPTIONS \
  { sizeof(winnow_pair_options), WINNOW_ORDER_FAST, 0, NULL, NULL }

/// Writes all pairs to `out` and the changes to `events`. One of the two may be null.
WINNOW_C_API winnow_status winnow_partition_self_pairs(const winnow_partition* partition,
                                                       winnow_pair_buffer* out,
                                                       winnow_pair_events* events,
                                                       const winnow_pair_options* options);
WINNOW_C_API winnow_status winnow_partition_pairs_with(const winnow_partition* partition,
                                                       const winnow_partition* other,
                                                       winnow_pair_buffer* out,
                                                       const winnow_pair_options* options);

/// A ray or a volume that moves by t * direction for t in [min_t, max_t].
typedef struct winnow_cast {
  int32_t kind;
  union {
    float origin[3];  ///< used by WINNOW_CAST_RAY
    winnow_aabb box;
    winnow_sphere sphere;
    winnow_capsule capsule;
  } from;
  float direction[3];
  float min_t;
  float max_t;
} winnow_cast;
enum { WINNOW_CAST_RAY = 0, WINNOW_CAST_BOX = 1, WINNOW_CAST_SPHERE = 2, WINNOW_CAST_CAPSULE = 3 };
/// A ray of infinite length. Set its origin and direction.
#define WINNOW_CAST \
  { WINNOW_CAST_RAY, {{0.0F, 0.0F, 0.0F}}, {0.0F, 0.0F, 0.0F}, 0.0F, INFINITY }

/// Writes a hit with the null key if there is none.
WINNOW_C_API winnow_status winnow_partition_closest(const winnow_partition* partition,
                                                    const winnow_cast* cast,
                                                    const winnow_filter* filter, winnow_hit* hit);
WINNOW_C_API winnow_status winnow_partition_any(const winnow_partition* partition,
                                                const winnow_cast* cast,
                                                const winnow_filter* filter, winnow_hit* hit);
WINNOW_C_API winnow_status winnow_partition_all(const winnow_partition* partition,
                                                const winnow_cast* cast,
                                                const winnow_filter* filter,
                                                winnow_hit_buffer* hits);

/// Columns of rays. Null `min_t` and `max_t` mean 0 and infinity.
typedef struct winnow_ray_batch {
  const float* origin[3];
  const float* direction[3];
  const float* min_t;
  const float* max_t;
  size_t count;
  size_t stride;
} winnow_ray_batch;

/// Columns to write; each may be null.
typedef struct winnow_hit_columns {
  winnow_key* key;
  uint64_t* data;
  float* t;
} winnow_hit_columns;

WINNOW_C_API winnow_status winnow_partition_closest_rays(const winnow_partition* partition,
                                                         const winnow_ray_batch* rays,
                                                         const winnow_filter* filter,
                                                         const winnow_hit_columns* hits);
WINNOW_C_API winnow_status winnow_partition_any_rays(const winnow_partition* partition,
                                                     const winnow_ray_batch* rays,
                                                     const winnow_filter* filter,
                                                     const winnow_hit_columns* hits);
WINNOW_C_API winnow_status winnow_partition_all_rays(const winnow_partition* partition,
                                                     const winnow_ray_batch* rays,
                                                     const winnow_filter* filter,
                                                     winnow_hit_buffer* hits);

/// A closed region of space.
typedef struct winnow_region {
  int32_t kind;
  union {
    float point[3];
    winnow_aabb box;
    winnow_oriented_box oriented_box;
    winnow_sphere sphere;
    winnow_capsule capsule;
    winnow_frustum frustum;
    struct {
      const winnow_plane* planes;
      size_t count;
    } planes;  ///< the points inside all planes
  } of;
} winnow_region;
enum {
  WINNOW_REGION_POINT = 0,
  WINNOW_REGION_BOX = 1,
  WINNOW_REGION_ORIENTED_BOX = 2,
  WINNOW_REGION_SPHERE = 3,
  WINNOW_REGION_CAPSULE = 4,
  WINNOW_REGION_FRUSTUM = 5,
  WINNOW_REGION_PLANES = 6
};

WINNOW_C_API winnow_status winnow_partition_overlap(const winnow_partition* partition,
                                                    const winnow_region* region,
                                                    const winnow_filter* filter, winnow_order order,
                                                    winnow_overlap_buffer* objects);
/// Finds all overlapping pairs (index of the box, object).
WINNOW_C_API winnow_status winnow_partition_overlap_boxes(const winnow_partition* partition,
                                                          const winnow_box_view* boxes,
                                                          const winnow_filter* filter,
                                                          winnow_order order,
                                                          winnow_pair_buffer* out);
WINNOW_C_API winnow_status winnow_partition_nearest(const winnow_partition* partition,
                                                    const winnow_aabb* from, size_t count,
                                                    float radius, const winnow_filter* filter,
                                                    winnow_hit_buffer* hits);

/// `options` may be null.
WINNOW_C_API winnow_status winnow_partition_debug_draw(const winnow_partition* partition,
                                                       const winnow_debug_draw* draw,
                                                       const winnow_debug_draw_options* options);

WINNOW_C_API winnow_status winnow_partition_footprint(const winnow_partition* partition,
                                                      winnow_footprint* footprint);

/// Counters, not timings.
typedef struct winnow_statistics {
  size_t size;  ///< set by the caller to sizeof(winnow_statistics)
  size_t objects;
  size_t regular;
  size_t irregular;
  size_t cells;
  size_t depth;
  size_t levels;
  uint64_t builds;
  uint64_t planned_builds;
  uint64_t refits;
  uint64_t full_queries;
  uint64_t incremental_queries;
  uint64_t last_tests;
  uint64_t last_pairs;
} winnow_statistics;
WINNOW_C_API winnow_status winnow_partition_statistics(const winnow_partition* partition,
                                                       winnow_statistics* statistics);

#ifdef __cplusplus
}
#endif
