// The class Sensors: volumes that detect the bodies of a scene, with events.

#include "pipeline/python/batch.h"
#include "pipeline/python/bodies.h"
#include "pipeline/python/entry_columns.h"

#include <winnow/pipeline/sensors.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace winnow::python {
namespace {

/// Sensors of a scene. Calls lock the scene; `held` counts the shapes of sensors as used.
struct SharedSensors : NeedsInit {
  explicit SharedSensors(std::shared_ptr<SharedScene> of)
      : scene(std::move(of)), sensors(scene->scene), held(scene->shapes) {}

  const std::shared_ptr<SharedScene> scene;
  Sensors sensors;
  HeldShapes held;
};

/// Runs body() with exclusive access to the sensors, while shapes do not change; throws unless its
/// status is ok.
template <typename Body>
void change_sensors_or_throw(SharedSensors& s, const char* call, Body&& body) {
  accept(s.scene->working(std::forward<Body>(body)), call);
}

using Definitions = std::vector<SensorDefinition>;

/// Definitions of sensors as columns.
struct SensorInput {
  SensorInput(const SharedSensors& s, py::handle shape_array, py::handle poses, py::handle layers,
              py::handle mask, py::handle environment, py::handle carriers, py::handle data,
              py::handle scene_layer)
      : pose(poses), shape(*s.scene->shapes, shape_array) {
    FilterInput filter(layers, mask, environment);
    const std::size_t count = agree({&pose, &shape});
    filter.expect(count);
    EachInteger layer(scene_layer, "layer", kEveryLayer);
    layer.expect(count);
    const std::vector<ClientData> values = data_of(data, count);
    if (!carriers.is_none()) carrier.emplace(*s.scene, carriers, "carrier").expect(count);
    list.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      list[i] = {shape[i],
                 pose[i],
                 filter[i],
                 carrier ? carrier->keys()[i] : Key{},
                 static_cast<std::uint16_t>(layer[i]),
                 values.empty() ? 0 : values[i]};
    }
  }

  PoseInput pose;
  ShapeInput shape;
  std::optional<KeyInput> carrier;
  Definitions list;
};

/// True if a key is of a sensor.
[[nodiscard]] bool has_key(const SharedSensors& s, Key key) {
  return reading(s.scene->mutex, [&] { return s.sensors.contains(key); });
}

[[nodiscard]] Status sensors_of(const Sensors& sensors, std::span<const Key> keys,
                                Definitions& all) {
  return definitions_of(keys, all, [&](Key key, SensorDefinition& sensor) {
    return sensors.sensor(key).get(sensor);
  });
}

[[nodiscard]] py::array add(SharedSensors& s, py::handle shapes, py::handle poses,
                            py::handle layers, py::handle mask, py::handle environment,
                            py::handle carriers, py::handle data, py::handle layer) {
  const SensorInput input(s, shapes, poses, layers, mask, environment, carriers, data, layer);
  const Definitions& sensors = input.list;
  auto keys = fresh<std::uint64_t>(sensors.size());
  Key* const out = keys_in(keys);
  const std::vector<ShapeId> used = shapes_of(sensors);
  change_sensors_or_throw(s, "add", [&] {
    const Status status = set_all(
        sensors.size(), [&](std::size_t i) { return s.sensors.add(sensors[i]).get(out[i]); },
        [&](std::size_t i) { return s.sensors.remove(out[i]); });
    if (status == Status::ok) s.held.use(used, 1);
    return status;
  });
  return keys;
}

void remove(SharedSensors& s, py::handle key_array) {
  const KeyInput keys(s, key_array);
  change_sensors_or_throw(s, "remove", [&] {
    Definitions before;
    Status status = sensors_of(s.sensors, keys.keys(), before);
    if (status == Status::ok && has_twice(keys.keys())) {
      status = Status::invalid_key;
    }
    if (status != Status::ok) return status;
    for (const Key key : keys.keys()) {
      status = s.sensors.remove(key);
      if (status != Status::ok) return status;
    }
    s.held.use(shapes_of(before), -1);
    return status;
  });
}

void move(SharedSensors& s, py::handle key_array, py::handle poses) {
  const KeyInput input(s, key_array);
  const std::span<const Key> keys = input.keys();
  PoseInput pose(poses);
  pose.expect(keys.size());
  change_sensors_or_throw(s, "move", [&] {
    Definitions before;
    const Status status = sensors_of(s.sensors, keys, before);
    if (status != Status::ok) return status;
    return set_all(
        keys.size(), [&](std::size_t i) { return s.sensors.move(keys[i], pose[i]); },
        [&](std::size_t i) { return s.sensors.move(keys[i], before[i].pose); });
  });
}

void set(SharedSensors& s, py::handle key_array, py::handle shapes, py::handle poses,
         py::handle layers, py::handle mask, py::handle environment, py::handle carriers,
         py::handle data, py::handle layer) {
  const KeyInput input(s, key_array);
  const std::span<const Key> keys = input.keys();
  const SensorInput sensors(s, shapes, poses, layers, mask, environment, carriers, data, layer);
  const Definitions& after = sensors.list;
  if (after.size() != keys.size()) {
    throw Refusal(Status::size_mismatch, "poses: expected one for each key");
  }
  change_sensors_or_throw(s, "set", [&] {
    Definitions before;
    Status status = sensors_of(s.sensors, keys, before);
    if (status == Status::ok && has_twice(keys)) status = Status::invalid_key;
    if (status != Status::ok) return status;
    status = set_all(
        keys.size(), [&](std::size_t i) { return s.sensors.set(keys[i], after[i]); },
        [&](std::size_t i) { return s.sensors.set(keys[i], before[i]); });
    if (status != Status::ok) return status;
    s.held.use(shapes_of(after), 1);
    s.held.use(shapes_of(before), -1);
    return status;
  });
}

[[nodiscard]] py::object sense(SharedSensors& s) {
  std::vector<SensedBody> in;
  std::vector<ExitedBody> out;
  change_sensors_or_throw(s, "sense", [&] {
    const Status status = s.sensors.sense();
    if (status != Status::ok) return status;
    in.assign(s.sensors.sensed().begin(), s.sensors.sensed().end());
    out.assign(s.sensors.left().begin(), s.sensors.left().end());
    return status;
  });
  const auto sensed = columns_of(std::move(in));
  const auto left = columns_of(std::move(out));
  return sensed.table("Sensed", &SensedBody::sensor, &SensedBody::body, &SensedBody::sensor_data,
                      &SensedBody::body_data, &SensedBody::event,
                      left.rows<std::uint64_t>(offsetof(ExitedBody, sensor), 2),
                      left.rows<std::uint64_t>(offsetof(ExitedBody, sensor_data), 2));
}

}  // namespace

void add_sensors(py::module_& module) {
  Class<SharedSensors>(module, "Sensors")
      .def(py::init([](const std::shared_ptr<SharedScene>& scene) {
        return std::make_shared<SharedSensors>(scene);
      }))
      .def("add", &add)
      .def("set", &set)
      .def("remove", &remove)
      .def("move", &move)
      .def("__len__",
           [](const SharedSensors& s) {
             return reading(s.scene->mutex, [&] { return s.sensors.size(); });
           })
      .def("contains",
           [](const SharedSensors& s, py::handle key_array) {
             const KeyInput keys(s, key_array);
             return each_answer<bool>(s.scene->mutex, keys.count(), [&](std::size_t i) {
               return s.sensors.contains(keys.keys()[i]);
             });
           })
      .def("sense", &sense);
}

}  // namespace winnow::python
