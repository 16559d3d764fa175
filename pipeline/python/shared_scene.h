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

/// A scene as several threads of Python may use it. Its lock is taken before that of the shapes.
class SharedScene : public NeedsInit {
 public:
  SharedScene(std::shared_ptr<SharedShapes> shapes_in, const SceneOptions& options,
              RecorderPointer recorder_in)
      : shapes(std::move(shapes_in)),
        recorder(std::move(recorder_in)),
        execution(options.execution),
        scene(recorder.get(), shapes->pool, shapes->composites, options),
        held(shapes) {}

  /// What one thread asks with: one that waits, or another.
  [[nodiscard]] std::unique_ptr<RecordableQueries> take_queries();
  /// It waits for the next question, if there is memory for that.
  void put_queries(std::unique_ptr<RecordableQueries> queries) noexcept;
  /// Exchanges the predicate for another one, or none. Under the mutex; the one before is let go of
  /// outside of it.
  void exchange_predicate(std::shared_ptr<Predicate>& other);
  /// Null if there is none. Under the mutex, shared or not.
  [[nodiscard]] std::shared_ptr<Predicate> predicate() const noexcept { return predicate_; }
  /// As `changing`, for work that may ask the predicate and support functions, for which shapes
  /// stay as they are; raises what those raise.
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
          // It is to be asked about all pairs anew.
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
  /// Made by the first sweep; asked while nobody else has the mutex.
  std::optional<RecordableSweep> sweep;
  /// Something has changed since boxes and partitions were brought up to date.
  std::atomic<bool> is_stale{true};
  std::atomic<std::uint64_t> shapes_seen{0};
  /// Shapes of its bodies.
  HeldShapes held;

 private:
  std::shared_ptr<Predicate> predicate_;
  std::mutex queries_mutex_;
  std::vector<std::unique_ptr<RecordableQueries>> queries_;
};

/// What scenes and clusters of scenes are made with.
[[nodiscard]] SceneOptions scene_options(double margin, const std::string& tier,
                                         const std::vector<std::string>& structures, bool parallel);

using SceneClass = py::class_<SharedScene, std::shared_ptr<SharedScene>>;

/// Columns of contacts.
void add_contacts(py::module_& module);
/// Which bodies meet, and which contacts hang together.
void add_meetings(py::module_& module, SceneClass& scene);
/// What bodies meet on their way from frame to frame.
void add_sweeps(py::module_& module, SceneClass& scene);
/// Volumes that tell which bodies are in them.
void add_sensors(py::module_& module);
/// Questions to the exact shapes.
void add_scene_queries(py::module_& module, SceneClass& scene);

}  // namespace winnow::python
