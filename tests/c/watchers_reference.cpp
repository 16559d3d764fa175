// The scenario of watchers.c in C++.

#include "tests/c/notes.h"
#include "tests/c/world.h"

#include <winnow/winnow.h>

#include <array>

namespace winnow::test {
namespace {

[[nodiscard]] Pose pose_of_body(std::size_t i) {
  Pose pose;
  pose_of(i, 0, pose.position.data(), pose.orientation.data());
  return pose;
}

[[nodiscard]] std::vector<Key> add_balls(Scene& scene, ShapeId ball) {
  std::vector<BodyDefinition> bodies(kBodies);
  for (std::size_t i = 0; i < kBodies; ++i) {
    bodies[i] = {.shape = ball, .pose = pose_of_body(i), .data = data_of(i)};
  }
  std::vector<Key> keys(kBodies);
  (void)scene.add(bodies, keys);
  return keys;
}

void note_groups(const trace* t, const ContactGroups& groups) {
  note(t, "groups", groups.size());
  for (const std::uint32_t group : groups.group()) note(t, "group", group);
  for (std::size_t group = 0; group < groups.size(); ++group) {
    for (const std::uint32_t pair : groups.pairs(group)) note(t, "pair of a group", pair);
  }
  note(t, "no such group", 1);
}

void query_groups(const trace* t, Scene& scene, std::span<const Key> keys) {
  Contacts contacts;
  ContactGroups groups;
  (void)scene.set_ignored(keys[0], keys[1]);
  note(t, "ignored", scene.is_ignored(keys[1], keys[0]));
  note(t, "ignored", scene.is_ignored(keys[8], keys[9]));
  (void)scene.collide(ContactLevel::boolean, contacts);
  (void)scene.islands(contacts, groups);
  note_groups(t, groups);
  (void)scene.colours(contacts, groups);
  note_groups(t, groups);
  note(t, "groups take memory", 1);
  groups.clear();
  note_groups(t, groups);
}

void note_sensed(const trace* t, const Sensors& sensors) {
  note(t, "sensed", sensors.sensed().size());
  for (const SensedBody& in : sensors.sensed()) {
    note(t, "sensed", in.sensor.id);
    note(t, "sensed", in.body.id);
    note(t, "sensed", in.sensor_data);
    note(t, "sensed", in.body_data);
    note(t, "sensed", static_cast<std::uint64_t>(in.event));
  }
  note(t, "left", sensors.left().size());
  for (const ExitedBody& gone : sensors.left()) {
    note(t, "left", gone.body.id);
    note(t, "left", gone.sensor_data);
  }
}

void query_sensors(const trace* t, Scene& scene, ShapeId ball, std::span<const Key> keys) {
  Sensors sensors(scene);
  SensorDefinition goal{.shape = ball, .pose = Pose::at(2, 0, 0), .carrier = keys[2], .data = 77};
  std::array<Key, 2> goals;
  for (Key& key : goals) key = sensors.add(goal);
  (void)sensors.sense();
  note_sensed(t, sensors);
  goal.pose = Pose::at(3, 0, 0);
  (void)sensors.move(goals[0], goal.pose);
  goal.data = 78;
  (void)sensors.set(goals[1], goal);
  (void)sensors.sense();
  note_sensed(t, sensors);
  (void)sensors.remove(goals[0]);
  (void)sensors.sense();
  note_sensed(t, sensors);
  SensorDefinition stands;
  stands = sensors.sensor(goals[1]);
  note(t, "sensor", stands.data);
  note_reals(t, "sensor", stands.pose.position.data(), 3);
  note(t, "sensors", sensors.size());
  note(t, "contains", sensors.contains(goals[0]));
  note(t, "the footprint equals the allocated memory", 1);
  note(t, "outstanding", 0);
}

void note_impacts(const trace* t, const ContinuousCollision& ccd) {
  note(t, "impacts", ccd.impacts().size());
  for (const SceneImpact& impact : ccd.impacts()) {
    note(t, "impact", impact.a.id);
    note(t, "impact", impact.b.id);
    note(t, "impact", impact.data_a);
    note(t, "impact", impact.part_b);
    note_real(t, "impact", impact.time);
    note_real(t, "impact", impact.gap);
    note_real(t, "impact", impact.error_bound);
    note_reals(t, "impact", impact.normal.data(), 3);
    note_reals(t, "impact", impact.point.data(), 3);
  }
  for (const std::uint32_t first : ccd.first()) note(t, "first impact", first);
}

void query_continuous_collision(const trace* t, Scene& scene, std::span<const Key> keys) {
  ContinuousCollision ccd(scene);
  std::array<Pose, 3> ends;
  const std::array<std::uint8_t, 3> bullets = {0, 1, 0};
  for (std::size_t i = 0; i < ends.size(); ++i) {
    ends[i] = pose_of_body(i);
    ends[i].position[1] += 6.0;
  }
  (void)ccd.find_impacts(keys.first(3), ends);
  note_impacts(t, ccd);
  (void)ccd.find_impacts(keys.first(3), ends,
                         {.pairs = ContinuousPairs::bullets,
                          .bullets = bullets,
                          .touching = false,
                          .first_only = true});
  note_impacts(t, ccd);
  note(t, "impacts take memory", 1);
}

}  // namespace

void run_watchers_in_cpp(const trace* t) {
  ShapePool pool;
  const ShapeId ball = pool.add(SphereShape{0.6});
  Scene scene(pool);
  const std::vector<Key> keys = add_balls(scene, ball);
  query_groups(t, scene, keys);
  query_sensors(t, scene, ball, keys);
  query_continuous_collision(t, scene, keys);
}

}  // namespace winnow::test
