// C binding of Sensors (sensors.h).

#include <winnow/c/sensors.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"

using namespace winnow::c;

winnow_status winnow_sensors_create(winnow_scene* scene, const winnow_memory* memory,
                                    winnow_sensors** sensors) {
  if (!are_given(scene, sensors)) return WINNOW_INVALID_ARGUMENT;
  return create(memory, sensors, scene->value);
}

void winnow_sensors_destroy(winnow_sensors* sensors) {
  destroy(sensors);
}

winnow_status winnow_sensors_add(winnow_sensors* sensors, const winnow_sensor_definition* sensor,
                                 winnow_key* key) {
  if (!are_given(sensors, sensor, key)) return WINNOW_INVALID_ARGUMENT;
  return answer(sensors->value.add(*as_cpp(sensor)), as_cpp(key));
}

winnow_status winnow_sensors_remove(winnow_sensors* sensors, winnow_key key) {
  if (sensors == nullptr) return WINNOW_INVALID_ARGUMENT;
  return answer(sensors->value.remove(*as_cpp(&key)));
}

winnow_status winnow_sensors_move(winnow_sensors* sensors, winnow_key key,
                                  const winnow_pose* pose) {
  if (!are_given(sensors, pose)) return WINNOW_INVALID_ARGUMENT;
  return answer(sensors->value.move(*as_cpp(&key), *as_cpp(pose)));
}

winnow_status winnow_sensors_set(winnow_sensors* sensors, winnow_key key,
                                 const winnow_sensor_definition* sensor) {
  if (!are_given(sensors, sensor)) return WINNOW_INVALID_ARGUMENT;
  return answer(sensors->value.set(*as_cpp(&key), *as_cpp(sensor)));
}

winnow_status winnow_sensors_sensor(const winnow_sensors* sensors, winnow_key key,
                                    winnow_sensor_definition* sensor) {
  if (!are_given(sensors, sensor)) return WINNOW_INVALID_ARGUMENT;
  return answer(sensors->value.sensor(*as_cpp(&key)), as_cpp(sensor));
}

winnow_status winnow_sensors_size(const winnow_sensors* sensors, size_t* size) {
  if (!are_given(sensors, size)) return WINNOW_INVALID_ARGUMENT;
  *size = sensors->value.size();
  return WINNOW_OK;
}

winnow_status winnow_sensors_contains(const winnow_sensors* sensors, winnow_key key,
                                      bool* contains) {
  if (!are_given(sensors, contains)) return WINNOW_INVALID_ARGUMENT;
  *contains = sensors->value.contains(*as_cpp(&key));
  return WINNOW_OK;
}

winnow_status winnow_sensors_sense(winnow_sensors* sensors) {
  if (sensors == nullptr) return WINNOW_INVALID_ARGUMENT;
  return answer(sensors->value.sense());
}

winnow_status winnow_sensors_sensed(const winnow_sensors* sensors,
                                    const winnow_sensed_body** bodies, size_t* count) {
  if (!are_given(sensors, bodies, count)) return WINNOW_INVALID_ARGUMENT;
  return_array(sensors->value.sensed(), bodies, count);
  return WINNOW_OK;
}

winnow_status winnow_sensors_left(const winnow_sensors* sensors, const winnow_left_sensor** bodies,
                                  size_t* count) {
  if (!are_given(sensors, bodies, count)) return WINNOW_INVALID_ARGUMENT;
  return_array(sensors->value.left(), bodies, count);
  return WINNOW_OK;
}

winnow_status winnow_sensors_footprint(const winnow_sensors* sensors, winnow_footprint* footprint) {
  if (sensors == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(sensors, sensors->value.footprint(), {}, footprint);
}
