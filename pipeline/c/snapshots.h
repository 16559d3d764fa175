#pragma once

/// What is saved as bytes and loaded again. What each call does stands at `save`, `load`,
/// `save_contacts` and `load_contacts` of the classes of C++: pools are loaded before scenes,
/// scenes before their contacts.

#include <winnow/c/core.h>
#include <winnow/c/partition.h>
#include <winnow/c/scene.h>
#include <winnow/c/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Bytes that something was saved as.
typedef struct winnow_snapshot winnow_snapshot;
WINNOW_C_API winnow_status winnow_snapshot_create(const winnow_memory* memory,
                                                  winnow_snapshot** snapshot);
WINNOW_C_API void winnow_snapshot_destroy(winnow_snapshot* snapshot);
/// Where they lie, until something else is saved there.
WINNOW_C_API winnow_status winnow_snapshot_bytes(const winnow_snapshot* snapshot,
                                                 const uint8_t** bytes, size_t* count);

/// Each takes the place of what was saved there before.
WINNOW_C_API winnow_status winnow_partition_save(const winnow_partition* partition,
                                                 winnow_snapshot* snapshot);
WINNOW_C_API winnow_status winnow_partition_load(winnow_partition* partition, const uint8_t* bytes,
                                                 size_t count);
WINNOW_C_API winnow_status winnow_shape_pool_save(const winnow_shape_pool* pool,
                                                  winnow_snapshot* snapshot);
WINNOW_C_API winnow_status winnow_shape_pool_load(winnow_shape_pool* pool, const uint8_t* bytes,
                                                  size_t count);
WINNOW_C_API winnow_status winnow_composite_pool_save(const winnow_composite_pool* pool,
                                                      winnow_snapshot* snapshot);
WINNOW_C_API winnow_status winnow_composite_pool_load(winnow_composite_pool* pool,
                                                      const uint8_t* bytes, size_t count);
WINNOW_C_API winnow_status winnow_scene_save(const winnow_scene* scene, winnow_snapshot* snapshot);
WINNOW_C_API winnow_status winnow_scene_load(winnow_scene* scene, const uint8_t* bytes,
                                             size_t count);
WINNOW_C_API winnow_status winnow_scene_save_contacts(const winnow_scene* scene,
                                                      const winnow_contacts* contacts,
                                                      winnow_snapshot* snapshot);
WINNOW_C_API winnow_status winnow_scene_load_contacts(const winnow_scene* scene,
                                                      const uint8_t* bytes, size_t count,
                                                      winnow_contacts* contacts);

#ifdef __cplusplus
}
#endif
