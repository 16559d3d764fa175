// The class Sensors: volumes that detect the bodies of a scene, with events.

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

/// Runs body() with exclusive access to the sensors, while shapes do not change.
template <typename Body>
auto changing_sensors(SharedSensors& s, Body&& body) {
  return s.scene->working(std::forward<Body>(body));
}

using Definitions = std::vector<SensorDefinition>;

/// Converts the arguments to definitions.
[[nodiscard]] Definitions defined(py::handle shape_array, py::handle poses, py::handle layers,
                                  py::handle mask, py::handle environment, py::handle carriers,
                                  py::handle data) {
  const PoseInput pose(poses);
  const ShapeInput shape(shape_array);
  const FilterInput filter(layers, mask, environment);
  const std::size_t count = pose.count();
  shape.expect(count);
  filter.expect(count);
  const std::vector<ClientData> values = data_of(data, count);
  std::optional<KeyInput> carrier;
  if (!carriers.is_none()) {
    carrier.emplace(carriers, "carrier");
    if (carrier->count() != count) {
      throw Refusal(Status::size_mismatch, "carrier: expected one key for each sensor");
    }
  }
  Definitions sensors(count);
  for (std::size_t i = 0; i < count; ++i) {
    sensors[i] = {shape[i], pose[i], filter[i], carrier ? carrier->keys()[i] : Key{},
                  values.empty() ? 0 : values[i]};
  }
  return sensors;
}

[[nodiscard]] Status sensors_of(const Sensors& sensors, std::span<const Key> keys,
                                Definitions& all) {
  return definitions_of(keys, all, [&](Key key, SensorDefinition& sensor) {
    return sensors.sensor(key).get(sensor);
  });
}

[[nodiscard]] py::array add(SharedSensors& s, py::handle shapes, py::handle poses,
                            py::handle layers, py::handle mask, py::handle environment,
                            py::handle carriers, py::handle data) {
  const Definitions sensors = defined(shapes, poses, layers, mask, environment, carriers, data);
  auto keys = fresh<std::uint64_t>(sensors.size());
  Key* const out = keys_in(keys);
  const std::vector<ShapeId> used = shapes_of(sensors);
  accept(
      changing_sensors(s,
                       [&] {
                         const Status status = set_all(
                             sensors.size(),
                             [&](std::size_t i) { return s.sensors.add(sensors[i]).get(out[i]); },
                             [&](std::size_t i) { return s.sensors.remove(out[i]); });
                         if (status == Status::ok) s.held.use(used, 1);
                         return status;
                       }),
      "add");
  return keys;
}

void remove(SharedSensors& s, py::handle key_array) {
  const KeyInput keys(key_array);
  accept(changing_sensors(s,
                          [&] {
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
                          }),
         "remove");
}

void move(SharedSensors& s, py::handle key_array, py::handle poses) {
  const KeyInput input(key_array);
  const std::span<const Key> keys = input.keys();
  const PoseInput pose(poses);
  if (pose.count() != keys.size()) {
    throw Refusal(Status::size_mismatch, "move: keys and poses differ in length");
  }
  accept(changing_sensors(
             s,
             [&] {
               Definitions before;
               const Status status = sensors_of(s.sensors, keys, before);
               if (status != Status::ok) return status;
               return set_all(
                   keys.size(), [&](std::size_t i) { return s.sensors.move(keys[i], pose[i]); },
                   [&](std::size_t i) { return s.sensors.move(keys[i], before[i].pose); });
             }),
         "move");
}

void set(SharedSensors& s, py::handle key_array, py::handle shapes, py::handle poses,
         py::handle layers, py::handle mask, py::handle environment, py::handle carriers,
         py::handle data) {
  const KeyInput input(key_array);
  const std::span<const Key> keys = input.keys();
  const Definitions after = defined(shapes, poses, layers, mask, environment, carriers, data);
  if (after.size() != keys.size()) {
    throw Refusal(Status::size_mismatch, "set: keys and poses differ in length");
  }
  accept(changing_sensors(s,
                          [&] {
                            Definitions before;
                            Status status = sensors_of(s.sensors, keys, before);
                            if (status == Status::ok && has_twice(keys))
                              status = Status::invalid_key;
                            if (status != Status::ok) return status;
                            status = set_all(
                                keys.size(),
                                [&](std::size_t i) { return s.sensors.set(keys[i], after[i]); },
                                [&](std::size_t i) { return s.sensors.set(keys[i], before[i]); });
                            if (status != Status::ok) return status;
                            s.held.use(shapes_of(after), 1);
                            s.held.use(shapes_of(before), -1);
                            return status;
                          }),
         "set");
}

[[nodiscard]] py::array contains(const SharedSensors& s, py::handle key_array) {
  const KeyInput keys(key_array);
  auto result = fresh<bool>(keys.count());
  bool* const to = result.mutable_data();
  reading(s.scene->mutex, [&] {
    for (std::size_t i = 0; i < keys.count(); ++i) to[i] = s.sensors.contains(keys.keys()[i]);
  });
  return result;
}

struct SensedTable : EmptyIfZero {
  py::array sensor;
  py::array body;
  py::array sensor_data;
  py::array body_data;
  py::array event;
  py::array left;
  py::array left_data;
};

[[nodiscard]] SensedTable sense(SharedSensors& s) {
  std::vector<SensedBody> in;
  std::vector<ExitedBody> out;
  accept(changing_sensors(s,
                          [&] {
                            const Status status = s.sensors.sense();
                            if (status != Status::ok) return status;
                            in.assign(s.sensors.sensed().begin(), s.sensors.sensed().end());
                            out.assign(s.sensors.left().begin(), s.sensors.left().end());
                            return status;
                          }),
         "sense");
  const auto sensed = columns_of(std::move(in));
  const auto left = columns_of(std::move(out));
  return {{},
          sensed.column<std::uint64_t>(offsetof(SensedBody, sensor)),
          sensed.column<std::uint64_t>(offsetof(SensedBody, body)),
          sensed.column<std::uint64_t>(offsetof(SensedBody, sensor_data)),
          sensed.column<std::uint64_t>(offsetof(SensedBody, body_data)),
          sensed.column<std::uint8_t>(offsetof(SensedBody, event)),
          left.rows<std::uint64_t>(offsetof(ExitedBody, sensor), 2),
          left.rows<std::uint64_t>(offsetof(ExitedBody, sensor_data), 2)};
}

using SensorsClass = py::class_<SharedSensors, std::shared_ptr<SharedSensors>>;

void add_table(py::module_& module) {
  using Table = SensedTable;
  py::class_<Table>(module, "Sensed", "Bodies in sensors, by the ids of sensors and of bodies.")
      .def_readonly("sensor", &Table::sensor, "Keys of sensors, (n,) uint64.")
      .def_readonly("body", &Table::body, "Keys of bodies in them, (n,) uint64.")
      .def_readonly("sensor_data", &Table::sensor_data, "Client data of sensors, (n,) uint64.")
      .def_readonly("body_data", &Table::body_data, "Client data of bodies, (n,) uint64.")
      .def_readonly("event", &Table::event,
                    "0 for bodies that entered, 1 for bodies that stay: (n,) uint8.")
      .def_readonly("left", &Table::left,
                    "Pairs (sensor, body) that were there in the last call and are not now: (k, 2) "
                    "uint64. Keys of removed sensors and bodies are stale.")
      .def_readonly("left_data", &Table::left_data,
                    "Client data of the pairs in `left`, (k, 2) uint64.");
}

void add_changes(SensorsClass& type) {
  using py::arg;
  constexpr std::uint32_t every = ~0U;
  type.def("add", &add, arg("shapes"), arg("poses"), arg("layers") = 1, arg("mask") = every,
           arg("environment") = 0, arg("carrier") = py::none(), arg("data") = py::none(),
           "Adds n sensors and returns their keys, (n,) uint64: shapes (n,), or one for all, with "
           "poses and filters as in Scene.add. `carrier`: keys (n,) of bodies that they ignore, "
           "NULL_KEY for none. `data`: (n,) uint64. All or none: size_mismatch, invalid_key for an "
           "unknown shape, invalid_pose, too_many_objects beyond 2^28.")
      .def("set", &set, arg("keys"), arg("shapes"), arg("poses"), arg("layers") = 1,
           arg("mask") = every, arg("environment") = 0, arg("carrier") = py::none(),
           arg("data") = py::none(),
           "Replaces the definitions of the sensors of `keys` (n,), as in `add`; their keys stay. "
           "Errors as in `add`, and invalid_key for a key that is stale or given twice.")
      .def("remove", &remove, arg("keys"),
           "Removes sensors (n,), all or none: their bodies leave them in the next `sense`. "
           "invalid_key for a key that is stale or given twice.")
      .def("move", &move, arg("keys"), arg("poses"),
           "Sets new poses of the sensors (n,). size_mismatch, invalid_key, invalid_pose.");
}

}  // namespace

void add_sensors(py::module_& module) {
  using py::arg;
  add_table(module);
  SensorsClass type(module, "Sensors",
                    "Volumes that detect the bodies in them, and which entered or left, without "
                    "contacts: goals, triggers, light curtains. Rays and bodies do not collide "
                    "with them. A call that raises changes nothing.");
  type.def(py::init([](const std::shared_ptr<SharedScene>& scene) {
             return std::make_shared<SharedSensors>(scene);
           }),
           arg("scene").none(false),
           "No sensors yet. They detect the bodies of `scene`, which they keep alive.");
  add_changes(type);
  type.def("__len__",
           [](const SharedSensors& s) {
             return reading(s.scene->mutex, [&] { return s.sensors.size(); });
           })
      .def("contains", &contains, arg("keys"), "True for `keys` (n,) of live sensors: (n,) bool.")
      .def("sense", &sense,
           "Finds the bodies in each sensor, exactly: fixed, dynamic and sleeping ones. O(sensors "
           "(log n + bodies near each)).");
}

}  // namespace winnow::python
