// SceneQueries: two bodies, or two sets of bodies: how far they are apart, and which overlap.

#include "core/threads/float_environment.h"
#include "pipeline/scene/queries/box_gaps.kernel.h"
#include "pipeline/scene/queries/queries.h"
#include "pipeline/scene/queries/two_shapes.h"

#include <cmath>
#include <limits>

namespace winnow {

WINNOW_DEFINE_KERNELS(BoxGapsKernels, box_gaps_kernels)

namespace {

/// Squared gaps between boxes are sums of three squares of differences of floats, all rounded; and
/// the solver's distance to what lies on the border of a box is.
constexpr double kSquareSlack = 1e-5;

/// The boxes of a set of bodies, and how far others are from them. Those that the partitions hold
/// serve: they contain the bodies.
class SetBoxes {
 public:
  explicit SetBoxes(QueryState& state) noexcept : state_(state) {}

  /// False if there is no room.
  [[nodiscard]] bool take(std::span<const Key> keys) noexcept {
    constexpr std::size_t kLanes = 16;
    count_ = keys.size();
    const std::size_t whole = (count_ + kLanes - 1) / kLanes * kLanes;
    if (!state_.bounds.resize(6 * whole) || !state_.gaps.resize(whole)) return false;
    float* column[6];
    for (std::size_t k = 0; k < 6; ++k) {
      column[k] = state_.bounds.data() + k * whole;
      bounds_[k] = column[k];
      std::fill(column[k] + count_, column[k] + whole, 0.0F);
    }
    for (std::size_t i = 0; i < count_; ++i) {
      const Aabb box = box_of(keys[i]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        column[axis][i] = box.min[axis];
        column[3 + axis][i] = box.max[axis];
      }
    }
    return true;
  }
  /// The square of how far each of the set is from a body, or less.
  [[nodiscard]] std::span<const float> squared_gaps(Key from) noexcept {
    const Aabb box = box_of(from);
    const float low[3] = {box.min[0], box.min[1], box.min[2]};
    const float high[3] = {box.max[0], box.max[1], box.max[2]};
    box_gaps_kernels().squared(bounds_, count_, low, high, state_.gaps.data());
    return {state_.gaps.data(), count_};
  }

 private:
  [[nodiscard]] Aabb box_of(Key key) const noexcept {
    const SceneState& scene = state_.scene;
    Aabb box;
    const SceneSet& set = scene.set(scene.motion[key.id]);
    (void)set.partition->bounds(scene.place[key.id], box);
    return box;
  }

  QueryState& state_;
  const float* bounds_[6] = {};
  std::size_t count_ = 0;
};

/// Pairs of bodies of two sets, without those of a body and itself.
class SetPairs {
 public:
  SetPairs(QueryState& state, std::span<const Key> a, std::span<const Key> b) noexcept
      : a_(a), b_(b), boxes_(state) {}

  [[nodiscard]] bool find_boxes() noexcept { return boxes_.take(b_); }

  /// The pair whose boxes are the nearest, if they are no farther apart than `most`.
  [[nodiscard]] KeyPair nearest(double most) noexcept {
    KeyPair found;
    double least = square_of(most);
    for (const Key a : a_) {
      const std::span<const float> gaps = boxes_.squared_gaps(a);
      for (std::size_t i = 0; i < gaps.size(); ++i) {
        const auto gap = static_cast<double>(gaps[i]);
        if (!(gap < least || (gap == least && found.first == Key{})) || a == b_[i]) continue;
        least = gap;
        found = {a, b_[i]};
      }
    }
    return found;
  }

  /// Calls look(body of a, body of b) for pairs whose boxes are no farther apart than most(), which
  /// may shrink meanwhile, until it says false.
  template <typename Most, typename Look>
  void each_within(Most&& most, Look&& look) {
    double least = square_of(most());
    for (const Key a : a_) {
      const std::span<const float> gaps = boxes_.squared_gaps(a);
      for (std::size_t i = 0; i < gaps.size(); ++i) {
        if (!(static_cast<double>(gaps[i]) <= least) || a == b_[i]) continue;
        if (!look(a, b_[i])) return;
        least = square_of(most());
      }
    }
  }

 private:
  [[nodiscard]] static double square_of(double gap) noexcept {
    return gap * gap * (1.0 + kSquareSlack);
  }

  std::span<const Key> a_;
  std::span<const Key> b_;
  SetBoxes boxes_;
};

/// The closest pair of two sets. First looked at is the pair whose boxes are the nearest: hardly
/// any other has boxes that are nearer than these two bodies are.
class ClosestBodies {
 public:
  ClosestBodies(QueryState& state, double limit) noexcept : state_(state), limit_(limit) {}

  [[nodiscard]] SetDistance find(SetPairs& pairs) {
    const KeyPair nearest = pairs.nearest(reach());
    if (nearest.first == Key{}) return best_;
    look(nearest.first, nearest.second);
    pairs.each_within([&] { return reach(); },
                      [&](Key a, Key b) {
                        look(a, b);
                        return true;
                      });
    return best_;
  }

 private:
  /// Overlapping bodies may be deeper than others.
  [[nodiscard]] double reach() const noexcept { return std::max(limit_, 0.0); }

  /// Of pairs that are equally far apart the first in the order of ids is kept.
  void look(Key a, Key b) noexcept {
    SceneDistance found;
    ClosestParts parts(state_.parts);
    if (!parts.find(state_.placed(a.id), state_.placed(b.id), limit_, found)) return;
    const std::pair ids(a.id, b.id);
    if (best_ && found.distance == limit_ && std::pair(best_.a.id, best_.to.key.id) <= ids) return;
    found.key = b;
    found.data = state_.scene.keys.client_data(b.id);
    best_ = {a, state_.scene.keys.client_data(a.id), found};
    limit_ = found.distance;
  }

  QueryState& state_;
  double limit_;
  SetDistance best_;
};

[[nodiscard]] Status check_sets(const QueryState* state, std::span<const Key> a,
                                std::span<const Key> b) noexcept {
  if (const Status status = QueryState::may_ask(state); status != Status::ok) return status;
  const auto is_there = [&](Key key) { return state->scene.keys.is_valid(key); };
  const bool all =
      std::all_of(a.begin(), a.end(), is_there) && std::all_of(b.begin(), b.end(), is_there);
  return all ? Status::ok : Status::invalid_key;
}

}  // namespace

Status SceneQueries::distance(Key a, Key b, SceneDistance& answer, double limit) {
  const DefaultEnvironment environment;
  if (const Status status = QueryState::may_ask(state_); status != Status::ok) return status;
  const KeyTable& keys = state_->scene.keys;
  if (!keys.is_valid(a) || !keys.is_valid(b)) return Status::invalid_key;
  if (std::isnan(limit)) return Status::invalid_argument;
  SceneDistance found;
  ClosestParts parts(state_->parts);
  if (parts.find(state_->placed(a.id), state_->placed(b.id), limit, found)) {
    found.key = b;
    found.data = keys.client_data(b.id);
    answer = found;
  } else {
    answer = {};
  }
  return Status::ok;
}

Status SceneQueries::least_distance(std::span<const Key> a, std::span<const Key> b,
                                    SetDistance& answer, double limit) {
  const DefaultEnvironment environment;
  if (const Status status = check_sets(state_, a, b); status != Status::ok) return status;
  if (std::isnan(limit)) return Status::invalid_argument;
  SetPairs pairs(*state_, a, b);
  if (!pairs.find_boxes()) return Status::out_of_memory;
  answer = ClosestBodies(*state_, limit).find(pairs);
  return Status::ok;
}

Status SceneQueries::overlaps(std::span<const Key> a, std::span<const Key> b,
                              std::span<const KeyPair>& pairs, std::size_t most) {
  const DefaultEnvironment environment;
  if (const Status status = check_sets(state_, a, b); status != Status::ok) return status;
  Column<KeyPair>& found = state_->overlapping;
  found.clear();
  SetPairs all(*state_, a, b);
  bool has_room = all.find_boxes();
  const auto look = [&](Key first, Key second) {
    std::uint32_t part = kWholeShape;
    if (do_overlap(state_->parts, state_->placed(first.id), state_->placed(second.id), part)) {
      has_room = found.push_back({first, second});
    }
    return has_room && found.size() < most;
  };
  if (has_room && most != 0) all.each_within([] { return 0.0; }, look);
  if (!has_room) return Status::out_of_memory;
  pairs = {found.data(), found.size()};
  return Status::ok;
}

}  // namespace winnow
