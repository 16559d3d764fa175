// C binding of the result buffers of partitions (buffer functions of partition.h).

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"

using namespace winnow::c;

winnow_status winnow_pair_buffer_create(const winnow_memory* memory, winnow_pair_buffer** buffer) {
  return create(memory, buffer);
}

void winnow_pair_buffer_destroy(winnow_pair_buffer* buffer) {
  destroy(buffer);
}

winnow_status winnow_pair_buffer_pairs(const winnow_pair_buffer* buffer, const winnow_pair** pairs,
                                       size_t* count) {
  if (!are_given(buffer, pairs, count)) return WINNOW_INVALID_ARGUMENT;
  return_array(buffer->value.pairs(), pairs, count);
  return WINNOW_OK;
}

winnow_status winnow_pair_buffer_reserve(winnow_pair_buffer* buffer, size_t count,
                                         winnow_pages pages) {
  winnow::Pages touch{};
  if (buffer == nullptr || !read_choice(pages, winnow::Pages::prefaulted, touch)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return buffer->value.reserve(count, touch) ? WINNOW_OK : WINNOW_OUT_OF_MEMORY;
}

winnow_status winnow_pair_buffer_assign(winnow_pair_buffer* buffer,
                                        const winnow_pair_buffer* other) {
  if (!are_given(buffer, other)) return WINNOW_INVALID_ARGUMENT;
  if (buffer == other) return WINNOW_OK;
  return buffer->value.assign(other->value) ? WINNOW_OK : WINNOW_OUT_OF_MEMORY;
}

winnow_status winnow_pair_buffer_clear(winnow_pair_buffer* buffer) {
  if (buffer == nullptr) return WINNOW_INVALID_ARGUMENT;
  buffer->value.clear();
  return WINNOW_OK;
}

winnow_status winnow_pair_buffer_release(winnow_pair_buffer* buffer) {
  if (buffer == nullptr) return WINNOW_INVALID_ARGUMENT;
  buffer->value.release();
  buffer->room.release();
  return WINNOW_OK;
}

winnow_status winnow_pair_buffer_footprint(const winnow_pair_buffer* buffer,
                                           winnow_footprint* footprint) {
  if (buffer == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(buffer, buffer->value.footprint(), buffer->room.bytes(), footprint);
}

winnow_status winnow_pair_events_create(const winnow_memory* memory, winnow_pair_events** events) {
  return create(memory, events);
}

winnow_status winnow_pair_events_create_with_client_data(const winnow_memory* memory,
                                                         winnow_pair_events** events) {
  return create(memory, events, true);
}

void winnow_pair_events_destroy(winnow_pair_events* events) {
  destroy(events);
}

winnow_status winnow_pair_events_begun(const winnow_pair_events* events,
                                       const winnow_key_pair** pairs, size_t* count) {
  if (!are_given(events, pairs, count)) return WINNOW_INVALID_ARGUMENT;
  return_array(events->value.begun(), pairs, count);
  return WINNOW_OK;
}

winnow_status winnow_pair_events_ended(const winnow_pair_events* events,
                                       const winnow_key_pair** pairs, size_t* count) {
  if (!are_given(events, pairs, count)) return WINNOW_INVALID_ARGUMENT;
  return_array(events->value.ended(), pairs, count);
  return WINNOW_OK;
}

winnow_status winnow_pair_events_begun_data(const winnow_pair_events* events,
                                            const winnow_client_data_pair** data, size_t* count) {
  if (!are_given(events, data, count)) return WINNOW_INVALID_ARGUMENT;
  return_array(events->value.begun_data(), data, count);
  return WINNOW_OK;
}

winnow_status winnow_pair_events_ended_data(const winnow_pair_events* events,
                                            const winnow_client_data_pair** data, size_t* count) {
  if (!are_given(events, data, count)) return WINNOW_INVALID_ARGUMENT;
  return_array(events->value.ended_data(), data, count);
  return WINNOW_OK;
}

winnow_status winnow_pair_events_persisting(const winnow_pair_events* events, size_t* count) {
  if (!are_given(events, count)) return WINNOW_INVALID_ARGUMENT;
  *count = events->value.persisting();
  return WINNOW_OK;
}

winnow_status winnow_pair_events_clear(winnow_pair_events* events) {
  if (events == nullptr) return WINNOW_INVALID_ARGUMENT;
  events->value.clear();
  return WINNOW_OK;
}

winnow_status winnow_pair_events_footprint(const winnow_pair_events* events,
                                           winnow_footprint* footprint) {
  if (events == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(events, events->value.footprint(), {}, footprint);
}

winnow_status winnow_hit_buffer_create(const winnow_memory* memory, winnow_hit_buffer** buffer) {
  return create(memory, buffer);
}

void winnow_hit_buffer_destroy(winnow_hit_buffer* buffer) {
  destroy(buffer);
}

winnow_status winnow_hit_buffer_hits(const winnow_hit_buffer* buffer, const winnow_hit** hits,
                                     size_t* count) {
  if (!are_given(buffer, hits, count)) return WINNOW_INVALID_ARGUMENT;
  return_array(buffer->value.hits(), hits, count);
  return WINNOW_OK;
}

winnow_status winnow_hit_buffer_queries(const winnow_hit_buffer* buffer, size_t* count) {
  if (!are_given(buffer, count)) return WINNOW_INVALID_ARGUMENT;
  *count = buffer->value.queries();
  return WINNOW_OK;
}

winnow_status winnow_hit_buffer_of(const winnow_hit_buffer* buffer, size_t query,
                                   const winnow_hit** hits, size_t* count) {
  if (!are_given(buffer, hits, count) || query >= buffer->value.queries()) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return_array(buffer->value.of(query), hits, count);
  return WINNOW_OK;
}

winnow_status winnow_hit_buffer_reserve(winnow_hit_buffer* buffer, size_t count) {
  if (buffer == nullptr) return WINNOW_INVALID_ARGUMENT;
  return buffer->value.reserve(count) ? WINNOW_OK : WINNOW_OUT_OF_MEMORY;
}

winnow_status winnow_hit_buffer_clear(winnow_hit_buffer* buffer) {
  if (buffer == nullptr) return WINNOW_INVALID_ARGUMENT;
  buffer->value.clear();
  return WINNOW_OK;
}

winnow_status winnow_hit_buffer_footprint(const winnow_hit_buffer* buffer,
                                          winnow_footprint* footprint) {
  if (buffer == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(buffer, buffer->value.footprint(), {}, footprint);
}

winnow_status winnow_overlap_buffer_create(const winnow_memory* memory,
                                           winnow_overlap_buffer** buffer) {
  return create(memory, buffer);
}

void winnow_overlap_buffer_destroy(winnow_overlap_buffer* buffer) {
  destroy(buffer);
}

winnow_status winnow_overlap_buffer_ids(const winnow_overlap_buffer* buffer, const uint32_t** ids,
                                        size_t* count, size_t* inside) {
  if (!are_given(buffer, ids, count, inside)) return WINNOW_INVALID_ARGUMENT;
  return_array(buffer->value.ids(), ids, count);
  *inside = buffer->value.inside().size();
  return WINNOW_OK;
}

winnow_status winnow_overlap_buffer_reserve(winnow_overlap_buffer* buffer, size_t count) {
  if (buffer == nullptr) return WINNOW_INVALID_ARGUMENT;
  return buffer->value.reserve(count) ? WINNOW_OK : WINNOW_OUT_OF_MEMORY;
}

winnow_status winnow_overlap_buffer_clear(winnow_overlap_buffer* buffer) {
  if (buffer == nullptr) return WINNOW_INVALID_ARGUMENT;
  buffer->value.clear();
  return WINNOW_OK;
}

winnow_status winnow_overlap_buffer_footprint(const winnow_overlap_buffer* buffer,
                                              winnow_footprint* footprint) {
  if (buffer == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(buffer, buffer->value.footprint(), {}, footprint);
}
