// Bodies of one rank of a ClusterScene: see rank_scene.h. Called by cluster_scene.cpp.

#include "pipeline/cluster/rank_scene.h"

#include "core/memory/catch_bad_alloc.h"
#include "pipeline/cluster/load_balance.h"
#include "pipeline/scene/contact_frame.h"
#include "pipeline/scene/scene_state.h"
#include "pipeline/shapes/pair_order.h"

#include <algorithm>

namespace winnow {
namespace {

[[nodiscard]] bool is_empty(const Aabb& box) noexcept {
  return !(box.min.x() <= box.max.x());
}

}  // namespace

RankScene::RankScene(std::uint32_t rank, std::uint32_t ranks, const ShapePool& shapes,
                     const SceneOptions& options)
    : RankMembers(shapes, options),
      rank_(rank),
      is_single_rank_(ranks == 1),
      region_(Regions().of(0)),
      contacts_(options.memory),
      events_(rank, ranks) {
  if (scene_.state_ == nullptr || contacts_.state_ == nullptr) throw_bad_alloc();
  state_ = scene_.state_;
  selection_.accept = [](const void* self, std::uint32_t a, std::uint32_t b) {
    return static_cast<const RankScene*>(self)->reports(a, b);
  };
  selection_.context = this;
  state().keeps_origin = true;
  state().selection = &selection_;
}

// ---- changes by the caller

Status RankScene::check(const ClusterSceneBatch& batch) {
  if (batch.names.size() != batch.bodies.size()) return Status::size_mismatch;
  if (batch.bodies.size() + state().keys.slot_count() >= kMaxBodies) {
    return Status::too_many_objects;
  }
  for (const BodyDefinition& body : batch.bodies) {
    if (body.state > BodyState::sleeping) return Status::invalid_argument;
    const bool is_plain = body.offsets == ContactOffsets{} && body.layer == 0;
    if (body.state == BodyState::sleeping || !is_plain) return Status::unsupported;
    if (const Status good = state().check(body.shape, body.pose); good != Status::ok) return good;
  }
  const auto is_here = [this](BodyName name) { return table_.find(name) != NameTable::kNone; };
  if (std::any_of(batch.names.begin(), batch.names.end(), is_here) ||
      has_twice(std::vector<BodyName>(batch.names.begin(), batch.names.end()))) {
    return Status::invalid_key;
  }
  return Status::ok;
}

/// Adds bodies to the scene. Their keys are in `keys_`; they have no flags except kNew.
Status RankScene::add_bodies(std::span<const BodyName> names, std::span<const BodyRecord> bodies) {
  definitions_.clear();
  for (std::size_t i = 0; i < names.size(); ++i) {
    definitions_.push_back(bodies[i].definition(names[i]));
  }
  keys_.resize(names.size());
  const Status status = scene_.add(definitions_, keys_);
  if (status != Status::ok) return status;
  const std::size_t slots = state().keys.slot_count();
  names_.resize(slots);
  flags_.resize(slots);
  table_.reserve(table_.size() + names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const ObjectId id = keys_[i].id;
    names_[id] = names[i];
    flags_[id] = bodies[i].is_new != 0 ? kNew : 0;
    table_.set(names[i], id);
    added_.push_back({names[i], id});
  }
  return Status::ok;
}

Status RankScene::insert(std::span<const BodyName> names, std::span<const BodyRecord> bodies) {
  if (names.empty()) return Status::ok;
  const Status status = add_bodies(names, bodies);
  if (status != Status::ok) return status;
  owned_ += names.size();
  for (const Key key : keys_) {
    flags_[key.id] |= kOwned | kMoved;
    moved_.push_back({key, Aabb{}, true});
  }
  return Status::ok;
}

Status RankScene::replicate(const ClusterSceneBatch& batch) {
  if (batch.names.empty()) return Status::ok;
  std::vector<BodyRecord> records;
  // Before the first collide, the bodies may belong to a restored cluster and may have touched.
  const std::uint8_t is_new = has_collided_ ? 1 : 0;
  for (const BodyDefinition& body : batch.bodies) {
    records.push_back({body.pose, body.shape, body.filter, body.state, is_new});
  }
  const Status status = add_bodies(batch.names, records);
  if (status != Status::ok) return status;
  for (const Key key : keys_) flags_[key.id] |= kReplicated;
  return Status::ok;
}

Status RankScene::check_replicated(std::span<const BodyName> names, std::span<const Pose> poses) {
  if (names.size() != poses.size()) return Status::size_mismatch;
  const auto is_valid = [](const Pose& pose) { return pose.is_valid(); };
  if (!std::all_of(poses.begin(), poses.end(), is_valid)) return Status::invalid_pose;
  return find_keys(names, kReplicated, replicated_keys_);
}

Status RankScene::move_replicated(std::span<const Pose> poses) {
  return scene_.move(replicated_keys_, poses);
}

/// Adds a body to `moved_`, with the box that other ranks know. Call it before the scene computes
/// the new box. `move` and `remove` reserve memory before, because they must not fail here.
void RankScene::note(ObjectId id, bool has_changed) {
  if ((flags_[id] & kMoved) != 0) return;
  moved_.push_back({state().keys.key_of(id), box_of(id), has_changed});
  flags_[id] |= kMoved;
}

Status RankScene::move(std::span<const Key> keys, const PoseView& poses) {
  if (keys.size() != poses.count) return Status::size_mismatch;
  if (!std::all_of(keys.begin(), keys.end(), [this](Key key) { return is_owned(key); })) {
    return Status::invalid_key;
  }
  const std::size_t room = moved_.size() + (is_single_rank_ ? 0 : keys.size());
  if (room > moved_.capacity()) moved_.reserve(2 * room);
  const Status status = scene_.move(keys, poses);
  if (status != Status::ok || is_single_rank_) return status;
  for (const Key key : keys) note(key.id, true);
  return Status::ok;
}

Status RankScene::move(std::span<const BodyName> names, const PoseView& poses) {
  if (names.size() != poses.count) return Status::size_mismatch;
  const Status status = find_keys(names, kOwned, keys_);
  return status == Status::ok ? move(std::span<const Key>(keys_), poses) : status;
}

Status RankScene::remove(std::span<const BodyName> names) {
  const Status status = find_keys(names, kOwned, keys_);
  if (status != Status::ok) return status;
  const std::size_t room = moved_.size() + names.size();
  if (room > moved_.capacity()) moved_.reserve(2 * room);
  removed_.insert(removed_.end(), names.begin(), names.end());
  for (const Key key : keys_) {
    note(key.id, true);
    flags_[key.id] |= kRemoved;
    table_.erase(names_[key.id]);
  }
  owned_ -= names.size();
  return Status::ok;
}

// ---- migration

bool RankScene::is_within(const Aabb& box) const noexcept {
  return contains(region_, box);
}

Status RankScene::refresh() {
  note_changed_composites();
  return scene_.refresh();
}

/// Notes all bodies with composite shapes if a shape of their pool changed: a change in place gives
/// a body a new box without a move.
void RankScene::note_changed_composites() {
  const CompositePool* const composites = state().options.composites;
  if (is_single_rank_ || composites == nullptr || composites->revision() == state().composites_seen)
    return;
  for (ObjectId id = 0; id < flags_.size(); ++id) {
    const Key key = state().keys.key_of(id);
    if (is_owned(key) && state().shape[id].is_composite()) note(id, true);
  }
}

void RankScene::send_removals(const Regions& regions) {
  send_queue_.clear();
  changes_.clear();
  const auto is_removed = [this](const MovedBody& moved) {
    return (flags_[moved.key.id] & kRemoved) != 0;
  };
  const auto rest = std::stable_partition(
      moved_.begin(), moved_.end(), [&](const MovedBody& moved) { return !is_removed(moved); });
  for (auto moved = rest; moved != moved_.end(); ++moved) add_messages(*moved, regions, regions);
  moved_.erase(rest, moved_.end());
}

void RankScene::send(const Regions& before, const Regions& now, bool regions_changed) {
  region_ = now.of(rank_);
  send_queue_.clear();
  changes_.clear();
  arrived_.clear();
  departed_.clear();
  works_.clear();
  if (regions_changed) {
    note_all_that_cross();
    // This rank now reports other pairs, so the scene must not reuse its pairs.
    state().pairs.clear();
  }
  for (const MovedBody& moved : moved_) add_messages(moved, before, now);
  moved_.clear();
}

/// Notes unmoved bodies that crossed the border of the old region or cross that of the new one.
void RankScene::note_all_that_cross() {
  for (ObjectId id = 0; id < flags_.size(); ++id) {
    if (!is_owned(state().keys.key_of(id))) continue;
    if ((flags_[id] & kCrosses) != 0 || !is_within(box_of(id))) note(id, false);
  }
}

void RankScene::add_messages(const MovedBody& moved, const Regions& before, const Regions& now) {
  const ObjectId id = moved.key.id;
  flags_[id] = static_cast<std::uint8_t>(flags_[id] & ~kMoved);
  const bool removed = (flags_[id] & kRemoved) != 0;
  const Aabb box = removed ? Aabb{} : box_of(id);
  const bool is_known = !is_empty(moved.sent_box);
  // Bodies that were and are contained in the region concern no other rank.
  if (is_known && !removed && (flags_[id] & kCrosses) == 0 && is_within(box)) return;
  const std::uint32_t owner = removed ? rank_ : now.owner(centre_of(box));
  before.ranks_of(moved.sent_box, ranks_before_);
  now.ranks_of(box, ranks_now_);
  send_queue_.add_messages(rank_, {names_[id], owner, !moved.has_changed}, record_of(id),
                           ranks_before_, ranks_now_);
  if (owner != rank_) {
    departed_.push_back(names_[id]);
    --owned_;
  }
  if (!std::binary_search(ranks_now_.begin(), ranks_now_.end(), rank_)) {
    if (!removed) table_.erase(names_[id]);
    flags_[id] = 0;
    changes_.dropped.push_back(moved.key);
    return;
  }
  const int kept = flags_[id] & (kNew | kWasInterior);
  flags_[id] = static_cast<std::uint8_t>(kept | (owner == rank_ ? kOwned : 0) |
                                         (is_within(box) ? 0 : kCrosses));
  if (owner != rank_) {
    ++ghosts_;
  } else if (!is_known) {
    arrived_.push_back({names_[id], moved.key});
  }
}

Status RankScene::receive(std::span<const RankMessage> messages) {
  // Apply removals first: a name may be added again in the same exchange.
  take_gone<BodyRecord>(messages, table_, [&](std::uint32_t id) {
    changes_.dropped.push_back(state().keys.key_of(id));
    flags_[id] = 0;
    --ghosts_;
  });
  for (const RankMessage& message : messages) take(BodyMessages<BodyRecord>(message));
  return apply_changes();
}

/// Adds the bodies that this rank does not have. For the others a message contains a new pose, and
/// also makes this rank the owner if `belongs` is set.
void RankScene::take(const BodyMessages<BodyRecord>& incoming) {
  for (std::size_t i = 0; i < incoming.names.size(); ++i) {
    const std::uint32_t id = table_.find(incoming.names[i]);
    if (id == NameTable::kNone) {
      changes_.add_fresh(incoming, i);
      continue;
    }
    const Key key = state().keys.key_of(id);
    changes_.keys.push_back(key);
    changes_.places.push_back(incoming.contents[i].pose);
    if (incoming.belongs[i] == 0) continue;
    flags_[id] |= kOwned;
    --ghosts_;
    ++owned_;
    arrived_.push_back({incoming.names[i], key});
  }
}

Status RankScene::apply_changes() {
  has_removed_ = has_removed_ || !changes_.dropped.empty();
  Status status = scene_.remove(changes_.dropped);
  if (status == Status::ok) status = scene_.move(changes_.keys, changes_.places);
  if (status == Status::ok && !changes_.names.empty()) {
    status = add_bodies(changes_.names, changes_.fresh);
  }
  // Compute the boxes of new and moved bodies: kCrosses depends on them.
  if (status == Status::ok) status = refresh();
  if (status != Status::ok) return status;
  for (std::size_t i = 0; i < changes_.names.size(); ++i) {
    const bool belongs = changes_.belongs[i] != 0;
    if (belongs) arrived_.push_back({changes_.names[i], keys_[i]});
    ++(belongs ? owned_ : ghosts_);
    if (belongs) flags_[keys_[i].id] |= kOwned;
    changes_.keys.push_back(keys_[i]);
  }
  for (const Key key : changes_.keys) {
    const int kept = flags_[key.id] & ~kCrosses;
    flags_[key.id] = static_cast<std::uint8_t>(kept | (is_within(box_of(key.id)) ? 0 : kCrosses));
  }
  return Status::ok;
}

// ---- contacts

/// The rank that owns the other body reports a pair with a replicated body. For other pairs, if one
/// box is contained in the region, the reference point is too.
bool RankScene::reports(ObjectId a, ObjectId b) const noexcept {
  if (is_single_rank_) return true;
  if (((flags_[a] | flags_[b]) & kReplicated) != 0) return ((flags_[a] | flags_[b]) & kOwned) != 0;
  if ((flags_[a] & flags_[b] & kCrosses) == 0) return true;
  const Vec3f at = reference_point(box_of(a).min, box_of(b).min);
  return is_within({at, at});
}

/// Removes erased bodies from the list by name and merges new bodies into it, which is cheaper than
/// sorting all bodies.
void RankScene::sort_names() {
  if (!has_removed_ && added_.empty()) return;
  std::erase_if(by_name_, [this](const NamedId& one) {
    return !state().keys.is_live(one.id) || names_[one.id] != one.name;
  });
  std::erase_if(added_, [this](const NamedId& one) {
    return !state().keys.is_live(one.id) || names_[one.id] != one.name;
  });
  std::sort(added_.begin(), added_.end());
  const auto old = static_cast<std::ptrdiff_t>(by_name_.size());
  by_name_.insert(by_name_.end(), added_.begin(), added_.end());
  std::inplace_merge(by_name_.begin(), by_name_.begin() + old, by_name_.end());
  by_name_.erase(std::unique(by_name_.begin(), by_name_.end()), by_name_.end());
  added_.clear();
  has_removed_ = false;
  place_.resize(names_.size());
  body_.resize(by_name_.size());
  for (std::uint32_t i = 0; i < by_name_.size(); ++i) {
    place_[by_name_[i].id] = i;
    body_[i] = by_name_[i].id;
  }
  selection_.place = place_;
  selection_.body = body_;
}

Status RankScene::collide(ContactLevel level) {
  sort_names();
  // Clear the previous frame of these contacts: another rank may have reported a pair then.
  // compare_contacts determines the events.
  contacts_.clear();
  const Status status = scene_.collide(level, contacts_);
  if (status != Status::ok) return status;
  compare_contacts();
  store_interior_flags();
  has_collided_ = true;
  return Status::ok;
}

void RankScene::compare_contacts() {
  using Knowledge = ContactEvents::Knowledge;
  std::vector<TouchingPair> now(contacts_.size());
  std::vector<Knowledge> knowledge(contacts_.size());
  for (const ContactRun& run : contacts_.runs()) {
    const std::uint32_t code = KindPairs::index(run.kind_a, run.kind_b);
    for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
      const ObjectId a = contacts_.a()[i].id;
      const ObjectId b = contacts_.b()[i].id;
      now[i] = {code, names_[a], names_[b]};
      const bool is_new = ((flags_[a] | flags_[b]) & kNew) != 0;
      const bool is_local = is_single_rank_ || (stayed_interior(a) && stayed_interior(b));
      knowledge[i] = is_new ? Knowledge::is_new : is_local ? Knowledge::local : Knowledge::none;
    }
  }
  events_.compare(now, knowledge, [this](const TouchingPair& pair) {
    const std::uint32_t a = table_.find(pair.a);
    const std::uint32_t b = table_.find(pair.b);
    return is_single_rank_ || (a != NameTable::kNone && b != NameTable::kNone &&
                               stayed_interior(a) && stayed_interior(b));
  });
}

/// Stores in the flags the state of this frame, which the next collide reads.
void RankScene::store_interior_flags() {
  for (std::uint8_t& flags : flags_) {
    const bool is_interior = (flags & (kOwned | kCrosses)) == kOwned;
    flags = static_cast<std::uint8_t>((flags & ~(kNew | kWasInterior)) |
                                      (is_interior ? kWasInterior : 0));
  }
}

void RankScene::show_events() {
  ContactsState& shown = *contacts_.state_;
  const auto persisted = events_.persisted();
  for (std::size_t i = 0; i < persisted.size(); ++i) {
    if (persisted[i] != 0) shown.frame.event[i] = ContactEvent::persisted;
  }
  const auto key_by_name = [this](BodyName name) {
    const std::uint32_t id = table_.find(name);
    return id == NameTable::kNone ? Key{} : state().keys.key_of(id);
  };
  for (const TouchingPair& pair : events_.ended()) {
    if (!shown.ended.push_back({key_by_name(pair.a), key_by_name(pair.b), pair.a, pair.b})) {
      throw_bad_alloc();
    }
  }
}

RankCounts RankScene::counts() const noexcept {
  const SceneStatistics& found = scene_.statistics();
  return {owned_, ghosts_, contacts_.size(), departed_.size(),
          scene_.size() + (found.body_pairs - found.rejected_by_spheres) + found.primitive_pairs};
}

void RankScene::measure_work() {
  std::vector<std::uint64_t> counts(flags_.size(), 1);
  const BodyPairs& pairs = state().pairs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const BodyPair pair = pairs[i];
    const bool a_is_elsewhere = (flags_[pair.a] & kOwned) == 0;
    const bool a_is_larger = is_larger(box_of(pair.a), box_of(pair.b));
    ++counts[a_is_elsewhere || a_is_larger ? pair.b : pair.a];
  }
  const auto owned = [this](std::size_t id) { return (flags_[id] & kOwned) != 0; };
  works_ = shares_of(counts, owned, this->counts().work);
}

CutWork RankScene::cut_work() {
  work_boxes_.clear();
  works_of_owned_.clear();
  for (ObjectId id = 0; id < flags_.size(); ++id) {
    if (!is_owned(state().keys.key_of(id))) continue;
    work_boxes_.push_back(box_of(id));
    works_of_owned_.push_back(id < works_.size() ? works_[id] : 1);
  }
  return {work_boxes_, works_of_owned_};
}

Bytes RankScene::bytes() const noexcept {
  Bytes sum = scene_.footprint().total();
  sum += contacts_.footprint().total();
  const std::size_t columns = names_.capacity() * sizeof(BodyName) + flags_.capacity() +
                              table_.bytes() + by_name_.capacity() * sizeof(NamedId) +
                              (place_.capacity() + body_.capacity()) * sizeof(std::uint32_t) +
                              events_.touching().size() * sizeof(TouchingPair);
  sum += {columns, columns};
  return sum;
}

}  // namespace winnow
