// SceneQueries: two bodies, or two sets of bodies: how far they are apart, and which overlap.

#include "pipeline/scene/queries/queries.h"
#include "pipeline/scene/queries/two_shapes.h"

#include <cmath>
#include <limits>

namespace winnow {
namespace {

/// Of a sum of squares and its root, and of the solver's distance to what lies on the border of a
/// box.
constexpr double kGapSlack = 1e-9;

/// Two boxes are not nearer than this.
double gap_of(const PlainPreciseBox& a, const PlainPreciseBox& b) noexcept {
  double square = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double gap = std::max({0.0, a.min[i] - b.max[i], b.min[i] - a.max[i]});
    square += gap * gap;
  }
  return std::sqrt(square) * (1.0 - kGapSlack);
}

/// Calls look(body of a, body of b) for pairs of bodies whose boxes are no farther apart than
/// gap(), which may shrink meanwhile, until it says false.
class SetPairs {
 public:
  SetPairs(QueryState& state, std::span<const Key> a, std::span<const Key> b) noexcept
      : state_(state), a_(a), b_(b) {}

  [[nodiscard]] bool find_boxes() noexcept {
    if (!state_.bounds.resize(b_.size())) return false;
    for (std::size_t i = 0; i < b_.size(); ++i) state_.bounds[i] = bounds_of(b_[i]);
    return true;
  }
  template <typename Gap, typename Look>
  void each_within(Gap&& gap, Look&& look) const {
    for (const Key a : a_) {
      const PlainPreciseBox box = bounds_of(a);
      for (std::size_t i = 0; i < b_.size(); ++i) {
        const double apart = gap_of(box, state_.bounds[i]);
        if (apart <= gap() && a != b_[i] && !look(a, b_[i], apart)) return;
      }
    }
  }

 private:
  [[nodiscard]] PlainPreciseBox bounds_of(Key key) const noexcept {
    const PreciseBox box = state_.parts.box(state_.placed(key.id));
    return {{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}};
  }

  QueryState& state_;
  std::span<const Key> a_;
  std::span<const Key> b_;
};

/// The closest pair of two sets. First looked at is the pair whose boxes are the nearest: hardly
/// any other has boxes that are nearer than these two bodies are.
class ClosestBodies {
 public:
  ClosestBodies(QueryState& state, double limit) noexcept : state_(state), limit_(limit) {}

  [[nodiscard]] SetDistance find(const SetPairs& pairs) {
    double least = mid::kInfinity;
    Key nearest[2];
    pairs.each_within([&] { return std::min(least, reach()); },
                      [&](Key a, Key b, double gap) {
                        if (gap == least) return true;
                        least = gap;
                        nearest[0] = a;
                        nearest[1] = b;
                        return true;
                      });
    if (nearest[0].id == kNoObject) return best_;
    look(nearest[0], nearest[1]);
    pairs.each_within([&] { return reach(); },
                      [&](Key a, Key b, double) {
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
  if (const Status status = check_sets(state_, a, b); status != Status::ok) return status;
  if (std::isnan(limit)) return Status::invalid_argument;
  SetPairs pairs(*state_, a, b);
  if (!pairs.find_boxes()) return Status::out_of_memory;
  answer = ClosestBodies(*state_, limit).find(pairs);
  return Status::ok;
}

Status SceneQueries::overlaps(std::span<const Key> a, std::span<const Key> b,
                              std::span<const KeyPair>& pairs, std::size_t most) {
  if (const Status status = check_sets(state_, a, b); status != Status::ok) return status;
  Column<KeyPair>& found = state_->overlapping;
  found.clear();
  SetPairs all(*state_, a, b);
  bool has_room = all.find_boxes();
  const auto look = [&](Key first, Key second, double) {
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
