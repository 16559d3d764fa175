// Plays calls of sensors and of continuous collision detection.

#include "pipeline/recording/impact_digest.h"
#include "pipeline/replay/replay_state.h"

namespace winnow {
namespace {

Status change_sensor(ReplayState& replay, RecordedCall call, ReplayedWorld& of,
                     ReplayedSensors& all) {
  const auto id = replay.in.get<ObjectId>();
  const Key key = id < all.keys.size() ? all.keys[id] : Key{};
  if (call == RecordedCall::remove_sensor)
    return replay.in.ok() ? all.sensors.remove(key) : status_of(replay.in);
  SensorDefinition sensor;
  if (call == RecordedCall::move_sensor) {
    if (!replay.in.get_bytes(&sensor.pose, sizeof sensor.pose)) return status_of(replay.in);
    return all.sensors.move(key, sensor.pose);
  }
  if (!replay.read_shape(of, sensor.shape)) return status_of(replay.in);
  (void)replay.in.get_bytes(&sensor.pose, sizeof sensor.pose);
  (void)replay.in.get_bytes(&sensor.filter, sizeof sensor.filter);
  sensor.carrier = of.scene->key_of(replay.in.get<ObjectId>());
  sensor.data = replay.in.get<ClientData>();
  const bool is_set = call == RecordedCall::set_sensor || call == RecordedCall::set_sensor_in_layer;
  // Sensors of recordings before version 5 have no layer.
  const bool has_layer =
      call == RecordedCall::add_sensor_in_layer || call == RecordedCall::set_sensor_in_layer;
  if (has_layer) sensor.layer = replay.in.get<std::uint16_t>();
  if (!replay.in.ok()) return status_of(replay.in);
  if (is_set) return all.sensors.set(key, sensor);
  const Answer<Key> made = all.sensors.add(sensor);
  if (made.status != Status::ok) return made.status;
  if (made.id != id) return Status::invalid_argument;
  while (all.keys.size() <= id) {
    if (!all.keys.push_back(Key{})) return Status::out_of_memory;
  }
  all.keys[id] = made;
  return Status::ok;
}

}  // namespace

Status play_sensors(ReplayState& replay, RecordedCall call, ReplayedWorld& of) {
  const auto number = replay.in.get<std::uint32_t>();
  if (!replay.in.ok()) return status_of(replay.in);
  if (call == RecordedCall::make_sensors) {
    if (number != of.sensors.size()) return Status::invalid_argument;
    auto* const made =
        new_in<ReplayedSensors>(replay.options.memory, *of.scene, replay.options.memory);
    if (made != nullptr && of.sensors.push_back(made)) return Status::ok;
    delete_in(replay.options.memory, made);
    return Status::out_of_memory;
  }
  if (number >= of.sensors.size() || of.sensors[number] == nullptr) return Status::invalid_argument;
  if (call == RecordedCall::end_sensors) {
    delete_in(replay.options.memory, std::exchange(of.sensors[number], nullptr));
    return Status::ok;
  }
  ReplayedSensors& all = *of.sensors[number];
  if (call != RecordedCall::sense) return change_sensor(replay, call, of, all);
  return replay.compare_if(all.sensors.sense(), all.sensors);
}

Status find_impacts(ReplayState& replay, RecordedCall call, ReplayedWorld& of) {
  if (!of.ccd) of.ccd.emplace(*of.scene, replay.options.memory);
  PoseView ends;
  if (!replay.read_keys(*of.scene)) return status_of(replay.in);
  const bool between = call == RecordedCall::find_impacts;
  if (!(between ? replay.read_poses(replay.keys.size(), ends)
                : replay.in.get_array(replay.motions)))
    return status_of(replay.in);
  ContinuousOptions how;
  how.pairs = replay.in.get_enum(ContinuousPairs::bullets_and_fixed);
  if (!replay.in.get_array(replay.flags)) return status_of(replay.in);
  how.bullets = {replay.flags.data(), replay.flags.size()};
  how.tolerance = replay.in.get<double>();
  how.touching = replay.in.get_bool();
  how.first_only = replay.in.get_bool();
  if (!replay.in.ok()) return status_of(replay.in);
  const std::span<const Key> moving(replay.keys.data(), replay.keys.size());
  const std::span<const RigidMotion> ways(replay.motions.data(), replay.motions.size());
  return replay.compare_if(
      between ? of.ccd->find_impacts(moving, ends, how) : of.ccd->find_impacts(moving, ways, how),
      *of.ccd);
}

}  // namespace winnow
