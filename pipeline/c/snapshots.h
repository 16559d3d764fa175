#pragma once

/// Saving to bytes and loading again. `save`, `load`, `save_contacts` and `load_contacts` of the
/// C++ classes document each call. Load pools before scenes, and scenes before their contacts.

#include <winnow/c/core.h>
#include <winnow/c/partition.h>
#include <winnow/c/scene.h>
#include <winnow/c/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Buffer of saved bytes.
typedef struct winnow_snapshot winnow_snapshot;
WINNOW_C_API winnow_status winnow_snapshot_create(const winnow_memory* memory,
                                                  winnow_snapshot** snapshot);
WINNOW_C_API void winnow_snapshot_destroy(winnow_snapshot* snapshot);
/// Returns the bytes, not copied, valid until the buffer is saved to again.
WINNOW_C_API winnow_status winnow_snapshot_bytes(const winnow_snapshot* snapshot,
                                                 const uint8_t** bytes, size_t* count);

/// Each `save` replaces the content of the snapshot.
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
