// Warm starts: finds the index of each contact in the last frame. Pairs match by key; points match
// by primitives and features, and the remaining ones by position on either body. Collision
// (collide.cpp) and ContactFrameWriter (contact_frame_writer.cpp) call this.

#include <winnow/core/eigen.h>
#include <winnow/core/pose.h>
#include "core/numbers/rotation.h"
#include "core/sort/parallel_ranges.h"
#include "pipeline/scene/collision.h"

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <numeric>

namespace winnow {
namespace {

constexpr std::size_t kBodiesPerCopy = 4096;
/// A point that has no feature match may have moved by at most this share of the smaller body's
/// radius, measured on the body on which it moved less, to match a point of the last frame.
constexpr double kSamePointFraction = 0.02;
/// If a pair has more unmatched points of the last frame than this, its points are matched by
/// feature only: matching by position is quadratic.
constexpr std::uint32_t kMaxUnmatched = 256;

/// A range of manifolds or points.
struct IndexRange {
  std::uint32_t first;
  std::uint32_t end;

  [[nodiscard]] std::uint32_t size() const noexcept { return end - first; }
};

/// The points of one pair in this frame and in the last one.
class PointMatch {
 public:
  PointMatch(const ContactFrame& now, const ContactFrame& before, ContactHistory& history,
             std::uint32_t pair) noexcept
      : now_(now),
        before_(before),
        history_(history),
        manifolds_(manifolds_of(now, pair)),
        old_manifolds_(manifolds_of(before, history.pair[pair])),
        points_(points_of(now, manifolds_)),
        old_points_(points_of(before, old_manifolds_)) {}

  [[nodiscard]] bool is_done() const noexcept {
    return matched_ == points_.size() || matched_ == old_points_.size();
  }
  [[nodiscard]] std::uint32_t left_over() const noexcept { return old_points_.size() - matched_; }

  // Manifolds have about the same order in every frame, so each search starts after the last match.
  void by_part() noexcept {
    std::uint32_t at = old_manifolds_.first;
    for (std::uint32_t m = manifolds_.first; m < manifolds_.end; ++m) {
      for (std::uint32_t step = 0; step < old_manifolds_.size(); ++step) {
        const std::uint32_t old = at;
        if (++at == old_manifolds_.end) at = old_manifolds_.first;
        if (before_.part_of(0, old) != now_.part_of(0, m) ||
            before_.part_of(1, old) != now_.part_of(1, m)) {
          continue;
        }
        by_feature(points_of(now_, {m, m + 1}), points_of(before_, {old, old + 1}));
        break;
      }
    }
  }

  // Ignores the primitives: features of regions are unique among all primitives of the two bodies.
  void by_feature() noexcept { by_feature(points_, old_points_); }

  // Each point in turn takes the nearest unmatched point of the last frame. The distance is the
  // smaller one of the distances in the frames of the two bodies.
  template <typename Places>
  void by_place(const Places& places, double reach) noexcept {
    for (std::uint32_t p = points_.first; p < points_.end; ++p) {
      if (history_.point[p] != kNoContact) continue;
      double least = reach * reach;
      std::uint32_t nearest = kNoContact;
      for (std::uint32_t old = old_points_.first; old < old_points_.end; ++old) {
        if (history_.taken[old] != 0) continue;
        const double square = places.square_between(position(now_, p), position(before_, old));
        if (square > least || (square == least && nearest != kNoContact)) continue;
        least = square;
        nearest = old;
      }
      if (nearest != kNoContact) take(p, nearest);
    }
  }

 private:
  [[nodiscard]] static IndexRange manifolds_of(const ContactFrame& frame,
                                               std::uint32_t pair) noexcept {
    return {frame.manifold_first[pair], frame.manifold_first[pair + 1]};
  }
  [[nodiscard]] static IndexRange points_of(const ContactFrame& frame,
                                            IndexRange manifolds) noexcept {
    return {frame.point_first[manifolds.first], frame.point_first[manifolds.end]};
  }
  [[nodiscard]] static Eigen::Vector3d position(const ContactFrame& frame,
                                                std::uint32_t p) noexcept {
    const auto& at = frame.points.position;
    return {static_cast<double>(at[0][p]), static_cast<double>(at[1][p]),
            static_cast<double>(at[2][p])};
  }

  void by_feature(IndexRange points, IndexRange old_points) noexcept {
    for (std::uint32_t p = points.first; p < points.end; ++p) {
      if (history_.point[p] != kNoContact) continue;
      for (std::uint32_t old = old_points.first; old < old_points.end; ++old) {
        if (history_.taken[old] != 0 || before_.points.feature[old] != now_.points.feature[p]) {
          continue;
        }
        take(p, old);
        break;
      }
    }
  }

  void take(std::uint32_t point, std::uint32_t old) noexcept {
    history_.point[point] = old;
    history_.taken[old] = 1;
    ++matched_;
  }

  const ContactFrame& now_;
  const ContactFrame& before_;
  ContactHistory& history_;
  const IndexRange manifolds_;
  const IndexRange old_manifolds_;
  const IndexRange points_;
  const IndexRange old_points_;
  std::uint32_t matched_ = 0;
};

/// Poses of two bodies now and in the last frame; measures how far a point has moved on either
/// body. Points are relative to the position of the first body.
class PairPoints {
 public:
  PairPoints(const Pose (&now)[2], const Pose (&before)[2]) noexcept {
    for (std::size_t side = 0; side < 2; ++side) {
      back_[side] = as_eigen(rotation_of(scale_to_unit_max(now[side].orientation))).transpose();
      back_before_[side] =
          as_eigen(rotation_of(scale_to_unit_max(before[side].orientation))).transpose();
      for (int k = 0; k < 3; ++k) {
        from_[side][k] = now[0].position[k] - now[side].position[k];
        from_before_[side][k] = before[0].position[k] - before[side].position[k];
      }
    }
  }

  [[nodiscard]] double square_between(const Eigen::Vector3d& now,
                                      const Eigen::Vector3d& before) const noexcept {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t side = 0; side < 2; ++side) {
      const Eigen::Vector3d moved =
          back_[side] * (now + from_[side]) - back_before_[side] * (before + from_before_[side]);
      least = std::min(least, moved.squaredNorm());
    }
    return least;
  }

 private:
  Eigen::Matrix3d back_[2];
  Eigen::Matrix3d back_before_[2];
  Eigen::Vector3d from_[2];
  Eigen::Vector3d from_before_[2];
};

}  // namespace

void ContactHistory::clear() noexcept {
  pair.clear();
  point.clear();
  pose.clear();
  is_same = false;
}

bool ContactHistory::reserve(std::size_t pairs, std::size_t points, std::size_t bodies,
                             Pages pages) noexcept {
  return pair.reserve(pairs, pages) && point.reserve(points, pages) &&
         taken.reserve(points, pages) && pose.reserve(bodies, pages);
}

bool ContactCache::begin_history() noexcept {
  if (!call_.stores_positions) return true;
  ContactHistory& history = contacts_.history;
  if (!history.taken.resize(contacts_.before.points.size()) ||
      !history.pose.grow(scene_.pose.size())) {
    return false;
  }
  history.is_same = false;
  std::fill(history.taken.begin(), history.taken.end(), std::uint8_t{0});
  return true;
}

bool ContactCache::grow_history() noexcept {
  ContactHistory& history = contacts_.history;
  return !call_.stores_positions || (history.pair.resize(contacts_.frame.pairs()) &&
                                     history.point.resize(contacts_.frame.points.size()));
}

void ContactCache::match_points() noexcept {
  if (!call_.stores_positions) return;
  if (call_.level == ContactLevel::manifold) {
    for_each_range(scene_.options.execution, contacts_.frame.pairs(), CollideCall::kPairsPerTask,
                   [&](std::size_t first, std::size_t end) {
                     for (std::size_t i = first; i < end; ++i) {
                       match_points(static_cast<std::uint32_t>(i));
                     }
                   });
  }
  note_poses();
}

void ContactCache::match_points(std::uint32_t index) noexcept {
  const ContactFrame& frame = contacts_.frame;
  const ContactFrame& before = contacts_.before;
  ContactHistory& history = contacts_.history;
  const std::uint32_t first = frame.point_first[frame.manifold_first[index]];
  const std::uint32_t end = frame.point_first[frame.manifold_first[index + 1]];
  std::fill(history.point.data() + first, history.point.data() + end, kNoContact);
  if (history.pair[index] == kNoContact || before.point_first.empty()) return;
  PointMatch match(frame, before, history, index);
  match.by_part();
  if (call_.reduces && !match.is_done()) match.by_feature();
  if (match.is_done() || match.left_over() > kMaxUnmatched) return;
  const std::uint32_t bodies[2] = {frame.key[0][index].id, frame.key[1][index].id};
  const double reach =
      kSamePointFraction * std::min(scene_.radius(bodies[0]), scene_.radius(bodies[1]));
  match.by_place(PairPoints({scene_.pose[bodies[0]], scene_.pose[bodies[1]]},
                            {history.pose[bodies[0]], history.pose[bodies[1]]}),
                 reach);
}

bool ContactCache::store_positions() noexcept {
  if (!call_.stores_positions) return true;
  ContactHistory& history = contacts_.history;
  if (!history.pose.grow(scene_.pose.size())) return false;
  if (!history.is_same) {
    std::iota(history.pair.begin(), history.pair.end(), 0U);
    std::iota(history.point.begin(), history.point.end(), 0U);
    history.is_same = true;
  }
  note_poses();
  return true;
}

// Stores the poses of bodies that have moved or are new.
void ContactCache::note_poses() noexcept {
  Column<Pose>& known = contacts_.history.pose;
  const std::size_t old = known.size();
  known.set_size(scene_.pose.size());
  for_each_range(scene_.options.execution, known.size(), kBodiesPerCopy,
                 [&](std::size_t first, std::size_t end) {
                   for (std::size_t body = first; body < end; ++body) {
                     if (body >= old || scene_.moved_at[body] > contacts_.clock) {
                       known[body] = scene_.pose[body];
                     }
                   }
                 });
}

}  // namespace winnow
