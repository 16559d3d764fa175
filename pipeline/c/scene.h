// Generated from pipeline/interface/scene.toml; do not edit.
// clang-format off
#pragma once

/// Bodies with shapes and poses, and the contacts between them. A scene is not thread-safe: calls
/// must not overlap. Results and their order are the same for any number of threads and any
/// instruction set.

#include <winnow/c/core.h>
#include <winnow/c/narrow_phase.h>
#include <winnow/c/partition.h>
#include <winnow/c/shapes.h>
#include <winnow/c/volumes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Bodies with shapes and poses.
typedef struct winnow_scene winnow_scene;

/// Results of winnow_scene_collide. They also keep the previous results, to report events.
typedef struct winnow_contacts winnow_contacts;

/// Number of states of bodies.
#define WINNOW_BODY_STATES 3

/// Number of layers.
#define WINNOW_SCENE_LAYERS 4096U

/// Layer of a query or sensor that considers bodies of all layers.
#define WINNOW_EVERY_LAYER 0xFFFFU

/// Index of no pair or point: the contact did not exist in the previous frame.
#define WINNOW_NO_CONTACT 0xFFFFFFFFU

/// The set of a scene that a body belongs to. Fixed and sleeping bodies collide only with dynamic
/// ones.
enum {
  WINNOW_BODY_STATE_FIXED = 0,    ///< never moves by itself: ground, walls
  WINNOW_BODY_STATE_DYNAMIC = 1,  ///< collides with every body
  WINNOW_BODY_STATE_SLEEPING = 2  ///< at rest; winnow_scene_set_body_state wakes it
};

/// State of a pair relative to the previous call that filled the contacts.
enum {
  WINNOW_EVENT_BEGUN = 0,     ///< it was not present
  WINNOW_EVENT_PERSISTED = 1  ///< it was present
};

/// Options of a scene. A null pointer, or zero members after `size`, mean the defaults of C++.
typedef struct winnow_scene_options {
  size_t size;                  ///< set by the caller to sizeof(winnow_scene_options)
  const winnow_memory* memory;  ///< source of every allocation; null means the default memory
  winnow_execution execution;   ///< how work is run in parallel
  winnow_structure_kind structures[WINNOW_BODY_STATES];  ///< structure of the partition of each set
  double contact_margin;    ///< pairs whose gap is at most this are contacts too. Finite, >= 0.
  winnow_narrow_tier tier;  ///< how exact contacts must be
  /// 0: merges the manifolds of all pairs of parts that touch into one manifold per contact region,
  /// with at most 4 points each. 1: reports one manifold for each pair of parts.
  uint8_t part_manifolds;
  /// A pair keeps its manifolds while its smaller body has moved by at most this length since they
  /// were computed; `error_bound` grows by it. 0 means that nothing is kept. Finite, >= 0.
  double cache_tolerance;
  size_t build_budget;  ///< of each partition; see winnow_partition_options
  /// Pool of the meshes, compounds and height fields, or null; must outlive the scene.
  const winnow_composite_pool* composites;
  /// 0 or 1: drops contacts with sides and edges of seams between fixed bodies with flush surfaces,
  /// so that bodies slide over them as over one floor.
  uint8_t suppress_ghost_contacts;
  /// 0 or 1: stores for each pair and each point its index in the previous frame; see
  /// winnow_contact_columns.
  uint8_t warm_start;
  winnow_recorder* recorder;  ///< records all calls and queries, or null; must outlive the scene
} winnow_scene_options;
#define WINNOW_SCENE_OPTIONS \
  {sizeof(winnow_scene_options), NULL, {0, {NULL, NULL, 0}}, {{0, 0.0F}, {0, 0.0F}, {0, 0.0F}}, \
  0.0, WINNOW_TIER_ROBUST, 0, 0.0, 0, NULL, 0, 0, NULL}

/// Distances from the surface of a body at which its contacts begin and at which it rests. The
/// offsets of two bodies are added. They apply at levels distance and manifold.
typedef struct winnow_contact_offsets {
  double contact;  ///< finite, >= 0 and >= `rest`
  double rest;     ///< finite; negative moves the surface inward
} winnow_contact_offsets;

/// Which bodies a query of a scene considers, as if the query were a body; a null pointer to it
/// accepts all bodies.
typedef struct winnow_scene_filter {
  uint32_t layers;       ///< layers that the query is in, one bit each
  uint32_t mask;         ///< layers of bodies that it considers
  uint32_t environment;  ///< bodies of other environments are skipped
  /// Bodies whose layer does not collide with this one are skipped; see
  /// winnow_scene_set_layers_collide.
  uint16_t layer;
  winnow_key ignored;  ///< a body that is skipped, such as the one that casts the ray
  /// Null, or called for bodies that pass the rest of the filter; see winnow_filter for its rules.
  bool (*accept)(void* context, winnow_key key, uint64_t data);
  void* context;  ///< passed to `accept`
} winnow_scene_filter;
#define WINNOW_SCENE_FILTER \
  {0xFFFFFFFFU, 0xFFFFFFFFU, WINNOW_EVERY_ENVIRONMENT, WINNOW_EVERY_LAYER, {WINNOW_NO_OBJECT, 0}, \
  NULL, NULL}

/// A body to add.
typedef struct winnow_body_definition {
  winnow_shape_id shape;        ///< from the shape pool, or the composite pool of the options
  winnow_pose pose;             ///< pose of the shape's frame in the world
  uint8_t state;                ///< the set that contains it
  winnow_object_filter filter;  ///< which other bodies it may collide with
  uint64_t data;                ///< the caller's value, returned with contacts and hits; never read
  winnow_contact_offsets offsets;
  uint16_t layer;  ///< below WINNOW_SCENE_LAYERS; see winnow_scene_set_layers_collide
} winnow_body_definition;
#define WINNOW_BODY_DEFINITION \
  {WINNOW_NO_SHAPE, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}, WINNOW_BODY_STATE_DYNAMIC, {1U, \
  0xFFFFFFFFU, 0U}, 0, {0.0, 0.0}, 0}

/// A pair that was present when the contacts were last filled and is not now. The key of a removed
/// body is stale.
typedef struct winnow_ended_contact {
  winnow_key a;
  winnow_key b;
  uint64_t data_a;  ///< client data of a
  uint64_t data_b;  ///< client data of b
} winnow_ended_contact;

/// Contacts as columns, not copied, valid until the contacts are filled again, cleared or
/// destroyed. A column that its level does not have is null. An empty column may be null.
typedef struct winnow_contact_columns {
  size_t size;                        ///< set by the caller to sizeof(winnow_contact_columns)
  winnow_contact_level level;         ///< level of the call
  size_t pairs;                       ///< pairs of bodies, grouped by the kinds of their shapes
  const winnow_key* a;                ///< first body of each pair
  const winnow_key* b;                ///< second body of each pair
  const uint64_t* data_a;             ///< client data of a
  const uint64_t* data_b;             ///< client data of b
  const uint8_t* event;               ///< WINNOW_EVENT_BEGUN or WINNOW_EVENT_PERSISTED
  const winnow_run* runs;             ///< together all pairs
  size_t run_count;                   ///< number of runs
  const winnow_ended_contact* ended;  ///< pairs that ended
  size_t ended_count;                 ///< number of pairs that ended
  size_t cached_pairs;                ///< number of pairs that kept their previous manifolds
  /// The manifolds of pair i are [manifold_first[i], manifold_first[i + 1]).
  const uint32_t* manifold_first;
  size_t manifolds;  ///< number of manifolds
  /// Triangle or child of a in each manifold; WINNOW_WHOLE_SHAPE for a convex shape.
  const uint32_t* part_a;
  const uint32_t* part_b;     ///< triangle or child of b
  const double* distance;     ///< minus the penetration depth if the bodies overlap
  const double* error_bound;  ///< the true distance is within distance +- error_bound
  const double* normal[3];    ///< unit vector from a to b
  /// Level distance: the closest (or deepest) point of a, relative to the position of a.
  const double* point[3];
  /// Level manifold: the points of manifold m are [point_first[m], point_first[m + 1]), relative to
  /// the position of body a.
  const uint32_t* point_first;
  size_t points;             ///< number of points
  const float* position[3];  ///< halfway between the surfaces
  const float* depth;        ///< positive where the bodies overlap
  const uint64_t* feature;   ///< equal features in two frames are the same point
  /// Index of each pair in the previous frame, or WINNOW_NO_CONTACT; null unless the scene has
  /// `warm_start`.
  const uint32_t* previous_pair;
  /// Index of each point in the previous frame, or WINNOW_NO_CONTACT; null likewise.
  const uint32_t* previous_point;
} winnow_contact_columns;

/// Numbers of bodies, pairs and contacts that memory is reserved for.
typedef struct winnow_scene_room {
  size_t size;                        ///< set by the caller to sizeof(winnow_scene_room)
  size_t bodies[WINNOW_BODY_STATES];  ///< in each set
  size_t pairs;                       ///< pairs found by the broad phase
  winnow_contact_level level;         ///< level at which contacts will be found
  size_t touching;                    ///< pairs stored in the contacts
  size_t manifolds;  ///< from level boolean on; without composite shapes as many as `touching`
  size_t points;     ///< at level manifold
} winnow_scene_room;
#define WINNOW_SCENE_ROOM {sizeof(winnow_scene_room), {0, 0, 0}, 0, WINNOW_LEVEL_MANIFOLD, 0, 0, 0}

/// Bytes by part. The sum of `reserved` equals the bytes allocated from the scene's memory.
typedef struct winnow_scene_bytes {
  size_t size;          ///< set by the caller to sizeof(winnow_scene_bytes)
  winnow_bytes bodies;  ///< shapes, poses, keys, filters, client data, the scene object
  winnow_bytes partitions[WINNOW_BODY_STATES];  ///< of each set
  winnow_bytes pairs;                           ///< pairs found by the broad phase
  winnow_bytes mid_phase;                       ///< pairs of primitives; 0 without composite shapes
  winnow_bytes narrow_phase;                    ///< results and scratch
} winnow_scene_bytes;

/// Counters of the last collide, not timings.
typedef struct winnow_scene_counts {
  size_t size;               ///< set by the caller to sizeof(winnow_scene_counts)
  uint64_t boxes_updated;    ///< boxes written to partitions since the previous collide
  uint64_t body_pairs;       ///< pairs found by the broad phase
  uint64_t cached_pairs;     ///< body pairs that kept their cached contacts
  uint64_t primitive_pairs;  ///< pairs of parts generated by the mid phase
  uint64_t convex_pairs;     ///< narrow phase, pairs of convex bodies; see winnow_narrow_statistics
  uint64_t convex_recomputed;
  uint64_t convex_exact;
  uint64_t part_pairs;  ///< narrow phase, pairs of parts
  uint64_t part_recomputed;
  uint64_t part_exact;
  uint64_t rejected_by_spheres;  ///< body_pairs skipped because their bounding spheres are disjoint
  uint64_t convex_without_lanes;
  uint64_t convex_bounded;
  uint64_t part_without_lanes;
  uint64_t part_bounded;
} winnow_scene_counts;

/// Creates an empty scene. `shapes` must outlive the scene. WINNOW_INVALID_ARGUMENT for options out
/// of range.
WINNOW_C_API winnow_status winnow_scene_create(
    const winnow_shape_pool* shapes, const winnow_scene_options* options, winnow_scene** scene);

/// Destroys the scene; does nothing for null.
WINNOW_C_API void winnow_scene_destroy(winnow_scene* scene);

/// Adds bodies, all or none, and writes their keys. WINNOW_INVALID_KEY if neither pool contains a
/// shape; WINNOW_UNSUPPORTED for a composite shape in a scene without a composite pool;
/// WINNOW_INVALID_POSE; WINNOW_INVALID_ARGUMENT for offsets or a layer out of range;
/// WINNOW_TOO_MANY_OBJECTS from 2^28 on.
WINNOW_C_API winnow_status winnow_scene_add(
    winnow_scene* scene, const winnow_body_definition* bodies, size_t count, winnow_key* keys);

/// Removes bodies, all or none. WINNOW_INVALID_KEY also if a key occurs twice.
WINNOW_C_API winnow_status winnow_scene_remove(
    winnow_scene* scene, const winnow_key* keys, size_t count);

/// Removes all bodies. Memory is kept.
WINNOW_C_API winnow_status winnow_scene_clear(winnow_scene* scene);

/// Sets the pose of each body, all or none; without orientations, only the positions. If a key
/// occurs twice, its last pose is used.
WINNOW_C_API winnow_status winnow_scene_move(
    winnow_scene* scene, const winnow_key* keys, size_t count, const winnow_pose_view* poses);

/// Moves bodies to a set, all or none. WINNOW_INVALID_KEY also if a key occurs twice.
WINNOW_C_API winnow_status winnow_scene_set_body_state(
    winnow_scene* scene, const winnow_key* keys, size_t count, uint8_t state);

/// Replaces the shape of a body; its pose stays. Errors as for winnow_scene_add.
WINNOW_C_API winnow_status winnow_scene_set_shape(
    winnow_scene* scene, winnow_key key, winnow_shape_id shape);

/// Replaces the filter of a body. It takes effect with the next collide or query.
WINNOW_C_API winnow_status winnow_scene_set_filter(
    winnow_scene* scene, winnow_key key, const winnow_object_filter* filter);

/// Replaces the contact offsets of a body. WINNOW_INVALID_ARGUMENT for offsets out of range.
WINNOW_C_API winnow_status winnow_scene_set_offsets(
    winnow_scene* scene, winnow_key key, const winnow_contact_offsets* offsets);

/// Moves a body to another layer; it takes effect with the next collide or query.
WINNOW_C_API winnow_status winnow_scene_set_layer(
    winnow_scene* scene, winnow_key key, uint16_t layer);

/// Returns the layer of a body.
WINNOW_C_API winnow_status winnow_scene_layer(
    const winnow_scene* scene, winnow_key key, uint16_t* layer);

/// Sets whether bodies of two layers collide; a may equal b, and their order does not matter. At
/// first all layers collide. WINNOW_INVALID_ARGUMENT for a layer out of range. The next collide
/// finds all pairs again.
WINNOW_C_API winnow_status winnow_scene_set_layers_collide(
    winnow_scene* scene, uint16_t a, uint16_t b, bool collide);

/// Returns true unless the two layers were excluded by winnow_scene_set_layers_collide.
WINNOW_C_API winnow_status winnow_scene_layers_collide(
    const winnow_scene* scene, uint16_t a, uint16_t b, bool* collide);

/// Makes pairs of bodies ignore each other, or collide again, all or none. Removing a body ends its
/// exclusions. WINNOW_INVALID_ARGUMENT for a pair of one body.
WINNOW_C_API winnow_status winnow_scene_set_ignored(
    winnow_scene* scene, const winnow_key_pair* pairs, size_t count, bool ignored);

/// Returns whether the pair is ignored, in either order; false for stale keys.
WINNOW_C_API winnow_status winnow_scene_is_ignored(
    const winnow_scene* scene, winnow_key a, winnow_key b, bool* ignored);

/// Sets a callback that accepts or rejects pairs of bodies whose boxes overlap, whose filters and
/// layers let them collide, and that are not ignored; null ends it. The struct is copied. It is not
/// called for every pair in every frame: if its results change, set it again.
WINNOW_C_API winnow_status winnow_scene_set_predicate(
    winnow_scene* scene, const winnow_pair_predicate* predicate);

/// Returns the number of live bodies in all sets.
WINNOW_C_API winnow_status winnow_scene_size(const winnow_scene* scene, size_t* size);

/// Returns the number of live bodies in one set.
WINNOW_C_API winnow_status winnow_scene_size_of(
    const winnow_scene* scene, uint8_t state, size_t* size);

/// Returns whether the key belongs to a live body of this scene. O(1).
WINNOW_C_API winnow_status winnow_scene_contains(
    const winnow_scene* scene, winnow_key key, bool* contains);

/// Writes the current state of a body.
WINNOW_C_API winnow_status winnow_scene_body(
    const winnow_scene* scene, winnow_key key, winnow_body_definition* body);

/// Returns the key of a live body; the null key for an id that no body has.
WINNOW_C_API winnow_status winnow_scene_key_of(
    const winnow_scene* scene, uint32_t id, winnow_key* key);

/// Updates boxes and partitions now instead of in the next collide. Queries need it.
WINNOW_C_API winnow_status winnow_scene_refresh(winnow_scene* scene);

/// Writes the point of the world to which the boxes of the partitions are relative.
WINNOW_C_API winnow_status winnow_scene_origin(const winnow_scene* scene, double origin[3]);

/// Returns the read-only partition of a set, valid as long as the scene; null while the set has
/// none. Its client data are body ids.
WINNOW_C_API winnow_status winnow_scene_partition(
    winnow_scene* scene, uint8_t state, const winnow_partition** partition);

/// Draws the partitions of all sets.
WINNOW_C_API winnow_status winnow_scene_debug_draw(
    const winnow_scene* scene, const winnow_debug_draw* draw,
    const winnow_debug_draw_options* options);

/// Finds all contacts at the given level of detail, and the changes since `contacts` was last
/// filled. Contacts of two bodies that fell asleep are stored, but neither reported nor ended,
/// until one of them wakes. WINNOW_OUT_OF_MEMORY leaves `contacts` empty.
WINNOW_C_API winnow_status winnow_scene_collide(
    winnow_scene* scene, winnow_contact_level level, winnow_contacts* contacts);

/// Reserves memory, so that a first collide within these numbers allocates nothing. Add the shapes
/// first.
WINNOW_C_API winnow_status winnow_scene_reserve(
    winnow_scene* scene, const winnow_scene_room* room, winnow_pages pages);

/// Reserves memory in contacts for this scene.
WINNOW_C_API winnow_status winnow_scene_reserve_contacts(
    const winnow_scene* scene, winnow_contacts* contacts, const winnow_scene_room* room,
    winnow_pages pages);

/// Writes the bytes by part.
WINNOW_C_API winnow_status winnow_scene_footprint(
    const winnow_scene* scene, winnow_scene_bytes* footprint);

/// Writes the counters of the last collide.
WINNOW_C_API winnow_status winnow_scene_statistics(
    const winnow_scene* scene, winnow_scene_counts* statistics);

/// Creates empty contacts.
WINNOW_C_API winnow_status winnow_contacts_create(
    const winnow_memory* memory, winnow_contacts** contacts);

/// Destroys the contacts; does nothing for null.
WINNOW_C_API void winnow_contacts_destroy(winnow_contacts* contacts);

/// Removes all contents. Memory is kept.
WINNOW_C_API winnow_status winnow_contacts_clear(winnow_contacts* contacts);

/// Writes the columns of the last collide.
WINNOW_C_API winnow_status winnow_contacts_columns(
    const winnow_contacts* contacts, winnow_contact_columns* columns);

/// Writes the bytes of the contacts, by purpose.
WINNOW_C_API winnow_status winnow_contacts_footprint(
    const winnow_contacts* contacts, winnow_footprint* footprint);

#ifdef __cplusplus
}
#endif
