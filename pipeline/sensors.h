#pragma once

#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/object_filter.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/shapes.h>

#include <cstddef>
#include <memory_resource>
#include <span>

namespace winnow {

struct SensorsState;

/// A sensor as it is added.
struct SensorDefinition {
  ShapeId shape{};        ///< of the scene's pools, convex or composite
  Pose pose{};            ///< where the shape's own frame stands in the world
  ObjectFilter filter{};  ///< which bodies it senses
  Key carrier{};          ///< a body that it does not sense, such as the one it is fixed to
  ClientData data = 0;    ///< yours, given back with what is sensed; never read
};

/// A body that shares a point with a sensor.
struct SensedBody {
  Key sensor;                                ///< of the Sensors
  Key body;                                  ///< of the scene
  ClientData sensor_data = 0;                ///< that the sensor was added with
  ClientData body_data = 0;                  ///< that the body was added with
  ContactEvent event = ContactEvent::begun;  ///< whether it was sensed the last time
};

/// A body that was sensed the last time and is not now. Keys of what was removed are stale.
struct LeftSensor {
  Key sensor;                  ///< of the Sensors
  Key body;                    ///< of the scene
  ClientData sensor_data = 0;  ///< that the sensor was added with
  ClientData body_data = 0;    ///< that the body was added with
};

/// Volumes that tell which bodies of a scene are in them, who came and who left, and make no
/// contacts: goals, triggers, a robot's light curtains. They are no bodies: neither rays nor bodies
/// meet them, nor do they sense each other, and a scene without them pays nothing.
///
///     winnow::Sensors sensors(scene);
///     sensors.add({.shape = ball, .pose = winnow::Pose::at(0, 0, 2)}, goal);
///     sensors.sense();
///     for (const winnow::SensedBody& in : sensors.sensed()) { ... }
///
/// Fixed, dynamic and sleeping bodies are sensed alike, exactly (as tier robust). A refused call
/// changed nothing. Calls are made one at a time.
class WINNOW_API Sensors {
 public:
  /// Senses bodies of `scene`, which must outlive this. Every allocation comes from `memory`, which
  /// must too; where its state is refused, calls are `out_of_memory`.
  explicit Sensors(Scene& scene, std::pmr::memory_resource* memory = default_memory()) noexcept;
  ~Sensors();
  Sensors(const Sensors&) = delete;
  Sensors& operator=(const Sensors&) = delete;

  /// Adds a sensor. `invalid_key` for a shape that the scene's pools do not have, `invalid_pose`;
  /// `too_many_objects` beyond 2^28.
  Status add(const SensorDefinition& sensor, Key& key);
  /// Removes a sensor: what it sensed leaves it by the next `sense`.
  Status remove(Key key);
  /// Gives a sensor a new pose.
  Status move(Key key, const Pose& pose);
  /// Replaces all that the sensor is; its key stays. Errors are those of `add`.
  Status set(Key key, const SensorDefinition& sensor);
  /// The sensor as it stands now.
  Status sensor(Key key, SensorDefinition& sensor) const noexcept;

  /// Looks at the scene as it stands now, which it refreshes, on the threads of the scene; what it
  /// senses is the same on any number. O(sensors (log n + bodies near each)). `out_of_memory`
  /// leaves nothing sensed. `invalid_key` if a shape of a sensor has been removed meanwhile.
  Status sense();
  /// What was sensed, by the ids of sensors and then of bodies.
  [[nodiscard]] std::span<const SensedBody> sensed() const noexcept;
  /// What has left, in the same order.
  [[nodiscard]] std::span<const LeftSensor> left() const noexcept;

  /// Sensors that there are.
  [[nodiscard]] std::size_t size() const noexcept;
  /// True for keys of sensors that there are.
  [[nodiscard]] bool contains(Key key) const noexcept;
  /// What is sensed and has left under `results`, what was sensed before under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  std::pmr::memory_resource* memory_;
  /// Null where memory was refused.
  SensorsState* state_;
};

}  // namespace winnow
