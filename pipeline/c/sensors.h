// Generated from pipeline/interface/sensors.toml; do not edit.
// clang-format off
#pragma once

/// Sensors: volumes that report which bodies of a scene overlap them. Sensors are not bodies: rays
/// and bodies do not hit them, and they do not sense each other.

#include <winnow/c/core.h>
#include <winnow/c/scene.h>
#include <winnow/c/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Sensors of a scene.
typedef struct winnow_sensors winnow_sensors;

/// A sensor to add.
typedef struct winnow_sensor_definition {
  winnow_shape_id shape;        ///< from the scene's pools, convex or composite
  winnow_pose pose;             ///< pose of the shape's frame in the world
  winnow_object_filter filter;  ///< which bodies it senses
  winnow_key carrier;           ///< a body that the sensor ignores
  /// Layer of the sensor; bodies whose layer does not collide with it are not sensed.
  uint16_t layer;
  uint64_t data;  ///< the caller's value, returned with sensed bodies; never read
} winnow_sensor_definition;
#define WINNOW_SENSOR_DEFINITION \
  {WINNOW_NO_SHAPE, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}, {1U, 0xFFFFFFFFU, 0U}, \
  {WINNOW_NO_OBJECT, 0}, WINNOW_EVERY_LAYER, 0}

/// A body that shares a point with a sensor.
typedef struct winnow_sensed_body {
  winnow_key sensor;
  winnow_key body;
  uint64_t sensor_data;  ///< client data of the sensor
  uint64_t body_data;    ///< client data of the body
  uint8_t event;         ///< WINNOW_EVENT_BEGUN or WINNOW_EVENT_PERSISTED
} winnow_sensed_body;

/// A body that the previous `sense` found and the last one did not. Keys of removed objects are
/// stale.
typedef struct winnow_left_sensor {
  winnow_key sensor;
  winnow_key body;
  uint64_t sensor_data;  ///< client data of the sensor
  uint64_t body_data;    ///< client data of the body
} winnow_left_sensor;

/// Creates sensors on a scene, which must outlive them.
WINNOW_C_API winnow_status winnow_sensors_create(
    winnow_scene* scene, const winnow_memory* memory, winnow_sensors** sensors);

/// Destroys the sensors; does nothing for null.
WINNOW_C_API void winnow_sensors_destroy(winnow_sensors* sensors);

/// Adds a sensor. WINNOW_INVALID_KEY if the scene's pools do not contain the shape;
/// WINNOW_INVALID_POSE; WINNOW_TOO_MANY_OBJECTS beyond 2^28.
WINNOW_C_API winnow_status winnow_sensors_add(
    winnow_sensors* sensors, const winnow_sensor_definition* sensor, winnow_key* key);

/// Removes a sensor. The bodies that it sensed leave it in the next `sense`.
WINNOW_C_API winnow_status winnow_sensors_remove(winnow_sensors* sensors, winnow_key key);

/// Sets the pose of a sensor.
WINNOW_C_API winnow_status winnow_sensors_move(
    winnow_sensors* sensors, winnow_key key, const winnow_pose* pose);

/// Replaces the whole definition of a sensor; its key stays. Errors as for winnow_sensors_add.
WINNOW_C_API winnow_status winnow_sensors_set(
    winnow_sensors* sensors, winnow_key key, const winnow_sensor_definition* sensor);

/// Writes the current definition of a sensor.
WINNOW_C_API winnow_status winnow_sensors_sensor(
    const winnow_sensors* sensors, winnow_key key, winnow_sensor_definition* sensor);

/// Returns the number of sensors.
WINNOW_C_API winnow_status winnow_sensors_size(const winnow_sensors* sensors, size_t* size);

/// Returns whether the key belongs to a sensor of this object.
WINNOW_C_API winnow_status winnow_sensors_contains(
    const winnow_sensors* sensors, winnow_key key, bool* contains);

/// Finds the bodies inside each sensor, on the threads of the scene; refreshes the scene first.
/// WINNOW_INVALID_KEY if the shape of a sensor has been removed from its pool.
WINNOW_C_API winnow_status winnow_sensors_sense(winnow_sensors* sensors);

/// Returns the sensed bodies, sorted by the ids of sensors, then of bodies; not copied, valid until
/// the next `sense`.
WINNOW_C_API winnow_status winnow_sensors_sensed(
    const winnow_sensors* sensors, const winnow_sensed_body** bodies, size_t* count);

/// Returns the bodies that left, in the same order; not copied, valid until the next `sense`.
WINNOW_C_API winnow_status winnow_sensors_left(
    const winnow_sensors* sensors, const winnow_left_sensor** bodies, size_t* count);

/// Writes the bytes of the sensors, by purpose.
WINNOW_C_API winnow_status winnow_sensors_footprint(
    const winnow_sensors* sensors, winnow_footprint* footprint);

#ifdef __cplusplus
}
#endif
