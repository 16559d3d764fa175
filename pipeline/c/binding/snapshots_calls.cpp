// Generated from pipeline/interface/snapshots.toml; do not edit.
// clang-format off

#include <winnow/c/snapshots.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_snapshot_create(const winnow_memory* memory, winnow_snapshot** snapshot) {
  if (!(are_given(snapshot))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, snapshot);
}

void winnow_snapshot_destroy(winnow_snapshot* snapshot) {
  destroy(snapshot);
}

winnow_status winnow_snapshot_bytes(
    const winnow_snapshot* snapshot, const uint8_t** bytes, size_t* count) {
  if (!(are_given(snapshot, bytes, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(snapshot)); }, bytes, count);
}

winnow_status winnow_partition_save(const winnow_partition* partition, winnow_snapshot* snapshot) {
  if (!(are_given(partition, snapshot))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (save_into(of(snapshot), [&](auto& out) { return of(partition).save(out); })); });
}

winnow_status winnow_partition_load(
    winnow_partition* partition, const uint8_t* bytes, size_t count) {
  if (!(are_given(partition) && is_array(bytes, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).load(std::as_bytes(span_of(bytes, count)))); });
}

winnow_status winnow_shape_pool_save(const winnow_shape_pool* pool, winnow_snapshot* snapshot) {
  if (!(are_given(pool, snapshot))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (save_into(of(snapshot), [&](auto& out) { return of(pool).save(out); })); });
}

winnow_status winnow_shape_pool_load(winnow_shape_pool* pool, const uint8_t* bytes, size_t count) {
  if (!(are_given(pool) && is_array(bytes, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).load(std::as_bytes(span_of(bytes, count)))); });
}

winnow_status winnow_composite_pool_save(
    const winnow_composite_pool* pool, winnow_snapshot* snapshot) {
  if (!(are_given(pool, snapshot))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (save_into(of(snapshot), [&](auto& out) { return of(pool).save(out); })); });
}

winnow_status winnow_composite_pool_load(
    winnow_composite_pool* pool, const uint8_t* bytes, size_t count) {
  if (!(are_given(pool) && is_array(bytes, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).load(std::as_bytes(span_of(bytes, count)))); });
}

winnow_status winnow_composite_pool_save_mesh(
    const winnow_composite_pool* pool, winnow_shape_id mesh, winnow_snapshot* snapshot) {
  if (!(are_given(pool, snapshot))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(pool).mesh(ShapeId{mesh}) != nullptr)) return WINNOW_INVALID_KEY;
  return give([&]() -> decltype(auto) { return (save_into(of(snapshot), [&](auto& out) { return of(pool).mesh(ShapeId{mesh})->save(out); })); });
}

winnow_status winnow_composite_pool_save_height_field(
    const winnow_composite_pool* pool, winnow_shape_id field, winnow_snapshot* snapshot) {
  if (!(are_given(pool, snapshot))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(pool).height_field(ShapeId{field}) != nullptr)) return WINNOW_INVALID_KEY;
  return give([&]() -> decltype(auto) { return (save_into(of(snapshot), [&](auto& out) { return of(pool).height_field(ShapeId{field})->save(out); })); });
}

winnow_status winnow_scene_save(const winnow_scene* scene, winnow_snapshot* snapshot) {
  if (!(are_given(scene, snapshot))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (save_into(of(snapshot), [&](auto& out) { return of(scene).save(out); })); });
}

winnow_status winnow_scene_load(winnow_scene* scene, const uint8_t* bytes, size_t count) {
  if (!(are_given(scene) && is_array(bytes, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(scene).load(std::as_bytes(span_of(bytes, count)))); });
}

winnow_status winnow_scene_save_contacts(
    const winnow_scene* scene, const winnow_contacts* contacts, winnow_snapshot* snapshot) {
  if (!(are_given(scene, contacts, snapshot))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (save_into(of(snapshot), [&](auto& out) { return of(scene).save_contacts(of(contacts), out); })); });
}
