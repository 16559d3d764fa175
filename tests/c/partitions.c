/* Uses in C every call about partitions and their buffers. */

#include <math.h>

#include "tests/c/check.h"
#include "tests/c/world.h"

/* Runs the tasks of winnow on the calling thread, the last one first. */
static void backwards(void* context, size_t count, void (*task)(void*, size_t), void* tasks) {
  ++*(size_t*)context;
  for (size_t i = count; i-- > 0;) task(tasks, i);
}

static bool is_even(void* context, winnow_key key, uint64_t data) {
  (void)context;
  (void)data;
  return key.id % 2 == 0;
}

static bool sum_is_even(void* context, uint32_t first, uint32_t second) {
  (void)context;
  return (first + second) % 2 == 0;
}

static void note_pairs(const trace* t, const char* what, const winnow_pair_buffer* buffer) {
  const winnow_pair* pairs = NULL;
  size_t count = 0;
  OK(winnow_pair_buffer_pairs(buffer, &pairs, &count));
  note(t, what, count);
  for (size_t i = 0; i < count; ++i) {
    note(t, what, pairs[i].first);
    note(t, what, pairs[i].second);
  }
}

static void note_key_pairs(const trace* t, const char* what, const winnow_key_pair* pairs,
                           size_t count) {
  note(t, what, count);
  for (size_t i = 0; i < count; ++i) {
    note(t, what, pairs[i].first.id);
    note(t, what, pairs[i].second.id);
  }
}

static void note_data_pairs(const trace* t, const char* what, const winnow_client_data_pair* pairs,
                            size_t count) {
  note(t, what, count);
  for (size_t i = 0; i < count; ++i) {
    note(t, what, pairs[i].first);
    note(t, what, pairs[i].second);
  }
}

static void note_hit(const trace* t, const char* what, const winnow_hit* hit) {
  note(t, what, hit->key.id);
  note(t, what, hit->data);
  note_real(t, what, (double)hit->t);
}

static void note_hits(const trace* t, const char* what, const winnow_hit_buffer* buffer) {
  const winnow_hit* hits = NULL;
  size_t count = 0;
  OK(winnow_hit_buffer_hits(buffer, &hits, &count));
  note(t, what, count);
  for (size_t i = 0; i < count; ++i) note_hit(t, what, &hits[i]);
}

/* Columns of double, and an array of float boxes. */
static double columns[6][kObjects];
static winnow_aabb boxes[kObjects];
static uint64_t data[kObjects];
static winnow_key keys[kObjects];

static void fill_columns(size_t frame) {
  for (size_t i = 0; i < kObjects; ++i) {
    double box[6];
    box_of(i, frame, box);
    for (size_t k = 0; k < 6; ++k) columns[k][i] = box[k];
    winnow_aabb_outward(box, box + 3, NULL, &boxes[i]);
    data[i] = data_of(i);
  }
}

static winnow_box_view column_view(void) {
  winnow_box_view view = {{columns[0], columns[1], columns[2]},
                          {columns[3], columns[4], columns[5]},
                          0,
                          kObjects,
                          WINNOW_DOUBLE};
  return view;
}

static void query_objects(const trace* t, winnow_partition* partition) {
  size_t size = 0;
  OK(winnow_partition_size(partition, &size));
  note(t, "size", size);
  winnow_aabb stored[kObjects];
  OK(winnow_partition_bounds_of(partition, keys, stored, kObjects));
  for (size_t i = 0; i < kObjects; ++i) note_real(t, "bounds of all", (double)stored[i].max[0]);
  for (size_t i = 0; i < kObjects; i += 7) {
    bool contains = false;
    winnow_aabb box;
    uint64_t value = 0;
    winnow_key key;
    OK(winnow_partition_contains(partition, keys[i], &contains));
    OK(winnow_partition_bounds(partition, keys[i], &box));
    OK(winnow_partition_client_data(partition, keys[i], &value));
    OK(winnow_partition_key_of(partition, (uint32_t)i, &key));
    note(t, "contains", contains);
    for (int axis = 0; axis < 3; ++axis) {
      note_real(t, "bounds", (double)box.min[axis]);
      note_real(t, "bounds", (double)box.max[axis]);
    }
    note(t, "data", value);
    note(t, "key", key.id == keys[i].id && key.stamp == keys[i].stamp);
  }
  winnow_object_filter filters[2] = {{2U, 3U, 0U}, {1U, 1U, 5U}};
  winnow_object_filter filter = WINNOW_OBJECT_FILTER;
  OK(winnow_partition_set_filter(partition, keys + 3, filters, 2));
  OK(winnow_partition_filter(partition, keys[4], &filter));
  note(t, "filter", filter.environment);
}

static void query_pairs(const trace* t, winnow_partition* partition, const winnow_memory* memory) {
  winnow_pair_buffer* pairs = NULL;
  winnow_pair_buffer* copy = NULL;
  winnow_pair_events* events = NULL;
  winnow_pair_events* plain = NULL;
  winnow_pair_options options = WINNOW_PAIR_OPTIONS;
  const winnow_key_pair* changed = NULL;
  const winnow_client_data_pair* changed_data = NULL;
  size_t count = 0;
  OK(winnow_pair_buffer_create(memory, &pairs));
  OK(winnow_pair_buffer_create(memory, &copy));
  OK(winnow_pair_events_create_with_client_data(memory, &events));
  OK(winnow_pair_events_create(memory, &plain));
  OK(winnow_partition_reserve_pairs(partition, pairs, 1000, WINNOW_PAGES_TOUCHED));
  OK(winnow_partition_reserve_events(partition, events, 1000, false, WINNOW_PAGES_TOUCHED));
  OK(winnow_partition_reserve_events(partition, plain, 1000, true, WINNOW_PAGES_UNTOUCHED));
  OK(winnow_pair_buffer_reserve(copy, 1000, WINNOW_PAGES_UNTOUCHED));
  options.order = WINNOW_ORDER_CANONICAL;
  OK(winnow_partition_self_pairs(partition, pairs, NULL, &options));
  note_pairs(t, "self_pairs", pairs);
  options.accept = sum_is_even;
  options.anew = 1;
  OK(winnow_partition_self_pairs(partition, copy, NULL, &options));
  note_pairs(t, "accepted pairs", copy);

  OK(winnow_pair_buffer_clear(pairs));
  OK(winnow_partition_self_pairs(partition, pairs, events, NULL));
  fill_columns(1);
  const uint32_t listed[4] = {1, 4, 100, 199};
  const uint64_t masked[4] = {0x10, 0, 0x5, 0};
  const winnow_entries list = {listed, NULL, 4};
  const winnow_entries mask = {NULL, masked, 4};
  winnow_box_view view = column_view();
  OK(winnow_partition_update(partition, keys, kObjects, &view, &list));
  OK(winnow_partition_update(partition, keys, kObjects, &view, &mask));
  OK(winnow_partition_self_pairs(partition, pairs, events, NULL));
  OK(winnow_pair_events_begun(events, &changed, &count));
  note_key_pairs(t, "begun", changed, count);
  OK(winnow_pair_events_ended(events, &changed, &count));
  note_key_pairs(t, "ended", changed, count);
  OK(winnow_pair_events_begun_data(events, &changed_data, &count));
  note_data_pairs(t, "data of begun", changed_data, count);
  OK(winnow_pair_events_ended_data(events, &changed_data, &count));
  note_data_pairs(t, "data of ended", changed_data, count);
  OK(winnow_pair_events_persisting(events, &count));
  note(t, "persisting", count);
  OK(winnow_pair_events_clear(events));
  OK(winnow_partition_self_pairs(partition, NULL, events, NULL));
  OK(winnow_pair_events_begun(events, &changed, &count));
  note_key_pairs(t, "all begun", changed, count);
  OK(winnow_partition_self_pairs(partition, NULL, plain, NULL));
  OK(winnow_pair_events_begun_data(plain, &changed_data, &count));
  note_data_pairs(t, "data without the option", changed_data, count);

  view = winnow_boxes(boxes, kObjects);
  OK(winnow_partition_update(partition, keys, kObjects, &view, NULL));
  options.accept = NULL;
  OK(winnow_partition_self_pairs(partition, pairs, NULL, &options));
  OK(winnow_pair_buffer_assign(copy, pairs));
  note_pairs(t, "assigned", copy);
  winnow_footprint bytes = {.size = sizeof bytes};
  OK(winnow_pair_buffer_footprint(pairs, &bytes));
  note(t, "pairs take memory", bytes.results.used > 0);
  OK(winnow_pair_events_footprint(events, &bytes));
  note(t, "events take memory", bytes.results.used > 0);
  OK(winnow_pair_buffer_release(copy));
  winnow_pair_events_destroy(plain);
  winnow_pair_events_destroy(events);
  winnow_pair_buffer_destroy(copy);
  winnow_pair_buffer_destroy(pairs);
}

static void query_casts(const trace* t, const winnow_partition* partition,
                      const winnow_memory* memory) {
  winnow_hit_buffer* hits = NULL;
  winnow_hit hit;
  winnow_filter filter = WINNOW_FILTER;
  filter.accept = is_even;
  OK(winnow_hit_buffer_create(memory, &hits));
  OK(winnow_hit_buffer_reserve(hits, 100));
  const winnow_cast casts[4] = {
      {WINNOW_CAST_RAY, {.origin = {-1.0F, 5.0F, 5.0F}}, {1.0F, 0.1F, 0.0F}, 0.0F, 100.0F},
      {WINNOW_CAST_BOX, {.box = {{-1, 5, 5}, {0, 6, 6}}}, {1.0F, 0.1F, 0.0F}, 0.0F, 100.0F},
      {WINNOW_CAST_SPHERE, {.sphere = {{-1, 5, 5}, 0.5F}}, {1.0F, 0.1F, 0.0F}, 0.0F, 100.0F},
      {WINNOW_CAST_CAPSULE,
       {.capsule = {{-1, 5, 5}, {-1, 7, 5}, 0.5F}},
       {1.0F, 0.1F, 0.0F},
       0.0F,
       100.0F}};
  for (size_t i = 0; i < 4; ++i) {
    OK(winnow_partition_closest(partition, &casts[i], NULL, &hit));
    note_hit(t, "closest", &hit);
    OK(winnow_partition_closest(partition, &casts[i], &filter, &hit));
    note_hit(t, "closest even", &hit);
    OK(winnow_partition_any(partition, &casts[i], NULL, &hit));
    note(t, "any", hit.key.id != WINNOW_NO_OBJECT);
    OK(winnow_partition_all(partition, &casts[i], NULL, hits));
    note_hits(t, "all", hits);
  }
  float rays[8][10];
  for (size_t i = 0; i < 10; ++i) {
    rays[0][i] = -1.0F;
    rays[1][i] = rays[2][i] = (float)i;
    rays[3][i] = 1.0F;
    rays[4][i] = rays[5][i] = 0.1F;
    rays[6][i] = 0.5F;
    rays[7][i] = 50.0F;
  }
  const winnow_ray_batch batch = {
      {rays[0], rays[1], rays[2]}, {rays[3], rays[4], rays[5]}, rays[6], rays[7], 10, 0};
  winnow_key key[10];
  uint64_t value[10];
  float at[10];
  const winnow_hit_columns found = {key, value, at};
  OK(winnow_partition_closest_rays(partition, &batch, NULL, &found));
  for (size_t i = 0; i < 10; ++i) {
    note(t, "closest of rays", key[i].id);
    note(t, "closest of rays", value[i]);
    note_real(t, "closest of rays", (double)at[i]);
  }
  OK(winnow_partition_any_rays(partition, &batch, NULL, &found));
  for (size_t i = 0; i < 10; ++i) note(t, "any of rays", key[i].id != WINNOW_NO_OBJECT);
  OK(winnow_partition_all_rays(partition, &batch, NULL, hits));
  size_t questions = 0;
  OK(winnow_hit_buffer_queries(hits, &questions));
  note(t, "questions", questions);
  for (size_t i = 0; i < questions; ++i) {
    const winnow_hit* of = NULL;
    size_t count = 0;
    OK(winnow_hit_buffer_of(hits, i, &of, &count));
    note(t, "all of rays", count);
    if (count > 0) note_hit(t, "all of rays", of);
  }
  const winnow_aabb from = {{7, 3, 2}, {7, 3, 2}};
  OK(winnow_partition_nearest(partition, &from, 8, 50.0F, &filter, hits));
  note_hits(t, "nearest", hits);
  winnow_footprint bytes = {.size = sizeof bytes};
  OK(winnow_hit_buffer_footprint(hits, &bytes));
  note(t, "hits take memory", bytes.results.used > 0);
  OK(winnow_hit_buffer_clear(hits));
  winnow_hit_buffer_destroy(hits);
}

static void query_regions(const trace* t, const winnow_partition* partition,
                        const winnow_memory* memory) {
  winnow_overlap_buffer* found = NULL;
  winnow_pair_buffer* pairs = NULL;
  OK(winnow_overlap_buffer_create(memory, &found));
  OK(winnow_overlap_buffer_reserve(found, 100));
  OK(winnow_pair_buffer_create(memory, &pairs));
  const winnow_plane planes[2] = {{{1, 0, 0}, -4}, {{0, 1, 0}, -4}};
  winnow_region regions[7] = {
      {WINNOW_REGION_POINT, {.point = {5, 5, 5}}},
      {WINNOW_REGION_BOX, {.box = {{2, 2, 2}, {9, 9, 9}}}},
      {WINNOW_REGION_ORIENTED_BOX,
       {.oriented_box = {{5, 5, 5}, {4, 3, 2}, {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}}}},
      {WINNOW_REGION_SPHERE, {.sphere = {{5, 5, 5}, 4}}},
      {WINNOW_REGION_CAPSULE, {.capsule = {{5, 5, 5}, {9, 5, 5}, 3}}},
      {WINNOW_REGION_FRUSTUM, {{0}}},
      {WINNOW_REGION_PLANES, {{0}}}};
  const float eye[3] = {10, 10, 60};
  const float ahead[3] = {0, 0, -1};
  const float up[3] = {0, 1, 0};
  OK(winnow_frustum_perspective(eye, ahead, up, 0.4F, 1.5F, 0.1F, 100.0F, &regions[5].of.frustum));
  regions[6].of.planes.planes = planes;
  regions[6].of.planes.count = 2;
  for (size_t i = 0; i < 7; ++i) {
    const uint32_t* ids = NULL;
    size_t count = 0;
    size_t inside = 0;
    OK(winnow_partition_overlap(partition, &regions[i], NULL, WINNOW_ORDER_CANONICAL, found));
    OK(winnow_overlap_buffer_ids(found, &ids, &count, &inside));
    note(t, "overlap", count);
    note(t, "inside", inside);
    for (size_t k = 0; k < count; ++k) note(t, "overlap", ids[k]);
  }
  const winnow_box_view all = column_view();
  OK(winnow_partition_overlap_boxes(partition, &all, NULL, WINNOW_ORDER_CANONICAL, pairs));
  note_pairs(t, "overlap of boxes", pairs);
  winnow_footprint bytes = {.size = sizeof bytes};
  OK(winnow_overlap_buffer_footprint(found, &bytes));
  note(t, "overlaps take memory", bytes.results.used > 0);
  OK(winnow_overlap_buffer_clear(found));
  winnow_pair_buffer_destroy(pairs);
  winnow_overlap_buffer_destroy(found);
}

static void count_box(void* context, const winnow_aabb* box, winnow_colour colour) {
  (void)box;
  *(size_t*)context += colour.a;
}
static void count_line(void* context, const float from[3], const float to[3],
                       winnow_colour colour) {
  (void)from;
  (void)to;
  *(size_t*)context += colour.a;
}
static void count_sphere(void* context, const winnow_sphere* sphere, winnow_colour colour) {
  (void)sphere;
  *(size_t*)context += colour.a;
}
static void count_text(void* context, const float at[3], const char* text, size_t length,
                       winnow_colour colour) {
  (void)at;
  (void)text;
  (void)colour;
  *(size_t*)context += length;
}

static void query_state(const trace* t, winnow_partition* partition) {
  OK(winnow_partition_refresh(partition));
  bool is_exact = false;
  winnow_volume volume = -1;
  winnow_fat_margin fat_margin = {-1, -1};
  winnow_structure_kind structure = {-1, 0};
  winnow_structure_choice choice = {.size = sizeof choice};
  winnow_statistics statistics = {.size = sizeof statistics};
  OK(winnow_partition_is_exact(partition, &is_exact));
  OK(winnow_partition_volume(partition, &volume));
  OK(winnow_partition_fat_margin(partition, &fat_margin));
  OK(winnow_partition_structure(partition, &structure));
  OK(winnow_partition_choice(partition, &choice));
  OK(winnow_partition_statistics(partition, &statistics));
  note(t, "is_exact", is_exact);
  note(t, "volume", (uint64_t)volume);
  note_real(t, "margin", (double)(fat_margin.distance + fat_margin.share));
  note(t, "structure", strcmp(winnow_structure_name(structure), "SweepAndPrune") == 0);
  note(t, "choice", strlen(choice.reason));
  note(t, "statistics", statistics.objects);
  note(t, "statistics", statistics.cells);
  note(t, "statistics", statistics.builds);
  size_t drawn = 0;
  const winnow_debug_draw draw = {&drawn, count_box, count_line, count_sphere, count_text};
  winnow_debug_draw_options options = WINNOW_DEBUG_DRAW_OPTIONS;
  options.labels = 1;
  OK(winnow_partition_debug_draw(partition, &draw, &options));
  note(t, "drawn", drawn);
}

void run_partitions_in_c(const trace* t) {
  size_t outstanding = 0;
  size_t tasks = 0;
  const winnow_memory memory = counted_in(&outstanding);
  winnow_partition* partition = NULL;
  winnow_partition* other = NULL;
  winnow_partition_options options = WINNOW_PARTITION_OPTIONS;
  winnow_structure_kind structure = {WINNOW_LOOSE_OCTREE, 3.0F};
  options.memory = &memory;
  options.execution.kind = WINNOW_EXECUTION_ON;
  options.execution.jobs.parallel_for = backwards;
  options.execution.jobs.context = &tasks;
  options.execution.jobs.threads = 2;
  OK(winnow_partition_create(structure, &options, &partition));
  OK(winnow_structure_named("SweepAndPrune", &structure));
  OK(winnow_partition_set_structure(partition, structure));
  OK(winnow_partition_reserve(partition, kObjects, WINNOW_PAGES_TOUCHED));
  fill_columns(0);
  winnow_box_view view = column_view();
  OK(winnow_partition_insert(partition, &view, data, keys));
  query_objects(t, partition);
  query_pairs(t, partition, &memory);
  query_casts(t, partition, &memory);
  query_regions(t, partition, &memory);
  query_state(t, partition);

  const winnow_structure_kind bvh = {WINNOW_LINEAR_BVH, 0.0F};
  OK(winnow_partition_create(bvh, NULL, &other));
  winnow_key others[3];
  view = winnow_boxes(boxes, 3);
  OK(winnow_partition_insert(other, &view, NULL, others));
  winnow_pair_buffer* pairs = NULL;
  winnow_pair_options canonical = WINNOW_PAIR_OPTIONS;
  canonical.order = WINNOW_ORDER_CANONICAL;
  OK(winnow_pair_buffer_create(NULL, &pairs));
  OK(winnow_partition_pairs_with(partition, other, pairs, &canonical));
  note_pairs(t, "pairs_with", pairs);
  OK(winnow_partition_remove(partition, keys, 10));
  OK(winnow_partition_self_pairs(partition, pairs, NULL, &canonical));
  note_pairs(t, "after removal", pairs);
  winnow_pair_buffer_destroy(pairs);
  winnow_partition_destroy(other);

  winnow_footprint bytes = {.size = sizeof bytes};
  OK(winnow_partition_footprint(partition, &bytes));
  note(t, "the footprint equals the allocated memory", reserved_of(&bytes) == outstanding);
  OK(winnow_partition_clear(partition));
  OK(winnow_partition_release_memory(partition));
  OK(winnow_partition_footprint(partition, &bytes));
  note(t, "the footprint equals the remaining memory", reserved_of(&bytes) == outstanding);
  winnow_partition_destroy(partition);
  note(t, "outstanding", outstanding);
}

void run_volumes_in_c(const trace* t) {
  winnow_threads* threads = NULL;
  winnow_partition_options options = WINNOW_PARTITION_OPTIONS;
  winnow_pair_options canonical = WINNOW_PAIR_OPTIONS;
  canonical.order = WINNOW_ORDER_CANONICAL;
  winnow_pair_buffer* pairs = NULL;
  OK(winnow_pair_buffer_create(NULL, &pairs));
  OK(winnow_threads_create(1, &threads));
  OK(winnow_threads_execution(threads, &options.execution));

  options.volume = WINNOW_VOLUME_SPHERE;
  winnow_partition* spheres = NULL;
  winnow_sphere balls[kSpheres];
  winnow_key ball_keys[kSpheres];
  for (size_t i = 0; i < kSpheres; ++i) {
    double box[6];
    box_of(i, 0, box);
    for (int axis = 0; axis < 3; ++axis) balls[i].center[axis] = (float)box[axis];
    balls[i].radius = 1.5F;
  }
  const winnow_structure_kind grid = {WINNOW_FLAT_GRID, 0.0F};
  OK(winnow_partition_create(grid, &options, &spheres));
  OK(winnow_partition_insert_spheres(spheres, balls, kSpheres, data, ball_keys));
  OK(winnow_partition_self_pairs(spheres, pairs, NULL, &canonical));
  note_pairs(t, "spheres", pairs);
  for (size_t i = 0; i < kSpheres; ++i) balls[i].radius = 2.0F;
  OK(winnow_partition_update_spheres(spheres, ball_keys, balls, kSpheres));
  OK(winnow_partition_self_pairs(spheres, pairs, NULL, &canonical));
  note_pairs(t, "larger spheres", pairs);
  winnow_partition_destroy(spheres);

  const winnow_volume volumes[3] = {WINNOW_VOLUME_KDOP14, WINNOW_VOLUME_KDOP18,
                                    WINNOW_VOLUME_KDOP26};
  const uint32_t faces[3] = {14, 18, 26};
  for (size_t v = 0; v < 3; ++v) {
    winnow_partition* kdops = NULL;
    float slabs[kSpheres * 26];
    options.volume = volumes[v];
    for (size_t i = 0; i < kSpheres; ++i) {
      winnow_oriented_box turned = {
          {0, 0, 0}, {1, 1, 1}, {{0.6F, 0.8F, 0}, {-0.8F, 0.6F, 0}, {0, 0, 1}}};
      for (int axis = 0; axis < 3; ++axis) turned.center[axis] = balls[i].center[axis];
      OK(winnow_kdop_around(faces[v], &turned, slabs + i * faces[v]));
    }
    OK(winnow_partition_create(grid, &options, &kdops));
    OK(winnow_partition_insert_kdops(kdops, faces[v], slabs, kSpheres, NULL, ball_keys));
    OK(winnow_partition_update_kdops(kdops, faces[v], ball_keys, slabs, kSpheres));
    OK(winnow_partition_self_pairs(kdops, pairs, NULL, &canonical));
    note_pairs(t, "kdops", pairs);
    winnow_partition_destroy(kdops);
  }
  winnow_pair_buffer_destroy(pairs);
  winnow_threads_destroy(threads);

  double matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -0.2, 0, 0, -1, 0};
  winnow_frustum frustum;
  OK(winnow_frustum_from_matrix(matrix, WINNOW_NEAR_DEPTH_ZERO, &frustum));
  for (int i = 0; i < 6; ++i) note_real(t, "frustum", (double)frustum.planes[i].offset);

  note(t, "version", winnow_version());
  note(t, "abi", winnow_abi());
  note(t, "version name", strlen(winnow_version_name()));
  note(t, "isa", winnow_available_isa(0) != NULL && winnow_available_isa(99) == NULL);
  OK(winnow_set_isa(winnow_isa_name()));
  note(t, "status", strcmp(winnow_status_name(WINNOW_INVALID_KEY), "invalid_key") == 0);
}
