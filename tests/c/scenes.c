/* Uses in C every call about scenes, their contacts and their queries. */

#include "tests/c/check.h"
#include "tests/c/shapes_in_c.h"
#include "tests/c/world.h"

static void note_columns(const trace* t, const winnow_contacts* contacts) {
  winnow_contact_columns c = {.size = sizeof c};
  OK(winnow_contacts_columns(contacts, &c));
  note(t, "level", (uint64_t)c.level);
  note(t, "pairs", c.pairs);
  for (size_t i = 0; i < c.pairs; ++i) {
    note(t, "a", c.a[i].id);
    note(t, "b", c.b[i].id);
    note(t, "data_a", c.data_a[i]);
    note(t, "data_b", c.data_b[i]);
    note(t, "event", c.event[i]);
    if (c.manifold_first != NULL) note(t, "manifold_first", c.manifold_first[i]);
  }
  for (size_t i = 0; i < c.run_count; ++i) {
    note(t, "run", c.runs[i].kind_a);
    note(t, "run", c.runs[i].kind_b);
    note(t, "run", c.runs[i].count);
  }
  for (size_t i = 0; i < c.ended_count; ++i) {
    note(t, "ended", c.ended[i].a.id);
    note(t, "ended", c.ended[i].data_b);
  }
  for (size_t m = 0; m < c.manifolds; ++m) {
    note(t, "part_a", c.part_a[m]);
    note(t, "part_b", c.part_b[m]);
    if (c.distance == NULL) continue;
    note_real(t, "distance", c.distance[m]);
    note_real(t, "error_bound", c.error_bound[m]);
    for (int axis = 0; axis < 3; ++axis) note_real(t, "normal", c.normal[axis][m]);
    if (c.point[0] != NULL) {
      for (int axis = 0; axis < 3; ++axis) note_real(t, "point", c.point[axis][m]);
    }
    if (c.point_first != NULL) note(t, "point_first", c.point_first[m]);
  }
  note(t, "points", c.points);
  for (size_t p = 0; p < c.points; ++p) {
    for (int axis = 0; axis < 3; ++axis) note_real(t, "position", (double)c.position[axis][p]);
    note_real(t, "depth", (double)c.depth[p]);
    note(t, "feature", c.feature[p]);
  }
  note(t, "cached_pairs", c.cached_pairs);
}

static void note_hit(const trace* t, const char* what, const winnow_scene_hit* hit) {
  note(t, what, hit->key.id);
  note(t, what, hit->data);
  note(t, what, hit->part);
  note_real(t, what, hit->t);
  note_reals(t, what, hit->normal, 3);
  note_reals(t, what, hit->point, 3);
}

static void note_hits(const trace* t, const char* what, const winnow_scene_hit* hits,
                      size_t count) {
  note(t, what, count);
  for (size_t i = 0; i < count; ++i) note_hit(t, what, &hits[i]);
}

static void note_distance(const trace* t, const char* what, const winnow_scene_distance* d) {
  note(t, what, d->key.id);
  note(t, what, d->part);
  note(t, what, d->part_a);
  note_real(t, what, d->distance);
  note_real(t, what, d->error_bound);
  note_reals(t, what, d->normal, 3);
  note_reals(t, what, d->point_a, 3);
  note_reals(t, what, d->point_b, 3);
}

static bool is_even(void* context, winnow_key key, uint64_t value) {
  (void)context;
  (void)value;
  return key.id % 2 == 0;
}

static void query_rays(const trace* t, winnow_scene_queries* queries) {
  winnow_filter filter = WINNOW_FILTER;
  filter.accept = is_even;
  const winnow_shape_ray ray = {{3.2, 1.3, 5}, {0.1, 0.2, -1}, 20};
  winnow_scene_hit hit;
  const winnow_scene_hit* hits = NULL;
  size_t count = 0;
  OK(winnow_scene_queries_closest(queries, &ray, NULL, &hit));
  note_hit(t, "closest", &hit);
  OK(winnow_scene_queries_closest(queries, &ray, &filter, &hit));
  note_hit(t, "closest even", &hit);
  OK(winnow_scene_queries_any(queries, &ray, NULL, &hit));
  note(t, "any", hit.key.id != WINNOW_NO_OBJECT);
  OK(winnow_scene_queries_all(queries, &ray, NULL, &hits, &count));
  note_hits(t, "all", hits, count);

  /* Columns of float. */
  enum { kRays = 16 };
  float o[3][kRays], d[3][kRays], max_t[kRays];
  for (size_t i = 0; i < kRays; ++i) {
    o[0][i] = 0.5F * (float)i;
    o[1][i] = 0.25F * (float)i;
    o[2][i] = 4;
    d[0][i] = 0.125F;
    d[1][i] = 0;
    d[2][i] = -1;
    max_t[i] = 10;
  }
  const winnow_shape_ray_batch rays = {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, max_t, kRays, 0,
                                       WINNOW_FLOAT};
  winnow_key key[kRays];
  uint64_t value[kRays];
  uint32_t part[kRays];
  double at[kRays], normal[3][kRays], point[3][kRays];
  const winnow_scene_hit_columns found = {
      key, value, part, at, {normal[0], normal[1], normal[2]}, {point[0], point[1], point[2]}};
  OK(winnow_scene_queries_closest_rays(queries, &rays, NULL, &found));
  for (size_t i = 0; i < kRays; ++i) {
    note(t, "closest of rays", key[i].id);
    note(t, "closest of rays", value[i]);
    note(t, "closest of rays", part[i]);
    note_real(t, "closest of rays", at[i]);
    note_real(t, "closest of rays", normal[2][i]);
    note_real(t, "closest of rays", point[0][i]);
  }
  OK(winnow_scene_queries_any_rays(queries, &rays, NULL, &found));
  for (size_t i = 0; i < kRays; ++i) note(t, "any of rays", key[i].id != WINNOW_NO_OBJECT);
  const size_t* first = NULL;
  OK(winnow_scene_queries_all_rays(queries, &rays, NULL, &hits, &first));
  note_hits(t, "all of rays", hits, first[kRays]);
}

static void query_shapes_of(const trace* t, winnow_scene_queries* queries, winnow_shape_id ball,
                          const winnow_key* keys) {
  const winnow_shape_cast cast = {ball, {{3.2, 1.3, 5}, {1, 0, 0, 0}}, {0.1, 0.2, -1}, 20};
  winnow_pose pose = WINNOW_POSE;
  pose.position[0] = 2.0;
  pose.position[2] = 0.6;
  winnow_scene_hit hit;
  const winnow_scene_hit* hits = NULL;
  const winnow_scene_overlap* bodies = NULL;
  const winnow_scene_distance* near_ones = NULL;
  winnow_scene_distance apart;
  size_t count = 0;
  OK(winnow_scene_queries_closest_cast(queries, &cast, NULL, WINNOW_CAST_TOLERANCE, &hit));
  note_hit(t, "closest of casts", &hit);
  OK(winnow_scene_queries_all_cast(queries, &cast, NULL, WINNOW_CAST_TOLERANCE, &hits, &count));
  note_hits(t, "all of casts", hits, count);
  const winnow_shape_cast leaving = {ball, {{2, 0, 0.6}, {1, 0, 0, 0}}, {0.3, 0.2, 1}, 20};
  OK(winnow_scene_queries_closest_cast_from_touch(queries, &leaving, NULL, WINNOW_CAST_TOLERANCE,
                                                  &hit));
  note_hit(t, "closest of casts from a touch", &hit);
  OK(winnow_scene_queries_all_cast_from_touch(queries, &leaving, NULL, WINNOW_CAST_TOLERANCE, &hits,
                                              &count));
  note_hits(t, "all of casts from a touch", hits, count);
  OK(winnow_scene_queries_overlap(queries, ball, &pose, NULL, &bodies, &count));
  note(t, "overlaps", count);
  for (size_t i = 0; i < count; ++i) {
    note(t, "overlap", bodies[i].key.id);
    note(t, "overlap", bodies[i].data);
    note(t, "overlap", bodies[i].part);
  }
  OK(winnow_scene_queries_distance(queries, keys[1], keys[30], INFINITY, WINNOW_PAIR_RULES_NONE,
                                   &apart));
  note_distance(t, "distance", &apart);
  OK(winnow_scene_queries_nearest(queries, pose.position, 5, 10.0, NULL, &near_ones, &count));
  note(t, "nearest", count);
  for (size_t i = 0; i < count; ++i) note_distance(t, "nearest", &near_ones[i]);
  winnow_set_distance least;
  OK(winnow_scene_queries_least_distance(queries, keys + 4, 6, keys + 16, 8, 1e9,
                                         WINNOW_PAIR_RULES_SCENE, &least));
  note(t, "least of sets", least.a.id);
  note(t, "least of sets", least.data_a);
  note_distance(t, "least of sets", &least.to);
  const winnow_key_pair* pairs = NULL;
  OK(winnow_scene_queries_overlaps(queries, keys + 4, 6, keys + 16, 12, 7, WINNOW_PAIR_RULES_SCENE,
                                   &pairs, &count));
  note(t, "overlaps of sets", count);
  for (size_t i = 0; i < count; ++i) {
    note(t, "overlaps of sets", pairs[i].first.id);
    note(t, "overlaps of sets", pairs[i].second.id);
  }
  for (winnow_pair_rules rules = 0; rules <= WINNOW_PAIR_RULES_NONE; ++rules) {
    winnow_key_pair found;
    OK(winnow_scene_queries_any_contact(queries, keys + 4, 6, keys + 16, 12, 0.25, rules, &found));
    note(t, "any contact of sets", found.first.id);
    note(t, "any contact of sets", found.second.id);
    OK(winnow_scene_queries_any_contact_in_scene(queries, 0.0, rules, &found));
    note(t, "any contact", found.first.id);
    note(t, "any contact", found.second.id);
  }
  winnow_footprint bytes = {.size = sizeof bytes};
  OK(winnow_scene_queries_footprint(queries, &bytes));
  note(t, "queries take memory", bytes.structure.used > 0);
}

static void count_box(void* context, const winnow_aabb* box, winnow_colour colour) {
  (void)box;
  (void)colour;
  ++*(size_t*)context;
}

static void query_state(const trace* t, winnow_scene* scene, const winnow_key* keys) {
  size_t size = 0;
  bool contains = false;
  winnow_body_definition body = WINNOW_BODY_DEFINITION;
  winnow_key key;
  double origin[3];
  const winnow_partition* partition = NULL;
  OK(winnow_scene_size(scene, &size));
  note(t, "size", size);
  OK(winnow_scene_size_of(scene, WINNOW_BODY_STATE_FIXED, &size));
  note(t, "fixed", size);
  OK(winnow_scene_contains(scene, keys[3], &contains));
  note(t, "contains", contains);
  OK(winnow_scene_body(scene, keys[3], &body));
  note(t, "body", body.shape);
  note(t, "body", body.state);
  note(t, "body", body.filter.mask);
  note(t, "body", body.data);
  note_reals(t, "body", body.pose.position, 3);
  note_reals(t, "body", body.pose.orientation, 4);
  OK(winnow_scene_key_of(scene, 3, &key));
  note(t, "key", key.id == keys[3].id && key.stamp == keys[3].stamp);
  OK(winnow_scene_origin(scene, origin));
  note_reals(t, "origin", origin, 3);
  OK(winnow_scene_partition(scene, WINNOW_BODY_STATE_DYNAMIC, &partition));
  OK(winnow_partition_size(partition, &size));
  note(t, "partition", size);
  OK(winnow_scene_partition(scene, WINNOW_BODY_STATE_SLEEPING, &partition));
  note(t, "no partition", partition == NULL);
  size_t drawn = 0;
  const winnow_debug_draw draw = {&drawn, count_box, NULL, NULL, NULL};
  OK(winnow_scene_debug_draw(scene, &draw, NULL));
  note(t, "drawn", drawn);
  winnow_scene_counts counts = {.size = sizeof counts};
  OK(winnow_scene_statistics(scene, &counts));
  note(t, "statistics", counts.body_pairs);
  note(t, "statistics", counts.rejected_by_spheres);
  note(t, "statistics", counts.convex_pairs);
  note(t, "statistics", counts.part_pairs);
}

static void note_footprint(const trace* t, const winnow_scene* scene,
                           const winnow_contacts* contacts, size_t outstanding) {
  winnow_scene_bytes bytes = {.size = sizeof bytes};
  winnow_footprint more = {.size = sizeof more};
  OK(winnow_scene_footprint(scene, &bytes));
  OK(winnow_contacts_footprint(contacts, &more));
  size_t sum = bytes.bodies.reserved + bytes.pairs.reserved + bytes.mid_phase.reserved +
               bytes.narrow_phase.reserved + reserved_of(&more);
  for (int i = 0; i < WINNOW_BODY_STATES; ++i) sum += bytes.partitions[i].reserved;
  note(t, "the footprints equal the allocated memory", sum == outstanding);
}

static void add_bodies(const trace* t, winnow_scene* scene, const winnow_shape_id* convex,
                       const winnow_shape_id* composite, winnow_key* keys) {
  winnow_body_definition bodies[kBodies];
  for (size_t i = 0; i < kBodies; ++i) {
    winnow_body_definition body = WINNOW_BODY_DEFINITION;
    /* Moving bodies have no half-space. */
    body.shape = i < kComposite ? composite[i] : convex[i % 6];
    pose_of(i, 0, body.pose.position, body.pose.orientation);
    if (i < 3) body.state = WINNOW_BODY_STATE_FIXED;
    if (i < 3) body.pose = (winnow_pose)WINNOW_POSE;
    body.data = data_of(i);
    bodies[i] = body;
  }
  OK(winnow_scene_add(scene, bodies, kBodies, keys));
}

static winnow_status load_partition(const trace* t, winnow_snapshot* snapshot,
                                    const winnow_partition* of, winnow_partition* into) {
  const uint8_t* bytes = NULL;
  size_t count = 0;
  OK(winnow_partition_save(of, snapshot));
  OK(winnow_snapshot_bytes(snapshot, &bytes, &count));
  return winnow_partition_load(into, bytes, count);
}

/* Saves all objects, changes them, and loads them again. */
static void save_and_load(const trace* t, winnow_shape_pool* pool,
                          winnow_composite_pool* composites, winnow_scene* scene,
                          winnow_contacts* contacts) {
  enum { kParts = 4 };
  winnow_snapshot* saved[kParts] = {NULL};
  const uint8_t* bytes[kParts] = {NULL};
  size_t count[kParts] = {0};
  for (size_t i = 0; i < kParts; ++i) OK(winnow_snapshot_create(NULL, &saved[i]));
  OK(winnow_shape_pool_save(pool, saved[0]));
  OK(winnow_composite_pool_save(composites, saved[1]));
  OK(winnow_scene_save(scene, saved[2]));
  OK(winnow_scene_save_contacts(scene, contacts, saved[3]));
  for (size_t i = 0; i < kParts; ++i) OK(winnow_snapshot_bytes(saved[i], &bytes[i], &count[i]));

  winnow_partition* copy = NULL;
  const winnow_partition* moving = NULL;
  size_t size = 0;
  winnow_snapshot* of_partition = NULL;
  OK(winnow_partition_create((winnow_structure_kind){WINNOW_LINEAR_BVH, 0.0F}, NULL, &copy));
  OK(winnow_snapshot_create(NULL, &of_partition));
  OK(winnow_scene_partition(scene, WINNOW_BODY_STATE_DYNAMIC, &moving));
  OK(load_partition(t, of_partition, moving, copy));
  OK(winnow_partition_size(copy, &size));
  note(t, "loaded objects", size);
  winnow_snapshot_destroy(of_partition);
  winnow_partition_destroy(copy);

  OK(winnow_scene_clear(scene));
  OK(winnow_shape_pool_load(pool, bytes[0], count[0]));
  OK(winnow_composite_pool_load(composites, bytes[1], count[1]));
  OK(winnow_scene_load(scene, bytes[2], count[2]));
  OK(winnow_scene_load_contacts(scene, bytes[3], count[3], contacts));
  OK(winnow_scene_collide(scene, WINNOW_LEVEL_MANIFOLD, contacts));
  note_columns(t, contacts);
  note(t, "cut short",
       (uint64_t)(winnow_scene_load(scene, bytes[2], count[2] - 1) == WINNOW_INVALID_ARGUMENT));
  for (size_t i = 0; i < kParts; ++i) winnow_snapshot_destroy(saved[i]);
}

void run_scenes_in_c(const trace* t) {
  size_t outstanding = 0;
  const winnow_memory memory = counted_in(&outstanding);
  winnow_shape_pool* pool = NULL;
  winnow_composite_pool* composites = NULL;
  winnow_scene* scene = NULL;
  winnow_contacts* contacts = NULL;
  winnow_shape_id convex[kConvex];
  winnow_shape_id composite[kComposite];
  winnow_key keys[kBodies];
  OK(winnow_shape_pool_create(NULL, &pool));
  OK(winnow_composite_pool_create(pool, NULL, &composites));
  make_shapes(t, pool, convex);
  make_composites(t, composites, convex, composite);
  /* Pools with user shapes cannot be saved. */
  winnow_snapshot* of_functions = NULL;
  OK(winnow_snapshot_create(NULL, &of_functions));
  note(t, "unsaved", winnow_shape_pool_save(pool, of_functions) == WINNOW_UNSUPPORTED);
  winnow_snapshot_destroy(of_functions);
  OK(winnow_shape_pool_remove(pool, convex[kConvex - 1]));
  winnow_scene_options options = WINNOW_SCENE_OPTIONS;
  options.memory = &memory;
  options.contact_margin = 0.02;
  options.cache_tolerance = 0.001;
  options.contact_reduction = 1;
  options.composites = composites;
  options.structures[WINNOW_BODY_STATE_FIXED].structure = WINNOW_STATIC_BVH;
  OK(winnow_scene_create(pool, &options, &scene));
  OK(winnow_contacts_create(&memory, &contacts));
  const winnow_scene_room room = {
      sizeof room, {3, kBodies, 0}, 500, WINNOW_LEVEL_MANIFOLD, 200, 300, 1000};
  OK(winnow_scene_reserve(scene, &room, WINNOW_PAGES_UNTOUCHED));
  OK(winnow_scene_reserve_contacts(scene, contacts, &room, WINNOW_PAGES_TOUCHED));
  add_bodies(t, scene, convex, composite, keys);
  for (winnow_contact_level level = WINNOW_LEVEL_PAIRS; level <= WINNOW_LEVEL_MANIFOLD; ++level) {
    OK(winnow_contacts_clear(contacts));
    OK(winnow_scene_collide(scene, level, contacts));
    note_columns(t, contacts);
  }
  query_state(t, scene, keys);

  winnow_pose poses[kBodies];
  for (size_t i = 0; i < kBodies; ++i) pose_of(i, 1, poses[i].position, poses[i].orientation);
  winnow_pose_view view = winnow_poses(poses + 4, 20);
  OK(winnow_scene_move(scene, keys + 4, 20, &view));
  /* Positions only, in float and in double: no body rotates. */
  float place[3][20];
  for (size_t i = 0; i < 20; ++i) {
    for (size_t k = 0; k < 3; ++k) place[k][i] = (float)poses[4 + i].position[k];
  }
  const winnow_pose_view rounded = {{place[0], place[1], place[2]},
                                    {NULL, NULL, NULL, NULL},
                                    0,
                                    0,
                                    20,
                                    WINNOW_FLOAT,
                                    WINNOW_FLOAT};
  OK(winnow_scene_move(scene, keys + 4, 20, &rounded));
  for (size_t k = 0; k < 4; ++k) view.orientation[k] = NULL;
  OK(winnow_scene_move(scene, keys + 4, 20, &view));
  OK(winnow_scene_set_body_state(scene, keys + 10, 2, WINNOW_BODY_STATE_SLEEPING));
  OK(winnow_scene_set_shape(scene, keys[12], convex[0]));
  const winnow_object_filter ghost = {0U, 0U, 0U};
  OK(winnow_scene_set_filter(scene, keys[13], &ghost));
  OK(winnow_scene_remove(scene, keys + 14, 2));
  OK(winnow_scene_collide(scene, WINNOW_LEVEL_MANIFOLD, contacts));
  note_columns(t, contacts);
  note_footprint(t, scene, contacts, outstanding);

  OK(winnow_scene_refresh(scene));
  winnow_scene_queries* queries = NULL;
  OK(winnow_scene_queries_create(scene, NULL, &queries));
  query_rays(t, queries);
  query_shapes_of(t, queries, convex[0], keys);
  winnow_scene_queries_destroy(queries);
  save_and_load(t, pool, composites, scene, contacts);

  OK(winnow_scene_clear(scene));
  winnow_contacts_destroy(contacts);
  winnow_scene_destroy(scene);
  winnow_composite_pool_destroy(composites);
  winnow_shape_pool_destroy(pool);
  note(t, "outstanding", outstanding);
}
