// RecordedScene: forwards each call to its scene, and writes successful calls and the shapes of
// bodies to the recording.

#include "core/memory/new_in.h"
#include "core/memory/saved_keys.h"
#include "pipeline/kinds/with_shape.h"
#include "pipeline/narrow/tier_number.h"
#include "pipeline/recording/composite_bytes.h"
#include "pipeline/recording/contact_digest.h"
#include "pipeline/recording/predicate_log.h"
#include "pipeline/scene/contact_frame.h"
#include "pipeline/scene/scene_state.h"
#include "pipeline/shapes/hull_bytes.h"

#include <algorithm>
#include <type_traits>

namespace winnow {
namespace {

RecordedBody recorded(const BodyDefinition& body, std::uint32_t shape) noexcept {
  RecordedBody out{};
  out.shape = shape;
  out.state = static_cast<std::uint32_t>(body.state);
  std::copy_n(body.pose.position.data(), 3, out.pose);
  std::copy_n(body.pose.orientation.data(), 4, out.pose + 3);
  out.filter[0] = body.filter.layers;
  out.filter[1] = body.filter.mask;
  out.filter[2] = body.filter.environment;
  out.data = body.data;
  return out;
}

std::uint64_t digest_of(const ShapeTables& tables, ShapeId id) noexcept {
  Digest digest;
  with_shape(tables, id, [&](const auto& shape) {
    if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, HullShape>) {
      add_to(digest, shape);
    } else {
      digest.add(std::as_bytes(std::span(&shape, 1)));
    }
  });
  return digest.value();
}

/// Writes the ids that are live with the same stamp before and after.
void put_kept(CallWriter& call, std::span<const std::uint32_t> before,
              std::span<const std::uint32_t> after) noexcept {
  const auto for_kept = [&](auto&& visit) {
    for_live(after, [&](ObjectId id) {
      if (id < before.size() && before[id] == after[id]) visit(id);
    });
  };
  std::uint64_t count = 0;
  for_kept([&](ObjectId) { ++count; });
  call.put(count);
  for_kept([&](ObjectId id) { call.put(id); });
}

/// Number of a shape that was removed or replaced.
constexpr std::uint32_t kRemovedShape = ~0U;

SceneOptions with_composites(SceneOptions options, const CompositePool& composites) noexcept {
  options.composites = &composites;
  return options;
}

}  // namespace

RecordedScene::RecordedScene(Recorder& recorder, const ShapePool& shapes,
                             const SceneOptions& options) noexcept
    : RecordedScene(recorder, shapes, options, nullptr) {}

RecordedScene::RecordedScene(Recorder& recorder, const ShapePool& shapes,
                             const CompositePool& composites, const SceneOptions& options) noexcept
    : RecordedScene(recorder, shapes, with_composites(options, composites), &composites) {}

RecordedScene::RecordedScene(Recorder& recorder, const ShapePool& shapes,
                             const SceneOptions& options, const CompositePool* composites) noexcept
    : recorder_(recorder.state_),
      world_(new_world(recorder_)),
      shapes_(shapes),
      composites_(composites),
      composites_seen_(composites == nullptr ? 0 : composites->revision()),
      scene_(shapes, options),
      recorded_shapes_(recorder.memory_) {
  if (options.suppress_ghost_contacts) stop_recording(Status::unsupported);
  CallWriter call(recorder_, RecordedCall::make_scene, world_);
  for (const StructureKind& structure : options.structures) {
    call.put_text(structure.name()).put(structure.parameter());
  }
  call.put(options.contact_margin).put(tier_number(options.tier)).put(options.cache_tolerance);
  call.put(options.contact_reduction).put(options.warm_start);
  call.put(std::uint64_t{options.build_budget});
}

RecordedScene::~RecordedScene() {
  CallWriter(recorder_, RecordedCall::end_world, world_);
  if (recorder_ == nullptr) return;
  const Lock lock(recorder_->mutex);
  delete_in(recorder_->block.memory(), passed_);
  recorded_shapes_.release();
}

/// Ends the recording with an error.
void RecordedScene::stop_recording(Status why) noexcept {
  if (recorder_ == nullptr) return;
  const Lock lock(recorder_->mutex);
  recorder_->fail(why);
}

// False for shapes that a recording cannot contain: support functions, one-sided surfaces, solids,
// and all composite shapes if the scene was created without their pool.
bool RecordedScene::can_hold(ShapeId id) const noexcept {
  if (!id.is_composite()) return id.kind() != ShapeKind::support;
  return composites_ != nullptr && !composites_->is_one_sided(id) && !composites_->is_solid(id);
}

RecordedShape* RecordedScene::find_shape(ShapeId id) noexcept {
  RecordedShape* const at = std::lower_bound(
      recorded_shapes_.begin(), recorded_shapes_.end(), id.bits,
      [](const RecordedShape& shape, std::uint32_t bits) { return shape.id.bits < bits; });
  return at != recorded_shapes_.end() && at->id == id ? at : nullptr;
}

void RecordedScene::describe(RecordedShape& shape) const noexcept {
  if (shape.id.is_composite()) {
    const CompositeDigests digests = digests_of(*composites_, shape.id);
    shape.digest = digests.all;
    shape.form = digests.form;
  } else {
    shape.digest = digest_of(shapes_.tables(), shape.id);
    shape.form = 0;
  }
}

// A shape is recorded when a body, sensor or query first uses it, and again if another shape has
// its id now. The digest of the shape shows this; for composite shapes, record_composite_changes
// compares the digests.
std::uint32_t RecordedScene::number_of(ShapeId id) noexcept {
  if (recorder_ == nullptr) return 0;
  if (!can_hold(id)) {
    stop_recording(Status::unsupported);
    return 0;
  }
  if (id.is_composite()) record_composite_changes();
  RecordedShape* const at = find_shape(id);
  if (at != nullptr && id.is_composite() && at->number != kRemovedShape) return at->number;
  RecordedShape shape{id, 0, 0, 0};
  describe(shape);
  if (at != nullptr && at->number != kRemovedShape && at->digest == shape.digest) return at->number;
  if (id.is_composite()) {
    for (const CompoundChild& child : composites_->children(id)) (void)number_of(child.shape);
  }
  shape.number = shapes_recorded_++;
  if (at != nullptr) {
    *find_shape(id) = shape;
  } else {
    insert_shape(shape);
  }
  id.is_composite() ? record_composite(shape) : record_shape(shape);
  return shape.number;
}

void RecordedScene::insert_shape(const RecordedShape& shape) noexcept {
  const Lock lock(recorder_->mutex);
  if (!recorded_shapes_.push_back(shape)) return recorder_->fail(Status::out_of_memory);
  const auto by_id = [](const RecordedShape& a, const RecordedShape& b) {
    return a.id.bits < b.id.bits;
  };
  std::rotate(std::upper_bound(recorded_shapes_.begin(), recorded_shapes_.end() - 1, shape, by_id),
              recorded_shapes_.end() - 1, recorded_shapes_.end());
}

void RecordedScene::record_shape(const RecordedShape& shape) noexcept {
  CallWriter call(recorder_, RecordedCall::add_shape, world_);
  call.put(shape.id.kind());
  with_shape(shapes_.tables(), shape.id, [&](const auto& one) {
    if constexpr (std::is_same_v<std::decay_t<decltype(one)>, HullShape>) {
      put_hull(call, one);
    } else {
      call.put_bytes(&one, sizeof one);
    }
  });
  call.put(shape.digest);
}

void RecordedScene::record_composite(const RecordedShape& shape) noexcept {
  CallWriter call(recorder_, RecordedCall::add_composite, world_);
  Column<std::byte> bytes(
      recorded_shapes_.memory());  // allocates from the recorder's memory, under its lock
  const Status status = save_composite(*composites_, shape.id, bytes);
  if (status != Status::ok) return call.give_up(status);
  call.put(shape.id.composite_kind());
  call.put_array(std::span<const std::byte>(bytes.data(), bytes.size()));
  const auto scale = composites_->scale(shape.id);
  call.put_bytes(scale.data(), sizeof scale);
  const auto children = composites_->children(shape.id);
  call.put(std::uint64_t{children.size()});
  for (const CompoundChild& child : children) {
    const RecordedShape* const one = find_shape(child.shape);
    call.put(one == nullptr ? 0U : one->number).put_bytes(&child.pose, sizeof child.pose);
  }
  call.put(shape.digest);
}

// Records composite shapes that were changed in place, and removes the numbers of shapes that were
// removed or replaced. If no shape was changed in place, records only that the pool changed:
// a scene then recomputes the contacts of all composite shapes.
void RecordedScene::record_composite_changes() noexcept {
  if (recorder_ == nullptr || composites_ == nullptr) return;
  if (composites_->revision() == composites_seen_) return;
  composites_seen_ = composites_->revision();
  bool has_recorded = false;
  for (RecordedShape& known : recorded_shapes_) {
    if (!known.id.is_composite()) continue;
    RecordedShape now = known;
    if (composites_->contains(known.id)) {
      if (!can_hold(known.id)) stop_recording(Status::unsupported);
      describe(now);
    }
    if (!composites_->contains(known.id) || now.form != known.form) {
      known.number = kRemovedShape;
    } else if (now.digest != known.digest && known.number != kRemovedShape) {
      known = now;
      has_recorded = true;
      CallWriter(recorder_, RecordedCall::change_composite, world_)
          .put(known.number)
          .put_array(values_of(*composites_, known.id))
          .put(known.digest);
    }
  }
  if (!has_recorded) CallWriter(recorder_, RecordedCall::composites_changed, world_);
}

Answer<Key> RecordedScene::add(const BodyDefinition& body) {
  Key key;
  const Status status = add(std::span<const BodyDefinition>(&body, 1), std::span<Key>(&key, 1));
  if (status != Status::ok) return status;
  return key;
}

Status RecordedScene::add(std::span<const BodyDefinition> bodies, std::span<Key> keys) {
  const Status status = scene_.add(bodies, keys);
  if (status != Status::ok) return status;
  for (const BodyDefinition& body : bodies) (void)number_of(body.shape);
  const auto number = [&](const BodyDefinition& body) {
    const RecordedShape* const at = find_shape(body.shape);
    return at == nullptr ? 0 : at->number;
  };
  {
    CallWriter call(recorder_, RecordedCall::add_bodies, world_);
    call.put(std::uint64_t{bodies.size()});
    for (const BodyDefinition& body : bodies) {
      const RecordedBody one = recorded(body, number(body));
      call.put_bytes(&one, sizeof one);
    }
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].offsets != ContactOffsets{}) record_offsets(keys[i], bodies[i].offsets);
    if (bodies[i].layer != 0) record_layer(keys[i], bodies[i].layer);
  }
  return status;
}

Status RecordedScene::remove(Key key) {
  return remove(std::span<const Key>(&key, 1));
}

Status RecordedScene::remove(std::span<const Key> keys) {
  const Status status = scene_.remove(keys);
  if (status == Status::ok) {
    CallWriter(recorder_, RecordedCall::remove_bodies, world_).put_ids(keys);
  }
  return status;
}

void RecordedScene::clear() noexcept {
  scene_.clear();
  CallWriter(recorder_, RecordedCall::clear_bodies, world_);
}

Status RecordedScene::move(Key key, const Pose& pose) {
  return move(std::span<const Key>(&key, 1), PoseView(std::span<const Pose>(&pose, 1)));
}

Status RecordedScene::move(std::span<const Key> keys, const PoseView& poses) {
  const Status status = scene_.move(keys, poses);
  if (status != Status::ok) return status;
  CallWriter(recorder_, RecordedCall::move, world_).put_ids(keys).put_poses(poses);
  return status;
}

Status RecordedScene::set_body_state(Key key, BodyState state) {
  return set_body_state(std::span<const Key>(&key, 1), state);
}

Status RecordedScene::set_body_state(std::span<const Key> keys, BodyState state) {
  const Status status = scene_.set_body_state(keys, state);
  if (status == Status::ok) {
    CallWriter(recorder_, RecordedCall::set_body_state, world_).put_ids(keys).put(state);
  }
  return status;
}

Status RecordedScene::set_shape(Key key, ShapeId shape) {
  const Status status = scene_.set_shape(key, shape);
  if (status != Status::ok) return status;
  const std::uint32_t number = number_of(shape);
  CallWriter(recorder_, RecordedCall::set_shape, world_).put(key.id).put(number);
  return status;
}

Status RecordedScene::set_filter(Key key, const ObjectFilter& filter) {
  const Status status = scene_.set_filter(key, filter);
  if (status == Status::ok) {
    CallWriter(recorder_, RecordedCall::set_body_filter, world_)
        .put(key.id)
        .put_bytes(&filter, sizeof filter);
  }
  return status;
}

Status RecordedScene::set_offsets(Key key, const ContactOffsets& offsets) {
  const Status status = scene_.set_offsets(key, offsets);
  if (status == Status::ok) record_offsets(key, offsets);
  return status;
}

Status RecordedScene::set_layer(Key key, std::uint16_t layer) {
  const Status status = scene_.set_layer(key, layer);
  if (status == Status::ok) record_layer(key, layer);
  return status;
}

Status RecordedScene::set_layers_collide(std::uint16_t a, std::uint16_t b, bool collide) {
  const Status status = scene_.set_layers_collide(a, b, collide);
  if (status == Status::ok) {
    CallWriter(recorder_, RecordedCall::set_layers_collide, world_).put(a).put(b).put(collide);
  }
  return status;
}

void RecordedScene::record_layer(Key key, std::uint16_t layer) noexcept {
  CallWriter(recorder_, RecordedCall::set_layer, world_).put(key.id).put(layer);
}

void RecordedScene::record_offsets(Key key, const ContactOffsets& offsets) noexcept {
  CallWriter(recorder_, RecordedCall::set_offsets, world_)
      .put(key.id)
      .put(offsets.contact)
      .put(offsets.rest);
}

Status RecordedScene::set_ignored(Key a, Key b, bool ignored) {
  const KeyPair pair{a, b};
  return set_ignored(std::span<const KeyPair>(&pair, 1), ignored);
}

Status RecordedScene::set_ignored(std::span<const KeyPair> pairs, bool ignored) {
  const Status status = scene_.set_ignored(pairs, ignored);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::set_ignored, world_);
  call.put(ignored).put(std::uint64_t{pairs.size()});
  for (const KeyPair& pair : pairs) call.put(pair.first.id).put(pair.second.id);
  return status;
}

void RecordedScene::set_predicate(const PairPredicate& predicate) noexcept {
  if (recorder_ != nullptr && passed_ == nullptr) {
    const Lock lock(recorder_->mutex);
    passed_ = new_in<AcceptedPairs>(recorder_->block.memory(), *recorder_);
    if (passed_ == nullptr) recorder_->fail(Status::out_of_memory);
  }
  if (passed_ != nullptr) passed_->pairs.clear();
  scene_.set_predicate(passed_ == nullptr ? predicate : passed_->wrap(predicate));
  CallWriter(recorder_, RecordedCall::set_predicate, world_).put(predicate.accept != nullptr);
}

// Recorded before the query, so that a player has the accepted pairs when it runs the query.
void RecordedScene::record_passed() noexcept {
  if (passed_ == nullptr || passed_->original.accept == nullptr) return;
  CallWriter(recorder_, RecordedCall::pairs_passed, world_)
      .put_array(sorted_unique(passed_->pairs));
  passed_->pairs.clear();
}

// The pairs may include pairs accepted by queries of other threads. They are not cleared here,
// because a query of another thread may be recorded later; record_passed clears them.
void RecordedScene::record_passed_so_far() noexcept {
  if (passed_ == nullptr || passed_->original.accept == nullptr) return;
  CallWriter(recorder_, RecordedCall::pairs_passed, world_)
      .put_array(sorted_unique(passed_->pairs));
}

// A failed query is not recorded, but the scene may have cached pairs that the predicate accepted
// during the query. If the predicate is set again, the scene tests all pairs again, here and in a
// player.
void RecordedScene::forget_passed() noexcept {
  if (passed_ == nullptr || passed_->pairs.empty()) return;
  const PairPredicate predicate = passed_->original;
  set_predicate(predicate);
}

Status RecordedScene::refresh() {
  record_composite_changes();
  const Status status = scene_.refresh();
  if (status == Status::ok) CallWriter(recorder_, RecordedCall::refresh_scene, world_);
  return status;
}

RecordedScene::Provenance RecordedScene::source_query(const Contacts& contacts) noexcept {
  return {contacts.state().clock, contacts.state().pairs_serial};
}

// Contacts of other scenes count as empty for this scene.
bool RecordedScene::is_filled_by_this(const Contacts& contacts) const noexcept {
  return scene_.state_ != nullptr && contacts.state().scene == scene_.state_->serial;
}

// Contacts store the previous frame. Events and cached manifolds depend on whether the last
// `collide` or `load_contacts` of this scene filled `contacts`, so the call records this.
Status RecordedScene::collide(ContactLevel level, Contacts& contacts) {
  record_composite_changes();
  const bool filled = is_filled_by_this(contacts);
  const bool continues = filled && source_query(contacts) == last_provenance_;
  const Status status = scene_.collide(level, contacts);
  if (status != Status::ok) {
    forget_passed();
    return status;
  }
  if (filled && !continues) stop_recording(Status::unsupported);
  last_provenance_ = source_query(contacts);
  record_passed();
  CallWriter call(recorder_, RecordedCall::collide, world_);
  call.put(level).put(continues);
  call.put(digest_of_answers(contacts).value());
  return status;
}

// The snapshot contains shape ids and keys of this process. The call records the number of each
// shape in the recording, and which bodies keep their keys, because sensors store keys. After a
// load, contacts count as contacts of another scene, and the predicate is called again for all
// pairs.
Status RecordedScene::load(std::span<const std::byte> saved) {
  if (recorder_ == nullptr || scene_.state_ == nullptr) return scene_.load(saved);
  Column<std::uint32_t> before(scene_.state_->options.memory);
  const std::span<const std::uint32_t> stamps = scene_.state_->keys.stamps();
  if (!before.resize(stamps.size())) return Status::out_of_memory;
  std::copy(stamps.begin(), stamps.end(), before.begin());
  const Status status = scene_.load(saved);
  if (status != Status::ok) return status;
  last_provenance_ = {};
  if (passed_ != nullptr) passed_->pairs.clear();
  if (scene_.state_->options.suppress_ghost_contacts) stop_recording(Status::unsupported);
  record_composite_changes();
  for_live(scene_.state_->keys.stamps(),
           [&](ObjectId body) { (void)number_of(scene_.state_->shape[body]); });
  CallWriter call(recorder_, RecordedCall::load_scene, world_);
  call.put_array(saved);
  const auto count =
      std::count_if(recorded_shapes_.begin(), recorded_shapes_.end(),
                    [](const RecordedShape& shape) { return shape.number != kRemovedShape; });
  call.put(static_cast<std::uint64_t>(count));
  for (const RecordedShape& shape : recorded_shapes_) {
    if (shape.number != kRemovedShape) call.put(shape.id.bits).put(shape.number);
  }
  put_kept(call, {before.data(), before.size()}, scene_.state_->keys.stamps());
  return status;
}

Status RecordedScene::load_contacts(std::span<const std::byte> saved, Contacts& contacts) {
  const Status status = scene_.load_contacts(saved, contacts);
  if (status != Status::ok) return status;
  last_provenance_ = source_query(contacts);
  CallWriter(recorder_, RecordedCall::load_contacts, world_).put_array(saved);
  return status;
}

}  // namespace winnow
