#pragma once

#include <winnow/core/export.h>
#include <winnow/core/filter.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
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

/// A sensor to be added.
struct SensorDefinition {
  ShapeId shape{};        ///< from the scene's pools, convex or composite
  Pose pose{};            ///< pose of the shape's frame in the world
  ObjectFilter filter{};  ///< which bodies it senses
  Key carrier{};          ///< a body that it does not sense, such as the body it is attached to
  /// Layer, below kSceneLayers; bodies whose layer does not collide with it are not sensed.
  std::uint16_t layer = kEveryLayer;
  ClientData data = 0;  ///< the caller's value, returned with sensed bodies; never read
};

/// A body that shares a point with a sensor.
struct SensedBody {
  Key sensor;                                ///< key of the sensor
  Key body;                                  ///< key of the body in the scene
  ClientData sensor_data = 0;                ///< client data of the sensor
  ClientData body_data = 0;                  ///< client data of the body
  ContactEvent event = ContactEvent::begun;  ///< whether the previous `sense` found it too
};

/// A body that the previous `sense` found and the last one did not. Keys of removed objects are
/// stale.
struct ExitedBody {
  Key sensor;                  ///< key of the sensor
  Key body;                    ///< key of the body in the scene
  ClientData sensor_data = 0;  ///< client data of the sensor
  ClientData body_data = 0;    ///< client data of the body
};

/// Volumes that report which bodies of a scene are inside, which entered and which left, without
/// contacts: goals, triggers, a robot's light curtains. Sensors are not bodies: rays and bodies do
/// not hit them, and they do not sense each other. A scene without sensors pays nothing.
///
///     winnow::Sensors sensors(scene);
///     winnow::Key goal = sensors.add({.shape = ball, .pose = winnow::Pose::at(0, 0, 2)});
///     sensors.sense();
///     for (const winnow::SensedBody& in : sensors.sensed()) { ... }
///
/// Fixed, dynamic and sleeping bodies are sensed alike. The test is exact, as in
/// NarrowTier::robust. A failed call changes nothing. The object is not thread-safe: calls must not
/// overlap.
class WINNOW_API Sensors {
 public:
  /// Creates sensors on `scene`, which must outlive this object. Every allocation comes from
  /// `memory`, which must also outlive it. If memory for the object itself is refused, calls return
  /// `out_of_memory`.
  explicit Sensors(Scene& scene, std::pmr::memory_resource* memory = default_memory()) noexcept;
  ~Sensors();
  Sensors(const Sensors&) = delete;
  Sensors& operator=(const Sensors&) = delete;

  /// Adds a sensor. `invalid_key` if the scene's pools do not contain the shape; `invalid_pose`;
  /// `invalid_argument` for a layer out of range; `too_many_objects` beyond 2^28.
  Answer<Key> add(const SensorDefinition& sensor);
  /// Removes a sensor. The bodies that it sensed leave it in the next `sense`.
  Status remove(Key key);
  /// Sets the pose of a sensor.
  Status move(Key key, const Pose& pose);
  /// Replaces the whole definition of a sensor; its key stays. Errors as for `add`.
  Status set(Key key, const SensorDefinition& sensor);
  /// Returns the current definition of a sensor.
  Answer<SensorDefinition> sensor(Key key) const noexcept;

  /// Finds the bodies inside each sensor, on the threads of the scene; refreshes the scene first.
  /// The result is the same for any number of threads. `out_of_memory` leaves no sensed bodies.
  /// `invalid_key` if the shape of a sensor has been removed from its pool. O(sensors (log n +
  /// bodies near each)).
  Status sense();
  /// Returns the sensed bodies, sorted by the ids of sensors, then of bodies.
  [[nodiscard]] std::span<const SensedBody> sensed() const noexcept;
  /// Returns the bodies that left, in the same order.
  [[nodiscard]] std::span<const ExitedBody> left() const noexcept;

  /// Returns the number of sensors.
  [[nodiscard]] std::size_t size() const noexcept;
  /// True if the key belongs to a sensor of this object.
  [[nodiscard]] bool contains(Key key) const noexcept;
  /// Returns the bytes of sensed bodies and bodies that left under `results`, of the previously
  /// sensed bodies and the search under `scratch`, and the rest by part.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  std::pmr::memory_resource* memory_;
  /// Null if memory was refused.
  SensorsState* state_;
};

}  // namespace winnow
