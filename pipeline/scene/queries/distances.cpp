// SceneQueries: how far two bodies, or two sets of bodies, are apart.

#include "pipeline/scene/queries/closest_parts.h"
#include "pipeline/scene/queries/queries.h"

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

/// The closest pair of two sets. First looked at is the pair whose boxes are the nearest: hardly
/// any other has boxes that are nearer than these two bodies are.
class SetQuestion {
 public:
  SetQuestion(QueryState& state, std::span<const Key> a, std::span<const Key> b,
              double limit) noexcept
      : state_(state), a_(a), b_(b), limit_(limit) {}

  Status ask(SetDistance& answer) {
    if (!state_.bounds.resize(b_.size())) return Status::out_of_memory;
    for (std::size_t i = 0; i < b_.size(); ++i) {
      state_.bounds[i] = bounds_of(b_[i]);
    }
    look_at_nearest_boxes();
    for (const Key a : a_) look_about(a);
    answer = best_;
    return Status::ok;
  }

 private:
  [[nodiscard]] PlainPreciseBox bounds_of(Key key) const noexcept {
    const PreciseBox box = state_.parts.box(state_.placed(key.id));
    return {{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}};
  }
  /// Overlapping bodies may be deeper than others.
  [[nodiscard]] bool may_be_nearer(double gap) const noexcept {
    return gap <= std::max(limit_, 0.0);
  }

  void look_at_nearest_boxes() noexcept {
    double least = mid::kInfinity;
    Key nearest[2];
    for (const Key a : a_) {
      const PlainPreciseBox box = bounds_of(a);
      for (std::size_t i = 0; i < b_.size(); ++i) {
        const double gap = gap_of(box, state_.bounds[i]);
        if (gap >= least || a == b_[i]) continue;
        least = gap;
        nearest[0] = a;
        nearest[1] = b_[i];
      }
    }
    if (least <= limit_) look(nearest[0], nearest[1]);
  }

  void look_about(Key a) noexcept {
    const PlainPreciseBox box = bounds_of(a);
    for (std::size_t i = 0; i < b_.size(); ++i) {
      if (may_be_nearer(gap_of(box, state_.bounds[i])) && a != b_[i]) look(a, b_[i]);
    }
  }

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
  std::span<const Key> a_;
  std::span<const Key> b_;
  double limit_;
  SetDistance best_;
};

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
  if (const Status status = QueryState::may_ask(state_); status != Status::ok) return status;
  const KeyTable& keys = state_->scene.keys;
  const auto is_there = [&](Key key) { return keys.is_valid(key); };
  if (!std::all_of(a.begin(), a.end(), is_there) || !std::all_of(b.begin(), b.end(), is_there)) {
    return Status::invalid_key;
  }
  if (std::isnan(limit)) return Status::invalid_argument;
  return SetQuestion(*state_, a, b, limit).ask(answer);
}

}  // namespace winnow
