// Generated from pipeline/interface/scene.toml; do not edit.
// clang-format off

#include <winnow/c/scene.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_scene_create(
    const winnow_shape_pool* shapes, const winnow_scene_options* options, winnow_scene** scene) {
  SceneOptions own_options{};
  if (!(are_given(shapes, scene) && read(options, own_options))) return WINNOW_INVALID_ARGUMENT;
  return create(memory_of(options), scene, of(shapes), own_options);
}

void winnow_scene_destroy(winnow_scene* scene) {
  destroy(scene);
}

winnow_status winnow_contacts_create(const winnow_memory* memory, winnow_contacts** contacts) {
  if (!(are_given(contacts))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, contacts);
}

void winnow_contacts_destroy(winnow_contacts* contacts) {
  destroy(contacts);
}

winnow_status winnow_scene_add(
    winnow_scene* scene, const winnow_body_definition* bodies, size_t count, winnow_key* keys) {
  if (!(are_given(scene) && is_array(bodies, count) && is_array(keys, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).add(as_cpp_span(bodies, count), as_cpp_span(keys, count))); });
}

winnow_status winnow_scene_remove(winnow_scene* scene, const winnow_key* keys, size_t count) {
  if (!(are_given(scene) && is_array(keys, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).remove(as_cpp_span(keys, count))); });
}

winnow_status winnow_scene_clear(winnow_scene* scene) {
  if (!(are_given(scene))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).clear()); });
}

winnow_status winnow_scene_move(
    winnow_scene* scene, const winnow_key* keys, size_t count, const winnow_pose_view* poses) {
  if (!(are_given(scene, poses) && is_array(keys, count))) return WINNOW_INVALID_ARGUMENT;
  PoseView own_poses;
  if (const Status bad = read_view(*poses, scene->room, own_poses); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(scene).move(as_cpp_span(keys, count), own_poses)); });
}

winnow_status winnow_scene_set_body_state(
    winnow_scene* scene, const winnow_key* keys, size_t count, uint8_t state) {
  if (!(are_given(scene) && is_array(keys, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).set_body_state(as_cpp_span(keys, count), static_cast<BodyState>(state))); });
}

winnow_status winnow_scene_set_shape(winnow_scene* scene, winnow_key key, winnow_shape_id shape) {
  if (!(are_given(scene))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).set_shape(to_cpp(key), ShapeId{shape})); });
}

winnow_status winnow_scene_set_filter(
    winnow_scene* scene, winnow_key key, const winnow_object_filter* filter) {
  if (!(are_given(scene, filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).set_filter(to_cpp(key), (*as_cpp(filter)))); });
}

winnow_status winnow_scene_set_offsets(
    winnow_scene* scene, winnow_key key, const winnow_contact_offsets* offsets) {
  if (!(are_given(scene, offsets))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).set_offsets(to_cpp(key), (*as_cpp(offsets)))); });
}

winnow_status winnow_scene_set_layer(winnow_scene* scene, winnow_key key, uint16_t layer) {
  if (!(are_given(scene))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).set_layer(to_cpp(key), layer)); });
}

winnow_status winnow_scene_layer(const winnow_scene* scene, winnow_key key, uint16_t* layer) {
  if (!(are_given(scene, layer))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(scene).contains(to_cpp(key)))) return WINNOW_INVALID_KEY;
  return give([&]() -> decltype(auto) { return (of(scene).layer(to_cpp(key))); }, layer);
}

winnow_status winnow_scene_set_layers_collide(
    winnow_scene* scene, uint16_t a, uint16_t b, bool collide) {
  if (!(are_given(scene))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).set_layers_collide(a, b, collide)); });
}

winnow_status winnow_scene_layers_collide(
    const winnow_scene* scene, uint16_t a, uint16_t b, bool* collide) {
  if (!(are_given(scene, collide))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).layers_collide(a, b)); }, collide);
}

winnow_status winnow_scene_set_ignored(
    winnow_scene* scene, const winnow_key_pair* pairs, size_t count, bool ignored) {
  if (!(are_given(scene) && is_array(pairs, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).set_ignored(as_cpp_span(pairs, count), ignored)); });
}

winnow_status winnow_scene_is_ignored(
    const winnow_scene* scene, winnow_key a, winnow_key b, bool* ignored) {
  if (!(are_given(scene, ignored))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).is_ignored(to_cpp(a), to_cpp(b))); }, ignored);
}

winnow_status winnow_scene_set_predicate(
    winnow_scene* scene, const winnow_pair_predicate* predicate) {
  PairPredicate own_predicate{};
  if (!(are_given(scene) && read(predicate, own_predicate))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).set_predicate(own_predicate)); });
}

winnow_status winnow_scene_size(const winnow_scene* scene, size_t* size) {
  if (!(are_given(scene, size))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).size()); }, size);
}

winnow_status winnow_scene_size_of(const winnow_scene* scene, uint8_t state, size_t* size) {
  BodyState own_state{};
  if (!(are_given(scene, size) && read(state, own_state))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).size(own_state)); }, size);
}

winnow_status winnow_scene_contains(const winnow_scene* scene, winnow_key key, bool* contains) {
  if (!(are_given(scene, contains))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).contains(to_cpp(key))); }, contains);
}

winnow_status winnow_scene_body(
    const winnow_scene* scene, winnow_key key, winnow_body_definition* body) {
  if (!(are_given(scene, body))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).body(to_cpp(key))); }, body);
}

winnow_status winnow_scene_key_of(const winnow_scene* scene, uint32_t id, winnow_key* key) {
  if (!(are_given(scene, key))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).key_of(id)); }, key);
}

winnow_status winnow_scene_refresh(winnow_scene* scene) {
  if (!(are_given(scene))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).refresh()); });
}

winnow_status winnow_scene_origin(const winnow_scene* scene, double origin[3]) {
  if (!(are_given(scene, origin))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).origin()); }, origin);
}

winnow_status winnow_scene_debug_draw(
    const winnow_scene* scene, const winnow_debug_draw* draw,
    const winnow_debug_draw_options* options) {
  CallbackDraw own_draw{};
  DebugDrawOptions own_options{};
  if (!(are_given(scene, draw) && read(draw, own_draw) && read(options, own_options))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).debug_draw(own_draw, own_options)); });
}

winnow_status winnow_scene_reserve(
    winnow_scene* scene, const winnow_scene_room* room, winnow_pages pages) {
  SceneCapacity own_room{};
  Pages own_pages{};
  if (!(are_given(scene, room) && read(room, own_room) && read(pages, own_pages))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).reserve(own_room, own_pages)); });
}

winnow_status winnow_scene_reserve_contacts(
    const winnow_scene* scene, winnow_contacts* contacts, const winnow_scene_room* room,
    winnow_pages pages) {
  SceneCapacity own_room{};
  Pages own_pages{};
  if (!(are_given(scene, contacts, room) && read(room, own_room) && read(pages, own_pages))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).reserve_contacts(of(contacts), own_room, own_pages)); });
}

winnow_status winnow_scene_footprint(const winnow_scene* scene, winnow_scene_bytes* footprint) {
  if (!(are_given(scene) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (*scene); }, footprint);
}

winnow_status winnow_scene_statistics(const winnow_scene* scene, winnow_scene_counts* statistics) {
  if (!(are_given(scene) && is_sized(statistics))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).statistics()); }, statistics);
}

winnow_status winnow_contacts_clear(winnow_contacts* contacts) {
  if (!(are_given(contacts))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(contacts).clear()); });
}

winnow_status winnow_contacts_columns(
    const winnow_contacts* contacts, winnow_contact_columns* columns) {
  if (!(are_given(contacts) && is_sized(columns))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (*contacts); }, columns);
}

winnow_status winnow_contacts_footprint(
    const winnow_contacts* contacts, winnow_footprint* footprint) {
  if (!(are_given(contacts) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(contacts, footprint);
}
