#pragma once

#include "pipeline/python/callbacks.h"
#include "pipeline/python/choices.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/partition.h"
#include "pipeline/python/recordable.h"
#include "pipeline/python/shared_shapes.h"

#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/scene.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <vector>

namespace winnow::python {

inline constexpr Choices<Motion, kMotions> kMotionNames{
    {{"fixed", Motion::fixed}, {"dynamic", Motion::dynamic}, {"sleeping", Motion::sleeping}}};

using HeldContacts = Exported<Contacts>;

/// A scene that several Python threads may use. Its lock is acquired before the lock of the shapes.
class SharedScene : public NeedsInit {
 public:
  SharedScene(std::shared_ptr<SharedShapes> shapes_in, const SceneOptions& options,
              RecorderPointer recorder_in)
      : shapes(std::move(shapes_in)),
        recorder(std::move(recorder_in)),
        execution(options.execution),
        scene(recorder.get(), shapes->pool, shapes->composites, options),
        held(shapes) {}

  /// Returns a query object for one thread: an unused one, or a new one.
  [[nodiscard]] std::unique_ptr<RecordableQueries> take_queries();
  /// Returns a query object for later use; frees it if memory is refused.
  void put_queries(std::unique_ptr<RecordableQueries> queries) noexcept;
  /// Swaps the predicate. Requires the mutex; the caller releases the old predicate without it.
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
        const std::shared_ptr<Predicate> asked = predicate_;
        if (asked) asked->begin();
        auto made = work();
        if (asked && asked->has_failed()) {
          // Set again, so that the next call applies it to all pairs.
          scene.set_predicate(pair_predicate(*asked));
          failed = asked;
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
  RecordableScene scene;
  /// Created by the first sweep; used with the mutex.
  std::optional<RecordableSweep> sweep;
  /// The scene has changed since its last refresh.
  std::atomic<bool> is_stale{true};
  std::atomic<std::uint64_t> shapes_seen{0};
  /// Shapes of its bodies.
  HeldShapes held;

 private:
  std::shared_ptr<Predicate> predicate_;
  std::mutex queries_mutex_;
  std::vector<std::unique_ptr<RecordableQueries>> queries_;
};

/// Options shared by scenes and clusters of scenes.
[[nodiscard]] SceneOptions scene_options(double margin, const std::string& tier,
                                         const std::vector<std::string>& structures, bool parallel);

using SceneClass = py::class_<SharedScene, std::shared_ptr<SharedScene>>;

/// Adds Contacts.
void add_contacts(py::module_& module);
/// Adds pair filters, offsets, and groups of contacts.
void add_pair_filter(py::module_& module, SceneClass& scene);
/// Adds sweeps.
void add_sweeps(py::module_& module, SceneClass& scene);
/// Adds Sensors.
void add_sensors(py::module_& module);
/// Adds queries of the exact shapes.
void add_scene_queries(py::module_& module, SceneClass& scene);

}  // namespace winnow::python
