#pragma once

// The observer of a recorded scene, with its sensors and its continuous collision detection. They
// call it at the end of each call that succeeds, with the arguments and results;
// pipeline/recording/ implements it. QueryObserver (queries/query_observer.h) is for SceneQueries.

#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/scene.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

class QueryObserver;
class Sensors;
struct ContactsOrigin;
struct SensorDefinition;

/// Receives the successful calls of one scene. A call that another call of the scene makes is not
/// received.
class SceneObserver {
 public:
  SceneObserver(const SceneObserver&) = delete;
  SceneObserver& operator=(const SceneObserver&) = delete;

  /// Called before the scene is destroyed; destroys this object.
  virtual void end() noexcept = 0;
  /// Returns the observer of all SceneQueries of the scene.
  [[nodiscard]] virtual QueryObserver& queries() noexcept = 0;

  // Scene.

  virtual void add(std::span<const BodyDefinition> bodies, std::span<const Key> keys) noexcept = 0;
  virtual void remove(std::span<const Key> keys) noexcept = 0;
  virtual void clear() noexcept = 0;
  virtual void move(std::span<const Key> keys, const PoseView& poses) noexcept = 0;
  virtual void set_body_state(std::span<const Key> keys, BodyState state) noexcept = 0;
  virtual void set_shape(Key key, ShapeId shape) noexcept = 0;
  virtual void set_filter(Key key, const ObjectFilter& filter) noexcept = 0;
  virtual void set_offsets(Key key, const ContactOffsets& offsets) noexcept = 0;
  virtual void set_layer(Key key, std::uint16_t layer) noexcept = 0;
  virtual void set_layers_collide(std::uint16_t a, std::uint16_t b, bool collide) noexcept = 0;
  virtual void set_ignored(std::span<const KeyPair> pairs, bool ignored) noexcept = 0;
  /// Returns the predicate that the scene must use: it calls `predicate` and stores accepted pairs.
  [[nodiscard]] virtual PairPredicate set_predicate(const PairPredicate& predicate) noexcept = 0;
  virtual void refresh() noexcept = 0;
  /// `before` and `now` are the origins of the contacts before and after the call.
  virtual void collide(ContactLevel level, const ContactsOrigin& before, const ContactsOrigin& now,
                       const Contacts& contacts) noexcept = 0;
  /// Called before `load`, which may fail.
  virtual void before_load() noexcept = 0;
  virtual void load(std::span<const std::byte> saved) noexcept = 0;
  virtual void load_contacts(std::span<const std::byte> saved,
                             const ContactsOrigin& now) noexcept = 0;
  /// Called after a `collide` or `find_impacts` that failed, and may have called the predicate.
  virtual void fail() noexcept = 0;

  // ContinuousCollision.

  virtual void find_impacts(std::span<const Key> keys, const PoseView& ends,
                            const ContinuousOptions& options,
                            const ContinuousCollision& ccd) noexcept = 0;
  virtual void find_impacts(std::span<const Key> keys, std::span<const RigidMotion> motions,
                            const ContinuousOptions& options,
                            const ContinuousCollision& ccd) noexcept = 0;

  // Sensors. `number` is the number that make_sensors() returned for the object.

  [[nodiscard]] virtual std::uint32_t make_sensors() noexcept = 0;
  virtual void end_sensors(std::uint32_t number) noexcept = 0;
  virtual void add_sensor(std::uint32_t number, Key key,
                          const SensorDefinition& sensor) noexcept = 0;
  virtual void set_sensor(std::uint32_t number, Key key,
                          const SensorDefinition& sensor) noexcept = 0;
  virtual void remove_sensor(std::uint32_t number, Key key) noexcept = 0;
  virtual void move_sensor(std::uint32_t number, Key key, const Pose& pose) noexcept = 0;
  virtual void sense(std::uint32_t number, const Sensors& sensors) noexcept = 0;

 protected:
  SceneObserver() = default;
  ~SceneObserver() = default;
};

}  // namespace winnow
