/* Uses in C every call about motions, times of impact and hooks. */

#include <string.h>

#include "tests/c/check.h"
#include "tests/c/world.h"

enum { kMoving = 3, kPairs = 4 };

static void note_pose(const trace* t, const winnow_rigid_motion* motion, double time) {
  winnow_pose pose;
  OK(winnow_rigid_motion_at(motion, time, &pose));
  note_reals(t, "position", pose.position, 3);
  note_reals(t, "orientation", pose.orientation, 4);
}

static void note_answers(const trace* t, const winnow_impact_result* result) {
  winnow_impact_columns found = {.size = sizeof found};
  OK(winnow_impact_result_columns(result, &found));
  note(t, "answers", found.answers);
  for (size_t i = 0; i < found.answers; ++i) {
    note(t, "status", found.status[i]);
    note(t, "hit", found.hit[i]);
    note_real(t, "time", found.time[i]);
    note_real(t, "gap", found.gap[i]);
    note_real(t, "error_bound", found.error_bound[i]);
    for (int axis = 0; axis < 3; ++axis) {
      note_real(t, "normal", found.normal[axis][i]);
      note_real(t, "point", found.point[axis][i]);
    }
    note(t, "part_a", found.part_a[i]);
    note(t, "part_b", found.part_b[i]);
  }
}

static void query_impacts(const trace* t) {
  const winnow_shape ball = {WINNOW_SHAPE_SPHERE, {.sphere = {0.5}}};
  const winnow_shape box = {WINNOW_SHAPE_BOX, {.box = {{0.5, 0.25, 1.0}, 0.0}}};
  const winnow_body_pair pairs[kPairs] = {{0, 1}, {1, 2}, {2, 0}, {0, 0}};
  winnow_shape_pool* shapes = NULL;
  winnow_composite_pool* composites = NULL;
  winnow_shape_id ids[kMoving];
  winnow_rigid_motion motions[kMoving];
  OK(winnow_shape_pool_create(NULL, &shapes));
  OK(winnow_composite_pool_create(shapes, NULL, &composites));
  OK(winnow_shape_pool_add(shapes, &ball, &ids[0]));
  OK(winnow_shape_pool_add(shapes, &box, &ids[1]));
  const winnow_compound_child children[2] = {{ids[0], WINNOW_POSE}, {ids[1], WINNOW_POSE}};
  OK(winnow_composite_pool_add_compound(composites, children, 2, &ids[2]));

  winnow_pose start = WINNOW_POSE;
  winnow_pose end = WINNOW_POSE;
  const double linear[3] = {0, 0, -2};
  const double angular[3] = {1, 2, 3};
  end.position[0] = 4.0;
  end.orientation[1] = 0.5;
  OK(winnow_rigid_motion_between(&start, &end, &motions[0]));
  start.position[0] = 3.0;
  start.position[2] = 2.0;
  OK(winnow_rigid_motion_by_velocities(&start, linear, angular, 1.5, &motions[1]));
  start.position[1] = 9.0;
  OK(winnow_rigid_motion_between(&start, &end, &motions[2]));
  for (size_t i = 0; i < kMoving; ++i) note_pose(t, &motions[i], 0.75);
  note(t, "no such time", winnow_rigid_motion_at(motions, 2.0, &end) == WINNOW_INVALID_ARGUMENT);
  memset(end.orientation, 0, sizeof end.orientation);
  note(t, "no pose", winnow_rigid_motion_between(&start, &end, motions) == WINNOW_INVALID_POSE);

  winnow_impact_result* result = NULL;
  winnow_footprint bytes = {.size = sizeof bytes};
  winnow_impact_options options = WINNOW_IMPACT_OPTIONS;
  const winnow_moving_bodies bodies = {ids, motions, kMoving};
  OK(winnow_impact_result_create(NULL, &result));
  OK(winnow_time_of_impact(shapes, &bodies, pairs, kPairs, NULL, result));
  note_answers(t, result);
  options.tolerance = 1e-3;
  options.composites = composites;
  OK(winnow_time_of_impact(shapes, &bodies, pairs, kPairs, &options, result));
  note_answers(t, result);
  OK(winnow_impact_result_footprint(result, &bytes));
  note(t, "impacts take memory", bytes.results.reserved > 0);
  winnow_impact_result_destroy(result);
  winnow_composite_pool_destroy(composites);
  winnow_shape_pool_destroy(shapes);
}

static const trace* hook_trace;

static void note_stage(winnow_work_stage stage, bool begins) {
  note(hook_trace, begins ? "begins" : "ends", (uint64_t)stage);
}

static void note_entry(const winnow_log_entry* entry) {
  note(hook_trace, "kind", (uint64_t)entry->kind);
  note(hook_trace, "what", entry->what.count);
  note(hook_trace, "what", (uint64_t)entry->what.first[0]);
  note(hook_trace, "before", entry->before.count);
  note(hook_trace, "reason", entry->reason.count);
  note(hook_trace, "status", (uint64_t)entry->status);
  note(hook_trace, "objects", entry->objects);
}

static void query_hooks(const trace* t) {
  const winnow_shape ball = {WINNOW_SHAPE_SPHERE, {.sphere = {0.5}}};
  winnow_shape_pool* shapes = NULL;
  winnow_scene* scene = NULL;
  winnow_contacts* contacts = NULL;
  winnow_body_definition bodies[2] = {WINNOW_BODY_DEFINITION, WINNOW_BODY_DEFINITION};
  winnow_key keys[2];
  hook_trace = t;
  OK(winnow_shape_pool_create(NULL, &shapes));
  OK(winnow_shape_pool_add(shapes, &ball, &bodies[0].shape));
  bodies[1].shape = bodies[0].shape;
  OK(winnow_scene_create(shapes, NULL, &scene));
  OK(winnow_contacts_create(NULL, &contacts));
  OK(winnow_scene_add(scene, bodies, 2, keys));
  note(t, "no hook", winnow_set_stage_hook(note_stage) == NULL);
  note(t, "no log", winnow_set_log_hook(note_entry) == NULL);
  OK(winnow_scene_collide(scene, WINNOW_LEVEL_MANIFOLD, contacts));
  OK(winnow_scene_remove(scene, keys, 2));
  note(t, "refused", winnow_scene_remove(scene, keys, 2) == WINNOW_INVALID_KEY);
  note(t, "the hook", winnow_set_stage_hook(NULL) == note_stage);
  note(t, "the log", winnow_set_log_hook(NULL) == note_entry);
  OK(winnow_scene_collide(scene, WINNOW_LEVEL_MANIFOLD, contacts));
  note(t, "stage", strlen(winnow_work_stage_name(WINNOW_STAGE_NARROW_PHASE)));
  note(t, "no stage", strlen(winnow_work_stage_name(99)));
  winnow_contacts_destroy(contacts);
  winnow_scene_destroy(scene);
  winnow_shape_pool_destroy(shapes);
}

void run_impacts_in_c(const trace* t) {
  query_impacts(t);
  query_hooks(t);
}
