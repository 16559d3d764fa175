// Writes the calls of a scene to a recording.

#include "pipeline/recording/scene_recording.h"

#include "core/memory/saved_keys.h"
#include "pipeline/narrow/tier_number.h"
#include "pipeline/recording/contact_digest.h"

#include <algorithm>

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

}  // namespace

SceneObserver* Recorder::observe_scene(SceneState& scene) noexcept {
  if (state_ == nullptr) return nullptr;
  auto* const made = state_->make_world<SceneRecording>(scene);
  if (made != nullptr) made->begin();
  return made;
}

void SceneRecording::begin() noexcept {
  const SceneOptions& options = scene_.options;
  if (options.suppress_ghost_contacts) recorder_.stop(Status::unsupported);
  CallWriter call = write(RecordedCall::make_scene);
  for (const StructureKind& structure : options.structures) {
    call.put_text(structure.name()).put(structure.parameter());
  }
  call.put(options.contact_margin).put(tier_number(options.tier)).put(options.cache_tolerance);
  call.put(!options.part_manifolds).put(options.warm_start);
  call.put(std::uint64_t{options.build_budget});
}

void SceneRecording::add(std::span<const BodyDefinition> bodies,
                         std::span<const Key> keys) noexcept {
  // Records all new shapes before the call.
  for (const BodyDefinition& body : bodies) (void)shapes_.number_of(body.shape);
  {
    CallWriter call = write(RecordedCall::add_bodies);
    call.put(std::uint64_t{bodies.size()});
    for (const BodyDefinition& body : bodies) {
      const RecordedBody one = recorded(body, shapes_.known_number_of(body.shape));
      call.put_bytes(&one, sizeof one);
    }
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].offsets != ContactOffsets{}) set_offsets(keys[i], bodies[i].offsets);
    if (bodies[i].layer != 0) set_layer(keys[i], bodies[i].layer);
  }
}

void SceneRecording::set_ignored(std::span<const KeyPair> pairs, bool ignored) noexcept {
  CallWriter call = write(RecordedCall::set_ignored);
  call.put(ignored).put(std::uint64_t{pairs.size()});
  for (const KeyPair& pair : pairs) call.put(pair.first.id).put(pair.second.id);
}

// A failed query is not recorded, but the scene may have cached pairs that the predicate accepted
// during the query. If the predicate is set again, the scene tests all pairs again, here and in a
// player.
void SceneRecording::fail() noexcept {
  if (accepted_.empty()) return;
  const PairPredicate predicate = accepted_.predicate();
  scene_.rules.predicate = set_predicate(predicate);
  scene_.invalidate_pairs();
}

// Contacts store the previous frame. Events and cached manifolds depend on whether the last
// `collide` or `load_contacts` of this scene filled the contacts, so the call records this.
// Contacts of other scenes count as empty for this scene.
void SceneRecording::collide(ContactLevel level, const ContactsOrigin& before,
                             const ContactsOrigin& now, const Contacts& contacts) noexcept {
  const bool filled = before.scene == scene_.serial;
  const bool continues = filled && before == last_contacts_;
  last_contacts_ = now;
  shapes_.record_changes();
  if (filled && !continues) recorder_.stop(Status::unsupported);
  accepted_.write();
  write(RecordedCall::collide).put(level).put(continues).put(digest_of_answers(contacts).value());
}

void SceneRecording::before_load() noexcept {
  const std::span<const std::uint32_t> stamps = scene_.keys.stamps();
  const Lock lock(recorder_.mutex);
  if (!stamps_before_load_.resize(stamps.size())) return recorder_.fail(Status::out_of_memory);
  std::copy(stamps.begin(), stamps.end(), stamps_before_load_.begin());
}

// The snapshot contains shape ids and keys of this process. The call records the number of each
// shape in the recording, and which bodies keep their keys, because sensors store keys. After a
// load, contacts count as contacts of another scene, and the predicate is called again for all
// pairs.
void SceneRecording::load(std::span<const std::byte> saved) noexcept {
  last_contacts_ = {};
  accepted_.clear();
  if (scene_.options.suppress_ghost_contacts) recorder_.stop(Status::unsupported);
  shapes_.record_changes();
  const std::span<const std::uint32_t> stamps = scene_.keys.stamps();
  for_live(stamps, [&](ObjectId body) { (void)shapes_.number_of(scene_.shape[body]); });
  CallWriter call = write(RecordedCall::load_scene);
  call.put_array(saved);
  shapes_.put_names(call);
  put_kept(call, {stamps_before_load_.data(), stamps_before_load_.size()}, stamps);
}

void SceneRecording::load_contacts(std::span<const std::byte> saved,
                                   const ContactsOrigin& now) noexcept {
  last_contacts_ = now;
  write(RecordedCall::load_contacts).put_array(saved);
}

}  // namespace winnow
