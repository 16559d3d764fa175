// Plays calls of sensors and of continuous collision detection.

#include "pipeline/recording/impact_digest.h"
#include "pipeline/replay/replay_state.h"

namespace winnow {

Status ReplayState::play_sensors(RecordedCall call, ReplayedWorld& of) {
  const auto number = in.get<std::uint32_t>();
  if (!in.ok()) return reading();
  if (call == RecordedCall::make_sensors) {
    if (number != of.sensors.size()) return Status::invalid_argument;
    auto* const made = new_in<ReplayedSensors>(options.memory, *of.scene, options.memory);
    if (made != nullptr && of.sensors.push_back(made)) return Status::ok;
    delete_in(options.memory, made);
    return Status::out_of_memory;
  }
  if (number >= of.sensors.size() || of.sensors[number] == nullptr) return Status::invalid_argument;
  if (call == RecordedCall::end_sensors) {
    delete_in(options.memory, std::exchange(of.sensors[number], nullptr));
    return Status::ok;
  }
  ReplayedSensors& all = *of.sensors[number];
  if (call != RecordedCall::sense) return change_sensor(call, of, all);
  const Status answered = all.sensors.sense();
  return answered == Status::ok ? compare(all.sensors) : answered;
}

Status ReplayState::change_sensor(RecordedCall call, ReplayedWorld& of, ReplayedSensors& all) {
  const auto id = in.get<ObjectId>();
  const Key key = id < all.keys.size() ? all.keys[id] : Key{};
  if (call == RecordedCall::remove_sensor) return in.ok() ? all.sensors.remove(key) : reading();
  SensorDefinition sensor;
  if (call == RecordedCall::move_sensor) {
    if (!in.get_bytes(&sensor.pose, sizeof sensor.pose)) return reading();
    return all.sensors.move(key, sensor.pose);
  }
  if (!read_shape(of, sensor.shape)) return reading();
  (void)in.get_bytes(&sensor.pose, sizeof sensor.pose);
  (void)in.get_bytes(&sensor.filter, sizeof sensor.filter);
  sensor.carrier = of.scene->key_of(in.get<ObjectId>());
  sensor.data = in.get<ClientData>();
  if (!in.ok()) return reading();
  if (call == RecordedCall::set_sensor) return all.sensors.set(key, sensor);
  Key made;
  const Status added = all.sensors.add(sensor, made);
  if (added != Status::ok) return added;
  if (made.id != id) return Status::invalid_argument;
  while (all.keys.size() <= id) {
    if (!all.keys.push_back(Key{})) return Status::out_of_memory;
  }
  all.keys[id] = made;
  return Status::ok;
}

Status ReplayState::find_impacts(RecordedCall call, ReplayedWorld& of) {
  if (!of.ccd) of.ccd.emplace(*of.scene, options.memory);
  PoseView ends;
  if (!read_keys(*of.scene)) return reading();
  const bool between = call == RecordedCall::find_impacts;
  if (!(between ? read_poses(keys.size(), ends) : in.get_array(motions))) return reading();
  ContinuousOptions how;
  how.pairs = in.get_enum(ContinuousPairs::bullets_and_fixed);
  if (!in.get_array(flags)) return reading();
  how.bullets = {flags.data(), flags.size()};
  how.tolerance = in.get<double>();
  how.touching = in.get_bool();
  how.first_only = in.get_bool();
  if (!in.ok()) return reading();
  const std::span<const Key> moving(keys.data(), keys.size());
  const std::span<const RigidMotion> ways(motions.data(), motions.size());
  const Status answered =
      between ? of.ccd->find_impacts(moving, ends, how) : of.ccd->find_impacts(moving, ways, how);
  return answered == Status::ok ? compare(*of.ccd) : answered;
}

}  // namespace winnow
