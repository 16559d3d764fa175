// C binding of islands and colours (contact_groups.h).

#include <winnow/c/contact_groups.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/columns.h"
#include "pipeline/c/binding/handles.h"

using namespace winnow::c;

static_assert(WINNOW_REST_COLOUR == winnow::kRestColour);

winnow_status winnow_contact_groups_create(const winnow_memory* memory,
                                           winnow_contact_groups** groups) {
  return create(memory, groups);
}

void winnow_contact_groups_destroy(winnow_contact_groups* groups) {
  destroy(groups);
}

winnow_status winnow_contact_groups_clear(winnow_contact_groups* groups) {
  if (groups == nullptr) return WINNOW_INVALID_ARGUMENT;
  groups->value.clear();
  return WINNOW_OK;
}

winnow_status winnow_contact_groups_footprint(const winnow_contact_groups* groups,
                                              winnow_footprint* footprint) {
  if (groups == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(groups, groups->value.footprint(), {}, footprint);
}

winnow_status winnow_scene_islands(const winnow_scene* scene, const winnow_contacts* contacts,
                                   winnow_contact_groups* groups) {
  if (!are_given(scene, contacts, groups)) return WINNOW_INVALID_ARGUMENT;
  return answer(scene->value.islands(contacts->value, groups->value));
}

winnow_status winnow_scene_colours(const winnow_scene* scene, const winnow_contacts* contacts,
                                   winnow_contact_groups* groups) {
  if (!are_given(scene, contacts, groups)) return WINNOW_INVALID_ARGUMENT;
  return answer(scene->value.colours(contacts->value, groups->value));
}

winnow_status winnow_contact_groups_size(const winnow_contact_groups* groups, size_t* size) {
  if (!are_given(groups, size)) return WINNOW_INVALID_ARGUMENT;
  *size = groups->value.size();
  return WINNOW_OK;
}

winnow_status winnow_contact_groups_group(const winnow_contact_groups* groups,
                                          const uint32_t** group, size_t* pairs) {
  if (!are_given(groups, group, pairs)) return WINNOW_INVALID_ARGUMENT;
  *group = column(groups->value.group());
  *pairs = groups->value.group().size();
  return WINNOW_OK;
}

winnow_status winnow_contact_groups_pairs(const winnow_contact_groups* groups, size_t group,
                                          const uint32_t** pairs, size_t* count) {
  if (!are_given(groups, pairs, count) || group >= groups->value.size()) {
    return WINNOW_INVALID_ARGUMENT;
  }
  *pairs = column(groups->value.pairs(group));
  *count = groups->value.pairs(group).size();
  return WINNOW_OK;
}
