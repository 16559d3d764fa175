// Records of pairs between calls of Scene::collide: they match the pairs of this call with the last
// frame, store sleeping pairs, and list the pairs that ended. With caching, pairs that have hardly
// moved since their contacts were computed keep them; points and normals rotate with body a.
// `remember` stores how far each pair may move, `decide` compares. Collision (collide.cpp) calls
// this, and the tasks in contact_frame_writer.cpp call `remember`.

#include <winnow/core/pose.h>
#include "core/numbers/rotation.h"
#include "core/sort/parallel_ranges.h"
#include "pipeline/narrow/tight_growth.h"
#include "pipeline/scene/collision.h"
#include "pipeline/scene/motion_bound.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

namespace winnow {
namespace {

constexpr std::size_t kPairsPerListing = 8192;

// Relative error of one rotation of a point in float.
constexpr double kTurnError = 4.0e-7;

// Upper bound on the motion of points within `radius` under a rotation.
[[nodiscard]] double turn_bound(const Quaternion& from, const Quaternion& to,
                                double radius) noexcept {
  Pose a;
  Pose b;
  a.orientation = from;
  b.orientation = to;
  return motion_bound(a, b, radius);
}

struct PoseChange {
  Eigen::Matrix3d m;

  // R(to) R(from)^T for unit quaternions.
  PoseChange(const Quaternion& to, const Quaternion& from) noexcept
      : m(rotation_of_unit(to * from.inverse())) {}

  template <typename T>
  void apply(Column<T> (&column)[3], std::uint32_t i) const noexcept {
    const double v[3] = {static_cast<double>(column[0][i]), static_cast<double>(column[1][i]),
                         static_cast<double>(column[2][i])};
    for (int k = 0; k < 3; ++k) {
      column[k][i] = static_cast<T>(m(k, 0) * v[0] + m(k, 1) * v[1] + m(k, 2) * v[2]);
    }
  }
};

}  // namespace

bool ContactCache::open_records() {
  return list_records() && wake_dormant() && match_cached();
}

// Lists the records of the last frame, which will be overwritten, if they were not kept (see
// PairRecords).
bool ContactCache::list_records() {
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
bool ContactCache::wake_dormant() {
  ContactsState& c = contacts_;
  if (!call_.same_level) {
    c.dormant_records.clear();
    c.dormant_cached.clear();
  }
  const std::size_t count = c.dormant_records.size();
  if (count == 0 || c.regroupings == scene_.regroupings) return true;
  ContactFrame::Cursor at{static_cast<std::uint32_t>(c.frame.pairs()),
                          static_cast<std::uint32_t>(c.frame.manifolds),
                          static_cast<std::uint32_t>(c.frame.points.size())};
  if (!c.frame.resize(call_.level, at.pair + count, at.manifold + c.dormant.manifolds,
                      at.point + c.dormant.points.size()) ||
      !c.records_before.reserve(c.records.size() + count) ||
      (call_.uses_cache && !c.cached_before.resize(c.records.size() + count))) {
    return false;
  }
  for (std::uint32_t& index : c.dormant_records.frame_index) {
    c.frame.copy(c.dormant, index, 1, at);
    const ContactFrame::Cursor taken = c.dormant.extent(index);
    index = at.pair;
    at += taken;
  }
  c.frame.close(call_.level, at);
  last_records_ = at.pair;
  merge_dormant();
  return true;
}

// Merges two sorted lists. The columns must have room.
void ContactCache::merge_dormant() noexcept {
  ContactsState& c = contacts_;
  const PairRecords& slept = c.dormant_records;
  c.records_before.clear();
  std::size_t one = 0;
  std::size_t other = 0;
  for (std::size_t i = 0; i < c.records.size() + slept.size(); ++i) {
    const bool first = other == slept.size() ||
                       (one < c.records.size() && c.records.bits[one] < slept.bits[other]);
    if (call_.uses_cache) c.cached_before[i] = first ? c.cached[one] : c.dormant_cached[other];
    const PairRecords& from = first ? c.records : slept;
    const std::size_t at = first ? one++ : other++;
    c.records_before.push_back_within_room(from.order_of(at), from.frame_index_of(at));
  }
  c.records.swap(c.records_before);
  c.cached.swap(c.cached_before);
  c.dormant_records.clear();
  c.dormant_cached.clear();
}

// Finds the record of each pair of the batch; both lists are sorted alike. The column must have
// room.
void ContactCache::match(const PairRecords& records) noexcept {
  const std::uint64_t* const begin = records.bits.begin();
  const std::uint64_t* const none = records.bits.end();
  call_.for_tasks([&](std::size_t, std::uint32_t first, std::uint32_t end) {
    const std::uint64_t* record = std::lower_bound(begin, none, scene_.pairs.order(first).bits);
    for (std::uint32_t i = first; i < end; ++i) {
      const std::uint64_t order = scene_.pairs.order(i).bits;
      while (record != none && *record < order) ++record;
      const bool found = record != none && *record == order;
      contacts_.old_record[i - call_.known_from] =
          found ? static_cast<std::uint32_t>(record++ - begin) : kNoEntry;
    }
  });
}

// Finds each pair's record of the last call. With caching this comes before the narrow phase and
// covers all pairs at once.
bool ContactCache::match_cached() {
  if (!call_.uses_cache) return true;
  ContactsState& c = contacts_;
  const std::size_t pairs = call_.pair_count();
  same_pairs_ = call_.same_level && c.pairs_serial == scene_.pairs.serial() &&
                c.records.size() == pairs && c.cached.size() == pairs;
  if (!resize_tightly(c.source, pairs)) return false;
  if (same_pairs_) return true;
  if (!resize_tightly(c.old_record, pairs)) return false;
  match(c.records);
  return true;
}

bool ContactCache::decide() {
  if (!call_.uses_cache) return true;
  ContactsState& c = contacts_;
  std::atomic<std::uint32_t> kept{0};
  const bool may_keep = call_.same_level && c.cached.size() == c.records.size();
  call_.for_tasks([&](std::size_t, std::uint32_t first, std::uint32_t end) {
    std::uint32_t count = 0;
    for (std::uint32_t i = first; i < end; ++i) {
      const BodyPair pair = scene_.pairs[i];
      const std::uint32_t record = same_pairs_ ? i : c.old_record[i];
      ContactSource source = call_.source_of_fresh(pair);
      if (may_keep && record != kNoEntry && call_.is_cacheable(pair) && keep(i, record)) {
        source = ContactSource::cached;
        ++count;
      }
      c.source[i] = static_cast<std::uint8_t>(source);
    }
    kept.fetch_add(count, std::memory_order_relaxed);
  });
  c.cached_count = kept.load();
  if (!same_pairs_ || c.cached_count != call_.pair_count()) return true;
  if (!c.is_settled) {
    std::fill(c.frame.event.begin(), c.frame.event.end(), ContactEvent::persisted);
    c.ended.clear();
    c.is_settled = true;
  }
  return false;
}

// Returns true if a pair has moved so little that it keeps its contacts. Rotates them if their
// total error would exceed the limit otherwise.
bool ContactCache::keep(std::uint32_t pair, std::uint32_t record) noexcept {
  ContactsState& c = contacts_;
  const BodyPair bodies = scene_.pairs[pair];
  CachedPair& cached = c.cached[record];
  if (cached.limit == CachedPair::kNever) return false;
  const std::uint32_t index = c.records.frame_index_of(record);
  const std::uint32_t since = has_slept(index) ? cached.tested_at : c.clock;
  if (scene_.shaped_at[bodies.a] > since || scene_.shaped_at[bodies.b] > since) return false;
  if (scene_.moved_at[bodies.a] <= since && scene_.moved_at[bodies.b] <= since) return true;
  const Pose& a = scene_.pose[bodies.a];
  const Pose& b = scene_.pose[bodies.b];
  const Pose now = cached.from_b ? relative_pose(b, a) : relative_pose(a, b);
  const double moved = motion_bound(cached.relative, now, static_cast<double>(cached.radius)) +
                       static_cast<double>(cached.drift);
  const auto limit = static_cast<double>(cached.limit);
  if (!(moved <= limit)) return false;
  if (index == kNoEntry) return true;
  const Pose unit = with_unit_turn(a);
  const double turned =
      turn_bound(cached.turned_for, unit.orientation, static_cast<double>(cached.radius_a));
  if (moved + turned == 0.0) return true;
  if (!(moved + turned <= limit)) {
    const double drift = static_cast<double>(cached.radius_a) * kTurnError;
    if (!(moved + drift <= limit)) return false;
    cached.drift = round_up(static_cast<double>(cached.drift) + drift);
    turn(cached, index, unit.orientation);
  }
  if (!cached.widened) {
    cached.widened = true;
    const std::uint32_t end = c.frame.manifold_first[index + 1];
    for (std::uint32_t m = c.frame.manifold_first[index]; m < end; ++m) {
      c.frame.error_bound[m] += scene_.options.cache_tolerance;
    }
  }
  return true;
}

// Rotates normals and points with body a.
void ContactCache::turn(CachedPair& cached, std::uint32_t index, const Quaternion& to) noexcept {
  ContactFrame& frame = contacts_.frame;
  const PoseChange turn(to, cached.turned_for);
  const std::uint32_t first = frame.manifold_first[index];
  const std::uint32_t end = frame.manifold_first[index + 1];
  for (std::uint32_t m = first; m < end; ++m) {
    turn.apply(frame.normal, m);
    if (call_.level == ContactLevel::distance) turn.apply(frame.point, m);
  }
  if (call_.level == ContactLevel::manifold) {
    for (std::uint32_t p = frame.point_first[first]; p < frame.point_first[end]; ++p) {
      turn.apply(frame.points.position, p);
    }
  }
  cached.turned_for = to;
}

// A composite pair may move by no more than the tolerance, because the mid phase lists only pairs
// of primitives within the tolerance beyond the margin (Collision::collide_composite).
float ContactCache::cache_limit(std::uint32_t pair, std::uint32_t index) const noexcept {
  const double cache_tolerance = scene_.options.cache_tolerance;
  const double clear = index == kNoEntry ? std::max(clearance(pair), 0.0) : cache_tolerance;
  return round_down(
      call_.source_of(pair) == ContactSource::convex ? clear : std::min(clear, cache_tolerance));
}

// Returns a lower bound on the distance beyond the margin of a pair that is not in contact. For
// composite shapes it covers only the primitive pairs that the mid phase found.
double ContactCache::clearance(std::uint32_t pair) const noexcept {
  const auto of = [&](const NarrowResult& answers, std::size_t at) {
    // At level manifold, a distance beyond the margin may be a lower bound of the true distance.
    // The error bound then applies only upwards, and half of the excess is left for rounding.
    const double beyond = answers.distance()[at] - call_.limit;
    return std::max(beyond - answers.error_bound()[at],
                    call_.level == ContactLevel::manifold ? 0.5 * beyond : 0.0);
  };
  double least = std::numeric_limits<double>::infinity();
  if (call_.source_of(pair) == ContactSource::convex) {
    least = of(scene_.batch.answers, call_.input_of(pair));
  } else {
    const std::uint32_t* const first =
        scene_.batch.parts->pairs.first.data() + call_.input_of(pair);
    for (std::uint32_t i = first[0]; i < first[1]; ++i) {
      least = std::min(least, of(scene_.batch.parts->answers, scene_.batch.parts->slot[i]));
    }
  }
  return least;
}

void ContactCache::remember(std::uint32_t pair, std::uint32_t index) noexcept {
  ContactsState& c = contacts_;
  const BodyPair bodies = scene_.pairs[pair];
  c.records.bits[pair] = scene_.pairs.order(pair).bits;
  c.records.frame_index[pair] = index;
  if (call_.source_of(pair) == ContactSource::cached) {
    if (!same_pairs_) c.cached[pair] = c.cached_before[c.old_record[pair]];
    return;
  }
  CachedPair cached{};
  const Pose& a = scene_.pose[bodies.a];
  const Pose& b = scene_.pose[bodies.b];
  const double radius_a = scene_.radius(bodies.a);
  const double radius_b = scene_.radius(bodies.b);
  cached.from_b = radius_a <= radius_b;
  cached.relative = cached.from_b ? relative_pose(b, a) : relative_pose(a, b);
  cached.turned_for = with_unit_turn(a).orientation;
  cached.radius = round_up(std::min(radius_a, radius_b));
  cached.radius_a = round_up(radius_a);
  cached.limit = call_.is_cacheable(bodies) ? cache_limit(pair, index) : CachedPair::kNever;
  c.cached[pair] = cached;
}

bool ContactCache::open_frame() {
  ContactsState& c = contacts_;
  if (same_pairs_) {
    // Records stay in place except for their frame indices: tasks read old indices of some pairs
    // after they wrote new ones of others.
    c.records.frame_index.swap(c.records_before.frame_index);
  } else {
    c.records.swap(c.records_before);
    c.cached.swap(c.cached_before);
  }
  const std::size_t records = call_.uses_cache ? call_.pair_count() : 0;
  if (!resize_tightly(c.records.bits, records) || !resize_tightly(c.records.frame_index, records) ||
      !c.cached.resize(records) || !resize_tightly(c.is_in_new_frame, last_records_)) {
    return false;
  }
  std::fill(c.is_in_new_frame.begin(), c.is_in_new_frame.end(), std::uint8_t{0});
  return begin_history();
}

bool ContactCache::match_batch() {
  if (call_.uses_cache) return true;
  call_.known_from = call_.batch_first;
  if (!call_.resize_for_batch(contacts_.old_record)) return false;
  match(contacts_.records_before);
  return true;
}

bool ContactCache::close_frame() {
  ContactsState& c = contacts_;
  // The next call swaps the records and may find as many pairs, and it flags this frame's points.
  if (!c.records_before.reserve(c.records.bits.capacity()) ||
      !c.cached_before.reserve(c.cached.capacity()) ||
      (call_.stores_positions && !c.history.taken.reserve(c.frame.points.size()))) {
    return false;
  }
  // A body falls asleep by changing its partition, which makes find_pairs run again.
  const bool may_sleep = call_.same_level && !same_pairs_ && c.regroupings != scene_.regroupings;
  if ((may_sleep && !put_to_sleep()) || !list_ended()) return false;
  c.is_settled =
      c.ended.empty() && std::all_of(c.frame.event.begin(), c.frame.event.end(),
                                     [](ContactEvent e) { return e == ContactEvent::persisted; });
  if (!call_.uses_cache) {
    // The next call lists them again, in the same memory.
    c.records.swap(c.records_before);
    c.records.clear();
  }
  return true;
}

// True if both bodies still exist and neither is dynamic any more, so that the pair is no longer
// tested.
bool ContactCache::sleeps(const BodyPair& pair) const noexcept {
  for (const std::uint32_t body : {pair.a, pair.b}) {
    if (!scene_.keys.is_valid(contacts_.known.key(body)) ||
        scene_.body_state[body] == BodyState::dynamic) {
      return false;
    }
  }
  return true;
}

bool ContactCache::put_to_sleep() {
  ContactsState& c = contacts_;
  PairRecords& slept = c.dormant_records;
  if (!slept.reserve(last_records_) ||
      (call_.uses_cache && !c.dormant_cached.reserve(last_records_))) {
    return false;
  }
  ContactFrame::Cursor room;
  for (std::size_t r = 0; r < c.records_before.size(); ++r) {
    const PairOrder order = c.records_before.order_of(r);
    const std::uint32_t index = c.records_before.frame_index_of(r);
    if (index == kNoEntry || c.is_in_new_frame[index] != 0 || !sleeps(order.bodies())) continue;
    c.is_in_new_frame[index] = 1;
    room += c.before.extent(index);
    slept.push_back_within_room(order, index);
    if (!call_.uses_cache) continue;
    CachedPair& cached = c.cached_before[r];
    if (!has_slept(index)) cached.tested_at = c.clock;
    (void)c.dormant_cached.push_back(cached);
  }
  if (room.pair == 0) return true;
  c.dormant.with_parts = c.frame.with_parts;
  if (!c.dormant.resize(call_.level, room.pair, room.manifold, room.point)) return false;
  ContactFrame::Cursor at;
  for (std::size_t i = 0; i < slept.size(); ++i) {
    const BodyPair bodies = slept.order_of(i).bodies();
    const std::uint32_t ids[2] = {bodies.a, bodies.b};
    for (int side = 0; side < 2; ++side) c.dormant.key[side][at.pair] = c.known.key(ids[side]);
    c.dormant.event[at.pair] = ContactEvent::persisted;
    const std::uint32_t index = std::exchange(slept.frame_index[i], at.pair);
    c.dormant.copy(c.before, index, 1, at);
    at += c.before.extent(index);
  }
  c.dormant.close(call_.level, at);
  return true;
}

// Lists ended pairs in the order of the last frame; pairs that slept follow, although the records
// of both are sorted together.
bool ContactCache::list_ended() {
  ContactsState& c = contacts_;
  c.ended.clear();
  const Column<std::uint64_t>& known = same_pairs_ ? c.records.bits : c.records_before.bits;
  const auto list = [&](bool slept) {
    for (std::size_t r = 0; r < known.size(); ++r) {
      const std::uint32_t index = c.records_before.frame_index_of(r);
      if (index == kNoEntry || has_slept(index) != slept || c.is_in_new_frame[index] != 0) {
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

// Stores nothing if there are no contacts. If no body was added or removed, the stored keys and
// data are still valid.
bool ContactCache::note_bodies() {
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
