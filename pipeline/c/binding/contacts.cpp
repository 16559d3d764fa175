// C binding of Contacts: columns, events and reserved memory (scene.h).

#include <winnow/c/scene.h>

#include "core/memory/columns.h"
#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/columns.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"

#include <algorithm>

namespace winnow::c {
namespace {

[[nodiscard]] const std::uint32_t* parts_of(const PartColumn& parts,
                                            const Column<std::uint32_t>& whole) noexcept {
  if (parts.empty()) return nullptr;
  return parts.lookup().parts != nullptr ? parts.lookup().parts : whole.data();
}

[[nodiscard]] winnow_contact_columns columns_of(const winnow_contacts& handle) noexcept {
  const Contacts& contacts = handle.value;
  static_assert(sizeof(ContactEvent) == 1 &&
                static_cast<int>(ContactEvent::persisted) == WINNOW_EVENT_PERSISTED);
  winnow_contact_columns shown{};
  shown.level = static_cast<winnow_contact_level>(contacts.level());
  std::size_t same = 0;
  return_array(contacts.a(), &shown.a, &shown.pairs);
  return_array(contacts.b(), &shown.b, &same);
  shown.data_a = handle.data[0].data();
  shown.data_b = handle.data[1].data();
  shown.event = reinterpret_cast<const std::uint8_t*>(contacts.event().data());
  return_array(contacts.runs(), &shown.runs, &shown.run_count);
  return_array(contacts.ended(), &shown.ended, &shown.ended_count);
  shown.cached_pairs = contacts.cached_pairs();
  shown.manifold_first = column(contacts.manifold_first());
  shown.manifolds = contacts.manifolds();
  shown.part_a = parts_of(contacts.part_a(), handle.whole);
  shown.part_b = parts_of(contacts.part_b(), handle.whole);
  shown.distance = column(contacts.distance());
  shown.error_bound = column(contacts.error_bound());
  for (int axis = 0; axis < 3; ++axis) {
    shown.normal[axis] = column(contacts.normal(axis));
    shown.point[axis] = column(contacts.point(axis));
  }
  shown.point_first = column(contacts.point_first());
  shown.points = contacts.points();
  show_points(contacts.contact_columns(), shown);
  return shown;
}

[[nodiscard]] bool read_room(const winnow_scene_room* given, SceneCapacity& room) noexcept {
  winnow_scene_room own{};
  if (given == nullptr || !read_sized(given, own) ||
      !read_choice(own.level, ContactLevel::manifold, room.level)) {
    return false;
  }
  std::copy(std::begin(own.bodies), std::end(own.bodies), room.bodies);
  room.pairs = own.pairs;
  room.touching = own.touching;
  room.manifolds = own.manifolds;
  room.points = own.points;
  return true;
}

}  // namespace
}  // namespace winnow::c

using namespace winnow::c;

winnow::Status winnow_contacts::look_up() noexcept {
  const bool is_whole = value.part_a().lookup().parts == nullptr;
  const std::size_t known = whole.size();
  if (!data[0].resize(value.size()) || !data[1].resize(value.size()) ||
      (is_whole && known < value.manifolds() && !whole.resize(value.manifolds()))) {
    value.clear();
    return winnow::Status::out_of_memory;
  }
  std::ranges::copy(value.data_a(), data[0].begin());
  std::ranges::copy(value.data_b(), data[1].begin());
  std::fill(whole.begin() + known, whole.end(), winnow::kWholeShape);
  return winnow::Status::ok;
}

winnow_status winnow_contacts_create(const winnow_memory* memory, winnow_contacts** contacts) {
  return create(memory, contacts);
}

void winnow_contacts_destroy(winnow_contacts* contacts) {
  destroy(contacts);
}

winnow_status winnow_contacts_clear(winnow_contacts* contacts) {
  if (contacts == nullptr) return WINNOW_INVALID_ARGUMENT;
  contacts->value.clear();
  return WINNOW_OK;
}

winnow_status winnow_contacts_footprint(const winnow_contacts* contacts,
                                        winnow_footprint* footprint) {
  if (contacts == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(contacts, contacts->value.footprint(),
                         winnow::bytes_of(contacts->data[0], contacts->data[1], contacts->whole),
                         footprint);
}

winnow_status winnow_contacts_columns(const winnow_contacts* contacts,
                                      winnow_contact_columns* columns) {
  if (contacts == nullptr || !is_sized(columns)) return WINNOW_INVALID_ARGUMENT;
  write_sized(columns_of(*contacts), *columns);
  return WINNOW_OK;
}

winnow_status winnow_scene_collide(winnow_scene* scene, winnow_contact_level level,
                                   winnow_contacts* contacts) {
  winnow::ContactLevel contact_level{};
  if (!are_given(scene, contacts) ||
      !read_choice(level, winnow::ContactLevel::manifold, contact_level)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  const winnow::Status status = scene->value.collide(contact_level, contacts->value);
  return answer(status == winnow::Status::ok ? contacts->look_up() : status);
}

winnow_status winnow_scene_reserve(winnow_scene* scene, const winnow_scene_room* room,
                                   winnow_pages pages) {
  winnow::SceneCapacity read;
  winnow::Pages touch{};
  if (scene == nullptr || !read_room(room, read) ||
      !read_choice(pages, winnow::Pages::prefaulted, touch)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(scene->value.reserve(read, touch));
}

winnow_status winnow_scene_reserve_contacts(const winnow_scene* scene, winnow_contacts* contacts,
                                            const winnow_scene_room* room, winnow_pages pages) {
  winnow::SceneCapacity read;
  winnow::Pages touch{};
  if (!are_given(scene, contacts) || !read_room(room, read) ||
      !read_choice(pages, winnow::Pages::prefaulted, touch)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(scene->value.reserve_contacts(contacts->value, read, touch));
}
