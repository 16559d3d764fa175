// SceneQueries: rays and moving shapes. Partitions tell which bodies' boxes are met on the way
// (BoxWay says why none is missed), and show them to a predicate, which asks the exact shapes.

#include "pipeline/scene/queries/queries.h"
#include "pipeline/scene/queries/queries_movers.h"
#include "pipeline/scene/queries/queries_way.h"

#include <algorithm>
#include <limits>

namespace winnow {
namespace {

bool is_before(const SceneHit& a, const SceneHit& b) noexcept {
  return a.t != b.t ? a.t < b.t : a.key.id < b.key.id;
}

/// Bodies that were looked at and may be shown again: a partition asks about a body once a stretch
/// of the way. Forgets, when two want the same place.
class Memo {
 public:
  /// What was noted about the body; null if nothing is known.
  [[nodiscard]] const bool* find(std::uint32_t body) const noexcept {
    const Entry& entry = entries_[body % kEntries];
    return entry.body == body ? &entry.met : nullptr;
  }
  bool note(std::uint32_t body, bool met) noexcept {
    entries_[body % kEntries] = {body, met};
    return met;
  }

 private:
  static constexpr std::size_t kEntries = 64;
  struct Entry {
    std::uint32_t body = kNoObject;
    bool met = false;
  };
  Entry entries_[kEntries];
};

/// One question: something moves through the scene.
class CastQuestion {
 public:
  CastQuestion(SceneQueries::State& state, const Mover& mover, const Filter& filter) noexcept
      : state_(state), mover_(mover), filter_(filter) {}

  Status closest(SceneHit& hit);
  Status any(SceneHit& hit);
  Status all();

 private:
  [[nodiscard]] PreciseBox start_box() const noexcept;
  [[nodiscard]] double limit() const noexcept { return found() ? best_.t() : mover_.max_t(); }
  [[nodiscard]] bool found() const noexcept { return body_ != kNoObject; }
  [[nodiscard]] bool meets(std::uint32_t body, double limit, bool any,
                           Encounter& encounter) const noexcept {
    return encounter.find(state_.walk, mover_, state_.placed(body), limit, any);
  }
  [[nodiscard]] SceneHit shown(std::uint32_t body, const Encounter& encounter) const noexcept;
  /// True if the body is now the first one met.
  bool improves(std::uint32_t body) noexcept;
  template <typename Look>
  [[nodiscard]] Status look_at_rest(const Partition& partition, const BoxWay& way, Look& look);

  SceneQueries::State& state_;
  const Mover& mover_;
  const Filter& filter_;
  /// The body that is the first one met, as far as is known.
  std::uint32_t body_ = kNoObject;
  Encounter best_;
  Memo memo_;
};

PreciseBox CastQuestion::start_box() const noexcept {
  // Rounding is covered by the slack of the way.
  const Eigen::Vector3d start = Eigen::Vector3d::Map(mover_.start());
  return {start + mover_.extent().min, start + mover_.extent().max};
}

SceneHit CastQuestion::shown(std::uint32_t body, const Encounter& encounter) const noexcept {
  SceneHit hit = encounter.hit(mover_);
  hit.key = state_.scene.keys.key_of(body);
  hit.data = state_.scene.keys.client_data(body);
  return hit;
}

bool CastQuestion::improves(std::uint32_t body) noexcept {
  if (const bool* const known = memo_.find(body)) return *known;
  Encounter encounter;
  bool better = meets(body, limit(), false, encounter);
  // Equal t are ordered by the bodies' ids.
  if (better && found() && encounter.t() == best_.t()) better = body < body_;
  if (better) {
    body_ = body;
    best_ = encounter;
  }
  return memo_.note(body, better);
}

/// What lies on a way that is too long to be swept.
template <typename Look>
Status CastQuestion::look_at_rest(const Partition& partition, const BoxWay& way, Look& look) {
  auto look_only = [&](std::uint32_t body) {
    look(body);
    return false;
  };
  LookingFilter looking(state_.scene, filter_, look_only);
  return partition.overlap(way.rest(limit()), state_.objects, looking.filter());
}

/// In two walks a partition and piece of the way. In the first one bodies that improve the answer
/// count as hits, so that the partition looks at no box behind theirs; it gives the box that was
/// met first of all that count, and every box before it has been looked at. What is left are boxes
/// from there to where the exact shape was met: the second walk. Both are short where boxes fit.
Status CastQuestion::closest(SceneHit& hit) {
  BoxWay way(start_box(), mover_.direction(), mover_.max_t());
  auto look = [&](std::uint32_t body) { return improves(body); };
  auto look_only = [&](std::uint32_t body) {
    improves(body);
    return false;
  };
  LookingFilter first(state_.scene, filter_, look);
  LookingFilter second(state_.scene, filter_, look_only);
  while (way.next() && !(found() && best_.t() < way.begin())) {
    const Status status = state_.each_partition([&](const Partition& partition) {
      if (way.is_rest()) return look_at_rest(partition, way, look);
      Hit box;
      BoxCast cast = way.cast(limit());
      Status asked = partition.closest(cast, box, first.filter());
      if (asked != Status::ok || !box) return asked;
      cast = way.cast(limit());
      cast.min_t = box.t;
      if (cast.max_t >= cast.min_t) asked = partition.closest(cast, box, second.filter());
      return asked;
    });
    if (status != Status::ok) return status;
  }
  hit = found() ? shown(body_, best_) : SceneHit{};
  return Status::ok;
}

Status CastQuestion::any(SceneHit& hit) {
  BoxWay way(start_box(), mover_.direction(), mover_.max_t());
  auto look = [&](std::uint32_t body) {
    if (found()) return true;
    if (const bool* const known = memo_.find(body)) return *known;
    if (!meets(body, mover_.max_t(), true, best_)) return memo_.note(body, false);
    body_ = body;
    return true;
  };
  LookingFilter looking(state_.scene, filter_, look);
  while (!found() && way.next()) {
    const Status status = state_.each_partition([&](const Partition& partition) {
      if (found()) return Status::ok;
      if (way.is_rest()) return look_at_rest(partition, way, look);
      Hit box;
      return partition.any(way.cast(mover_.max_t()), box, looking.filter());
    });
    if (status != Status::ok) return status;
  }
  hit = found() ? shown(body_, best_) : SceneHit{};
  return Status::ok;
}

Status CastQuestion::all() {
  Column<SceneHit>& hits = state_.hits;
  hits.clear();
  BoxWay way(start_box(), mover_.direction(), mover_.max_t());
  bool has_room = true;
  auto look = [&](std::uint32_t body) {
    if (memo_.find(body) != nullptr) return false;
    memo_.note(body, false);
    Encounter encounter;
    if (meets(body, mover_.max_t(), false, encounter)) {
      has_room = hits.push_back(shown(body, encounter)) && has_room;
    }
    return false;
  };
  LookingFilter looking(state_.scene, filter_, look);
  Status status = Status::ok;
  while (status == Status::ok && way.next()) {
    status = state_.each_partition([&](const Partition& partition) {
      if (way.is_rest()) return look_at_rest(partition, way, look);
      return partition.all(way.cast(mover_.max_t()), state_.boxes, looking.filter());
    });
  }
  if (!has_room) status = Status::out_of_memory;
  if (status != Status::ok) {
    hits.clear();
    return status;
  }
  std::sort(hits.begin(), hits.end(), is_before);
  // A body whose box reaches from one piece of the way into the next was met in both.
  const SceneHit* const end =
      std::unique(hits.begin(), hits.end(),
                  [](const SceneHit& a, const SceneHit& b) { return a.key == b.key; });
  hits.set_size(static_cast<std::size_t>(end - hits.begin()));
  return Status::ok;
}

bool is_valid(const double (&direction)[3], double max_t) noexcept {
  double sum = 0.0;
  bool moves = false;
  for (const double d : direction) {
    sum += d - d;
    moves = moves || d != 0.0;
  }
  return sum == 0.0 && moves && max_t >= 0.0;
}

Status check(const SceneQueries::State* state, const ShapeRay& ray) noexcept {
  if (const Status status = SceneQueries::State::may_ask(state); status != Status::ok) {
    return status;
  }
  double sum = 0.0;
  for (const double x : ray.origin) sum += x - x;
  return sum == 0.0 && is_valid(ray.direction, ray.max_t) ? Status::ok : Status::invalid_argument;
}

Status check(const SceneQueries::State* state, const ShapeCast& cast, double tolerance) noexcept {
  if (const Status status = SceneQueries::State::may_ask(state); status != Status::ok) {
    return status;
  }
  if (!state->walk.contains(cast.shape)) return Status::invalid_key;
  if (cast.shape.is_composite() || cast.shape.kind() == ShapeKind::half_space) {
    return Status::unsupported;
  }
  if (!cast.pose.is_valid()) return Status::invalid_pose;
  const bool valid = is_valid(cast.direction, cast.max_t) && tolerance >= 0.0 &&
                     tolerance <= std::numeric_limits<double>::max();
  return valid ? Status::ok : Status::invalid_argument;
}

}  // namespace

Status SceneQueries::closest(const ShapeRay& ray, SceneHit& hit, const Filter& filter) {
  if (const Status status = check(state_, ray); status != Status::ok) return status;
  return CastQuestion(*state_, RayMover(state_->scene.shapes, ray), filter).closest(hit);
}

Status SceneQueries::any(const ShapeRay& ray, SceneHit& hit, const Filter& filter) {
  if (const Status status = check(state_, ray); status != Status::ok) return status;
  return CastQuestion(*state_, RayMover(state_->scene.shapes, ray), filter).any(hit);
}

Status SceneQueries::all(const ShapeRay& ray, std::span<const SceneHit>& hits,
                         const Filter& filter) {
  if (const Status status = check(state_, ray); status != Status::ok) return status;
  const RayMover mover(state_->scene.shapes, ray);
  const Status status = CastQuestion(*state_, mover, filter).all();
  if (status == Status::ok) hits = {state_->hits.data(), state_->hits.size()};
  return status;
}

Status SceneQueries::closest(const ShapeCast& cast, SceneHit& hit, const Filter& filter,
                             double tolerance) {
  if (const Status status = check(state_, cast, tolerance); status != Status::ok) return status;
  return CastQuestion(*state_, ShapeMover(state_->walk, cast, tolerance), filter).closest(hit);
}

Status SceneQueries::all(const ShapeCast& cast, std::span<const SceneHit>& hits,
                         const Filter& filter, double tolerance) {
  if (const Status status = check(state_, cast, tolerance); status != Status::ok) return status;
  const ShapeMover mover(state_->walk, cast, tolerance);
  const Status status = CastQuestion(*state_, mover, filter).all();
  if (status == Status::ok) hits = {state_->hits.data(), state_->hits.size()};
  return status;
}

}  // namespace winnow
