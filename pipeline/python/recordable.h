#pragma once

// Partitions, scenes, and the queries, sensors and continuous collision detection of scenes. Each
// may be recorded or not, with one interface for both cases. recordings.cpp provides the recorder.

#include "pipeline/python/init_checks.h"
#include "pipeline/python/refusal.h"

#include <winnow/pipeline/recording.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>

namespace winnow::python {

/// A recorder, kept alive by the objects that it records. Its calls may come from any thread.
struct SharedRecorder : NeedsInit {
  explicit SharedRecorder(const char* path) : recorder(path) {}
  Recorder recorder;
};
using RecorderPointer = std::shared_ptr<SharedRecorder>;

/// Contains one of two objects that have the same calls; `recorded_` also records them.
template <typename Plain, typename Recorded>
class Recordable {
 public:
  [[nodiscard]] bool is_recorded() const noexcept { return recorded_.has_value(); }

 protected:
  Recordable() = default;

  /// Returns call(object) for the object that exists.
  template <typename Call>
  decltype(auto) on(Call&& call) {
    return recorded_ ? call(*recorded_) : call(*plain_);
  }
  template <typename Call>
  decltype(auto) on(Call&& call) const {
    return recorded_ ? call(*recorded_) : call(*plain_);
  }

  std::optional<Plain> plain_;
  std::optional<Recorded> recorded_;
};

/// A Recordable that also has calls that are not recorded.
template <typename Plain, typename Recorded>
class RecordableWorld : public Recordable<Plain, Recorded> {
 public:
  /// The object itself, for const calls.
  [[nodiscard]] const Plain& operator*() const noexcept {
    return this->recorded_ ? *this->recorded_->operator->() : *this->plain_;
  }
  [[nodiscard]] const Plain* operator->() const noexcept { return &**this; }
  /// The object itself, for calls that cannot be recorded; throws `unsupported` if it is recorded.
  [[nodiscard]] Plain& unrecorded(const char* call) {
    if (this->recorded_) {
      throw Refusal(Status::unsupported, std::string(call) + " of what is recorded");
    }
    return *this->plain_;
  }

 protected:
  RecordableWorld() = default;
};

/// A partition; see Partition for the calls.
class RecordablePartition : public RecordableWorld<Partition, RecordedPartition> {
 public:
  RecordablePartition(SharedRecorder* recorder, StructureKind structure,
                      const PartitionOptions& options) {
    if (recorder == nullptr) {
      plain_.emplace(structure, options);
    } else {
      recorded_.emplace(recorder->recorder, structure, options);
    }
  }

  template <typename... Given>
  Status insert(Given&&... given) {
    return on([&](auto& p) { return p.insert(given...); });
  }
  template <typename... Given>
  Status update(Given&&... given) {
    return on([&](auto& p) { return p.update(given...); });
  }
  Status remove(std::span<const Key> keys) {
    return on([&](auto& p) { return p.remove(keys); });
  }
  void clear() {
    on([](auto& p) { p.clear(); });
  }
  void release_memory() {
    on([](auto& p) { p.release_memory(); });
  }
  Status reserve(std::size_t objects, Pages pages) {
    return on([&](auto& p) { return p.reserve(objects, pages); });
  }
  Status set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters) {
    return on([&](auto& p) { return p.set_filter(keys, filters); });
  }
  Status set_structure(StructureKind kind) {
    return on([&](auto& p) { return p.set_structure(kind); });
  }
  Status refresh() const {
    return on([](const auto& p) { return p.refresh(); });
  }
  /// A recorded partition stores state of its pair queries, so only one may run at a time.
  template <typename... Given>
  Status self_pairs(Given&&... given) const {
    std::unique_lock<std::mutex> query_lock;
    if (is_recorded()) query_lock = std::unique_lock(pair_query_mutex_);
    return on([&](const auto& p) { return p.self_pairs(given...); });
  }
  /// Returns `unsupported` if only one of the two is recorded.
  Status pairs_with(const RecordablePartition& other, PairBuffer& out,
                    const PairOptions& options) const {
    if (is_recorded() != other.is_recorded()) return Status::unsupported;
    return is_recorded() ? recorded_->pairs_with(*other.recorded_, out, options)
                         : plain_->pairs_with(*other.plain_, out, options);
  }
  template <typename... Given>
  auto closest(Given&&... given) const {
    return on([&](const auto& p) { return p.closest(given...); });
  }
  template <typename... Given>
  auto any(Given&&... given) const {
    return on([&](const auto& p) { return p.any(given...); });
  }
  template <typename... Given>
  auto all(Given&&... given) const {
    return on([&](const auto& p) { return p.all(given...); });
  }
  template <typename... Given>
  auto overlap(Given&&... given) const {
    return on([&](const auto& p) { return p.overlap(given...); });
  }
  template <typename... Given>
  auto nearest(Given&&... given) const {
    return on([&](const auto& p) { return p.nearest(given...); });
  }

 private:
  mutable std::mutex pair_query_mutex_;
};

/// A scene; see Scene for the calls.
class RecordableScene : public RecordableWorld<Scene, RecordedScene> {
 public:
  RecordableScene(SharedRecorder* recorder, const ShapePool& shapes,
                  const CompositePool& composites, SceneOptions options) {
    options.composites = &composites;
    if (recorder == nullptr) {
      plain_.emplace(shapes, options);
    } else {
      recorded_.emplace(recorder->recorder, shapes, composites, options);
    }
  }

  Status add(std::span<const BodyDefinition> bodies, std::span<Key> keys) {
    return on([&](auto& s) { return s.add(bodies, keys); });
  }
  Status remove(std::span<const Key> keys) {
    return on([&](auto& s) { return s.remove(keys); });
  }
  void clear() {
    on([](auto& s) { s.clear(); });
  }
  Status reserve(const SceneCapacity& room, Pages pages) {
    return on([&](auto& s) { return s.reserve(room, pages); });
  }
  Status move(std::span<const Key> keys, const PoseView& poses) {
    return on([&](auto& s) { return s.move(keys, poses); });
  }
  Status set_body_state(std::span<const Key> keys, BodyState state) {
    return on([&](auto& s) { return s.set_body_state(keys, state); });
  }
  Status set_shape(Key key, ShapeId shape) {
    return on([&](auto& s) { return s.set_shape(key, shape); });
  }
  Status set_filter(Key key, const ObjectFilter& filter) {
    return on([&](auto& s) { return s.set_filter(key, filter); });
  }
  Status set_offsets(Key key, const ContactOffsets& offsets) {
    return on([&](auto& s) { return s.set_offsets(key, offsets); });
  }
  Status set_layer(Key key, std::uint16_t layer) {
    return on([&](auto& s) { return s.set_layer(key, layer); });
  }
  Status set_layers_collide(std::uint16_t a, std::uint16_t b, bool collide) {
    return on([&](auto& s) { return s.set_layers_collide(a, b, collide); });
  }
  Status set_ignored(std::span<const KeyPair> pairs, bool ignored) {
    return on([&](auto& s) { return s.set_ignored(pairs, ignored); });
  }
  void set_predicate(const PairPredicate& predicate) {
    on([&](auto& s) { s.set_predicate(predicate); });
  }
  Status refresh() {
    return on([](auto& s) { return s.refresh(); });
  }
  Status collide(ContactLevel level, Contacts& contacts) {
    return on([&](auto& s) { return s.collide(level, contacts); });
  }
  Status load(std::span<const std::byte> saved) {
    return on([&](auto& s) { return s.load(saved); });
  }
  Status load_contacts(std::span<const std::byte> saved, Contacts& contacts) {
    return on([&](auto& s) { return s.load_contacts(saved, contacts); });
  }

 private:
  friend class RecordableQueries;
  friend class RecordableSensors;
  friend class RecordableContinuousCollision;
};

/// Queries of a scene; see SceneQueries for the calls.
class RecordableQueries : public Recordable<SceneQueries, RecordedQueries> {
 public:
  explicit RecordableQueries(RecordableScene& scene) {
    if (scene.is_recorded()) {
      recorded_.emplace(*scene.recorded_);
    } else {
      plain_.emplace(*scene);
    }
  }

  template <typename... Given>
  auto closest(Given&&... given) {
    return on([&](auto& q) { return q.closest(given...); });
  }
  template <typename... Given>
  auto any(Given&&... given) {
    return on([&](auto& q) { return q.any(given...); });
  }
  template <typename... Given>
  auto all(Given&&... given) {
    return on([&](auto& q) { return q.all(given...); });
  }
  template <typename... Given>
  auto overlap(Given&&... given) {
    return on([&](auto& q) { return q.overlap(given...); });
  }
  template <typename... Given>
  auto distance(Given&&... given) {
    return on([&](auto& q) { return q.distance(given...); });
  }
  template <typename... Given>
  auto least_distance(Given&&... given) {
    return on([&](auto& q) { return q.least_distance(given...); });
  }
  template <typename... Given>
  auto overlaps(Given&&... given) {
    return on([&](auto& q) { return q.overlaps(given...); });
  }
  template <typename... Given>
  auto any_contact(Given&&... given) {
    return on([&](auto& q) { return q.any_contact(given...); });
  }
  template <typename... Given>
  auto nearest(Given&&... given) {
    return on([&](auto& q) { return q.nearest(given...); });
  }
};

/// Continuous collision detection; see ContinuousCollision for the calls.
class RecordableContinuousCollision
    : public Recordable<ContinuousCollision, RecordedContinuousCollision> {
 public:
  explicit RecordableContinuousCollision(RecordableScene& scene) {
    if (scene.is_recorded()) {
      recorded_.emplace(*scene.recorded_);
    } else {
      plain_.emplace(*scene.plain_);
    }
  }

  [[nodiscard]] const ContinuousCollision* operator->() const noexcept {
    return recorded_ ? recorded_->operator->() : &*plain_;
  }
  template <typename... Given>
  Status find_impacts(Given&&... given) {
    return on([&](auto& s) { return s.find_impacts(given...); });
  }
};

/// Sensors; see Sensors for the calls.
class RecordableSensors : public Recordable<Sensors, RecordedSensors> {
 public:
  explicit RecordableSensors(RecordableScene& scene) {
    if (scene.is_recorded()) {
      recorded_.emplace(*scene.recorded_);
    } else {
      plain_.emplace(*scene.plain_);
    }
  }

  [[nodiscard]] const Sensors& operator*() const noexcept {
    return recorded_ ? **recorded_ : *plain_;
  }
  [[nodiscard]] const Sensors* operator->() const noexcept { return &**this; }
  Answer<Key> add(const SensorDefinition& sensor) {
    return on([&](auto& s) { return s.add(sensor); });
  }
  Status remove(Key key) {
    return on([&](auto& s) { return s.remove(key); });
  }
  Status move(Key key, const Pose& pose) {
    return on([&](auto& s) { return s.move(key, pose); });
  }
  Status set(Key key, const SensorDefinition& sensor) {
    return on([&](auto& s) { return s.set(key, sensor); });
  }
  Status sense() {
    return on([](auto& s) { return s.sense(); });
  }
};

}  // namespace winnow::python
