// Bodies of one rank of a Cluster: see rank_bodies.h. Called by cluster.cpp.

#include "pipeline/cluster/rank_bodies.h"

#include "partitions/rows/box_compare.kernel.h"
#include "partitions/rows/row_input.h"
#include "pipeline/cluster/load_balance.h"

#include <algorithm>
#include <array>

namespace winnow {
namespace {

[[nodiscard]] bool are_valid(const BoxView& boxes) noexcept {
  for (std::size_t i = 0; i < boxes.count; ++i) {
    if (!boxes[i].is_valid()) return false;
  }
  return true;
}

/// True for four keys with consecutive ids. Ids wrap: 0 follows the greatest one.
[[nodiscard]] bool follow_each_other(std::span<const Key> keys) noexcept {
  const ObjectId first = keys[0].id;
  return ((keys[1].id - first - 1) | (keys[2].id - first - 2) | (keys[3].id - first - 3)) == 0;
}

}  // namespace

RankBodies::RankBodies(std::uint32_t rank, bool is_single_rank, const ClusterOptions& options)
    : rank_(rank),
      is_single_rank_(is_single_rank),
      region_(Regions().of(0)),
      partition_(options.structure, {.memory = options.memory, .execution = options.execution}),
      found_(options.memory),
      names_(options.memory),
      flags_(options.memory),
      table_(options.memory),
      sorted_(options.memory) {}

// ---- changes by the caller

Status RankBodies::check(const ClusterBatch& batch) {
  if (batch.names.size() != batch.boxes.count) return Status::size_mismatch;
  if (!are_valid(batch.boxes)) return Status::invalid_bounds;
  const auto is_here = [this](BodyName name) { return table_.find(name) != NameTable::kNone; };
  if (std::any_of(batch.names.begin(), batch.names.end(), is_here) ||
      has_twice(std::vector<BodyName>(batch.names.begin(), batch.names.end()))) {
    return Status::invalid_key;
  }
  return Status::ok;
}

Status RankBodies::insert(const ClusterBatch& batch) {
  if (batch.names.empty()) return Status::ok;
  keys_.resize(batch.names.size());
  const Status status = partition_.insert(batch.boxes, {}, keys_);
  if (status != Status::ok) return status;
  add_rows(batch.names, keys_);
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    flags_[keys_[i].id] = kOwned | kMoved;
    moved_.push_back({keys_[i], Aabb{}});
  }
  return Status::ok;
}

void RankBodies::add_rows(std::span<const BodyName> names, std::span<const Key> keys) {
  forget_pairs();  // ids of removed bodies are reused for other names
  std::size_t rows = names_.size();
  for (const Key& key : keys) rows = std::max<std::size_t>(rows, key.id + std::size_t{1});
  names_.resize(rows);
  flags_.resize(rows);
  table_.reserve(table_.size() + names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    names_[keys[i].id] = names[i];
    table_.set(names[i], keys[i].id);
  }
}

Status RankBodies::move(std::span<const Key> keys, const BoxView& boxes) {
  if (is_single_rank_) return partition_.update(keys, boxes);
  if (keys.size() != boxes.count) return Status::size_mismatch;
  const std::size_t moved = moved_.size();
  Status status = note_moves(keys, boxes) ? Status::ok : Status::invalid_key;
  // The partition also checks for stale keys and invalid boxes.
  if (status == Status::ok) status = partition_.update(keys, boxes);
  if (status == Status::ok) return status;
  for (std::size_t i = moved; i < moved_.size(); ++i) flags_[moved_[i].key.id] &= ~kMoved;
  moved_.resize(moved);
  return status;
}

/// Writes to `beyond_` the indices of boxes that are not contained in this rank's region.
void RankBodies::find_beyond(const BoxView& boxes) {
  beyond_.resize(boxes.count);
  std::uint32_t found = 0;
  if (BoxSource{boxes}.packed()) {
    const float around[6] = {region_.min[0], region_.min[1], region_.min[2],
                             region_.max[0], region_.max[1], region_.max[2]};
    found = box_compare_kernels().beyond(boxes.min[0], around, boxes.count, beyond_.data());
  } else {
    for (std::uint32_t i = 0; i < boxes.count; ++i) {
      if (!is_within(boxes[i])) beyond_[found++] = i;
    }
  }
  beyond_.resize(found);
}

/// Adds bodies to `moved_` before their boxes change, except bodies that were and will be contained
/// in the region: those concern no other rank. Returns false if a key does not belong to this rank.
bool RankBodies::note_moves(std::span<const Key> keys, const BoxView& boxes) {
  box_keys_.clear();
  const auto look = [this](Key key) {
    if (key.id >= flags_.size()) return false;
    const std::uint8_t flags = flags_[key.id];
    if ((flags & (kOwned | kRemoved)) != kOwned) return false;
    if (flags != kOwned && (flags & kMoved) == 0) box_keys_.push_back(key);
    return true;
  };
  constexpr std::size_t kTogether = 4;
  for (std::size_t i = 0; i < keys.size(); i += kTogether) {
    const std::span<const Key> some = keys.subspan(i, std::min(kTogether, keys.size() - i));
    if (some.size() == kTogether && follow_each_other(some)) {
      // Fast path: most bodies have no other flag.
      std::array<std::uint8_t, kTogether> flags{};
      if (std::max(some.front().id, some.back().id) >= flags_.size()) return false;
      std::copy_n(flags_.data() + some.front().id, kTogether, flags.begin());
      if (flags == std::array<std::uint8_t, kTogether>{kOwned, kOwned, kOwned, kOwned}) continue;
    }
    if (!std::ranges::all_of(some, look)) return false;
  }
  find_beyond(boxes);
  for (const std::uint32_t i : beyond_) {
    if (flags_[keys[i].id] == kOwned) box_keys_.push_back(keys[i]);
  }
  if (!find_boxes()) return false;
  const std::size_t room = moved_.size() + box_keys_.size();
  if (room > moved_.capacity()) moved_.reserve(2 * room);
  for (std::size_t i = 0; i < box_keys_.size(); ++i) {
    std::uint8_t& flags = flags_[box_keys_[i].id];
    if ((flags & kMoved) == 0) moved_.push_back({box_keys_[i], boxes_[i]});
    flags |= kMoved;
  }
  return true;
}

Status RankBodies::find_keys(std::span<const BodyName> names, std::vector<Key>& keys) const {
  keys.clear();
  for (const BodyName name : names) {
    Key key;
    const Status status = key_of(name, key);
    if (status != Status::ok) return status;
    keys.push_back(key);
  }
  return has_twice(std::vector<BodyName>(names.begin(), names.end())) ? Status::invalid_key
                                                                      : Status::ok;
}

Status RankBodies::move(std::span<const BodyName> names, const BoxView& boxes) {
  if (names.size() != boxes.count) return Status::size_mismatch;
  const Status status = find_keys(names, keys_);
  return status == Status::ok ? move(std::span<const Key>(keys_), boxes) : status;
}

Status RankBodies::remove(std::span<const BodyName> names) {
  const Status status = find_keys(names, keys_);
  if (status != Status::ok) return status;
  if (is_single_rank_) {
    const Status removed = partition_.remove(keys_);
    if (removed != Status::ok) return removed;
    for (const BodyName name : names) table_.erase(name);
    return Status::ok;
  }
  const std::size_t room = moved_.size() + names.size();
  if (room > moved_.capacity()) moved_.reserve(2 * room);
  removed_.insert(removed_.end(), names.begin(), names.end());
  for (const Key key : keys_) {
    std::uint8_t& flags = flags_[key.id];
    if ((flags & kMoved) == 0) moved_.push_back({key, box_of(key)});
    flags |= kMoved | kRemoved;
    table_.erase(names_[key.id]);
  }
  return Status::ok;
}

Status RankBodies::key_of(BodyName name, Key& key) const noexcept {
  const std::uint32_t id = table_.find(name);
  if (id == NameTable::kNone || (flags_[id] & kOwned) == 0) return Status::invalid_key;
  key = partition_.key_of(id);
  return Status::ok;
}

Status RankBodies::bodies(std::span<ClusterBody> bodies, std::span<Aabb> boxes) const {
  if (bodies.size() != size() || boxes.size() != size()) return Status::size_mismatch;
  std::vector<Key> keys;
  keys.reserve(bodies.size());
  std::size_t count = 0;
  for (ObjectId id = 0; id < flags_.size(); ++id) {
    const Key key = partition_.key_of(id);
    if (!is_owned(key)) continue;
    bodies[count++] = {names_[id], key};
    keys.push_back(key);
  }
  return partition_.bounds(keys, boxes);
}

// ---- migration

Aabb RankBodies::box_of(Key key) const noexcept {
  return partition_.bounds(key);
}

/// Looks up the boxes of the keys in `box_keys_`; false if any is stale.
bool RankBodies::find_boxes() {
  boxes_.resize(box_keys_.size());
  return partition_.bounds(box_keys_, boxes_) == Status::ok;
}

bool RankBodies::is_within(const Aabb& box) const noexcept {
  return contains(region_, box);
}

std::uint8_t RankBodies::flags_of(const Aabb& box, bool owned) const noexcept {
  unsigned flags = owned ? unsigned{kOwned} : 0U;
  if (is_within(box)) return static_cast<std::uint8_t>(flags);
  flags |= kCrosses;
  constexpr std::array kBelowOf{kBelowX, kBelowY, kBelowZ};
  for (int axis = 0; axis < 3; ++axis) {
    if (box.min[axis] < region_.min[axis]) flags |= kBelowOf[static_cast<std::size_t>(axis)];
  }
  return static_cast<std::uint8_t>(flags);
}

void RankBodies::send_removals(const Regions& regions) {
  send_queue_.clear();
  changes_.clear();
  const auto is_removed = [this](const MovedBox& moved) {
    return partition_.contains(moved.key) && (flags_[moved.key.id] & kRemoved) != 0;
  };
  const auto rest = std::stable_partition(
      moved_.begin(), moved_.end(), [&](const MovedBox& moved) { return !is_removed(moved); });
  for (auto moved = rest; moved != moved_.end(); ++moved)
    add_messages(*moved, Aabb{}, regions, regions);
  moved_.erase(rest, moved_.end());
}

void RankBodies::send(const Regions& before, const Regions& now, bool regions_changed) {
  region_ = now.of(rank_);
  send_queue_.clear();
  changes_.clear();
  arrived_.clear();
  departed_.clear();
  works_.clear();
  if (regions_changed) note_all_that_cross();
  // A single rank removes bodies at once, and leaves them in `moved_`.
  std::erase_if(moved_, [this](const MovedBox& moved) { return !partition_.contains(moved.key); });
  box_keys_.clear();
  for (const MovedBox& moved : moved_) box_keys_.push_back(moved.key);
  (void)find_boxes();
  for (std::size_t i = 0; i < moved_.size(); ++i) {
    const bool removed = (flags_[moved_[i].key.id] & kRemoved) != 0;
    add_messages(moved_[i], removed ? Aabb{} : boxes_[i], before, now);
  }
  moved_.clear();
}

/// Adds to `moved_` the unmoved bodies that crossed the border of the old region or cross that of
/// the new one, and updates the flags of copies.
void RankBodies::note_all_that_cross() {
  box_keys_.clear();
  for (ObjectId id = 0; id < flags_.size(); ++id) {
    const Key key = partition_.key_of(id);
    if (partition_.contains(key) && (flags_[id] & kMoved) == 0) box_keys_.push_back(key);
  }
  (void)find_boxes();
  for (std::size_t i = 0; i < box_keys_.size(); ++i) {
    std::uint8_t& flags = flags_[box_keys_[i].id];
    if ((flags & kOwned) == 0) {
      flags = flags_of(boxes_[i], false);
    } else if ((flags & kCrosses) != 0 || !is_within(boxes_[i])) {
      moved_.push_back({box_keys_[i], boxes_[i]});
    }
  }
}

void RankBodies::add_messages(const MovedBox& moved, const Aabb& box, const Regions& before,
                              const Regions& now) {
  const ObjectId id = moved.key.id;
  const bool removed = (flags_[id] & kRemoved) != 0;
  const std::uint32_t owner = removed ? rank_ : now.owner(centre_of(box));
  before.ranks_of(moved.sent_box, ranks_before_);
  now.ranks_of(box, ranks_now_);
  send_queue_.add_messages(rank_, {names_[id], owner, box == moved.sent_box}, box, ranks_before_,
                           ranks_now_);

  const bool stays = std::binary_search(ranks_now_.begin(), ranks_now_.end(), rank_);
  if (owner != rank_) departed_.push_back(names_[id]);
  if (!stays) {
    if (!removed) table_.erase(names_[id]);
    flags_[id] = 0;
    changes_.dropped.push_back(moved.key);
    return;
  }
  flags_[id] = flags_of(box, owner == rank_);
  if (owner != rank_) {
    ++ghosts_;
  } else if (!(moved.sent_box.min.x() <= moved.sent_box.max.x())) {
    arrived_.push_back({names_[id], moved.key});
  }
}

Status RankBodies::receive(std::span<const RankMessage> messages) {
  // Apply removals first: a name may be added again in the same exchange.
  take_gone<Aabb>(messages, table_, [&](std::uint32_t id) {
    changes_.dropped.push_back(partition_.key_of(id));
    flags_[id] = 0;
    --ghosts_;
  });
  for (const RankMessage& message : messages) take(BodyMessages<Aabb>(message));
  return apply_changes();
}

void RankBodies::take(const BodyMessages<Aabb>& incoming) {
  for (std::size_t i = 0; i < incoming.names.size(); ++i) {
    if (i + kFetchAhead < incoming.names.size()) table_.fetch(incoming.names[i + kFetchAhead]);
    const bool belongs = incoming.belongs[i] != 0;
    const std::uint32_t id = table_.find(incoming.names[i]);
    if (id == NameTable::kNone) {
      changes_.add_fresh(incoming, i);
      continue;
    }
    const Key key = partition_.key_of(id);
    changes_.keys.push_back(key);
    changes_.places.push_back(incoming.contents[i]);
    flags_[id] = flags_of(incoming.contents[i], belongs);
    if (!belongs) continue;
    --ghosts_;
    arrived_.push_back({incoming.names[i], key});
  }
}

Status RankBodies::apply_changes() {
  Status status = partition_.remove(changes_.dropped);
  if (status == Status::ok) status = partition_.update(changes_.keys, changes_.places);
  if (status != Status::ok || changes_.names.empty()) return status;
  keys_.resize(changes_.names.size());
  status = partition_.insert(changes_.fresh, {}, keys_);
  if (status != Status::ok) return status;
  add_rows(changes_.names, keys_);
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    const bool belongs = changes_.belongs[i] != 0;
    flags_[keys_[i].id] = flags_of(changes_.fresh[i], belongs);
    if (belongs) {
      arrived_.push_back({changes_.names[i], keys_[i]});
    } else {
      ++ghosts_;
    }
  }
  return Status::ok;
}

// ---- pairs, and the work that they cause

/// A pair is reported by the rank of its reference point: on each axis the larger of the two low
/// corners. The point is below this region on an axis if both low corners are. The point is never
/// above the region, because both boxes overlap the region.
std::size_t RankBodies::put_reported_first() noexcept {
  return found_.partition([flags = flags_.data()](const Pair& pair) {
    const unsigned below = flags[pair.first] & kBelow;
    return below == 0 || (below & flags[pair.second]) == 0;
  });
}

void RankBodies::sort_by_names() {
  const auto names_of = [this](const Pair& pair) {
    return detail::NamePairLookup{&pair, names_.data()}(0);
  };
  std::ranges::sort(sorted_, {}, names_of);
}

Status RankBodies::find_pairs(Order order) {
  reported_ = {};
  const Status status = partition_.self_pairs(found_);
  if (status != Status::ok) return status;
  reported_ = found_.pairs();
  if (!is_single_rank_) reported_ = reported_.first(put_reported_first());
  if (order == Order::fast) return Status::ok;
  sorted_.assign(reported_.begin(), reported_.end());
  sort_by_names();
  reported_ = sorted_;
  return Status::ok;
}

void RankBodies::measure_work() {
  box_keys_.clear();
  for (ObjectId id = 0; id < flags_.size(); ++id) {
    const Key key = partition_.key_of(id);
    if (partition_.contains(key)) box_keys_.push_back(key);
  }
  (void)find_boxes();
  std::vector<Aabb> box_of(flags_.size());
  for (std::size_t i = 0; i < box_keys_.size(); ++i) box_of[box_keys_[i].id] = boxes_[i];
  std::vector<std::uint64_t> counts(flags_.size(), 1);
  for (const Pair& pair : found_) {
    const bool first_is_larger = is_larger(box_of[pair.first], box_of[pair.second]);
    ++counts[first_is_larger ? pair.second : pair.first];
  }
  const auto owned = [this](std::size_t id) { return (flags_[id] & kOwned) != 0; };
  works_ = shares_of(counts, owned, work());
}

CutWork RankBodies::cut_work() {
  works_of_owned_.clear();
  box_keys_.clear();
  for (ObjectId id = 0; id < flags_.size(); ++id) {
    const Key key = partition_.key_of(id);
    if (!is_owned(key)) continue;
    box_keys_.push_back(key);
    works_of_owned_.push_back(id < works_.size() ? works_[id] : 1);
  }
  (void)find_boxes();
  return {boxes_, works_of_owned_};
}

Bytes RankBodies::bytes() const noexcept {
  Bytes sum = partition_.footprint().total();
  const std::size_t columns =
      names_.capacity() * sizeof(BodyName) + flags_.capacity() + table_.bytes();
  sum += {columns, columns};
  return sum;
}

}  // namespace winnow
