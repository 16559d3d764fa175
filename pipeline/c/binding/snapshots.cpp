// C binding of saving and loading (snapshots.h).

#include <winnow/c/snapshots.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"

struct winnow_snapshot : winnow::c::Handle {
  using Handle::Handle;
  winnow::Column<std::byte> value{&memory};
};

namespace winnow::c {
namespace {

/// Replaces the snapshot by the bytes that `save(column)` appends, if it succeeds.
template <typename Save>
[[nodiscard]] winnow_status save_into(winnow_snapshot& snapshot, Save&& save) noexcept {
  Column<std::byte> fresh(snapshot.value.memory());
  const Status status = save(fresh);
  if (status == Status::ok) snapshot.value.swap(fresh);
  return answer(status);
}

/// Calls `load(bytes)` if the array is valid.
template <typename Load>
[[nodiscard]] winnow_status load_from(const std::uint8_t* bytes, std::size_t count,
                                      Load&& load) noexcept {
  if (!is_array(bytes, count)) return WINNOW_INVALID_ARGUMENT;
  return answer(load(std::as_bytes(std::span(bytes, count))));
}

}  // namespace
}  // namespace winnow::c

using namespace winnow::c;

winnow_status winnow_snapshot_create(const winnow_memory* memory, winnow_snapshot** snapshot) {
  return create(memory, snapshot);
}

void winnow_snapshot_destroy(winnow_snapshot* snapshot) {
  destroy(snapshot);
}

winnow_status winnow_snapshot_bytes(const winnow_snapshot* snapshot, const uint8_t** bytes,
                                    size_t* count) {
  if (!are_given(snapshot, bytes, count)) return WINNOW_INVALID_ARGUMENT;
  *bytes = reinterpret_cast<const uint8_t*>(snapshot->value.data());
  *count = snapshot->value.size();
  return WINNOW_OK;
}

winnow_status winnow_partition_save(const winnow_partition* partition, winnow_snapshot* snapshot) {
  if (!are_given(partition, snapshot)) return WINNOW_INVALID_ARGUMENT;
  return save_into(*snapshot, [&](auto& out) { return partition->target->save(out); });
}

winnow_status winnow_partition_load(winnow_partition* partition, const uint8_t* bytes,
                                    size_t count) {
  if (partition == nullptr) return WINNOW_INVALID_ARGUMENT;
  return load_from(bytes, count, [&](auto saved) { return partition->value.load(saved); });
}

winnow_status winnow_shape_pool_save(const winnow_shape_pool* pool, winnow_snapshot* snapshot) {
  if (!are_given(pool, snapshot)) return WINNOW_INVALID_ARGUMENT;
  return save_into(*snapshot, [&](auto& out) { return pool->value.save(out); });
}

winnow_status winnow_shape_pool_load(winnow_shape_pool* pool, const uint8_t* bytes, size_t count) {
  if (pool == nullptr) return WINNOW_INVALID_ARGUMENT;
  return load_from(bytes, count, [&](auto saved) { return pool->value.load(saved); });
}

winnow_status winnow_composite_pool_save(const winnow_composite_pool* pool,
                                         winnow_snapshot* snapshot) {
  if (!are_given(pool, snapshot)) return WINNOW_INVALID_ARGUMENT;
  return save_into(*snapshot, [&](auto& out) { return pool->value.save(out); });
}

winnow_status winnow_composite_pool_load(winnow_composite_pool* pool, const uint8_t* bytes,
                                         size_t count) {
  if (pool == nullptr) return WINNOW_INVALID_ARGUMENT;
  return load_from(bytes, count, [&](auto saved) { return pool->value.load(saved); });
}

winnow_status winnow_scene_save(const winnow_scene* scene, winnow_snapshot* snapshot) {
  if (!are_given(scene, snapshot)) return WINNOW_INVALID_ARGUMENT;
  return save_into(*snapshot, [&](auto& out) { return scene->value.save(out); });
}

winnow_status winnow_scene_load(winnow_scene* scene, const uint8_t* bytes, size_t count) {
  if (scene == nullptr) return WINNOW_INVALID_ARGUMENT;
  return load_from(bytes, count, [&](auto saved) { return scene->value.load(saved); });
}

winnow_status winnow_scene_save_contacts(const winnow_scene* scene, const winnow_contacts* contacts,
                                         winnow_snapshot* snapshot) {
  if (!are_given(scene, contacts, snapshot)) return WINNOW_INVALID_ARGUMENT;
  return save_into(*snapshot,
                   [&](auto& out) { return scene->value.save_contacts(contacts->value, out); });
}

winnow_status winnow_scene_load_contacts(const winnow_scene* scene, const uint8_t* bytes,
                                         size_t count, winnow_contacts* contacts) {
  if (!are_given(scene, contacts)) return WINNOW_INVALID_ARGUMENT;
  return load_from(bytes, count, [&](auto saved) {
    const winnow::Status status = scene->value.load_contacts(saved, contacts->value);
    return status == winnow::Status::ok ? contacts->look_up() : status;
  });
}
