// Writes the calls of Sensors and ContinuousCollision to a recording.

#include "pipeline/recording/impact_digest.h"
#include "pipeline/recording/scene_recording.h"

namespace winnow {
namespace {

/// Writes the end of a call that found impacts.
void put_impacts(CallWriter& call, const ContinuousOptions& options,
                 const ContinuousCollision& ccd) noexcept {
  call.put(options.pairs).put_array(options.bullets);
  call.put(options.tolerance).put(options.touching).put(options.first_only);
  call.put(digest_of_answers(ccd).value());
}

}  // namespace

void SceneRecording::find_impacts(std::span<const Key> keys, const PoseView& ends,
                                  const ContinuousOptions& options,
                                  const ContinuousCollision& ccd) noexcept {
  shapes_.record_changes();
  accepted_.write();
  CallWriter call = write(RecordedCall::find_impacts);
  put_impacts(call.put_ids(keys).put_poses(ends), options, ccd);
}

void SceneRecording::find_impacts(std::span<const Key> keys, std::span<const RigidMotion> motions,
                                  const ContinuousOptions& options,
                                  const ContinuousCollision& ccd) noexcept {
  shapes_.record_changes();
  accepted_.write();
  CallWriter call = write(RecordedCall::find_impacts_of_motions);
  put_impacts(call.put_ids(keys).put_array(motions), options, ccd);
}

std::uint32_t SceneRecording::make_sensors() noexcept {
  write(RecordedCall::make_sensors).put(sensors_);
  return sensors_++;
}

void SceneRecording::end_sensors(std::uint32_t number) noexcept {
  write(RecordedCall::end_sensors).put(number);
}

void SceneRecording::write_sensor(RecordedCall kind, std::uint32_t number, Key key,
                                  const SensorDefinition& sensor) noexcept {
  const std::uint32_t shape = shapes_.number_of(sensor.shape);
  const bool is_carried = scene_.keys.is_valid(sensor.carrier);
  CallWriter call = write(kind);
  call.put(number).put(key.id).put(shape);
  call.put_bytes(&sensor.pose, sizeof sensor.pose);
  call.put_bytes(&sensor.filter, sizeof sensor.filter);
  call.put(is_carried ? sensor.carrier.id : kNoObject).put(sensor.data).put(sensor.layer);
}

void SceneRecording::add_sensor(std::uint32_t number, Key key,
                                const SensorDefinition& sensor) noexcept {
  write_sensor(RecordedCall::add_sensor_in_layer, number, key, sensor);
}

void SceneRecording::set_sensor(std::uint32_t number, Key key,
                                const SensorDefinition& sensor) noexcept {
  write_sensor(RecordedCall::set_sensor_in_layer, number, key, sensor);
}

void SceneRecording::remove_sensor(std::uint32_t number, Key key) noexcept {
  write(RecordedCall::remove_sensor).put(number).put(key.id);
}

void SceneRecording::move_sensor(std::uint32_t number, Key key, const Pose& pose) noexcept {
  write(RecordedCall::move_sensor).put(number).put(key.id).put_bytes(&pose, sizeof pose);
}

void SceneRecording::sense(std::uint32_t number, const Sensors& sensors) noexcept {
  shapes_.record_changes();
  write(RecordedCall::sense).put(number).put(digest_of_answers(sensors).value());
}

}  // namespace winnow
