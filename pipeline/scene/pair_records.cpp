// Records of pairs between calls: matches them with the pairs of this call, stores the records of
// sleeping pairs separately, and lists the pairs that ended. Collision (collide.cpp,
// write_contacts.cpp) calls this.

#include "core/sort/parallel_ranges.h"
#include "pipeline/narrow/tight_growth.h"
#include "pipeline/scene/collision.h"

#include <algorithm>
#include <utility>

namespace winnow {
namespace {

constexpr std::size_t kPairsPerListing = 8192;

}  // namespace

// Lists the records of the last frame if they were not kept.
bool Collision::list_records() {
  ContactsState& c = contacts_;
  last_records_ = last_pairs_ = static_cast<std::uint32_t>(c.frame.pairs());
  if (last_pairs_ == 0 || c.records.size() != 0) return true;
  if (!resize_tightly(c.records.bits, last_pairs_)) return false;
  for (const ContactRun& run : c.frame.runs) {
    const std::uint32_t code = KindPairs::index(run.kind_a, run.kind_b);
    for_each_range(scene_.options.execution, run.count, kPairsPerListing,
                   [&](std::size_t first, std::size_t end) {
                     for (std::size_t i = run.first + first; i < run.first + end; ++i) {
                       const BodyPair bodies{c.frame.key[0][i].id, c.frame.key[1][i].id};
                       c.records.bits[i] = PairOrder::of(code, bodies).bits;
                     }
                   });
  }
  return true;
}

// Appends sleeping pairs to the last frame again if bodies may have woken.
bool Collision::wake_dormant() {
  ContactsState& c = contacts_;
  if (!same_level_) {
    c.dormant_records.clear();
    c.dormant_cached.clear();
  }
  const std::size_t count = c.dormant_records.size();
  if (count == 0 || c.regroupings == scene_.regroupings) return true;
  Cursor at{static_cast<std::uint32_t>(c.frame.pairs()),
            static_cast<std::uint32_t>(c.frame.manifolds),
            static_cast<std::uint32_t>(c.frame.points.size())};
  if (!c.frame.resize(level_, at.pair + count, at.manifold + c.dormant.manifolds,
                      at.point + c.dormant.points.size()) ||
      !c.records_before.reserve(c.records.size() + count) ||
      (uses_cache_ && !c.cached_before.resize(c.records.size() + count))) {
    return false;
  }
  for (std::uint32_t& shown : c.dormant_records.shown) {
    c.frame.copy(c.dormant, shown, 1, at);
    const Cursor taken = c.dormant.extent(shown);
    shown = at.pair;
    at += taken;
  }
  c.frame.close(level_, at);
  last_records_ = at.pair;
  merge_dormant();
  return true;
}

// Merges two sorted lists. The columns must have room.
void Collision::merge_dormant() noexcept {
  ContactsState& c = contacts_;
  const PairRecords& slept = c.dormant_records;
  c.records_before.clear();
  std::size_t one = 0;
  std::size_t other = 0;
  for (std::size_t i = 0; i < c.records.size() + slept.size(); ++i) {
    const bool first = other == slept.size() ||
                       (one < c.records.size() && c.records.bits[one] < slept.bits[other]);
    if (uses_cache_) c.cached_before[i] = first ? c.cached[one] : c.dormant_cached[other];
    const PairRecords& from = first ? c.records : slept;
    const std::size_t at = first ? one++ : other++;
    c.records_before.push_back_within_room(from.order_of(at), from.shown_of(at));
  }
  c.records.swap(c.records_before);
  c.cached.swap(c.cached_before);
  c.dormant_records.clear();
  c.dormant_cached.clear();
}

// Finds the record of each pair of the batch; both lists are sorted alike. The column must have
// room.
void Collision::match(const PairRecords& records) noexcept {
  const std::uint64_t* const begin = records.bits.begin();
  const std::uint64_t* const none = records.bits.end();
  for_tasks([&](std::size_t, std::uint32_t first, std::uint32_t end) {
    const std::uint64_t* record = std::lower_bound(begin, none, scene_.pairs.order(first).bits);
    for (std::uint32_t i = first; i < end; ++i) {
      const std::uint64_t order = scene_.pairs.order(i).bits;
      while (record != none && *record < order) ++record;
      const bool found = record != none && *record == order;
      contacts_.old_record[i - known_from_] =
          found ? static_cast<std::uint32_t>(record++ - begin) : kNoEntry;
    }
  });
}
// True if both bodies still exist and neither is dynamic any more, so that the pair is no longer
// tested.
bool Collision::sleeps(const BodyPair& pair) const noexcept {
  for (const std::uint32_t body : {pair.a, pair.b}) {
    if (!scene_.keys.is_valid(contacts_.known.key(body)) ||
        scene_.body_state[body] == BodyState::dynamic) {
      return false;
    }
  }
  return true;
}

// Pairs of the last frame that are not in this frame have ended, or sleep.
bool Collision::close_frame() {
  ContactsState& c = contacts_;
  // A body falls asleep by changing its partition, which makes find_pairs run again.
  const bool may_sleep = same_level_ && !same_pairs_ && c.regroupings != scene_.regroupings;
  if ((may_sleep && !put_to_sleep()) || !list_ended()) return false;
  c.is_settled =
      c.ended.empty() && std::all_of(c.frame.event.begin(), c.frame.event.end(),
                                     [](ContactEvent e) { return e == ContactEvent::persisted; });
  return true;
}

bool Collision::put_to_sleep() {
  ContactsState& c = contacts_;
  PairRecords& slept = c.dormant_records;
  if (!slept.reserve(last_records_) || (uses_cache_ && !c.dormant_cached.reserve(last_records_))) {
    return false;
  }
  Cursor room;
  for (std::size_t r = 0; r < c.records_before.size(); ++r) {
    const PairOrder order = c.records_before.order_of(r);
    const std::uint32_t shown = c.records_before.shown_of(r);
    if (shown == kNoEntry || c.shown_again[shown] != 0 || !sleeps(order.bodies())) continue;
    c.shown_again[shown] = 1;
    room += c.before.extent(shown);
    slept.push_back_within_room(order, shown);
    if (!uses_cache_) continue;
    CachedPair& cached = c.cached_before[r];
    if (!has_slept(shown)) cached.tested_at = c.clock;
    (void)c.dormant_cached.push_back(cached);
  }
  if (room.pair == 0) return true;
  c.dormant.with_parts = c.frame.with_parts;
  if (!c.dormant.resize(level_, room.pair, room.manifold, room.point)) return false;
  Cursor at;
  for (std::size_t i = 0; i < slept.size(); ++i) {
    const BodyPair bodies = slept.order_of(i).bodies();
    const std::uint32_t ids[2] = {bodies.a, bodies.b};
    for (int side = 0; side < 2; ++side) c.dormant.key[side][at.pair] = c.known.key(ids[side]);
    c.dormant.event[at.pair] = ContactEvent::persisted;
    const std::uint32_t shown = std::exchange(slept.shown[i], at.pair);
    c.dormant.copy(c.before, shown, 1, at);
    at += c.before.extent(shown);
  }
  c.dormant.close(level_, at);
  return true;
}

// Lists ended pairs in the order of the last frame; pairs that slept follow.
bool Collision::list_ended() {
  ContactsState& c = contacts_;
  c.ended.clear();
  const Column<std::uint64_t>& known = same_pairs_ ? c.records.bits : c.records_before.bits;
  const auto list = [&](bool slept) {
    for (std::size_t r = 0; r < known.size(); ++r) {
      const std::uint32_t shown = c.records_before.shown_of(r);
      if (shown == kNoEntry || has_slept(shown) != slept || c.shown_again[shown] != 0) {
        continue;
      }
      const auto [a, b] = PairOrder{known[r]}.bodies();
      const EndedContact ended{c.known.key(a), c.known.key(b), c.known.data[a], c.known.data[b]};
      if (!c.ended.push_back(ended)) return false;
    }
    return true;
  };
  return list(false) && (last_records_ == last_pairs_ || list(true));
}

// Stores the keys and data of all bodies, unless there are no contacts. If no body was added or
// removed, the stored ones are still valid.
bool Collision::note_bodies() {
  KnownBodies& known = contacts_.known;
  if (contacts_.frame.pairs() == 0 && contacts_.dormant_records.size() == 0) {
    known.clear();
    return true;
  }
  const std::span<const std::uint32_t> stamps = scene_.keys.stamps();
  const std::span<const ClientData> data = scene_.keys.all_client_data();
  if (known.stamp.size() == stamps.size() && known.live == scene_.keys.size() &&
      contacts_.regroupings == scene_.regroupings) {
    return true;
  }
  if (!known.stamp.resize(stamps.size()) || !known.data.resize(data.size())) return false;
  std::ranges::copy(stamps, known.stamp.begin());
  std::ranges::copy(data, known.data.begin());
  known.live = scene_.keys.size();
  return true;
}

}  // namespace winnow
