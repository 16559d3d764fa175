// Caching: pairs that have hardly moved since their contacts were computed keep them; points and
// normals rotate with body a. `remember` stores how far each pair may move, `decide` compares.
// Called by Collision::run (collide.cpp) and the tasks in write_contacts.cpp.

#include <winnow/core/rotation.h>
#include "pipeline/narrow/tight_growth.h"
#include "pipeline/scene/collision.h"
#include "pipeline/scene/motion_bound.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

// Relative error of one rotation of a point in float.
constexpr double kTurnError = 4.0e-7;

// Upper bound on the motion of points within `radius` under a rotation.
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
            multiply({to[0], to[1], to[2], to[3]}, {from[0], -from[1], -from[2], -from[3]}))) {}

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

// Finds each pair's record of the last call. With caching this comes before the narrow phase and
// covers all pairs at once.
bool Collision::match_cached() {
  if (!uses_cache_) return true;
  ContactsState& c = contacts_;
  const std::size_t pairs = pair_count();
  same_pairs_ = same_level_ && c.pairs_serial == scene_.pairs.serial() &&
                c.records.size() == pairs && c.cached.size() == pairs;
  if (!resize_tightly(c.origin, pairs)) return false;
  if (same_pairs_) return true;
  if (!resize_tightly(c.old_record, pairs)) return false;
  match(c.records);
  return true;
}

// Decides for every pair where its contacts come from. Returns false if all pairs keep their
// contacts and the last frame can stay as it is.
bool Collision::decide() {
  if (!uses_cache_) return true;
  ContactsState& c = contacts_;
  std::atomic<std::uint32_t> kept{0};
  const bool may_keep = same_level_ && c.cached.size() == c.records.size();
  for_tasks([&](std::size_t, std::uint32_t first, std::uint32_t end) {
    std::uint32_t count = 0;
    for (std::uint32_t i = first; i < end; ++i) {
      const BodyPair pair = scene_.pairs[i];
      const std::uint32_t record = same_pairs_ ? i : c.old_record[i];
      ContactSource origin = origin_of_fresh(pair);
      if (may_keep && record != kNoEntry && is_cacheable(pair) && keep(i, record)) {
        origin = ContactSource::cached;
        ++count;
      }
      c.origin[i] = static_cast<std::uint8_t>(origin);
    }
    kept.fetch_add(count, std::memory_order_relaxed);
  });
  c.cached_count = kept.load();
  if (!same_pairs_ || c.cached_count != pair_count()) return true;
  if (!c.is_settled) {
    std::fill(c.frame.event.begin(), c.frame.event.end(), ContactEvent::persisted);
    c.ended.clear();
    c.is_settled = true;
  }
  return false;
}

// Returns true if a pair has moved so little that it keeps its contacts. Rotates them if their
// total error would exceed the limit otherwise.
bool Collision::keep(std::uint32_t pair, std::uint32_t record) noexcept {
  ContactsState& c = contacts_;
  const BodyPair bodies = scene_.pairs[pair];
  CachedPair& cached = c.cached[record];
  if (cached.limit == CachedPair::kNever) return false;
  const std::uint32_t shown = c.records.shown_of(record);
  const std::uint32_t since = has_slept(shown) ? cached.tested_at : c.clock;
  if (scene_.shaped_at[bodies.a] > since || scene_.shaped_at[bodies.b] > since) return false;
  if (scene_.moved_at[bodies.a] <= since && scene_.moved_at[bodies.b] <= since) return true;
  const Pose& a = scene_.pose[bodies.a];
  const Pose& b = scene_.pose[bodies.b];
  const Pose now = cached.from_b ? relative_pose(b, a) : relative_pose(a, b);
  const double moved = motion_bound(cached.relative, now, static_cast<double>(cached.radius)) +
                       static_cast<double>(cached.drift);
  const auto limit = static_cast<double>(cached.limit);
  if (!(moved <= limit)) return false;
  if (shown == kNoEntry) return true;
  const Pose unit = with_unit_turn(a);
  const double turned =
      turn_bound(cached.turn, unit.orientation, static_cast<double>(cached.radius_a));
  if (moved + turned == 0.0) return true;
  if (!(moved + turned <= limit)) {
    const double drift = static_cast<double>(cached.radius_a) * kTurnError;
    if (!(moved + drift <= limit)) return false;
    cached.drift = round_up(static_cast<double>(cached.drift) + drift);
    turn(cached, shown, unit.orientation);
  }
  if (!cached.widened) {
    cached.widened = true;
    const std::uint32_t end = c.frame.manifold_first[shown + 1];
    for (std::uint32_t m = c.frame.manifold_first[shown]; m < end; ++m) {
      c.frame.error_bound[m] += scene_.options.cache_tolerance;
    }
  }
  return true;
}

// Rotates normals and points with body a.
void Collision::turn(CachedPair& cached, std::uint32_t shown, const double (&to)[4]) noexcept {
  ContactFrame& frame = contacts_.frame;
  const PoseChange turn(to, cached.turn);
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
  std::copy_n(to, 4, cached.turn);
}

float Collision::cache_limit(std::uint32_t pair, std::uint32_t shown) const noexcept {
  const double cache_tolerance = scene_.options.cache_tolerance;
  const double clear = shown == kNoEntry ? std::max(clearance(pair), 0.0) : cache_tolerance;
  return round_down(origin_of(pair) == ContactSource::convex ? clear
                                                             : std::min(clear, cache_tolerance));
}

// Returns a lower bound on the distance beyond the margin of a pair that is not in contact. For
// composite shapes it covers only the primitive pairs that the mid phase found.
double Collision::clearance(std::uint32_t pair) const noexcept {
  const auto of = [&](const NarrowResult& answers, std::size_t at) {
    // At level manifold, a distance beyond the margin may be a lower bound of the true distance.
    // The error bound then applies only upwards, and half of the excess is left for rounding.
    const double beyond = answers.distance()[at] - limit_;
    return std::max(beyond - answers.error_bound()[at],
                    level_ == ContactLevel::manifold ? 0.5 * beyond : 0.0);
  };
  double least = std::numeric_limits<double>::infinity();
  if (origin_of(pair) == ContactSource::convex) {
    least = of(scene_.answers, source_of(pair));
  } else {
    const std::uint32_t* const first = scene_.parts->pairs.first.data() + source_of(pair);
    for (std::uint32_t i = first[0]; i < first[1]; ++i) {
      least = std::min(least, of(scene_.parts->answers, scene_.parts->slot[i]));
    }
  }
  return least;
}

// Stores the data that caching of the pair needs in the next call. The columns must have room.
void Collision::remember(std::uint32_t pair, std::uint32_t shown) noexcept {
  ContactsState& c = contacts_;
  const BodyPair bodies = scene_.pairs[pair];
  c.records.bits[pair] = scene_.pairs.order(pair).bits;
  c.records.shown[pair] = shown;
  if (origin_of(pair) == ContactSource::cached) {
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
  std::copy_n(with_unit_turn(a).orientation, 4, cached.turn);
  cached.radius = round_up(std::min(radius_a, radius_b));
  cached.radius_a = round_up(radius_a);
  cached.limit = is_cacheable(bodies) ? cache_limit(pair, shown) : CachedPair::kNever;
  c.cached[pair] = cached;
}

}  // namespace winnow
