// Generated from pipeline/interface/contact_groups.toml; do not edit.
// clang-format off
#pragma once

/// Groups of contacts for solvers: islands and colours.

#include <winnow/c/core.h>
#include <winnow/c/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Groups of the pairs of contacts; invalid once the contacts are filled again.
typedef struct winnow_contact_groups winnow_contact_groups;

/// The last colour: pairs that fit no other colour and must be solved one after the other.
#define WINNOW_REST_COLOUR 63U

/// Creates an empty grouping.
WINNOW_C_API winnow_status winnow_contact_groups_create(
    const winnow_memory* memory, winnow_contact_groups** groups);

/// Destroys the contact groups; does nothing for null.
WINNOW_C_API void winnow_contact_groups_destroy(winnow_contact_groups* groups);

/// Returns the number of groups; none of them is empty.
WINNOW_C_API winnow_status winnow_contact_groups_size(
    const winnow_contact_groups* groups, size_t* size);

/// Returns the group of each pair. The array is not copied.
WINNOW_C_API winnow_status winnow_contact_groups_group(
    const winnow_contact_groups* groups, const uint32_t** group, size_t* pairs);

/// Returns the pairs of a group, ascending. WINNOW_INVALID_ARGUMENT if there is no such group.
WINNOW_C_API winnow_status winnow_contact_groups_pairs(
    const winnow_contact_groups* groups, size_t group, const uint32_t** pairs, size_t* count);

/// Removes all groups. Memory is kept.
WINNOW_C_API winnow_status winnow_contact_groups_clear(winnow_contact_groups* groups);

/// Writes the bytes of the contact groups, by purpose.
WINNOW_C_API winnow_status winnow_contact_groups_footprint(
    const winnow_contact_groups* groups, winnow_footprint* footprint);

/// Groups the pairs of contacts into islands: sets of pairs that are connected by bodies, numbered
/// in the order of their first pairs. Fixed bodies connect nothing; sleeping bodies count as
/// dynamic. `contacts` must have been filled by this scene, and their bodies must still exist
/// (WINNOW_INVALID_KEY).
WINNOW_C_API winnow_status winnow_scene_islands(
    const winnow_scene* scene, const winnow_contacts* contacts, winnow_contact_groups* groups);

/// Groups the pairs of contacts into colours: no two pairs of a colour share a dynamic or sleeping
/// body, so that they can be solved in parallel. Only pairs of WINNOW_REST_COLOUR may share such
/// bodies. Errors as for winnow_scene_islands.
WINNOW_C_API winnow_status winnow_scene_colours(
    const winnow_scene* scene, const winnow_contacts* contacts, winnow_contact_groups* groups);

#ifdef __cplusplus
}
#endif
