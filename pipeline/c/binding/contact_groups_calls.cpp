// Generated from pipeline/interface/contact_groups.toml; do not edit.
// clang-format off

#include <winnow/c/contact_groups.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_contact_groups_create(
    const winnow_memory* memory, winnow_contact_groups** groups) {
  if (!(are_given(groups))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, groups);
}

void winnow_contact_groups_destroy(winnow_contact_groups* groups) {
  destroy(groups);
}

winnow_status winnow_scene_islands(
    const winnow_scene* scene, const winnow_contacts* contacts, winnow_contact_groups* groups) {
  if (!(are_given(scene, contacts, groups))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).islands(of(contacts), of(groups))); });
}

winnow_status winnow_scene_colours(
    const winnow_scene* scene, const winnow_contacts* contacts, winnow_contact_groups* groups) {
  if (!(are_given(scene, contacts, groups))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).colours(of(contacts), of(groups))); });
}

winnow_status winnow_contact_groups_size(const winnow_contact_groups* groups, size_t* size) {
  if (!(are_given(groups, size))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(groups).size()); }, size);
}

winnow_status winnow_contact_groups_group(
    const winnow_contact_groups* groups, const uint32_t** group, size_t* pairs) {
  if (!(are_given(groups, group, pairs))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(groups).group()); }, group, pairs);
}

winnow_status winnow_contact_groups_pairs(
    const winnow_contact_groups* groups, size_t group, const uint32_t** pairs, size_t* count) {
  if (!(are_given(groups, pairs, count))) return WINNOW_INVALID_ARGUMENT;
  if (!(group < of(groups).size())) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(groups).pairs(group)); }, pairs, count);
}

winnow_status winnow_contact_groups_clear(winnow_contact_groups* groups) {
  if (!(are_given(groups))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(groups).clear()); });
}

winnow_status winnow_contact_groups_footprint(
    const winnow_contact_groups* groups, winnow_footprint* footprint) {
  if (!(are_given(groups) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(groups, footprint);
}
