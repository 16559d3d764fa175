// Generated from pipeline/interface/sensors.toml; do not edit.
// clang-format off

#include <winnow/c/sensors.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_sensors_create(
    winnow_scene* scene, const winnow_memory* memory, winnow_sensors** sensors) {
  if (!(are_given(scene, sensors))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, sensors, of(scene));
}

void winnow_sensors_destroy(winnow_sensors* sensors) {
  destroy(sensors);
}

winnow_status winnow_sensors_add(
    winnow_sensors* sensors, const winnow_sensor_definition* sensor, winnow_key* key) {
  if (!(are_given(sensors, sensor, key))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(sensors).add((*as_cpp(sensor)))); }, key);
}

winnow_status winnow_sensors_remove(winnow_sensors* sensors, winnow_key key) {
  if (!(are_given(sensors))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(sensors).remove(to_cpp(key))); });
}

winnow_status winnow_sensors_move(
    winnow_sensors* sensors, winnow_key key, const winnow_pose* pose) {
  if (!(are_given(sensors, pose))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(sensors).move(to_cpp(key), (*as_cpp(pose)))); });
}

winnow_status winnow_sensors_set(
    winnow_sensors* sensors, winnow_key key, const winnow_sensor_definition* sensor) {
  if (!(are_given(sensors, sensor))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(sensors).set(to_cpp(key), (*as_cpp(sensor)))); });
}

winnow_status winnow_sensors_sensor(
    const winnow_sensors* sensors, winnow_key key, winnow_sensor_definition* sensor) {
  if (!(are_given(sensors, sensor))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(sensors).sensor(to_cpp(key))); }, sensor);
}

winnow_status winnow_sensors_size(const winnow_sensors* sensors, size_t* size) {
  if (!(are_given(sensors, size))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(sensors).size()); }, size);
}

winnow_status winnow_sensors_contains(
    const winnow_sensors* sensors, winnow_key key, bool* contains) {
  if (!(are_given(sensors, contains))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(sensors).contains(to_cpp(key))); }, contains);
}

winnow_status winnow_sensors_sense(winnow_sensors* sensors) {
  if (!(are_given(sensors))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(sensors).sense()); });
}

winnow_status winnow_sensors_sensed(
    const winnow_sensors* sensors, const winnow_sensed_body** bodies, size_t* count) {
  if (!(are_given(sensors, bodies, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(sensors).sensed()); }, bodies, count);
}

winnow_status winnow_sensors_left(
    const winnow_sensors* sensors, const winnow_left_sensor** bodies, size_t* count) {
  if (!(are_given(sensors, bodies, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(sensors).left()); }, bodies, count);
}

winnow_status winnow_sensors_footprint(const winnow_sensors* sensors, winnow_footprint* footprint) {
  if (!(are_given(sensors) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(sensors, footprint);
}
