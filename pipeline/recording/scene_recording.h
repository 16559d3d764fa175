#pragma once

// The recording of one scene. scene_recording.cpp writes the calls of Scene, sensor_recording.cpp
// those of Sensors and ContinuousCollision, and QueryRecording the queries.

#include "pipeline/recording/accepted_pairs.h"
#include "pipeline/recording/query_recording.h"
#include "pipeline/recording/shape_recording.h"
#include "pipeline/scene/contact_frame.h"
#include "pipeline/scene/scene_observer.h"
#include "pipeline/scene/scene_state.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

class SceneRecording final : public SceneObserver {
 public:
  SceneRecording(RecorderState& recorder, std::uint32_t world, SceneState& scene) noexcept
      : recorder_(recorder),
        world_(world),
        scene_(scene),
        shapes_(recorder, world, scene.shapes, scene.options.composites),
        accepted_(recorder, world),
        queries_(recorder, world, shapes_, accepted_),
        stamps_before_load_(recorder.block.memory()) {}

  void begin() noexcept;
  void end() noexcept override {
    write(RecordedCall::end_world);
    recorder_.destroy(this);
  }
  [[nodiscard]] QueryObserver& queries() noexcept override { return queries_; }

  void add(std::span<const BodyDefinition> bodies, std::span<const Key> keys) noexcept override;
  void remove(std::span<const Key> keys) noexcept override {
    write(RecordedCall::remove_bodies).put_ids(keys);
  }
  void clear() noexcept override { write(RecordedCall::clear_bodies); }
  void move(std::span<const Key> keys, const PoseView& poses) noexcept override {
    write(RecordedCall::move).put_ids(keys).put_poses(poses);
  }
  void set_body_state(std::span<const Key> keys, BodyState state) noexcept override {
    write(RecordedCall::set_body_state).put_ids(keys).put(state);
  }
  void set_shape(Key key, ShapeId shape) noexcept override {
    const std::uint32_t number = shapes_.number_of(shape);
    write(RecordedCall::set_shape).put(key.id).put(number);
  }
  void set_filter(Key key, const ObjectFilter& filter) noexcept override {
    write(RecordedCall::set_body_filter).put(key.id).put_bytes(&filter, sizeof filter);
  }
  void set_offsets(Key key, const ContactOffsets& offsets) noexcept override {
    write(RecordedCall::set_offsets).put(key.id).put(offsets.contact).put(offsets.rest);
  }
  void set_layer(Key key, std::uint16_t layer) noexcept override {
    write(RecordedCall::set_layer).put(key.id).put(layer);
  }
  void set_layers_collide(std::uint16_t a, std::uint16_t b, bool collide) noexcept override {
    write(RecordedCall::set_layers_collide).put(a).put(b).put(collide);
  }
  void set_ignored(std::span<const KeyPair> pairs, bool ignored) noexcept override;
  [[nodiscard]] PairPredicate set_predicate(const PairPredicate& predicate) noexcept override {
    write(RecordedCall::set_predicate).put(predicate.accept != nullptr);
    return accepted_.wrap(predicate);
  }
  void refresh() noexcept override {
    shapes_.record_changes();
    write(RecordedCall::refresh_scene);
  }
  void collide(ContactLevel level, const ContactsOrigin& before, const ContactsOrigin& now,
               const Contacts& contacts) noexcept override;
  void before_load() noexcept override;
  void load(std::span<const std::byte> saved) noexcept override;
  void load_contacts(std::span<const std::byte> saved, const ContactsOrigin& now) noexcept override;
  void fail() noexcept override;

  void find_impacts(std::span<const Key> keys, const PoseView& ends,
                    const ContinuousOptions& options,
                    const ContinuousCollision& ccd) noexcept override;
  void find_impacts(std::span<const Key> keys, std::span<const RigidMotion> motions,
                    const ContinuousOptions& options,
                    const ContinuousCollision& ccd) noexcept override;

  [[nodiscard]] std::uint32_t make_sensors() noexcept override;
  void end_sensors(std::uint32_t number) noexcept override;
  void add_sensor(std::uint32_t number, Key key, const SensorDefinition& sensor) noexcept override;
  void set_sensor(std::uint32_t number, Key key, const SensorDefinition& sensor) noexcept override;
  void remove_sensor(std::uint32_t number, Key key) noexcept override;
  void move_sensor(std::uint32_t number, Key key, const Pose& pose) noexcept override;
  void sense(std::uint32_t number, const Sensors& sensors) noexcept override;

 private:
  /// Begins a call, which is complete when the returned object is destroyed.
  CallWriter write(RecordedCall call) noexcept { return {recorder_, call, world_}; }
  void write_sensor(RecordedCall kind, std::uint32_t number, Key key,
                    const SensorDefinition& sensor) noexcept;

  RecorderState& recorder_;
  const std::uint32_t world_;
  SceneState& scene_;
  ShapeRecording shapes_;
  AcceptedPairs accepted_;
  QueryRecording queries_;
  /// The last `collide` or `load_contacts`.
  ContactsOrigin last_contacts_;
  Column<std::uint32_t> stamps_before_load_;
  std::uint32_t sensors_ = 0;
};

}  // namespace winnow
