/* Uses in C every call about sensors, impacts, groups of contacts and ignored pairs of bodies. */

#include "tests/c/check.h"
#include "tests/c/world.h"

static void add_balls(const trace* t, winnow_shape_pool* pool, winnow_scene* scene,
                      winnow_shape_id* ball, winnow_key* keys) {
  const winnow_shape round = {WINNOW_SHAPE_SPHERE, {.sphere = {0.6}}};
  winnow_body_definition bodies[kBodies];
  OK(winnow_shape_pool_add(pool, &round, ball));
  for (size_t i = 0; i < kBodies; ++i) {
    winnow_body_definition body = WINNOW_BODY_DEFINITION;
    body.shape = *ball;
    pose_of(i, 0, body.pose.position, body.pose.orientation);
    body.data = data_of(i);
    bodies[i] = body;
  }
  OK(winnow_scene_add(scene, bodies, kBodies, keys));
}

static void note_groups(const trace* t, const winnow_contact_groups* groups) {
  size_t size = 0;
  size_t count = 0;
  const uint32_t* column = NULL;
  OK(winnow_contact_groups_size(groups, &size));
  note(t, "groups", size);
  OK(winnow_contact_groups_group(groups, &column, &count));
  for (size_t i = 0; i < count; ++i) note(t, "group", column[i]);
  for (size_t group = 0; group < size; ++group) {
    OK(winnow_contact_groups_pairs(groups, group, &column, &count));
    for (size_t i = 0; i < count; ++i) note(t, "pair of a group", column[i]);
  }
  note(t, "no such group",
       winnow_contact_groups_pairs(groups, size, &column, &count) == WINNOW_INVALID_ARGUMENT);
}

static void query_groups(const trace* t, winnow_scene* scene, const winnow_key* keys) {
  winnow_contacts* contacts = NULL;
  winnow_contact_groups* groups = NULL;
  winnow_footprint bytes = {.size = sizeof bytes};
  const winnow_key_pair strangers[] = {{keys[0], keys[1]}, {keys[9], keys[8]}};
  bool ignored = false;
  OK(winnow_contacts_create(NULL, &contacts));
  OK(winnow_contact_groups_create(NULL, &groups));
  OK(winnow_scene_set_ignored(scene, strangers, 2, true));
  OK(winnow_scene_is_ignored(scene, keys[1], keys[0], &ignored));
  note(t, "ignored", ignored);
  OK(winnow_scene_set_ignored(scene, strangers + 1, 1, false));
  OK(winnow_scene_is_ignored(scene, keys[8], keys[9], &ignored));
  note(t, "ignored", ignored);
  OK(winnow_scene_collide(scene, WINNOW_LEVEL_BOOLEAN, contacts));
  OK(winnow_scene_islands(scene, contacts, groups));
  note_groups(t, groups);
  OK(winnow_scene_colours(scene, contacts, groups));
  note_groups(t, groups);
  OK(winnow_contact_groups_footprint(groups, &bytes));
  note(t, "groups take memory", bytes.results.reserved > 0);
  OK(winnow_contact_groups_clear(groups));
  note_groups(t, groups);
  winnow_contact_groups_destroy(groups);
  winnow_contacts_destroy(contacts);
}

static void note_sensed(const trace* t, const winnow_sensors* sensors) {
  const winnow_sensed_body* in = NULL;
  const winnow_left_sensor* gone = NULL;
  size_t count = 0;
  OK(winnow_sensors_sensed(sensors, &in, &count));
  note(t, "sensed", count);
  for (size_t i = 0; i < count; ++i) {
    note(t, "sensed", in[i].sensor.id);
    note(t, "sensed", in[i].body.id);
    note(t, "sensed", in[i].sensor_data);
    note(t, "sensed", in[i].body_data);
    note(t, "sensed", in[i].event);
  }
  OK(winnow_sensors_left(sensors, &gone, &count));
  note(t, "left", count);
  for (size_t i = 0; i < count; ++i) {
    note(t, "left", gone[i].body.id);
    note(t, "left", gone[i].sensor_data);
  }
}

static void query_sensors(const trace* t, winnow_scene* scene, winnow_shape_id ball,
                        const winnow_key* keys) {
  size_t outstanding = 0;
  const winnow_memory memory = counted_in(&outstanding);
  winnow_sensors* sensors = NULL;
  winnow_key goals[2];
  winnow_sensor_definition goal = WINNOW_SENSOR_DEFINITION;
  winnow_footprint bytes = {.size = sizeof bytes};
  size_t size = 0;
  bool contains = false;
  OK(winnow_sensors_create(scene, &memory, &sensors));
  goal.shape = ball;
  goal.pose.position[0] = 2.0;
  goal.carrier = keys[2];
  goal.data = 77;
  for (size_t i = 0; i < 2; ++i) OK(winnow_sensors_add(sensors, &goal, &goals[i]));
  OK(winnow_sensors_sense(sensors));
  note_sensed(t, sensors);
  goal.pose.position[0] = 3.0;
  OK(winnow_sensors_move(sensors, goals[0], &goal.pose));
  goal.data = 78;
  OK(winnow_sensors_set(sensors, goals[1], &goal));
  OK(winnow_sensors_sense(sensors));
  note_sensed(t, sensors);
  OK(winnow_sensors_remove(sensors, goals[0]));
  OK(winnow_sensors_sense(sensors));
  note_sensed(t, sensors);
  OK(winnow_sensors_sensor(sensors, goals[1], &goal));
  note(t, "sensor", goal.data);
  note_reals(t, "sensor", goal.pose.position, 3);
  OK(winnow_sensors_size(sensors, &size));
  note(t, "sensors", size);
  OK(winnow_sensors_contains(sensors, goals[0], &contains));
  note(t, "contains", contains);
  OK(winnow_sensors_footprint(sensors, &bytes));
  note(t, "the footprint equals the allocated memory", reserved_of(&bytes) == outstanding);
  winnow_sensors_destroy(sensors);
  note(t, "outstanding", outstanding);
}

static void note_impacts(const trace* t, const winnow_continuous_collision* ccd) {
  const winnow_scene_impact* impacts = NULL;
  const uint32_t* first = NULL;
  size_t count = 0;
  OK(winnow_continuous_collision_impacts(ccd, &impacts, &count));
  note(t, "impacts", count);
  for (size_t i = 0; i < count; ++i) {
    note(t, "impact", impacts[i].a.id);
    note(t, "impact", impacts[i].b.id);
    note(t, "impact", impacts[i].data_a);
    note(t, "impact", impacts[i].part_b);
    note_real(t, "impact", impacts[i].time);
    note_real(t, "impact", impacts[i].gap);
    note_real(t, "impact", impacts[i].error_bound);
    note_reals(t, "impact", impacts[i].normal, 3);
    note_reals(t, "impact", impacts[i].point, 3);
  }
  OK(winnow_continuous_collision_first(ccd, &first, &count));
  for (size_t i = 0; i < count; ++i) note(t, "first impact", first[i]);
}

static void query_continuous_collision(const trace* t, winnow_scene* scene, const winnow_key* keys) {
  enum { kMoving = 3 };
  winnow_continuous_collision* ccd = NULL;
  winnow_continuous_options options = WINNOW_CONTINUOUS_OPTIONS;
  winnow_footprint bytes = {.size = sizeof bytes};
  winnow_pose ends[kMoving];
  const uint8_t bullets[kMoving] = {0, 1, 0};
  OK(winnow_continuous_collision_create(scene, NULL, &ccd));
  for (size_t i = 0; i < kMoving; ++i) {
    pose_of(i, 0, ends[i].position, ends[i].orientation);
    ends[i].position[1] += 6.0;
  }
  const winnow_pose_view view = winnow_poses(ends, kMoving);
  OK(winnow_continuous_collision_find_impacts(ccd, keys, kMoving, &view, NULL));
  note_impacts(t, ccd);
  options.pairs = WINNOW_CONTINUOUS_BULLETS;
  options.bullets = bullets;
  options.leave_out_touching = 1;
  options.first_only = 1;
  OK(winnow_continuous_collision_find_impacts(ccd, keys, kMoving, &view, &options));
  note_impacts(t, ccd);
  OK(winnow_continuous_collision_footprint(ccd, &bytes));
  note(t, "impacts take memory", bytes.results.reserved > 0);
  winnow_continuous_collision_destroy(ccd);
}

void run_watchers_in_c(const trace* t) {
  winnow_shape_pool* pool = NULL;
  winnow_scene* scene = NULL;
  winnow_shape_id ball = WINNOW_NO_SHAPE;
  winnow_key keys[kBodies];
  OK(winnow_shape_pool_create(NULL, &pool));
  OK(winnow_scene_create(pool, NULL, &scene));
  add_balls(t, pool, scene, &ball, keys);
  query_groups(t, scene, keys);
  query_sensors(t, scene, ball, keys);
  query_continuous_collision(t, scene, keys);
  winnow_scene_destroy(scene);
  winnow_shape_pool_destroy(pool);
}
