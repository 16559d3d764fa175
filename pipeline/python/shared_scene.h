#pragma once

#include "pipeline/python/callbacks.h"
#include "pipeline/python/choices.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/partition.h"
#include "pipeline/python/recordings.h"
#include "pipeline/python/shared_shapes.h"

#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <vector>

namespace winnow::python {

inline constexpr Choices<BodyState, kBodyStates> kBodyStateNames{
    {{"fixed", BodyState::fixed},
     {"dynamic", BodyState::dynamic},
     {"sleeping", BodyState::sleeping}}};

using HeldContacts = Exported<Contacts>;

/// A scene that several Python threads may use. Its lock is acquired before the lock of the shapes.
class SharedScene : public NeedsInit {
 public:
  /// `options` without composite shapes and recorder.
  SharedScene(std::shared_ptr<SharedShapes> shapes_in, const SceneOptions& options,
              RecorderPointer recorder_in)
      : shapes(std::move(shapes_in)),
        recorder(std::move(recorder_in)),
        execution(options.execution),
        scene(shapes->pool, recorded_by(recorder, with_shapes(options))),
        held(shapes) {}

  /// Returns a query object for one thread: an unused one, or a new one.
  [[nodiscard]] std::unique_ptr<SceneQueries> take_queries();
  /// Returns a query object for later use; frees it if memory is refused.
  void put_queries(std::unique_ptr<SceneQueries> queries) noexcept;
  /// Swaps the predicate of the scene with `other`. The caller holds the mutex, and unlocks it
  /// before the old predicate is destroyed.
  void exchange_predicate(std::shared_ptr<Predicate>& other);
  /// Null if there is none. Requires the mutex, shared or not.
  [[nodiscard]] std::shared_ptr<Predicate> predicate() const noexcept { return predicate_; }
  /// As `changing`, for work that may call the predicate and support functions; shapes do not
  /// change meanwhile. Raises the exceptions of these functions.
  template <typename Work>
  auto working(Work&& work) {
    return shapes->raised.during([&] {
      std::shared_ptr<Predicate> failed;
      auto answer = changing(mutex, [&] {
        const std::shared_lock lock(shapes->mutex);
        const std::shared_ptr<Predicate> current = predicate_;
        if (current) current->begin();
        auto made = work();
        if (current && current->has_failed()) {
          // Set again, so that the next call applies it to all pairs.
          scene.set_predicate(pair_predicate(*current));
          failed = current;
        }
        return made;
      });
      if (failed) failed->raise();
      return answer;
    });
  }

  const std::shared_ptr<SharedShapes> shapes;
  /// Null if it is not recorded.
  const RecorderPointer recorder;
  Execution execution;
  mutable std::shared_mutex mutex;
  Scene scene;
  /// Created by the first call that uses it; used with the mutex.
  std::optional<ContinuousCollision> ccd;
  /// The scene has changed since its last refresh.
  std::atomic<bool> is_stale{true};
  std::atomic<std::uint64_t> shapes_seen{0};
  /// Shapes of its bodies.
  HeldShapes held;

 private:
  [[nodiscard]] SceneOptions with_shapes(SceneOptions options) const noexcept {
    options.composites = &shapes->composites;
    return options;
  }

  std::shared_ptr<Predicate> predicate_;
  std::mutex queries_mutex_;
  std::vector<std::unique_ptr<SceneQueries>> queries_;
};

/// True if a key is of a body of the scene.
[[nodiscard]] inline bool has_key(const SharedScene& s, Key key) {
  return reading(s.mutex, [&] { return s.scene.contains(key); });
}

/// Options shared by scenes and clusters of scenes.
[[nodiscard]] SceneOptions scene_options(double contact_margin, const std::string& tier,
                                         const std::vector<std::string>& structures, bool parallel);

using SceneClass = Class<SharedScene>;

/// Adds Contacts.
void add_contacts(py::module_& module);
/// Adds pair filters, offsets, and groups of contacts.
void add_pair_filter(py::module_& module, SceneClass& scene);
/// Adds continuous collision detection.
void add_continuous_collision(py::module_& module, SceneClass& scene);
/// Adds Sensors.
void add_sensors(py::module_& module);
/// Adds queries of the exact shapes.
void add_scene_queries(SceneClass& scene);

}  // namespace winnow::python
