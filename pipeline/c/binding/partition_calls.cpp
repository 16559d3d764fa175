// Generated from pipeline/interface/partition.toml; do not edit.
// clang-format off

#include <winnow/c/partition.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_pair_buffer_create(const winnow_memory* memory, winnow_pair_buffer** buffer) {
  if (!(are_given(buffer))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, buffer);
}

void winnow_pair_buffer_destroy(winnow_pair_buffer* buffer) {
  destroy(buffer);
}

winnow_status winnow_pair_events_create(const winnow_memory* memory, winnow_pair_events** events) {
  if (!(are_given(events))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, events);
}

void winnow_pair_events_destroy(winnow_pair_events* events) {
  destroy(events);
}

winnow_status winnow_hit_buffer_create(const winnow_memory* memory, winnow_hit_buffer** buffer) {
  if (!(are_given(buffer))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, buffer);
}

void winnow_hit_buffer_destroy(winnow_hit_buffer* buffer) {
  destroy(buffer);
}

winnow_status winnow_overlap_buffer_create(
    const winnow_memory* memory, winnow_overlap_buffer** buffer) {
  if (!(are_given(buffer))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, buffer);
}

void winnow_overlap_buffer_destroy(winnow_overlap_buffer* buffer) {
  destroy(buffer);
}

winnow_status winnow_partition_create(
    winnow_structure_kind structure, const winnow_partition_options* options,
    winnow_partition** partition) {
  PartitionOptions own_options{};
  if (!(are_given(partition) && read(options, own_options))) return WINNOW_INVALID_ARGUMENT;
  return create(memory_of(options), partition, to_cpp(structure), own_options);
}

void winnow_partition_destroy(winnow_partition* partition) {
  destroy(partition);
}

winnow_status winnow_pair_buffer_pairs(
    const winnow_pair_buffer* buffer, const winnow_pair** pairs, size_t* count) {
  if (!(are_given(buffer, pairs, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).pairs()); }, pairs, count);
}

winnow_status winnow_pair_buffer_reserve(
    winnow_pair_buffer* buffer, size_t count, winnow_pages pages) {
  Pages own_pages{};
  if (!(are_given(buffer) && read(pages, own_pages))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).reserve(count, own_pages)); });
}

winnow_status winnow_pair_buffer_capacity(const winnow_pair_buffer* buffer, size_t* count) {
  if (!(are_given(buffer, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).capacity()); }, count);
}

winnow_status winnow_pair_buffer_shrink(winnow_pair_buffer* buffer, size_t count) {
  if (!(are_given(buffer))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).shrink(count)); });
}

winnow_status winnow_pair_buffer_assign(
    winnow_pair_buffer* buffer, const winnow_pair_buffer* other) {
  if (!(are_given(buffer, other))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).assign(of(other))); });
}

winnow_status winnow_pair_buffer_clear(winnow_pair_buffer* buffer) {
  if (!(are_given(buffer))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).clear()); });
}

winnow_status winnow_pair_events_begun(
    const winnow_pair_events* events, const winnow_key_pair** pairs, size_t* count) {
  if (!(are_given(events, pairs, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(events).begun()); }, pairs, count);
}

winnow_status winnow_pair_events_ended(
    const winnow_pair_events* events, const winnow_key_pair** pairs, size_t* count) {
  if (!(are_given(events, pairs, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(events).ended()); }, pairs, count);
}

winnow_status winnow_pair_events_begun_data(
    const winnow_pair_events* events, const winnow_client_data_pair** data, size_t* count) {
  if (!(are_given(events, data, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(events).begun_data()); }, data, count);
}

winnow_status winnow_pair_events_ended_data(
    const winnow_pair_events* events, const winnow_client_data_pair** data, size_t* count) {
  if (!(are_given(events, data, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(events).ended_data()); }, data, count);
}

winnow_status winnow_pair_events_persisting(const winnow_pair_events* events, size_t* count) {
  if (!(are_given(events, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(events).persisting()); }, count);
}

winnow_status winnow_pair_events_clear(winnow_pair_events* events) {
  if (!(are_given(events))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(events).clear()); });
}

winnow_status winnow_hit_buffer_hits(
    const winnow_hit_buffer* buffer, const winnow_hit** hits, size_t* count) {
  if (!(are_given(buffer, hits, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).hits()); }, hits, count);
}

winnow_status winnow_hit_buffer_queries(const winnow_hit_buffer* buffer, size_t* count) {
  if (!(are_given(buffer, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).queries()); }, count);
}

winnow_status winnow_hit_buffer_of(
    const winnow_hit_buffer* buffer, size_t query, const winnow_hit** hits, size_t* count) {
  if (!(are_given(buffer, hits, count))) return WINNOW_INVALID_ARGUMENT;
  if (!(query < of(buffer).queries())) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).of(query)); }, hits, count);
}

winnow_status winnow_hit_buffer_reserve(winnow_hit_buffer* buffer, size_t count) {
  if (!(are_given(buffer))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).reserve(count)); });
}

winnow_status winnow_hit_buffer_clear(winnow_hit_buffer* buffer) {
  if (!(are_given(buffer))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).clear()); });
}

winnow_status winnow_overlap_buffer_ids(
    const winnow_overlap_buffer* buffer, const uint32_t** ids, size_t* count, size_t* inside) {
  if (!(are_given(buffer, ids, count, inside))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer)); }, ids, count, inside);
}

winnow_status winnow_overlap_buffer_reserve(winnow_overlap_buffer* buffer, size_t count) {
  if (!(are_given(buffer))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).reserve(count)); });
}

winnow_status winnow_overlap_buffer_clear(winnow_overlap_buffer* buffer) {
  if (!(are_given(buffer))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(buffer).clear()); });
}

winnow_status winnow_partition_structure(
    const winnow_partition* partition, winnow_structure_kind* structure) {
  if (!(are_given(partition, structure))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).structure()); }, structure);
}

winnow_status winnow_partition_set_structure(
    winnow_partition* partition, winnow_structure_kind structure) {
  if (!(are_given(partition))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).set_structure(to_cpp(structure))); });
}

winnow_status winnow_partition_choice(
    const winnow_partition* partition, winnow_structure_choice* choice) {
  if (!(are_given(partition) && is_sized(choice))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).choice()); }, choice);
}

winnow_status winnow_partition_is_exact(const winnow_partition* partition, bool* is_exact) {
  if (!(are_given(partition, is_exact))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).is_exact()); }, is_exact);
}

winnow_status winnow_partition_volume(const winnow_partition* partition, winnow_volume* volume) {
  if (!(are_given(partition, volume))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).volume()); }, volume);
}

winnow_status winnow_partition_fat_margin(
    const winnow_partition* partition, winnow_fat_margin* fat_margin) {
  if (!(are_given(partition, fat_margin))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).fat_margin()); }, fat_margin);
}

winnow_status winnow_partition_insert(
    winnow_partition* partition, const winnow_box_view* boxes, const uint64_t* data,
    winnow_key* keys) {
  if (!(are_given(partition, boxes) && is_array(keys, boxes->count))) return WINNOW_INVALID_ARGUMENT;
  BoxView own_boxes;
  if (const Status bad = read_view(*boxes, partition->room, own_boxes); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(partition).insert(own_boxes, span_of(data, boxes->count), as_cpp_span(keys, boxes->count))); });
}

winnow_status winnow_partition_insert_spheres(
    winnow_partition* partition, const winnow_sphere* spheres, size_t count, const uint64_t* data,
    winnow_key* keys) {
  if (!(are_given(partition) && is_array(spheres, count) && is_array(keys, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).insert(as_cpp_span(spheres, count), span_of(data, count), as_cpp_span(keys, count))); });
}

winnow_status winnow_partition_update_spheres(
    winnow_partition* partition, const winnow_key* keys, const winnow_sphere* spheres,
    size_t count) {
  if (!(are_given(partition) && is_array(keys, count) && is_array(spheres, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).update(as_cpp_span(keys, count), as_cpp_span(spheres, count))); });
}

winnow_status winnow_partition_insert_kdops(
    winnow_partition* partition, uint32_t k, const float* kdops, size_t count, const uint64_t* data,
    winnow_key* keys) {
  if (!(are_given(partition) && is_array(kdops, count) && is_array(keys, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (with_kdops(k, span_of(kdops, count), [&](auto given) { return of(partition).insert(given, span_of(data, count), as_cpp_span(keys, count)); })); });
}

winnow_status winnow_partition_update_kdops(
    winnow_partition* partition, uint32_t k, const winnow_key* keys, const float* kdops,
    size_t count) {
  if (!(are_given(partition) && is_array(keys, count) && is_array(kdops, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (with_kdops(k, span_of(kdops, count), [&](auto given) { return of(partition).update(as_cpp_span(keys, count), given); })); });
}

winnow_status winnow_partition_remove(
    winnow_partition* partition, const winnow_key* keys, size_t count) {
  if (!(are_given(partition) && is_array(keys, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).remove(as_cpp_span(keys, count))); });
}

winnow_status winnow_partition_clear(winnow_partition* partition) {
  if (!(are_given(partition))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return ((of(partition).clear(), of(partition).status())); });
}

winnow_status winnow_partition_reserve(
    winnow_partition* partition, size_t objects, winnow_pages pages) {
  Pages own_pages{};
  if (!(are_given(partition) && read(pages, own_pages))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).reserve(objects, own_pages)); });
}

winnow_status winnow_partition_reserve_pairs(
    const winnow_partition* partition, winnow_pair_buffer* out, size_t pairs, winnow_pages pages) {
  Pages own_pages{};
  if (!(are_given(partition, out) && read(pages, own_pages))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).reserve_pairs(of(out), pairs, own_pages)); });
}

winnow_status winnow_partition_reserve_events(
    const winnow_partition* partition, winnow_pair_events* out, size_t pairs, bool with_pairs,
    winnow_pages pages) {
  Pages own_pages{};
  if (!(are_given(partition, out) && read(pages, own_pages))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).reserve_events(of(out), pairs, with_pairs, own_pages)); });
}

winnow_status winnow_partition_size(const winnow_partition* partition, size_t* size) {
  if (!(are_given(partition, size))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).size()); }, size);
}

winnow_status winnow_partition_contains(
    const winnow_partition* partition, winnow_key key, bool* contains) {
  if (!(are_given(partition, contains))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).contains(to_cpp(key))); }, contains);
}

winnow_status winnow_partition_bounds(
    const winnow_partition* partition, winnow_key key, winnow_aabb* box) {
  if (!(are_given(partition, box))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).bounds(to_cpp(key))); }, box);
}

winnow_status winnow_partition_bounds_of(
    const winnow_partition* partition, const winnow_key* keys, winnow_aabb* boxes, size_t count) {
  if (!(are_given(partition) && is_array(keys, count) && is_array(boxes, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).bounds(as_cpp_span(keys, count), as_cpp_span(boxes, count))); });
}

winnow_status winnow_partition_client_data(
    const winnow_partition* partition, winnow_key key, uint64_t* data) {
  if (!(are_given(partition, data))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(partition).contains(to_cpp(key)))) return WINNOW_INVALID_KEY;
  return give([&]() -> decltype(auto) { return (of(partition).client_data(to_cpp(key))); }, data);
}

winnow_status winnow_partition_key_of(
    const winnow_partition* partition, uint32_t id, winnow_key* key) {
  if (!(are_given(partition, key))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).key_of(id)); }, key);
}

winnow_status winnow_partition_client_data_of(
    const winnow_partition* partition, uint32_t id, uint64_t* data) {
  if (!(are_given(partition, data))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).client_data_of(id)); }, data);
}

winnow_status winnow_partition_set_filter(
    winnow_partition* partition, const winnow_key* keys, const winnow_object_filter* filters,
    size_t count) {
  if (!(are_given(partition) && is_array(keys, count) && is_array(filters, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).set_filter(as_cpp_span(keys, count), as_cpp_span(filters, count))); });
}

winnow_status winnow_partition_filter(
    const winnow_partition* partition, winnow_key key, winnow_object_filter* filter) {
  if (!(are_given(partition, filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).filter(to_cpp(key))); }, filter);
}

winnow_status winnow_partition_refresh(const winnow_partition* partition) {
  if (!(are_given(partition))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).refresh()); });
}

winnow_status winnow_partition_pairs_with(
    const winnow_partition* partition, const winnow_partition* other, winnow_pair_buffer* out,
    const winnow_pair_options* options) {
  PairOptions own_options{};
  if (!(are_given(partition, other, out) && read(options, own_options))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).pairs_with(of(other), of(out), own_options)); });
}

winnow_status winnow_partition_closest(
    const winnow_partition* partition, const winnow_cast* cast, const winnow_filter* filter,
    winnow_hit* hit) {
  Cast own_cast{};
  Filter own_filter{};
  if (!(are_given(partition, cast, hit) && read(cast, own_cast) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).closest(own_cast, own_filter)); }, hit);
}

winnow_status winnow_partition_any(
    const winnow_partition* partition, const winnow_cast* cast, const winnow_filter* filter,
    winnow_hit* hit) {
  Cast own_cast{};
  Filter own_filter{};
  if (!(are_given(partition, cast, hit) && read(cast, own_cast) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).any(own_cast, own_filter)); }, hit);
}

winnow_status winnow_partition_all(
    const winnow_partition* partition, const winnow_cast* cast, const winnow_filter* filter,
    winnow_hit_buffer* hits) {
  Cast own_cast{};
  Filter own_filter{};
  if (!(are_given(partition, cast, hits) && read(cast, own_cast) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).all(own_cast, of(hits), own_filter)); });
}

winnow_status winnow_partition_closest_rays(
    const winnow_partition* partition, const winnow_ray_batch* rays, const winnow_filter* filter,
    const winnow_hit_columns* hits) {
  RayBatch own_rays{};
  Filter own_filter{};
  HitColumns own_hits{};
  if (!(are_given(partition, rays, hits) && read(rays, own_rays) && read(filter, own_filter) && read(hits, own_hits))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).closest(own_rays, own_hits, own_filter)); });
}

winnow_status winnow_partition_any_rays(
    const winnow_partition* partition, const winnow_ray_batch* rays, const winnow_filter* filter,
    const winnow_hit_columns* hits) {
  RayBatch own_rays{};
  Filter own_filter{};
  HitColumns own_hits{};
  if (!(are_given(partition, rays, hits) && read(rays, own_rays) && read(filter, own_filter) && read(hits, own_hits))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).any(own_rays, own_hits, own_filter)); });
}

winnow_status winnow_partition_all_rays(
    const winnow_partition* partition, const winnow_ray_batch* rays, const winnow_filter* filter,
    winnow_hit_buffer* hits) {
  RayBatch own_rays{};
  Filter own_filter{};
  if (!(are_given(partition, rays, hits) && read(rays, own_rays) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).all(own_rays, of(hits), own_filter)); });
}

winnow_status winnow_partition_overlap(
    const winnow_partition* partition, const winnow_region* region, const winnow_filter* filter,
    winnow_order order, winnow_overlap_buffer* objects) {
  Region own_region{};
  Filter own_filter{};
  Order own_order{};
  if (!(are_given(partition, region, objects) && read(region, own_region) && read(filter, own_filter) && read(order, own_order))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).overlap(own_region, of(objects), own_filter, own_order)); });
}

winnow_status winnow_partition_overlap_boxes(
    const winnow_partition* partition, const winnow_box_view* boxes, const winnow_filter* filter,
    winnow_order order, winnow_pair_buffer* out) {
  Filter own_filter{};
  Order own_order{};
  if (!(are_given(partition, boxes, out) && read(filter, own_filter) && read(order, own_order))) return WINNOW_INVALID_ARGUMENT;
  BoxView own_boxes;
  if (const Status bad = read_view(*boxes, out->room, own_boxes); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(partition).overlap(own_boxes, of(out), own_filter, own_order)); });
}

winnow_status winnow_partition_nearest(
    const winnow_partition* partition, const winnow_aabb* from, size_t count, float radius,
    const winnow_filter* filter, winnow_hit_buffer* hits) {
  Filter own_filter{};
  if (!(are_given(partition, from, hits) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).nearest((*as_cpp(from)), count, radius, of(hits), own_filter)); });
}

winnow_status winnow_partition_debug_draw(
    const winnow_partition* partition, const winnow_debug_draw* draw,
    const winnow_debug_draw_options* options) {
  CallbackDraw own_draw{};
  DebugDrawOptions own_options{};
  if (!(are_given(partition, draw) && read(draw, own_draw) && read(options, own_options))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).debug_draw(own_draw, own_options)); });
}

winnow_status winnow_partition_statistics(
    const winnow_partition* partition, winnow_statistics* statistics) {
  if (!(are_given(partition) && is_sized(statistics))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(partition).statistics()); }, statistics);
}

winnow_status winnow_pair_buffer_footprint(
    const winnow_pair_buffer* buffer, winnow_footprint* footprint) {
  if (!(are_given(buffer) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(buffer, footprint);
}

winnow_status winnow_pair_events_footprint(
    const winnow_pair_events* events, winnow_footprint* footprint) {
  if (!(are_given(events) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(events, footprint);
}

winnow_status winnow_hit_buffer_footprint(
    const winnow_hit_buffer* buffer, winnow_footprint* footprint) {
  if (!(are_given(buffer) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(buffer, footprint);
}

winnow_status winnow_overlap_buffer_footprint(
    const winnow_overlap_buffer* buffer, winnow_footprint* footprint) {
  if (!(are_given(buffer) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(buffer, footprint);
}

winnow_status winnow_partition_footprint(
    const winnow_partition* partition, winnow_footprint* footprint) {
  if (!(are_given(partition) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(partition, footprint);
}
