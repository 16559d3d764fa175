#pragma once

/// Groups of contacts for solvers: islands and colours. The C++ functions of the same names
/// document each call; see <winnow/pipeline/scene.h> and contact_groups.h.

#include <winnow/c/core.h>
#include <winnow/c/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The last colour: pairs that fit no other colour and must be solved one after the other.
#define WINNOW_REST_COLOUR 63U

typedef struct winnow_contact_groups winnow_contact_groups;
WINNOW_C_API winnow_status winnow_contact_groups_create(const winnow_memory* memory,
                                                        winnow_contact_groups** groups);
WINNOW_C_API void winnow_contact_groups_destroy(winnow_contact_groups* groups);
WINNOW_C_API winnow_status winnow_contact_groups_clear(winnow_contact_groups* groups);
WINNOW_C_API winnow_status winnow_contact_groups_footprint(const winnow_contact_groups* groups,
                                                           winnow_footprint* footprint);

WINNOW_C_API winnow_status winnow_scene_islands(const winnow_scene* scene,
                                                const winnow_contacts* contacts,
                                                winnow_contact_groups* groups);
WINNOW_C_API winnow_status winnow_scene_colours(const winnow_scene* scene,
                                                const winnow_contacts* contacts,
                                                winnow_contact_groups* groups);

WINNOW_C_API winnow_status winnow_contact_groups_size(const winnow_contact_groups* groups,
                                                      size_t* size);
/// Returns the group of each pair. The array is not copied.
WINNOW_C_API winnow_status winnow_contact_groups_group(const winnow_contact_groups* groups,
                                                       const uint32_t** group, size_t* pairs);
/// Returns the pairs of a group, ascending.
WINNOW_C_API winnow_status winnow_contact_groups_pairs(const winnow_contact_groups* groups,
                                                       size_t group, const uint32_t** pairs,
                                                       size_t* count);

#ifdef __cplusplus
}
#endif
