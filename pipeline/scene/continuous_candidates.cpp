// Candidate pairs of moving bodies. Boxes of the moving bodies' paths are inserted in a partition,
// which finds pairs among them and with the scene's partitions. If paths are long because most
// bodies move in the same direction, pairs among them are found in a frame that moves along.

#include "pipeline/scene/continuous_state.h"

#include <winnow/core/volumes.h>
#include "core/sort/radix_sort.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <numeric>

namespace winnow {
namespace {

/// The moving frame is used only if it shortens paths to less than this share, and by more than
/// kLongPath times the sum of the radii.
constexpr double kShortened = 0.25;
constexpr double kLongPath = 4.0;

/// Filter for pairs of paths, or of paths and bodies at rest.
struct PathPairFilter {
  const ContinuousState& state;
  const ContinuousOptions& options;
  /// Null for pairs among paths.
  const SceneSet* stationary;

  [[nodiscard]] bool is_selected(const PathPiece& way, BodyState other,
                                 bool bullet) const noexcept {
    if (way.body_state != BodyState::dynamic && other != BodyState::dynamic) return false;
    const bool fixed = way.body_state == BodyState::fixed || other == BodyState::fixed;
    return options.pairs == ContinuousPairs::all ||
           (bullet && options.pairs != ContinuousPairs::fixed) ||
           (fixed && options.pairs != ContinuousPairs::bullets);
  }
  [[nodiscard]] bool accept(ObjectId first, ObjectId second) const noexcept {
    const PathPiece way = state.pieces[first];
    if (stationary != nullptr) {
      const std::uint32_t other = stationary->body_of[second];
      return is_selected(way, state.bodies.body_state[other], way.bullet) &&
             state.mover_of[other] == kNoMover &&
             state.bodies.rules.may_pair(state.movers[way.mover], other);
    }
    const PathPiece then = state.pieces[second];
    return is_selected(way, then.body_state, way.bullet || then.bullet) &&
           way.mover != then.mover && way.overlaps(then) &&
           state.bodies.rules.may_pair(state.movers[way.mover], state.movers[then.mover]);
  }
  [[nodiscard]] PairOptions pair_options() const noexcept {
    PairOptions pair_options;
    pair_options.incremental = false;
    pair_options.predicate = {[](void* context, ObjectId first, ObjectId second) {
                                return static_cast<const PathPairFilter*>(context)->accept(first,
                                                                                           second);
                              },
                              const_cast<PathPairFilter*>(this)};
    return pair_options;
  }
};

}  // namespace

Status ContinuousState::take_bodies(std::span<const Key> keys) noexcept {
  std::atomic<bool> valid = true;
  for_movers([&](std::size_t mover) {
    if (!motions[mover].is_valid()) valid.store(false, std::memory_order_relaxed);
  });
  if (!valid) return Status::invalid_pose;
  if (!movers.resize(keys.size()) || !balls.resize(keys.size()) ||
      !mover_of.resize(bodies.shape.size()) || !first.resize(keys.size())) {
    return Status::out_of_memory;
  }
  std::fill(mover_of.begin(), mover_of.end(), kNoMover);
  movers_in = {};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    movers[i] = keys[i].id;
    mover_of[keys[i].id] = static_cast<std::uint32_t>(i);
    ++movers_in[static_cast<std::size_t>(bodies.body_state[keys[i].id])];
  }
  for_movers([&](std::size_t mover) { balls[mover] = ball_of(motions[mover], movers[mover]); });
  return Status::ok;
}

Status ContinuousState::take(std::span<const Key> keys, const PoseView& ends) noexcept {
  const auto motion_to = [&](std::size_t i) {
    const Pose& start = bodies.pose[keys[i].id];
    Pose end = ends[i];
    if (!ends.has_orientations()) end.orientation = start.orientation;
    return RigidMotion::between(start, end);
  };
  if (keys.size() != ends.count) return Status::size_mismatch;
  if (!bodies.stale.are_distinct(bodies.keys, keys)) return Status::invalid_key;
  if (!motions.resize(keys.size())) return Status::out_of_memory;
  for_movers([&](std::size_t mover) { motions[mover] = motion_to(mover); });
  return take_bodies(keys);
}

Status ContinuousState::take(std::span<const Key> keys,
                             std::span<const RigidMotion> given) noexcept {
  if (keys.size() != given.size()) return Status::size_mismatch;
  if (!bodies.stale.are_distinct(bodies.keys, keys)) return Status::invalid_key;
  if (!motions.resize(keys.size())) return Status::out_of_memory;
  std::ranges::copy(given, motions.begin());
  return take_bodies(keys);
}

/// Sets `drift` to the median travel on each axis, or to zero if this does not shorten the paths as
/// much as kShortened and kLongPath require.
bool ContinuousState::choose_drift() noexcept {
  drift.setZero();
  double as_they_are = 0.0;
  double radii = 0.0;
  for (const MovingBall& ball : balls) {
    as_they_are += Eigen::Vector3d::Map(ball.travel).lpNorm<1>();
    radii += ball.radius;
  }
  if (!(as_they_are > kLongPath * radii)) return true;
  const std::size_t count = movers.size();
  if (!along_axis.resize(count)) return false;
  Eigen::Vector3d common;
  double shortened = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < count; ++i) along_axis[i] = balls[i].travel[axis];
    double* const middle = along_axis.data() + count / 2;
    std::nth_element(along_axis.begin(), middle, along_axis.end());
    common[axis] = *middle;
    for (const double way : along_axis) shortened += std::abs(way - common[axis]);
  }
  const bool shortens =
      shortened < kShortened * as_they_are && as_they_are - shortened > kLongPath * radii;
  if (shortens) drift = common;
  return true;
}

/// Computes the number of boxes of each path.
bool ContinuousState::count_pieces() noexcept {
  const std::size_t count = movers.size();
  if (!first_piece.resize(count + 1)) return false;
  const RigidMotion origin = frame();
  for_movers([&](std::size_t mover) {
    const impact::MovingShape moving = path_of(mover);
    first_piece[mover] = impact::RelativeMotionBounds(parts, origin, moving).piece_count();
  });
  first_piece[count] = 0;
  std::exclusive_scan(first_piece.begin(), first_piece.end(), first_piece.begin(), 0U);
  const std::uint32_t total = first_piece[count];
  statistics.boxes += total;
  return boxes.resize(total) && piece_keys.resize(total);
}

void ContinuousState::box_path(std::uint32_t mover) noexcept {
  const RigidMotion origin = frame();
  const impact::MovingShape moving = path_of(mover);
  const impact::RelativeMotionBounds passage(parts, origin, moving);
  const std::uint32_t begin = first_piece[mover];
  const std::uint32_t count = first_piece[mover + 1] - begin;
  for (std::uint32_t i = 0; i < count; ++i) {
    const mid::Box3 box = passage.box(impact::piece_of(i, count));
    const Aabb outward = Aabb::outward(box.min, box.max);
    for (int axis = 0; axis < 3; ++axis) {
      boxes[begin + i].min[axis] = outward.min[axis];
      boxes[begin + i].max[axis] = outward.max[axis];
    }
  }
}

/// Fills `ways` with new boxes.
Status ContinuousState::box_paths(const ContinuousOptions& options) {
  if (!count_pieces()) return Status::out_of_memory;
  for_movers([&](std::size_t mover) { box_path(static_cast<std::uint32_t>(mover)); });
  ways.clear();
  if (boxes.empty()) return Status::ok;
  const PlainBox* const box = boxes.data();
  const BoxView view{{&box->min[0], &box->min[1], &box->min[2]},
                     {&box->max[0], &box->max[1], &box->max[2]},
                     boxes.size(),
                     sizeof(PlainBox)};
  const std::span<Key> keys{piece_keys.data(), boxes.size()};
  if (const Status status = ways.insert(view, {}, keys); status != Status::ok) return status;
  std::size_t objects = 0;
  for (const Key& key : keys) objects = std::max(objects, key.id + std::size_t{1});
  if (!pieces.resize(objects)) return Status::out_of_memory;
  for_movers([&](std::size_t mover) { name_pieces(static_cast<std::uint32_t>(mover), options); });
  return set_filters();
}

void ContinuousState::name_pieces(std::uint32_t mover, const ContinuousOptions& options) noexcept {
  const std::uint32_t begin = first_piece[mover];
  const auto count = static_cast<std::uint8_t>(first_piece[mover + 1] - begin);
  const BodyState body_state = bodies.body_state[movers[mover]];
  const bool bullet = !options.bullets.empty() && options.bullets[mover] != 0;
  for (std::uint8_t i = 0; i < count; ++i) {
    pieces[piece_keys[begin + i].id] = {mover, i, count, body_state, bullet};
  }
}

Status ContinuousState::set_filters() {
  for (std::uint32_t mover = 0; mover < movers.size(); ++mover) {
    const std::uint32_t body = movers[mover];
    const Answer<ObjectFilter> filter =
        bodies.set(bodies.body_state[body]).partition->filter(bodies.place[body]);
    Status status = filter.status;
    for (std::uint32_t i = first_piece[mover];
         status == Status::ok && filter != ObjectFilter{} && i < first_piece[mover + 1]; ++i) {
      status = ways.set_filter(piece_keys[i], filter);
    }
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

/// Appends the pairs that were found; second_body(object) returns the body of a pair's second
/// object.
template <typename Body>
Status ContinuousState::collect(Body&& second_body) {
  const std::size_t before = candidates.size();
  if (!candidates.grow(before + pairs.size())) return Status::out_of_memory;
  candidates.set_size(before + pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::uint32_t a = movers[pieces[pairs[i].first].mover];
    const std::uint32_t b = second_body(pairs[i].second);
    candidates[before + i] = std::uint64_t{std::min(a, b)} << 32U | std::max(a, b);
  }
  return Status::ok;
}

/// Sorts and removes duplicates: a pair is found once for each two overlapping pieces.
bool ContinuousState::sort_candidates() noexcept {
  const std::size_t count = candidates.size();
  if (!spare.resize(count)) return false;
  const auto bits = static_cast<unsigned>(std::bit_width(bodies.shape.size()));
  const Execution& execution = bodies.options.execution;
  std::uint64_t* sorted = candidates.data();
  for (const unsigned digit : {0U, 32U}) {
    std::uint64_t* const other = sorted == candidates.data() ? spare.data() : candidates.data();
    sorted = radix_sort(sorted, other, count, bits, execution, digit);
  }
  const std::uint64_t* const end = std::unique_copy(sorted, sorted + count, candidates.data());
  candidates.set_size(static_cast<std::size_t>(end - candidates.data()));
  return true;
}

Status ContinuousState::find_pairs_among(const ContinuousOptions& options) {
  const PathPairFilter among{*this, options, nullptr};
  const Status status = ways.self_pairs(pairs, among.pair_options());
  if (status != Status::ok) return status;
  return collect([&](ObjectId way) { return movers[pieces[way].mover]; });
}

/// True if pairs of movers with bodies of this set that do not move are to be found.
bool ContinuousState::is_included(BodyState body_state,
                                  const ContinuousOptions& options) const noexcept {
  const SceneSet& set = bodies.set(body_state);
  if (!set.partition.has_value()) return false;
  if (set.partition->size() == movers_in[static_cast<std::size_t>(body_state)]) return false;
  return options.pairs != ContinuousPairs::fixed || body_state == BodyState::fixed ||
         movers_in[static_cast<std::size_t>(BodyState::fixed)] > 0;
}

Status ContinuousState::find_pairs_with(BodyState body_state, const ContinuousOptions& options) {
  const SceneSet& set = bodies.set(body_state);
  const PathPairFilter with{*this, options, &set};
  const Status status = ways.pairs_with(*set.partition, pairs, with.pair_options());
  if (status != Status::ok) return status;
  return collect([&](ObjectId id) { return set.body_of[id]; });
}

Status ContinuousState::find_pairs(const ContinuousOptions& options) {
  candidates.clear();
  statistics = {};
  if (!choose_drift()) return Status::out_of_memory;
  Status status = box_paths(options);
  if (status == Status::ok) status = find_pairs_among(options);
  for (const BodyState body_state : kAllBodyStates) {
    if (!is_included(body_state, options)) continue;
    if (status == Status::ok && !drift.isZero(0.0)) {
      drift.setZero();
      status = box_paths(options);
    }
    if (status == Status::ok) status = find_pairs_with(body_state, options);
  }
  if (status != Status::ok) return status;
  if (!sort_candidates()) return Status::out_of_memory;
  statistics.body_pairs = candidates.size();
  return Status::ok;
}

}  // namespace winnow
