// Generated from pipeline/interface/partition.toml; do not edit.
// clang-format off
#pragma once

/// Partitions of bounding volumes, and their result buffers. A partition finds the pairs of objects
/// that may touch; it never misses a pair. Insert, update and remove cost O(1) per object; the
/// structure is brought up to date by the next query or by winnow_partition_refresh.
///
/// Result buffers belong to the caller, are reused from frame to frame, and are used by one thread
/// at a time. Returned arrays are not copied: they are valid until the buffer is used again or
/// destroyed.

#include <winnow/c/core.h>
#include <winnow/c/recording.h>
#include <winnow/c/volumes.h>
#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Array of pairs. If it is passed to the same partition again, the query starts from the pairs of
/// the previous frame, and only the pairs of objects that moved are found again.
typedef struct winnow_pair_buffer winnow_pair_buffer;

/// The pairs that began and ended since the previous query.
typedef struct winnow_pair_events winnow_pair_events;

/// Array of hits of a query, or of each query of a batch.
typedef struct winnow_hit_buffer winnow_hit_buffer;

/// Array of objects that overlap a region.
typedef struct winnow_overlap_buffer winnow_overlap_buffer;

/// A set of bounding volumes, each with 64 bits of client data and a key.
typedef struct winnow_partition winnow_partition;

/// Data structures of partitions; C++ documents them in <winnow/partitions/structures.h>.
enum {
  WINNOW_LINEAR_BVH = 0,  ///< BVH that is refitted; the default
  WINNOW_AUTOMATIC = 1,   ///< chooses one of the others, and may change the choice in any refresh
  WINNOW_SWEEP_AND_PRUNE = 2,    ///< many moving objects of similar size, long thin worlds
  WINNOW_HIERARCHICAL_GRID = 3,  ///< many moving objects, of one size or of many
  WINNOW_FLAT_GRID = 4,          ///< objects of similar size and even density
  /// Slow build and a better tree: objects that rarely move and are queried often.
  WINNOW_STATIC_BVH = 5,
  WINNOW_LOOSE_OCTREE = 6,    ///< `parameter` is the edge of a loose cell over the edge of its cell
  WINNOW_LOOSE_QUADTREE = 7,  ///< over the two axes with the largest extent; flat worlds
  WINNOW_BOUNDS_N_SQUARED = 8,  ///< tests every volume against every other; least memory
  WINNOW_N_SQUARED = 9          ///< every pair, untested; a baseline
};

/// Bounding volume of the objects. Every partition prunes by boxes. With spheres and k-DOPs it also
/// drops pairs whose boxes overlap but whose volumes do not.
typedef int32_t winnow_volume;
enum {
  WINNOW_VOLUME_AABB = 0,
  WINNOW_VOLUME_SPHERE = 1,
  WINNOW_VOLUME_KDOP14 = 2,
  WINNOW_VOLUME_KDOP18 = 3,
  WINNOW_VOLUME_KDOP26 = 4
};

/// Kind of a winnow_cast.
enum {
  WINNOW_CAST_RAY = 0,
  WINNOW_CAST_BOX = 1,
  WINNOW_CAST_SPHERE = 2,
  WINNOW_CAST_CAPSULE = 3
};

/// Kind of a winnow_region.
enum {
  WINNOW_REGION_POINT = 0,
  WINNOW_REGION_BOX = 1,
  WINNOW_REGION_ORIENTED_BOX = 2,
  WINNOW_REGION_SPHERE = 3,
  WINNOW_REGION_CAPSULE = 4,
  WINNOW_REGION_FRUSTUM = 5,
  WINNOW_REGION_PLANES = 6
};

/// Ids of two objects that may touch; first < second if both are of one partition.
typedef struct winnow_pair {
  uint32_t first;
  uint32_t second;
} winnow_pair;

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

/// Object found by a ray, a cast or a nearest query; the null key, 0 and infinity if none was
/// found.
typedef struct winnow_hit {
  winnow_key key;  ///< the object
  uint64_t data;   ///< its client data
  /// Where the cast enters the object's box, in units of its direction; the distance of a nearest
  /// object.
  float t;
} winnow_hit;

/// Data structure of a partition. A struct of zeros means linear_bvh.
typedef struct winnow_structure_kind {
  int32_t structure;  ///< WINNOW_LINEAR_BVH, ...
  float parameter;    ///< of the loose trees; 0 means the default of the structure
} winnow_structure_kind;

/// Enlarges stored volumes by `distance` plus `share` times the longest edge of the object's box,
/// so that small motions need no update of the structure. Every query tests the enlarged volumes.
/// Negative values count as 0.
typedef struct winnow_fat_margin {
  float distance;  ///< in units of length
  float share;     ///< 0.05 is a twentieth of the longest edge
} winnow_fat_margin;

/// Options of a partition. A null pointer, or zero members after `size`, mean the defaults of C++.
typedef struct winnow_partition_options {
  size_t size;                   ///< set by the caller to sizeof(winnow_partition_options)
  const winnow_memory* memory;   ///< source of every allocation; null means the default memory
  winnow_execution execution;    ///< how builds, refits and queries are run
  winnow_volume volume;          ///< bounding volume of the objects
  winnow_fat_margin fat_margin;  ///< enlarges stored volumes
  /// Number of rows that one refresh may process for a planned rebuild; 0 lets the partition choose
  /// it, SIZE_MAX plans nothing.
  size_t build_budget;
  winnow_recorder* recorder;  ///< records all calls, or null; must outlive the partition
} winnow_partition_options;
#define WINNOW_PARTITION_OPTIONS \
  {sizeof(winnow_partition_options), NULL, {0, {NULL, NULL, 0}}, WINNOW_VOLUME_AABB, {0.0F, 0.0F}, \
  0, NULL}

/// The structure that `automatic` has chosen, the reason, and the measured features of the scene.
typedef struct winnow_structure_choice {
  size_t size;                      ///< set by the caller to sizeof(winnow_structure_choice)
  winnow_structure_kind structure;  ///< the structure in use
  const char* reason;               ///< a few words; a constant string
  uint64_t changes;                 ///< changes of structure after the first choice
  size_t objects;                   ///< objects in the scene
  double room[3];      ///< per axis, the range of most objects divided by their mean edge
  double size_spread;  ///< log2 of the ratio of edges between a large and a small object
  double crowding;     ///< how strongly objects cluster: 0 if even, at most 6
  double pairs;        ///< estimated pairs per object, at most 16
} winnow_structure_choice;

/// A subset of the entries of the caller's `keys` and `boxes`: a list of indices, or, if `words` is
/// not null, a bit mask with 64 entries per word.
typedef struct winnow_entries {
  const uint32_t* numbers;  ///< indices
  const uint64_t* words;    ///< bit mask
  size_t count;             ///< number of indices or of words
} winnow_entries;

/// Options of a query for pairs: by default all pairs in the fast order, found incrementally. A
/// null pointer, or zero members after `size`, mean the defaults of C++.
typedef struct winnow_pair_options {
  size_t size;         ///< set by the caller to sizeof(winnow_pair_options)
  winnow_order order;  ///< order of the written pairs
  uint8_t anew;  ///< 0 or 1: finds all pairs again instead of updating from the objects that moved
  /// Null, or a callback that accepts or rejects each pair; see winnow_filter for its rules. It is
  /// not called again for pairs that are kept.
  bool (*accept)(void* context, uint32_t first, uint32_t second);
  void* context;  ///< passed to `accept`
} winnow_pair_options;
#define WINNOW_PAIR_OPTIONS {sizeof(winnow_pair_options), WINNOW_ORDER_FAST, 0, NULL, NULL}

/// A ray or a volume that moves by t * direction for t in [min_t, max_t]. The macro WINNOW_CAST is
/// a ray of infinite length: set its origin and direction.
typedef struct winnow_cast {
  int32_t kind;  ///< WINNOW_CAST_RAY, ...
  /// Where it is at t = 0: `origin` of a ray, or the volume.
  union {
    float origin[3];
    winnow_aabb box;
    winnow_sphere sphere;
    winnow_capsule capsule;
  } from;
  float direction[3];  ///< finite, not zero
  float min_t;         ///< >= 0
  float max_t;         ///< may be infinite
} winnow_cast;
#define WINNOW_CAST {WINNOW_CAST_RAY, {{0.0F, 0.0F, 0.0F}}, {0.0F, 0.0F, 0.0F}, 0.0F, INFINITY}

/// Columns of rays in float.
typedef struct winnow_ray_batch {
  const float* origin[3];     ///< x, y, z
  const float* direction[3];  ///< x, y, z
  const float* min_t;         ///< null means 0
  const float* max_t;         ///< null means infinity
  size_t count;               ///< number of rays
  size_t stride;              ///< bytes from one ray to the next; 0 means no gaps
} winnow_ray_batch;

/// Columns to write, with one entry per ray; each may be null. A ray without a hit gets the null
/// key, 0 and infinity.
typedef struct winnow_hit_columns {
  winnow_key* key;  ///< objects
  uint64_t* data;   ///< their client data
  float* t;         ///< see winnow_hit
} winnow_hit_columns;

/// A closed region of space.
typedef struct winnow_region {
  int32_t kind;  ///< WINNOW_REGION_POINT, ...
  /// The member of this kind; `planes`: the points inside all planes.
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
    } planes;
  } of;
} winnow_region;

/// State of a partition and counters of its work, without times.
typedef struct winnow_statistics {
  size_t size;                   ///< set by the caller to sizeof(winnow_statistics)
  size_t objects;                ///< live objects
  size_t regular;                ///< objects in the cells, strips or leaves of the last build
  size_t irregular;              ///< objects apart from these: too large, new, or moved away
  size_t cells;                  ///< cells, strips or leaf blocks
  size_t depth;                  ///< levels of the node tree; 0 if there is none
  size_t levels;                 ///< grids of a hierarchical grid, depths of an octree
  uint64_t builds;               ///< builds since construction
  uint64_t planned_builds;       ///< builds that were planned before they were due
  uint64_t refits;               ///< refreshes that did not need a build
  uint64_t full_queries;         ///< pair queries that tested every object
  uint64_t incremental_queries;  ///< pair queries that tested only objects that moved
  uint64_t last_tests;           ///< tests of 16 volumes at once, in the last pair query
  uint64_t last_pairs;           ///< pairs that the last pair query returned
} winnow_statistics;

/// Creates an empty buffer.
WINNOW_C_API winnow_status winnow_pair_buffer_create(
    const winnow_memory* memory, winnow_pair_buffer** buffer);

/// Destroys the pair buffer; does nothing for null.
WINNOW_C_API void winnow_pair_buffer_destroy(winnow_pair_buffer* buffer);

/// Returns all pairs, in the order that the query requested.
WINNOW_C_API winnow_status winnow_pair_buffer_pairs(
    const winnow_pair_buffer* buffer, const winnow_pair** pairs, size_t* count);

/// Reserves memory for `count` pairs.
WINNOW_C_API winnow_status winnow_pair_buffer_reserve(
    winnow_pair_buffer* buffer, size_t count, winnow_pages pages);

/// Returns the number of pairs that fit in the allocated memory.
WINNOW_C_API winnow_status winnow_pair_buffer_capacity(
    const winnow_pair_buffer* buffer, size_t* count);

/// Frees the memory for more than `count` pairs, or for more than there are if that is larger.
/// O(pairs).
WINNOW_C_API winnow_status winnow_pair_buffer_shrink(winnow_pair_buffer* buffer, size_t count);

/// Copies the pairs of another buffer; the next query can start from either of the two. O(pairs).
WINNOW_C_API winnow_status winnow_pair_buffer_assign(
    winnow_pair_buffer* buffer, const winnow_pair_buffer* other);

/// Removes all pairs: the next query is a full one. Memory is kept.
WINNOW_C_API winnow_status winnow_pair_buffer_clear(winnow_pair_buffer* buffer);

/// Removes all pairs and frees the memory.
WINNOW_C_API winnow_status winnow_pair_buffer_release(winnow_pair_buffer* buffer);

/// Writes the bytes of the pair buffer, by purpose.
WINNOW_C_API winnow_status winnow_pair_buffer_footprint(
    const winnow_pair_buffer* buffer, winnow_footprint* footprint);

/// Creates events without client data.
WINNOW_C_API winnow_status winnow_pair_events_create(
    const winnow_memory* memory, winnow_pair_events** events);

/// Destroys the pair events; does nothing for null.
WINNOW_C_API void winnow_pair_events_destroy(winnow_pair_events* events);

/// Creates events that also report the client data of both objects of each pair.
WINNOW_C_API winnow_status winnow_pair_events_create_with_client_data(
    const winnow_memory* memory, winnow_pair_events** events);

/// Returns the pairs of this frame that were not in the previous one, sorted by ids.
WINNOW_C_API winnow_status winnow_pair_events_begun(
    const winnow_pair_events* events, const winnow_key_pair** pairs, size_t* count);

/// Returns the pairs of the previous frame that are not in this one, sorted by ids. The key of a
/// removed object is stale.
WINNOW_C_API winnow_status winnow_pair_events_ended(
    const winnow_pair_events* events, const winnow_key_pair** pairs, size_t* count);

/// Returns the client data of the pairs that began, in the same order; empty if created without
/// client data.
WINNOW_C_API winnow_status winnow_pair_events_begun_data(
    const winnow_pair_events* events, const winnow_client_data_pair** data, size_t* count);

/// Returns the client data of the pairs that ended, in the same order; empty if created without
/// client data.
WINNOW_C_API winnow_status winnow_pair_events_ended_data(
    const winnow_pair_events* events, const winnow_client_data_pair** data, size_t* count);

/// Returns the number of pairs that are in both frames. They come first in the pair buffer; the
/// pairs that began follow, in the order in which they are reported.
WINNOW_C_API winnow_status winnow_pair_events_persisting(
    const winnow_pair_events* events, size_t* count);

/// Removes all events: the next query starts anew, and every pair begins. Memory is kept.
WINNOW_C_API winnow_status winnow_pair_events_clear(winnow_pair_events* events);

/// Writes the bytes of the pair events, by purpose.
WINNOW_C_API winnow_status winnow_pair_events_footprint(
    const winnow_pair_events* events, winnow_footprint* footprint);

/// Creates an empty buffer.
WINNOW_C_API winnow_status winnow_hit_buffer_create(
    const winnow_memory* memory, winnow_hit_buffer** buffer);

/// Destroys the hit buffer; does nothing for null.
WINNOW_C_API void winnow_hit_buffer_destroy(winnow_hit_buffer* buffer);

/// Returns all hits; for a batch, the hits of each query one after the other.
WINNOW_C_API winnow_status winnow_hit_buffer_hits(
    const winnow_hit_buffer* buffer, const winnow_hit** hits, size_t* count);

/// Returns the number of queries in the last call: 1, or the size of the batch; 0 after `clear`.
WINNOW_C_API winnow_status winnow_hit_buffer_queries(
    const winnow_hit_buffer* buffer, size_t* count);

/// Returns the hits of one query of a batch. WINNOW_INVALID_ARGUMENT if there is no such query.
WINNOW_C_API winnow_status winnow_hit_buffer_of(
    const winnow_hit_buffer* buffer, size_t query, const winnow_hit** hits, size_t* count);

/// Reserves memory for `count` hits.
WINNOW_C_API winnow_status winnow_hit_buffer_reserve(winnow_hit_buffer* buffer, size_t count);

/// Removes all hits. Memory is kept.
WINNOW_C_API winnow_status winnow_hit_buffer_clear(winnow_hit_buffer* buffer);

/// Writes the bytes of the hit buffer, by purpose.
WINNOW_C_API winnow_status winnow_hit_buffer_footprint(
    const winnow_hit_buffer* buffer, winnow_footprint* footprint);

/// Creates an empty buffer.
WINNOW_C_API winnow_status winnow_overlap_buffer_create(
    const winnow_memory* memory, winnow_overlap_buffer** buffer);

/// Destroys the overlap buffer; does nothing for null.
WINNOW_C_API void winnow_overlap_buffer_destroy(winnow_overlap_buffer* buffer);

/// Returns the ids of the overlapping objects: first `inside` objects whose boxes are contained in
/// the region, then all other objects.
WINNOW_C_API winnow_status winnow_overlap_buffer_ids(
    const winnow_overlap_buffer* buffer, const uint32_t** ids, size_t* count, size_t* inside);

/// Reserves memory for `count` objects.
WINNOW_C_API winnow_status winnow_overlap_buffer_reserve(
    winnow_overlap_buffer* buffer, size_t count);

/// Removes all objects. Memory is kept.
WINNOW_C_API winnow_status winnow_overlap_buffer_clear(winnow_overlap_buffer* buffer);

/// Writes the bytes of the overlap buffer, by purpose.
WINNOW_C_API winnow_status winnow_overlap_buffer_footprint(
    const winnow_overlap_buffer* buffer, winnow_footprint* footprint);

/// Creates an empty partition. WINNOW_INVALID_ARGUMENT for an invalid structure or volume.
WINNOW_C_API winnow_status winnow_partition_create(
    winnow_structure_kind structure, const winnow_partition_options* options,
    winnow_partition** partition);

/// Destroys the partition; does nothing for null.
WINNOW_C_API void winnow_partition_destroy(winnow_partition* partition);

/// Returns the structure given at creation or set later.
WINNOW_C_API winnow_status winnow_partition_structure(
    const winnow_partition* partition, winnow_structure_kind* structure);

/// Exchanges the structure; the next refresh builds the new one. Objects, keys, filters and events
/// stay. WINNOW_INVALID_ARGUMENT for an invalid structure.
WINNOW_C_API winnow_status winnow_partition_set_structure(
    winnow_partition* partition, winnow_structure_kind structure);

/// Writes the structure that `automatic` has chosen, and the reason. With any other structure,
/// writes the structure of the partition.
WINNOW_C_API winnow_status winnow_partition_choice(
    const winnow_partition* partition, winnow_structure_choice* choice);

/// Returns whether a query for pairs returns exactly the pairs whose given boxes overlap.
WINNOW_C_API winnow_status winnow_partition_is_exact(
    const winnow_partition* partition, bool* is_exact);

/// Returns the bounding volume of the options.
WINNOW_C_API winnow_status winnow_partition_volume(
    const winnow_partition* partition, winnow_volume* volume);

/// Returns the fat margin of the options.
WINNOW_C_API winnow_status winnow_partition_fat_margin(
    const winnow_partition* partition, winnow_fat_margin* fat_margin);

/// Adds one object per box and writes its key to `keys`. `data` is null (all zero) or has one value
/// per box. WINNOW_INVALID_BOUNDS for a box with NaN, min > max or wholly at infinity.
WINNOW_C_API winnow_status winnow_partition_insert(
    winnow_partition* partition, const winnow_box_view* boxes, const uint64_t* data,
    winnow_key* keys);

/// Gives new boxes to the listed entries of `keys` and `boxes`, or to all if `entries` is null. If
/// a key occurs twice, its last box counts. WINNOW_SIZE_MISMATCH, WINNOW_INVALID_KEY and
/// WINNOW_INVALID_BOUNDS change nothing; WINNOW_INVALID_ARGUMENT for an index out of range.
WINNOW_C_API winnow_status winnow_partition_update(
    winnow_partition* partition, const winnow_key* keys, size_t count, const winnow_box_view* boxes,
    const winnow_entries* entries);

/// Adds one object per sphere. WINNOW_UNSUPPORTED_VOLUME unless the volume is WINNOW_VOLUME_SPHERE.
WINNOW_C_API winnow_status winnow_partition_insert_spheres(
    winnow_partition* partition, const winnow_sphere* spheres, size_t count, const uint64_t* data,
    winnow_key* keys);

/// Gives each object a new sphere. WINNOW_INVALID_BOUNDS for values that are not finite or a
/// negative radius.
WINNOW_C_API winnow_status winnow_partition_update_spheres(
    winnow_partition* partition, const winnow_key* keys, const winnow_sphere* spheres,
    size_t count);

/// Adds one object per k-DOP. Each is k floats: the k/2 lower bounds of its slabs, then the k/2
/// upper bounds. WINNOW_UNSUPPORTED_VOLUME unless the volume is the one with this k: 14, 18 or 26.
WINNOW_C_API winnow_status winnow_partition_insert_kdops(
    winnow_partition* partition, uint32_t k, const float* kdops, size_t count, const uint64_t* data,
    winnow_key* keys);

/// Gives each object a new k-DOP.
WINNOW_C_API winnow_status winnow_partition_update_kdops(
    winnow_partition* partition, uint32_t k, const winnow_key* keys, const float* kdops,
    size_t count);

/// Removes the objects. WINNOW_INVALID_KEY also if a key occurs twice.
WINNOW_C_API winnow_status winnow_partition_remove(
    winnow_partition* partition, const winnow_key* keys, size_t count);

/// Removes all objects. Memory is kept.
WINNOW_C_API winnow_status winnow_partition_clear(winnow_partition* partition);

/// Frees scratch memory, and all memory of an empty partition.
WINNOW_C_API winnow_status winnow_partition_release_memory(winnow_partition* partition);

/// Reserves all memory that the first frame of up to `objects` objects needs, at any positions:
/// inserting them, refreshing and a query for all pairs then allocate nothing.
WINNOW_C_API winnow_status winnow_partition_reserve(
    winnow_partition* partition, size_t objects, winnow_pages pages);

/// Reserves memory in a buffer for up to `pairs` pairs of winnow_partition_self_pairs, for the
/// number of objects that winnow_partition_reserve was called with.
WINNOW_C_API winnow_status winnow_partition_reserve_pairs(
    const winnow_partition* partition, winnow_pair_buffer* out, size_t pairs, winnow_pages pages);

/// Reserves memory for the events of up to `pairs` pairs. If `with_pairs` is set, memory for the
/// pairs is reserved too: set it if no pair buffer is used.
WINNOW_C_API winnow_status winnow_partition_reserve_events(
    const winnow_partition* partition, winnow_pair_events* out, size_t pairs, bool with_pairs,
    winnow_pages pages);

/// Returns the number of live objects.
WINNOW_C_API winnow_status winnow_partition_size(const winnow_partition* partition, size_t* size);

/// Returns whether the key belongs to a live object of this partition. O(1).
WINNOW_C_API winnow_status winnow_partition_contains(
    const winnow_partition* partition, winnow_key key, bool* contains);

/// Writes the box that queries test: enlarged by the margin; for other volumes the box around them.
WINNOW_C_API winnow_status winnow_partition_bounds(
    const winnow_partition* partition, winnow_key key, winnow_aabb* box);

/// Writes one box per key. If any key is stale, writes nothing.
WINNOW_C_API winnow_status winnow_partition_bounds_of(
    const winnow_partition* partition, const winnow_key* keys, winnow_aabb* boxes, size_t count);

/// Returns the client data of an object.
WINNOW_C_API winnow_status winnow_partition_client_data(
    const winnow_partition* partition, winnow_key key, uint64_t* data);

/// Returns the key of a live object; the null key for an id that no object has.
WINNOW_C_API winnow_status winnow_partition_key_of(
    const winnow_partition* partition, uint32_t id, winnow_key* key);

/// Returns the client data of a live object; 0 for an id that no object has.
WINNOW_C_API winnow_status winnow_partition_client_data_of(
    const winnow_partition* partition, uint32_t id, uint64_t* data);

/// Sets the filters that restrict which objects pair. Every object starts with
/// WINNOW_OBJECT_FILTER.
WINNOW_C_API winnow_status winnow_partition_set_filter(
    winnow_partition* partition, const winnow_key* keys, const winnow_object_filter* filters,
    size_t count);

/// Returns the filter of an object.
WINNOW_C_API winnow_status winnow_partition_filter(
    const winnow_partition* partition, winnow_key key, winnow_object_filter* filter);

/// Brings the structure up to date now instead of in the next query.
WINNOW_C_API winnow_status winnow_partition_refresh(const winnow_partition* partition);

/// Writes all pairs of objects whose volumes overlap to `out`, each once, and the changes since the
/// frame whose pairs `out` contains to `events`. One of the two may be null. The cost of events
/// grows with the number of moved objects.
WINNOW_C_API winnow_status winnow_partition_self_pairs(
    const winnow_partition* partition, winnow_pair_buffer* out, winnow_pair_events* events,
    const winnow_pair_options* options);

/// Writes all pairs (object of this partition, object of the other one) whose boxes overlap, each
/// once.
WINNOW_C_API winnow_status winnow_partition_pairs_with(
    const winnow_partition* partition, const winnow_partition* other, winnow_pair_buffer* out,
    const winnow_pair_options* options);

/// Finds the hit of least t; a hit with the null key if there is none. A cast that starts inside a
/// box hits it at min_t. No hit is missed. WINNOW_INVALID_ARGUMENT for an invalid cast. About O(log
/// n).
WINNOW_C_API winnow_status winnow_partition_closest(
    const winnow_partition* partition, const winnow_cast* cast, const winnow_filter* filter,
    winnow_hit* hit);

/// Finds any one hit; a hit with the null key if there is none.
WINNOW_C_API winnow_status winnow_partition_any(
    const winnow_partition* partition, const winnow_cast* cast, const winnow_filter* filter,
    winnow_hit* hit);

/// Finds all hits, sorted by t, then by id.
WINNOW_C_API winnow_status winnow_partition_all(
    const winnow_partition* partition, const winnow_cast* cast, const winnow_filter* filter,
    winnow_hit_buffer* hits);

/// Finds the hit of least t of each ray. One invalid ray makes the call fail.
WINNOW_C_API winnow_status winnow_partition_closest_rays(
    const winnow_partition* partition, const winnow_ray_batch* rays, const winnow_filter* filter,
    const winnow_hit_columns* hits);

/// Finds any one hit of each ray, the same hit for any number of threads.
WINNOW_C_API winnow_status winnow_partition_any_rays(
    const winnow_partition* partition, const winnow_ray_batch* rays, const winnow_filter* filter,
    const winnow_hit_columns* hits);

/// Finds all hits of each ray, sorted by t; winnow_hit_buffer_of returns the hits of one ray.
WINNOW_C_API winnow_status winnow_partition_all_rays(
    const winnow_partition* partition, const winnow_ray_batch* rays, const winnow_filter* filter,
    winnow_hit_buffer* hits);

/// Finds every object whose box overlaps the region. No object is missed; an object that is found
/// although it does not overlap is within rounding of the region.
WINNOW_C_API winnow_status winnow_partition_overlap(
    const winnow_partition* partition, const winnow_region* region, const winnow_filter* filter,
    winnow_order order, winnow_overlap_buffer* objects);

/// Finds all overlapping pairs (index of the box, object). Boxes may be infinite.
WINNOW_C_API winnow_status winnow_partition_overlap_boxes(
    const winnow_partition* partition, const winnow_box_view* boxes, const winnow_filter* filter,
    winnow_order order, winnow_pair_buffer* out);

/// Finds the `count` objects whose boxes are nearest to a finite box (or a point: min == max)
/// within distance `radius`, which may be infinite; sorted by distance, then by id. Boxes that
/// touch have distance 0.
WINNOW_C_API winnow_status winnow_partition_nearest(
    const winnow_partition* partition, const winnow_aabb* from, size_t count, float radius,
    const winnow_filter* filter, winnow_hit_buffer* hits);

/// Draws the objects and the cells or nodes of the structure. O(n).
WINNOW_C_API winnow_status winnow_partition_debug_draw(
    const winnow_partition* partition, const winnow_debug_draw* draw,
    const winnow_debug_draw_options* options);

/// Writes the current counters.
WINNOW_C_API winnow_status winnow_partition_statistics(
    const winnow_partition* partition, winnow_statistics* statistics);

/// Writes the bytes of the partition, by purpose.
WINNOW_C_API winnow_status winnow_partition_footprint(
    const winnow_partition* partition, winnow_footprint* footprint);

/// Returns the name of a structure, such as "LinearBvh"; empty if it is invalid.
WINNOW_C_API const char* winnow_structure_name(winnow_structure_kind structure);

/// Writes the structure of this name. WINNOW_INVALID_ARGUMENT if there is none.
WINNOW_C_API winnow_status winnow_structure_named(
    const char* name, winnow_structure_kind* structure);

#ifdef __cplusplus
}
#endif
