// C binding of Scene: options, bodies and state. Contacts are in contacts.cpp.

#include <winnow/c/scene.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/drawing.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"
#include "pipeline/c/binding/options.h"
#include "pipeline/c/binding/structures.h"
#include "pipeline/c/binding/views.h"

namespace winnow::c {

bool read_options(const winnow_scene_options* given, const winnow_memory*& memory,
                  SceneOptions& options) noexcept {
  winnow_scene_options own{};
  if (!read_sized(given, own) || !read_execution(own.execution, options.execution) ||
      !read_choice(own.tier, NarrowTier::reference, options.tier)) {
    return false;
  }
  memory = own.memory;
  for (std::size_t i = 0; i < kBodyStates; ++i)
    options.structures[i] = structure_of(own.structures[i]);
  options.contact_margin = own.contact_margin;
  options.cache_tolerance = own.cache_tolerance;
  options.contact_reduction = own.contact_reduction != 0;
  options.build_budget = own.build_budget;
  if (own.composites != nullptr) options.composites = &own.composites->value;
  return true;
}

}  // namespace winnow::c

using namespace winnow::c;

winnow_status winnow_scene_create(const winnow_shape_pool* shapes,
                                  const winnow_scene_options* options, winnow_scene** scene) {
  winnow::SceneOptions read;
  const winnow_memory* memory = nullptr;
  if (!are_given(shapes, scene) || !read_options(options, memory, read)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  winnow_scene* made = nullptr;
  const winnow_status status = create(memory, &made, shapes->value, read);
  if (status != WINNOW_OK) return status;
  // A Scene reports invalid options or refused memory only in `add`: test with an empty one.
  const winnow::Status stands = made->value.add({}, std::span<winnow::Key>());
  if (stands == winnow::Status::ok) {
    *scene = made;
  } else {
    destroy(made);
  }
  return answer(stands);
}

void winnow_scene_destroy(winnow_scene* scene) {
  destroy(scene);
}

winnow_status winnow_scene_add(winnow_scene* scene, const winnow_body_definition* bodies,
                               size_t count, winnow_key* keys) {
  if (scene == nullptr || !is_array(bodies, count) || !is_array(keys, count)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(scene->value.add(as_cpp_span(bodies, count), as_cpp_span(keys, count)));
}

winnow_status winnow_scene_remove(winnow_scene* scene, const winnow_key* keys, size_t count) {
  if (scene == nullptr || !is_array(keys, count)) return WINNOW_INVALID_ARGUMENT;
  return answer(scene->value.remove(as_cpp_span(keys, count)));
}

winnow_status winnow_scene_clear(winnow_scene* scene) {
  if (scene == nullptr) return WINNOW_INVALID_ARGUMENT;
  scene->value.clear();
  return WINNOW_OK;
}

winnow_status winnow_scene_move(winnow_scene* scene, const winnow_key* keys, size_t count,
                                const winnow_pose_view* poses) {
  if (!are_given(scene, poses) || !is_array(keys, count)) return WINNOW_INVALID_ARGUMENT;
  if (count != poses->count) return WINNOW_SIZE_MISMATCH;
  winnow::PoseView view;
  const winnow::Status status = read_poses(poses, scene->room, view);
  if (status != winnow::Status::ok) return answer(status);
  return answer(scene->value.move(as_cpp_span(keys, count), view));
}

winnow_status winnow_scene_set_body_state(winnow_scene* scene, const winnow_key* keys, size_t count,
                                          uint8_t state) {
  if (scene == nullptr || !is_array(keys, count)) return WINNOW_INVALID_ARGUMENT;
  return answer(
      scene->value.set_body_state(as_cpp_span(keys, count), static_cast<winnow::BodyState>(state)));
}

winnow_status winnow_scene_set_shape(winnow_scene* scene, winnow_key key, winnow_shape_id shape) {
  if (scene == nullptr) return WINNOW_INVALID_ARGUMENT;
  return answer(scene->value.set_shape(*as_cpp(&key), {shape}));
}

winnow_status winnow_scene_set_filter(winnow_scene* scene, winnow_key key,
                                      const winnow_object_filter* filter) {
  if (!are_given(scene, filter)) return WINNOW_INVALID_ARGUMENT;
  return answer(scene->value.set_filter(*as_cpp(&key), *as_cpp(filter)));
}

winnow_status winnow_scene_set_ignored(winnow_scene* scene, const winnow_key_pair* pairs,
                                       size_t count, bool ignored) {
  if (scene == nullptr || !is_array(pairs, count)) return WINNOW_INVALID_ARGUMENT;
  return answer(scene->value.set_ignored(as_cpp_span(pairs, count), ignored));
}

winnow_status winnow_scene_is_ignored(const winnow_scene* scene, winnow_key a, winnow_key b,
                                      bool* ignored) {
  if (!are_given(scene, ignored)) return WINNOW_INVALID_ARGUMENT;
  *ignored = scene->value.is_ignored(*as_cpp(&a), *as_cpp(&b));
  return WINNOW_OK;
}

winnow_status winnow_scene_size(const winnow_scene* scene, size_t* size) {
  if (!are_given(scene, size)) return WINNOW_INVALID_ARGUMENT;
  *size = scene->value.size();
  return WINNOW_OK;
}

winnow_status winnow_scene_size_of(const winnow_scene* scene, uint8_t state, size_t* size) {
  winnow::BodyState which{};
  if (!are_given(scene, size) || !read_choice(state, winnow::BodyState::sleeping, which)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  *size = scene->value.size(which);
  return WINNOW_OK;
}

winnow_status winnow_scene_contains(const winnow_scene* scene, winnow_key key, bool* contains) {
  if (!are_given(scene, contains)) return WINNOW_INVALID_ARGUMENT;
  *contains = scene->value.contains(*as_cpp(&key));
  return WINNOW_OK;
}

winnow_status winnow_scene_body(const winnow_scene* scene, winnow_key key,
                                winnow_body_definition* body) {
  if (!are_given(scene, body)) return WINNOW_INVALID_ARGUMENT;
  return answer(scene->value.body(*as_cpp(&key)), as_cpp(body));
}

winnow_status winnow_scene_key_of(const winnow_scene* scene, uint32_t id, winnow_key* key) {
  if (!are_given(scene, key)) return WINNOW_INVALID_ARGUMENT;
  *as_cpp(key) = scene->value.key_of(id);
  return WINNOW_OK;
}

winnow_status winnow_scene_refresh(winnow_scene* scene) {
  if (scene == nullptr) return WINNOW_INVALID_ARGUMENT;
  return answer(scene->value.refresh());
}

winnow_status winnow_scene_origin(const winnow_scene* scene, double origin[3]) {
  if (!are_given(scene, origin)) return WINNOW_INVALID_ARGUMENT;
  const Eigen::Vector3d own = scene->value.origin();
  for (Eigen::Index axis = 0; axis < 3; ++axis) origin[axis] = own[axis];
  return WINNOW_OK;
}

winnow_status winnow_scene_partition(winnow_scene* scene, uint8_t state,
                                     const winnow_partition** partition) {
  winnow::BodyState which{};
  if (!are_given(scene, partition) || !read_choice(state, winnow::BodyState::sleeping, which)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  winnow_partition& view = scene->sets[state];
  const winnow::Partition* const own = scene->value.partition(which);
  view.target = own;
  *partition = own == nullptr ? nullptr : &view;
  return WINNOW_OK;
}

winnow_status winnow_scene_debug_draw(const winnow_scene* scene, const winnow_debug_draw* draw,
                                      const winnow_debug_draw_options* options) {
  winnow::DebugDrawOptions read;
  if (!are_given(scene, draw) || !read_options(options, read)) return WINNOW_INVALID_ARGUMENT;
  CallbackDraw drawing(*draw);
  return answer(scene->value.debug_draw(drawing, read));
}

winnow_status winnow_scene_footprint(const winnow_scene* scene, winnow_scene_bytes* footprint) {
  if (scene == nullptr || !is_sized(footprint)) return WINNOW_INVALID_ARGUMENT;
  winnow::SceneFootprint own = scene->value.footprint();
  own.bodies += {sizeof(*scene), sizeof(*scene)};
  own.bodies += scene->room.bytes();
  write_sized(
      {0,
       bytes_of(own.bodies),
       {bytes_of(own.partitions[0]), bytes_of(own.partitions[1]), bytes_of(own.partitions[2])},
       bytes_of(own.pairs),
       bytes_of(own.mid_phase),
       bytes_of(own.narrow_phase)},
      *footprint);
  return WINNOW_OK;
}

winnow_status winnow_scene_statistics(const winnow_scene* scene, winnow_scene_counts* statistics) {
  if (scene == nullptr || !is_sized(statistics)) return WINNOW_INVALID_ARGUMENT;
  const winnow::SceneStatistics& own = scene->value.statistics();
  write_sized({0, own.boxes_updated, own.body_pairs, own.cached_pairs, own.primitive_pairs,
               own.convex.pairs, own.convex.recomputed, own.convex.exact, own.parts.pairs,
               own.parts.recomputed, own.parts.exact, own.rejected_by_spheres},
              *statistics);
  return WINNOW_OK;
}
