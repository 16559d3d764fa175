// Generated from pipeline/interface/snapshots.toml; do not edit.
// clang-format off
#pragma once

/// Saving to bytes and loading again. Load pools before scenes, and scenes before their contacts.
/// Untrusted bytes are safe. pipeline/FORMATS.md has the formats.

#include <winnow/c/core.h>
#include <winnow/c/partition.h>
#include <winnow/c/scene.h>
#include <winnow/c/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Buffer of saved bytes.
typedef struct winnow_snapshot winnow_snapshot;

/// Creates an empty buffer.
WINNOW_C_API winnow_status winnow_snapshot_create(
    const winnow_memory* memory, winnow_snapshot** snapshot);

/// Destroys the snapshot; does nothing for null.
WINNOW_C_API void winnow_snapshot_destroy(winnow_snapshot* snapshot);

/// Returns the bytes, not copied, valid until the buffer is saved to again.
WINNOW_C_API winnow_status winnow_snapshot_bytes(
    const winnow_snapshot* snapshot, const uint8_t** bytes, size_t* count);

/// Replaces the content of the snapshot by the objects: keys, stored volumes, client data, filters,
/// the structure and its options. O(objects).
WINNOW_C_API winnow_status winnow_partition_save(
    const winnow_partition* partition, winnow_snapshot* snapshot);

/// Replaces the objects by a snapshot; memory and execution stay. Saved keys belong to the same
/// objects again, unless another partition of this process uses them. WINNOW_INVALID_ARGUMENT if
/// the bytes are not a valid snapshot.
WINNOW_C_API winnow_status winnow_partition_load(
    winnow_partition* partition, const uint8_t* bytes, size_t count);

/// Replaces the content of the snapshot by all shapes. WINNOW_UNSUPPORTED if the pool contains user
/// shapes.
WINNOW_C_API winnow_status winnow_shape_pool_save(
    const winnow_shape_pool* pool, winnow_snapshot* snapshot);

/// Replaces the shapes by a snapshot, with the ids that they had.
WINNOW_C_API winnow_status winnow_shape_pool_load(
    winnow_shape_pool* pool, const uint8_t* bytes, size_t count);

/// Replaces the content of the snapshot by all shapes.
WINNOW_C_API winnow_status winnow_composite_pool_save(
    const winnow_composite_pool* pool, winnow_snapshot* snapshot);

/// Replaces the shapes by a snapshot, with the ids that they had; load the shape pool first.
WINNOW_C_API winnow_status winnow_composite_pool_load(
    winnow_composite_pool* pool, const uint8_t* bytes, size_t count);

/// Replaces the content of the snapshot by one mesh, without its scale, for
/// winnow_composite_pool_add_saved_mesh. WINNOW_INVALID_KEY if the id is not of a mesh.
WINNOW_C_API winnow_status winnow_composite_pool_save_mesh(
    const winnow_composite_pool* pool, winnow_shape_id mesh, winnow_snapshot* snapshot);

/// Replaces the content of the snapshot by one height field, for
/// winnow_composite_pool_add_saved_height_field. WINNOW_INVALID_KEY if the id is not of a height
/// field.
WINNOW_C_API winnow_status winnow_composite_pool_save_height_field(
    const winnow_composite_pool* pool, winnow_shape_id field, winnow_snapshot* snapshot);

/// Replaces the content of the snapshot by the bodies: keys, shape ids, poses, states, filters,
/// client data, ignored pairs, layers, and the options that affect results. Pools and contacts are
/// saved separately. O(bodies).
WINNOW_C_API winnow_status winnow_scene_save(const winnow_scene* scene, winnow_snapshot* snapshot);

/// Replaces the bodies by a snapshot. From then on contacts equal the contacts of the saved scene
/// bit for bit. WINNOW_INVALID_ARGUMENT if the bytes are not a valid snapshot or use shapes that
/// the pools do not contain.
WINNOW_C_API winnow_status winnow_scene_load(
    winnow_scene* scene, const uint8_t* bytes, size_t count);

/// Replaces the content of the snapshot by contacts that this scene filled last (WINNOW_INVALID_KEY
/// for others).
WINNOW_C_API winnow_status winnow_scene_save_contacts(
    const winnow_scene* scene, const winnow_contacts* contacts, winnow_snapshot* snapshot);

/// Replaces `contacts` by a snapshot that was saved with the loaded state of this scene. The next
/// collide keeps cached contacts, warm starts and reports events as the original scene would have.
WINNOW_C_API winnow_status winnow_scene_load_contacts(
    const winnow_scene* scene, const uint8_t* bytes, size_t count, winnow_contacts* contacts);

#ifdef __cplusplus
}
#endif
