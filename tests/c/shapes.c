/* Uses in C every call about shapes and pairs of shapes. */

#include "tests/c/check.h"
#include "tests/c/world.h"

#include "tests/c/shapes_in_c.h"

static void note_box(const trace* t, const char* what, const winnow_aabb* box) {
  for (int axis = 0; axis < 3; ++axis) {
    note_real(t, what, (double)box->min[axis]);
    note_real(t, what, (double)box->max[axis]);
  }
}

/* A user shape, given by a support function; equals the cube in shapes_reference.cpp. */
static void farthest_of_cube(const void* context, const double* direction, double* point) {
  const double half = *(const double*)context;
  for (int i = 0; i < 3; ++i) point[i] = direction[i] < 0 ? -half : half;
}

static void make_round_shapes(const trace* t, winnow_shape_pool* pool, winnow_shape_id* ids) {
  static const double half = 0.25;
  const winnow_shape shapes[3] = {
      {WINNOW_SHAPE_ELLIPSOID, {.ellipsoid = {{0.5, 0.4, 0.3}, 0.05}}},
      {WINNOW_SHAPE_TAPERED_CAPSULE, {.tapered_capsule = {{0.4, 0.2}, 0.5}}},
      {WINNOW_SHAPE_SUPPORT, {.support = {farthest_of_cube, &half, 0.5, 0.1}}}};
  for (size_t i = 0; i < 3; ++i) OK(winnow_shape_pool_add(pool, &shapes[i], &ids[i]));
}

void make_shapes(const trace* t, winnow_shape_pool* pool, winnow_shape_id* ids) {
  const winnow_shape shapes[7] = {
      {WINNOW_SHAPE_SPHERE, {.sphere = {0.5}}},
      {WINNOW_SHAPE_CAPSULE, {.capsule = {0.3, 0.4}}},
      {WINNOW_SHAPE_BOX, {.box = {{0.5, 0.4, 0.3}, 0.05}}},
      {WINNOW_SHAPE_CYLINDER, {.cylinder = {0.4, 0.5, 0.0}}},
      {WINNOW_SHAPE_CONE, {.cone = {0.5, 0.5, 0.0}}},
      {WINNOW_SHAPE_TRIANGLE, {.triangle = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 0.1}}},
      {WINNOW_SHAPE_HALF_SPACE, {.half_space = {{0, 0, 2}, 0}}}};
  for (size_t i = 0; i < 7; ++i) OK(winnow_shape_pool_add(pool, &shapes[i], &ids[i]));
  const double corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const uint32_t indices[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  const uint32_t sizes[4] = {3, 3, 3, 3};
  const winnow_hull_faces faces = {indices, 12, sizes, 4};
  const winnow_point_view points = winnow_points(corners, 4);
  OK(winnow_shape_pool_add_hull_faces(pool, &points, &faces, 0.02, &ids[7]));
  const winnow_status status = winnow_shape_pool_add_hull(pool, &points, 0.02, &ids[8]);
  if (status == WINNOW_UNSUPPORTED) {
    OK(winnow_shape_pool_add_hull_faces(pool, &points, &faces, 0.02, &ids[8]));
  }
  make_round_shapes(t, pool, &ids[9]);
}

void make_composites(const trace* t, winnow_composite_pool* pool, const winnow_shape_id* convex,
                     winnow_shape_id* ids) {
  /* A square of two triangles, in columns of float, and a height field. */
  const float x[4] = {-20, 20, 20, -20};
  const float y[4] = {-20, -20, 20, 20};
  const float z[4] = {0, 0, 0, 0};
  const uint16_t corners[6] = {0, 1, 2, 0, 2, 3};
  const winnow_point_view vertices = {{x, y, z}, 0, 4, WINNOW_FLOAT};
  const winnow_index_view triangles = {corners, 0, 2, WINNOW_UINT16};
  const winnow_mesh_options options = WINNOW_MESH_OPTIONS;
  const winnow_execution serial = {WINNOW_EXECUTION_SERIAL, {NULL, NULL, 0}};
  const double scale[3] = {2, 1, 1};
  OK(winnow_composite_pool_add_mesh(pool, &vertices, &triangles, &options, &serial, &ids[0]));
  OK(winnow_composite_pool_add_scaled(pool, ids[0], scale, &ids[1]));
  OK(winnow_composite_pool_refit_mesh(pool, ids[0], &vertices, NULL));
  float heights[9] = {0, 0.1F, 0, 0.2F, 0, 0.1F, 0, 0.3F, 0};
  winnow_height_samples samples = {heights, 9, 3, 3, 0, {4.0, 4.0}};
  OK(winnow_composite_pool_add_height_field(pool, &samples, &ids[2]));
  heights[0] = 0.25F;
  samples.count = 1;
  samples.columns = samples.rows = 1;
  OK(winnow_composite_pool_update_height_field(pool, ids[2], 1, 1, &samples));
  winnow_compound_child children[3] = {
      {convex[0], WINNOW_POSE}, {convex[2], WINNOW_POSE}, {ids[0], WINNOW_POSE}};
  children[2].pose.position[2] = -0.3;
  children[1].pose.position[2] = 0.4;
  OK(winnow_composite_pool_add_compound(pool, children, 3, &ids[3]));
}

void run_shapes_in_c(const trace* t) {
  size_t outstanding = 0;
  const winnow_memory memory = counted_in(&outstanding);
  winnow_shape_pool* pool = NULL;
  winnow_composite_pool* composites = NULL;
  winnow_shape_id ids[kConvex];
  winnow_shape_id many[kComposite];
  winnow_pose pose = WINNOW_POSE;
  pose_of(13, 0, pose.position, pose.orientation);
  OK(winnow_shape_pool_create(&memory, &pool));
  OK(winnow_composite_pool_create(pool, &memory, &composites));
  make_shapes(t, pool, ids);
  make_composites(t, composites, ids, many);
  winnow_aabb box;
  for (size_t i = 0; i < kConvex; ++i) {
    note(t, "id", ids[i]);
    OK(winnow_shape_pool_bounds(pool, ids[i], &pose, &box));
    note_box(t, "bounds", &box);
    const winnow_shape_ray ray = {{8, 1, 9}, {-0.2, 0.1, -1}, 30};
    winnow_shape_hit hit = {false, 0, {0, 0, 0}};
    OK(winnow_cast_ray(pool, ids[i], &pose, &ray, &hit));
    note(t, "hit", hit.hit);
    note_real(t, "t", hit.t);
    note_reals(t, "normal", hit.normal, 3);
  }
  for (size_t i = 0; i < kComposite; ++i) {
    double radius = 0;
    size_t parts = 0;
    bool contains = false;
    note(t, "id", many[i]);
    OK(winnow_composite_pool_contains(composites, many[i], &contains));
    OK(winnow_composite_pool_bounds(composites, many[i], &pose, &box));
    OK(winnow_composite_pool_radius(composites, many[i], &radius));
    OK(winnow_composite_pool_parts(composites, many[i], &parts));
    note(t, "contains", contains);
    note_box(t, "bounds", &box);
    note_real(t, "radius", radius);
    note(t, "parts", parts);
    note(t, "solid", winnow_composite_pool_set_solid(composites, many[i], true) == WINNOW_OK);
    bool solid = false;
    OK(winnow_composite_pool_is_solid(composites, many[i], &solid));
    note(t, "solid", solid);
  }
  const winnow_compound_child* children = NULL;
  size_t count = 0;
  OK(winnow_composite_pool_children(composites, many[3], &children, &count));
  note(t, "children", count);
  note_reals(t, "child", children[1].pose.position, 3);
  size_t parts = 0;
  OK(winnow_composite_pool_parts(composites, many[3], &parts));
  for (uint32_t part = 0; part < parts; ++part) {
    uint32_t child = 0;
    uint32_t child_part = 0;
    OK(winnow_composite_pool_part(composites, many[3], part, &child, &child_part));
    note(t, "child", child);
    note(t, "part", child_part);
  }
  OK(winnow_composite_pool_size(composites, WINNOW_SHAPE_MESH, &count));
  note(t, "meshes", count);

  winnow_shape shape;
  OK(winnow_shape_pool_shape(pool, ids[2], &shape));
  note_reals(t, "box", shape.as.box.half, 3);
  OK(winnow_shape_pool_shape(pool, ids[6], &shape));
  note_reals(t, "half-space", shape.as.half_space.normal, 3);
  OK(winnow_shape_pool_shape(pool, ids[10], &shape));
  note_reals(t, "tapered capsule", shape.as.tapered_capsule.radius, 2);
  OK(winnow_shape_pool_shape(pool, ids[11], &shape));
  note(t, "support", shape.as.support.function == farthest_of_cube);
  winnow_hull hull = {.size = sizeof hull};
  OK(winnow_shape_pool_hull(pool, ids[7], &hull));
  note(t, "hull", hull.vertices);
  note(t, "hull", hull.faces);
  note_reals(t, "hull", hull.vertex[1], (int)hull.vertices);
  note_reals(t, "hull", hull.face[1].normal, 3);
  note(t, "hull", hull.loop[hull.face[1].first]);
  note(t, "kind", strlen(winnow_shape_kind_name(WINNOW_SHAPE_HALF_SPACE)));

  winnow_footprint bytes = {.size = sizeof bytes};
  winnow_footprint more = {.size = sizeof more};
  OK(winnow_shape_pool_footprint(pool, &bytes));
  OK(winnow_composite_pool_footprint(composites, &more));
  note(t, "the footprints equal the allocated memory",
       reserved_of(&bytes) + reserved_of(&more) == outstanding);
  OK(winnow_composite_pool_remove(composites, many[1]));
  OK(winnow_shape_pool_remove(pool, ids[1]));
  bool contains = true;
  OK(winnow_shape_pool_contains(pool, ids[1], &contains));
  OK(winnow_shape_pool_size(pool, WINNOW_SHAPE_CAPSULE, &count));
  note(t, "contains", contains);
  note(t, "capsules", count);
  winnow_composite_pool_destroy(composites);
  winnow_shape_pool_destroy(pool);
  note(t, "outstanding", outstanding);
}

static void note_answers(const trace* t, const winnow_narrow_result* result) {
  winnow_narrow_columns c = {.size = sizeof c};
  OK(winnow_narrow_result_columns(result, &c));
  note(t, "level", (uint64_t)c.level);
  note(t, "answers", c.answers);
  note(t, "runs", c.run_count);
  for (size_t i = 0; i < c.run_count; ++i) {
    note(t, "run", c.runs[i].kind_a);
    note(t, "run", c.runs[i].kind_b);
    note(t, "run", c.runs[i].count);
  }
  for (size_t i = 0; i < c.answers; ++i) {
    note(t, "pair_of", c.pair_of[i]);
    if (c.level == WINNOW_LEVEL_BOOLEAN) {
      note(t, "overlap", c.overlap[i] != 0);
      continue;
    }
    note_real(t, "distance", c.distance[i]);
    note_real(t, "error_bound", c.error_bound[i]);
    for (int axis = 0; axis < 3; ++axis) note_real(t, "normal", c.normal[axis][i]);
    if (c.level == WINNOW_LEVEL_DISTANCE) {
      for (int axis = 0; axis < 3; ++axis) note_real(t, "point", c.point[axis][i]);
      continue;
    }
    for (uint32_t p = c.contact_first[i]; p < c.contact_first[i] + c.contact_count[i]; ++p) {
      for (int axis = 0; axis < 3; ++axis) note_real(t, "contact", (double)c.position[axis][p]);
      note_real(t, "depth", (double)c.depth[p]);
      note(t, "feature", c.feature[p]);
    }
  }
  note(t, "contacts", c.contacts);
}

static void note_pair(const trace* t, winnow_contact_level level,
                      const winnow_pair_answer* answer) {
  note(t, "overlap", answer->overlap);
  if (level == WINNOW_LEVEL_BOOLEAN) return;
  note_real(t, "distance", answer->distance);
  note_real(t, "error_bound", answer->error_bound);
  for (int axis = 0; axis < 3; ++axis) note_real(t, "normal", answer->normal[axis]);
  if (level == WINNOW_LEVEL_DISTANCE) {
    for (int axis = 0; axis < 3; ++axis) note_real(t, "point", answer->point[axis]);
  }
  for (uint32_t k = 0; k < answer->contact_count; ++k) {
    const winnow_contact_point* point = &answer->contacts[k];
    for (int axis = 0; axis < 3; ++axis) note_real(t, "contact", (double)point->position[axis]);
    note_real(t, "depth", (double)point->depth);
    note(t, "feature", point->feature);
  }
}

void run_narrow_phase_in_c(const trace* t) {
  size_t outstanding = 0;
  const winnow_memory memory = counted_in(&outstanding);
  winnow_shape_pool* pool = NULL;
  winnow_narrow_phase* narrow = NULL;
  winnow_narrow_result* result = NULL;
  winnow_shape_id ids[kConvex];
  winnow_shape_id shape_of[kBodies];
  float place[kBodies][7];
  winnow_pose poses[kBodies];
  winnow_body_pair pairs[kBodies - 1];
  OK(winnow_shape_pool_create(NULL, &pool));
  make_shapes(t, pool, ids);
  for (size_t i = 0; i < kBodies; ++i) {
    shape_of[i] = ids[i % kConvex];
    pose_of(i, 0, poses[i].position, poses[i].orientation);
    for (size_t k = 0; k < 3; ++k) place[i][k] = (float)poses[i].position[k];
    for (size_t k = 0; k < 4; ++k) place[i][3 + k] = (float)poses[i].orientation[k];
    if (i > 0) {
      pairs[i - 1].a = (uint32_t)i - 1;
      pairs[i - 1].b = (uint32_t)i;
    }
  }
  OK(winnow_narrow_phase_create(&memory, &narrow));
  OK(winnow_narrow_result_create(&memory, &result));
  winnow_bodies bodies = {shape_of, kBodies, winnow_poses(poses, kBodies)};
  winnow_narrow_options options = WINNOW_NARROW_OPTIONS;
  for (options.level = WINNOW_LEVEL_BOOLEAN; options.level <= WINNOW_LEVEL_MANIFOLD;
       ++options.level) {
    options.contact_margin = 0.1;
    OK(winnow_narrow_phase_collide(narrow, pool, &bodies, pairs, kBodies - 1, &options, result));
    note_answers(t, result);
    for (size_t i = 1; i < kBodies; ++i) {
      winnow_pair_answer answer;
      OK(winnow_collide(pool, shape_of[i - 1], &poses[i - 1], shape_of[i], &poses[i], &options,
                        &answer));
      note_pair(t, options.level, &answer);
    }
  }
  /* Poses of float, with a stride. */
  winnow_pose_view* view = &bodies.poses;
  for (size_t k = 0; k < 3; ++k) view->position[k] = &place[0][k];
  for (size_t k = 0; k < 4; ++k) view->orientation[k] = &place[0][3 + k];
  view->position_stride = view->orientation_stride = sizeof place[0];
  view->position_number = view->orientation_number = WINNOW_FLOAT;
  OK(winnow_narrow_phase_collide(narrow, pool, &bodies, pairs, kBodies - 1, NULL, result));
  note_answers(t, result);

  winnow_narrow_statistics statistics = {.size = sizeof statistics};
  OK(winnow_narrow_phase_statistics(narrow, &statistics));
  note(t, "statistics", statistics.pairs);
  note(t, "statistics", statistics.without_lanes);
  winnow_footprint bytes = {.size = sizeof bytes};
  winnow_footprint more = {.size = sizeof more};
  OK(winnow_narrow_phase_footprint(narrow, &bytes));
  OK(winnow_narrow_result_footprint(result, &more));
  note(t, "the footprints equal the allocated memory",
       reserved_of(&bytes) + reserved_of(&more) == outstanding);
  place[2][0] = 1e38F * 10.0F;
  note(t, "refused",
       winnow_narrow_phase_collide(narrow, pool, &bodies, pairs, kBodies - 1, NULL, result) ==
           WINNOW_INVALID_POSE);
  uint32_t bad = 0;
  OK(winnow_narrow_phase_bad_body(narrow, &bad));
  note(t, "bad body", bad);
  winnow_narrow_result_destroy(result);
  winnow_narrow_phase_destroy(narrow);
  winnow_shape_pool_destroy(pool);
  note(t, "outstanding", outstanding);
}
