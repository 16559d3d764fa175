#pragma once

/// Sensors: volumes that report which bodies of a scene overlap them. <winnow/pipeline/sensors.h>
/// documents each call under the same name.

#include <winnow/c/core.h>
#include <winnow/c/scene.h>
#include <winnow/c/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// A sensor to add.
typedef struct winnow_sensor_definition {
  winnow_shape_id shape;
  winnow_pose pose;
  winnow_object_filter filter;
  winnow_key carrier;  ///< a body that the sensor ignores
  uint64_t data;
} winnow_sensor_definition;
#define WINNOW_SENSOR_DEFINITION                                                     \
  {                                                                                  \
    WINNOW_NO_SHAPE, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}, {1U, 0xFFFFFFFFU, 0U}, \
        WINNOW_NULL_KEY, 0                                                           \
  }

/// A body that shares a point with a sensor.
typedef struct winnow_sensed_body {
  winnow_key sensor;
  winnow_key body;
  uint64_t sensor_data;
  uint64_t body_data;
  uint8_t event;  ///< WINNOW_EVENT_BEGUN or WINNOW_EVENT_PERSISTED
} winnow_sensed_body;

/// A body that was sensed by the previous `sense` and is not sensed now.
typedef struct winnow_left_sensor {
  winnow_key sensor;
  winnow_key body;
  uint64_t sensor_data;
  uint64_t body_data;
} winnow_left_sensor;

typedef struct winnow_sensors winnow_sensors;
/// `scene` must outlive the sensors.
WINNOW_C_API winnow_status winnow_sensors_create(winnow_scene* scene, const winnow_memory* memory,
                                                 winnow_sensors** sensors);
WINNOW_C_API void winnow_sensors_destroy(winnow_sensors* sensors);

WINNOW_C_API winnow_status winnow_sensors_add(winnow_sensors* sensors,
                                              const winnow_sensor_definition* sensor,
                                              winnow_key* key);
WINNOW_C_API winnow_status winnow_sensors_remove(winnow_sensors* sensors, winnow_key key);
WINNOW_C_API winnow_status winnow_sensors_move(winnow_sensors* sensors, winnow_key key,
                                               const winnow_pose* pose);
WINNOW_C_API winnow_status winnow_sensors_set(winnow_sensors* sensors, winnow_key key,
                                              const winnow_sensor_definition* sensor);
WINNOW_C_API winnow_status winnow_sensors_sensor(const winnow_sensors* sensors, winnow_key key,
                                                 winnow_sensor_definition* sensor);
WINNOW_C_API winnow_status winnow_sensors_size(const winnow_sensors* sensors, size_t* size);
WINNOW_C_API winnow_status winnow_sensors_contains(const winnow_sensors* sensors, winnow_key key,
                                                   bool* contains);

WINNOW_C_API winnow_status winnow_sensors_sense(winnow_sensors* sensors);
/// Return arrays that are not copied and are valid until the next `sense`.
WINNOW_C_API winnow_status winnow_sensors_sensed(const winnow_sensors* sensors,
                                                 const winnow_sensed_body** bodies, size_t* count);
WINNOW_C_API winnow_status winnow_sensors_left(const winnow_sensors* sensors,
                                               const winnow_left_sensor** bodies, size_t* count);
WINNOW_C_API winnow_status winnow_sensors_footprint(const winnow_sensors* sensors,
                                                    winnow_footprint* footprint);

#ifdef __cplusplus
}
#endif
