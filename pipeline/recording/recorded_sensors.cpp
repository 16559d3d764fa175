#include <winnow/pipeline/recording.h>

#include "pipeline/recording/impact_digest.h"
#include "pipeline/recording/recorder_state.h"

namespace winnow {

RecordedSensors::RecordedSensors(RecordedScene& scene, std::pmr::memory_resource* memory) noexcept
    : scene_(scene), number_(scene.sensors_recorded_++), sensors_(scene.scene_, memory) {
  CallWriter(scene_.recorder_, RecordedCall::make_sensors, scene_.world_).put(number_);
}

RecordedSensors::~RecordedSensors() {
  CallWriter(scene_.recorder_, RecordedCall::end_sensors, scene_.world_).put(number_);
}

void RecordedSensors::record(RecordedCall kind, Key key, const SensorDefinition& sensor) noexcept {
  const std::uint32_t shape = scene_.number_of(sensor.shape);
  const bool is_carried = scene_.scene_.contains(sensor.carrier);
  CallWriter call(scene_.recorder_, kind, scene_.world_);
  call.put(number_).put(key.id).put(shape);
  call.put_bytes(&sensor.pose, sizeof sensor.pose);
  call.put_bytes(&sensor.filter, sizeof sensor.filter);
  call.put(is_carried ? sensor.carrier.id : kNoObject).put(sensor.data);
}

Answer<Key> RecordedSensors::add(const SensorDefinition& sensor) {
  const Answer<Key> key = sensors_.add(sensor);
  if (key.status == Status::ok) record(RecordedCall::add_sensor, key, sensor);
  return key;
}

Status RecordedSensors::set(Key key, const SensorDefinition& sensor) {
  const Status status = sensors_.set(key, sensor);
  if (status == Status::ok) record(RecordedCall::set_sensor, key, sensor);
  return status;
}

Status RecordedSensors::remove(Key key) {
  const Status status = sensors_.remove(key);
  if (status == Status::ok) {
    CallWriter(scene_.recorder_, RecordedCall::remove_sensor, scene_.world_)
        .put(number_)
        .put(key.id);
  }
  return status;
}

Status RecordedSensors::move(Key key, const Pose& pose) {
  const Status status = sensors_.move(key, pose);
  if (status == Status::ok) {
    CallWriter(scene_.recorder_, RecordedCall::move_sensor, scene_.world_)
        .put(number_)
        .put(key.id)
        .put_bytes(&pose, sizeof pose);
  }
  return status;
}

Status RecordedSensors::sense() {
  scene_.record_composite_changes();
  const Status status = sensors_.sense();
  if (status == Status::ok) {
    CallWriter(scene_.recorder_, RecordedCall::sense, scene_.world_)
        .put(number_)
        .put(digest_of_answers(sensors_).value());
  }
  return status;
}

}  // namespace winnow
