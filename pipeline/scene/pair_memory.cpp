// What is known of a scene's pairs from the last call: matched with the pairs of this one, kept
// where they have hardly moved, told where they have ended.

#include <winnow/core/rotation.h>
#include "core/sort/stretches.h"
#include "pipeline/narrow/steady_column.h"
#include "pipeline/scene/collision.h"
#include "pipeline/scene/motion_bound.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

namespace winnow {
namespace {

constexpr std::size_t kPairsPerListing = 8192;

// Relative error of turning a point in float, once.
constexpr double kTurnError = 4.0e-7;

// How far points of a body of this radius move when it turns.
[[nodiscard]] double turn_bound(const double (&from)[4], const double (&to)[4],
                                double radius) noexcept {
  Pose a;
  Pose b;
  std::copy_n(from, 4, a.orientation);
  std::copy_n(to, 4, b.orientation);
  return motion_bound(a, b, radius);
}

struct PoseChange {
  Eigen::Matrix3d m;

  // R(to) R(from)^T for unit quaternions.
  PoseChange(const double (&to)[4], const double (&from)[4]) noexcept
      : m(rotation_of_unit(
            product({to[0], to[1], to[2], to[3]}, {from[0], -from[1], -from[2], -from[3]}))) {}

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

// Of a frame whose records are not kept.
bool Collision::list_records() {
  ContactsState& c = contacts_;
  known_last_ = shown_last_ = static_cast<std::uint32_t>(c.frame.pairs());
  if (shown_last_ == 0 || c.records.size() != 0) return true;
  if (!resize_steadily(c.records.bits, shown_last_)) return false;
  for (const ContactRun& run : c.frame.runs) {
    const std::uint32_t code = KindPairs::index(run.kind_a, run.kind_b);
    for_stretches(scene_.options.execution, run.count, kPairsPerListing,
                  [&](std::size_t first, std::size_t end) {
                    for (std::size_t i = run.first + first; i < run.first + end; ++i) {
                      const BodyPair bodies{c.frame.key[0][i].id, c.frame.key[1][i].id};
                      c.records.bits[i] = PairOrder::of(code, bodies).bits;
                    }
                  });
  }
  return true;
}

// Pairs of bodies that slept are put back among those of the last frame, when bodies may have
// woken.
bool Collision::wake_dormant() {
  ContactsState& c = contacts_;
  if (!same_level_) {
    c.dormant_records.clear();
    c.dormant_carried.clear();
  }
  const std::size_t count = c.dormant_records.size();
  if (count == 0 || c.regroupings == scene_.regroupings) return true;
  Place at{static_cast<std::uint32_t>(c.frame.pairs()),
           static_cast<std::uint32_t>(c.frame.manifolds),
           static_cast<std::uint32_t>(c.frame.points.size())};
  if (!c.frame.resize(level_, at.pair + count, at.manifold + c.dormant.manifolds,
                      at.point + c.dormant.points.size()) ||
      !c.records_before.reserve(c.records.size() + count) ||
      (carries_ && !c.carried_before.resize(c.records.size() + count))) {
    return false;
  }
  for (std::uint32_t& shown : c.dormant_records.shown) {
    c.frame.copy(c.dormant, shown, 1, at);
    const Place taken = c.dormant.extent(shown);
    shown = at.pair;
    at += taken;
  }
  c.frame.close(level_, at);
  known_last_ = at.pair;
  merge_dormant();
  return true;
}

// Both in the order of pairs. Room was made.
void Collision::merge_dormant() noexcept {
  ContactsState& c = contacts_;
  const PairRecords& slept = c.dormant_records;
  c.records_before.clear();
  std::size_t one = 0;
  std::size_t other = 0;
  for (std::size_t i = 0; i < c.records.size() + slept.size(); ++i) {
    const bool first = other == slept.size() ||
                       (one < c.records.size() && c.records.bits[one] < slept.bits[other]);
    if (carries_) c.carried_before[i] = first ? c.carried[one] : c.dormant_carried[other];
    const PairRecords& from = first ? c.records : slept;
    const std::size_t at = first ? one++ : other++;
    c.records_before.push_back_within_room(from.order_of(at), from.shown_of(at));
  }
  c.records.swap(c.records_before);
  c.carried.swap(c.carried_before);
  c.dormant_records.clear();
  c.dormant_carried.clear();
}

// Which record each pair of the batch had. Both are sorted alike. Room was made.
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

// What may be carried over is matched before anything is answered.
bool Collision::match_carried() {
  if (!carries_) return true;
  ContactsState& c = contacts_;
  const std::size_t pairs = pair_count();
  same_pairs_ = same_level_ && c.pairs_serial == scene_.pairs.serial() &&
                c.records.size() == pairs && c.carried.size() == pairs;
  if (!resize_steadily(c.origin, pairs)) return false;
  if (same_pairs_) return true;
  if (!resize_steadily(c.old_record, pairs)) return false;
  match(c.records);
  return true;
}

// Says of every pair where its contacts come from. False if the last frame can stay as it is.
bool Collision::decide() {
  if (!carries_) return true;
  ContactsState& c = contacts_;
  std::atomic<std::uint32_t> kept{0};
  const bool may_keep = same_level_ && c.carried.size() == c.records.size();
  for_tasks([&](std::size_t, std::uint32_t first, std::uint32_t end) {
    std::uint32_t count = 0;
    for (std::uint32_t i = first; i < end; ++i) {
      const BodyPair pair = scene_.pairs[i];
      const std::uint32_t record = same_pairs_ ? i : c.old_record[i];
      Origin origin = origin_of_fresh(pair);
      if (may_keep && record != kNoEntry && is_carried_over(pair) && keep(i, record)) {
        origin = Origin::carried;
        ++count;
      }
      c.origin[i] = static_cast<std::uint8_t>(origin);
    }
    kept.fetch_add(count, std::memory_order_relaxed);
  });
  c.carried_count = kept.load();
  if (!same_pairs_ || c.carried_count != pair_count()) return true;
  if (!c.is_settled) {
    std::fill(c.frame.event.begin(), c.frame.event.end(), ContactEvent::persisted);
    c.ended.clear();
    c.is_settled = true;
  }
  return false;
}

// True if a pair has moved so little that its contacts stay, and turns them if it must.
bool Collision::keep(std::uint32_t pair, std::uint32_t record) noexcept {
  ContactsState& c = contacts_;
  const BodyPair bodies = scene_.pairs[pair];
  const std::uint32_t since = c.clock;
  if (scene_.shaped_at[bodies.a] > since || scene_.shaped_at[bodies.b] > since) return false;
  if (scene_.moved_at[bodies.a] <= since && scene_.moved_at[bodies.b] <= since) return true;
  CarriedPair& carried = c.carried[record];
  const std::uint32_t shown = c.records.shown_of(record);
  const Pose& a = scene_.pose[bodies.a];
  const Pose& b = scene_.pose[bodies.b];
  const Pose now = carried.from_b ? relative_pose(b, a) : relative_pose(a, b);
  const double moved = motion_bound(carried.relative, now, static_cast<double>(carried.radius)) +
                       static_cast<double>(carried.drift);
  if (!(moved <= carried.limit)) return false;
  if (shown == kNoEntry) return true;
  const Pose unit = with_unit_turn(a);
  const double turned =
      turn_bound(carried.turn, unit.orientation, static_cast<double>(carried.radius_a));
  if (moved + turned == 0.0) return true;
  if (!(moved + turned <= carried.limit)) {
    const double drift = static_cast<double>(carried.radius_a) * kTurnError;
    if (!(moved + drift <= carried.limit)) return false;
    carried.drift = round_up(static_cast<double>(carried.drift) + drift);
    turn(carried, shown, unit.orientation);
  }
  if (!carried.widened) {
    carried.widened = true;
    const std::uint32_t end = c.frame.manifold_first[shown + 1];
    for (std::uint32_t m = c.frame.manifold_first[shown]; m < end; ++m) {
      c.frame.error_bound[m] += scene_.options.carry_over;
    }
  }
  return true;
}

// Normals and points follow body a.
void Collision::turn(CarriedPair& carried, std::uint32_t shown, const double (&to)[4]) noexcept {
  ContactFrame& frame = contacts_.frame;
  const PoseChange turn(to, carried.turn);
  const std::uint32_t first = frame.manifold_first[shown];
  const std::uint32_t end = frame.manifold_first[shown + 1];
  for (std::uint32_t m = first; m < end; ++m) {
    turn.apply(frame.normal, m);
    if (level_ == ContactLevel::distance) turn.apply(frame.point, m);
  }
  if (level_ == ContactLevel::manifold) {
    for (std::uint32_t p = frame.point_first[first]; p < frame.point_first[end]; ++p) {
      turn.apply(frame.points.position, p);
    }
  }
  std::copy_n(to, 4, carried.turn);
}

// How much farther than the margin a pair that does not touch is at least; of composite shapes that
// of what the mid phase found near.
double Collision::clearance(std::uint32_t pair) const noexcept {
  const auto of = [&](const NarrowResult& answers, std::size_t at) {
    // At level manifold the distance of what is farther than the margin may be a lower bound
    // already, its error on the other side; half of it is one where the error is a rounding's.
    const double beyond = answers.distance()[at] - limit_;
    return std::max(beyond - answers.error_bound()[at],
                    level_ == ContactLevel::manifold ? 0.5 * beyond : 0.0);
  };
  double least = std::numeric_limits<double>::infinity();
  if (origin_of(pair) == Origin::convex) {
    least = of(scene_.answers, source_of(pair));
  } else {
    const std::uint32_t* const first = scene_.parts->pairs.first.data() + source_of(pair);
    for (std::uint32_t i = first[0]; i < first[1]; ++i) {
      least = std::min(least, of(scene_.parts->answers, scene_.parts->slot[i]));
    }
  }
  return least;
}

// Notes what a pair was found to be, to be carried over. Room was made.
void Collision::remember(std::uint32_t pair, std::uint32_t shown) noexcept {
  ContactsState& c = contacts_;
  const BodyPair bodies = scene_.pairs[pair];
  c.records.bits[pair] = scene_.pairs.order(pair).bits;
  c.records.shown[pair] = shown;
  if (origin_of(pair) == Origin::carried) {
    if (!same_pairs_) c.carried[pair] = c.carried_before[c.old_record[pair]];
    return;
  }
  CarriedPair carried{};
  const Pose& a = scene_.pose[bodies.a];
  const Pose& b = scene_.pose[bodies.b];
  const double radius_a = scene_.radius(bodies.a);
  const double radius_b = scene_.radius(bodies.b);
  carried.from_b = radius_a <= radius_b;
  carried.relative = carried.from_b ? relative_pose(b, a) : relative_pose(a, b);
  std::copy_n(with_unit_turn(a).orientation, 4, carried.turn);
  carried.radius = round_up(std::min(radius_a, radius_b));
  carried.radius_a = round_up(radius_a);
  const double carry_over = scene_.options.carry_over;
  const double clear = shown == kNoEntry ? clearance(pair) : carry_over;
  carried.limit = origin_of(pair) == Origin::convex ? clear : std::min(clear, carry_over);
  c.carried[pair] = carried;
}

// A pair that is not looked at because neither body is dynamic any more.
bool Collision::sleeps(const BodyPair& pair) const noexcept {
  for (const std::uint32_t body : {pair.a, pair.b}) {
    if (!scene_.keys.is_valid(contacts_.known.key(body)) ||
        scene_.motion[body] == Motion::dynamic) {
      return false;
    }
  }
  return true;
}

// Pairs of the last frame that are not in this one have ended, or sleep.
bool Collision::close_frame() {
  ContactsState& c = contacts_;
  // Bodies fall asleep by changing their partition, so that pairs are found anew.
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
  if (!slept.reserve(known_last_) || (carries_ && !c.dormant_carried.reserve(known_last_))) {
    return false;
  }
  Place room;
  for (std::size_t r = 0; r < c.records_before.size(); ++r) {
    const PairOrder order = c.records_before.order_of(r);
    const std::uint32_t shown = c.records_before.shown_of(r);
    if (shown == kNoEntry || c.shown_again[shown] != 0 || !sleeps(order.bodies())) continue;
    c.shown_again[shown] = 1;
    room += c.before.extent(shown);
    slept.push_back_within_room(order, shown);
    if (carries_) (void)c.dormant_carried.push_back(c.carried_before[r]);
  }
  if (room.pair == 0) return true;
  c.dormant.with_parts = c.frame.with_parts;
  if (!c.dormant.resize(level_, room.pair, room.manifold, room.point)) return false;
  Place at;
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

// In the order in which they were shown, those that slept last.
bool Collision::list_ended() {
  ContactsState& c = contacts_;
  c.ended.clear();
  const PairRecords& known = same_pairs_ ? c.records : c.records_before;
  const auto list = [&](bool slept) {
    for (std::size_t r = 0; r < known.size(); ++r) {
      const std::uint32_t shown = known.shown_of(r);
      if (shown == kNoEntry || (shown >= shown_last_) != slept || c.shown_again[shown] != 0) {
        continue;
      }
      const auto [a, b] = known.order_of(r).bodies();
      const EndedContact ended{c.known.key(a), c.known.key(b), c.known.data[a], c.known.data[b]};
      if (!c.ended.push_back(ended)) return false;
    }
    return true;
  };
  return list(false) && (known_last_ == shown_last_ || list(true));
}

// Who the bodies are, where any touch; which has changed only if some came or went.
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
