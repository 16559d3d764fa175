// SceneQueries: casts of shapes that translate and rotate. The path is cut into pieces, each
// bounded by a box; partitions find the bodies whose boxes overlap the box of a piece and call a
// predicate (BodyCandidateFilter), which tests the exact shapes (motion/body_impact.h).

#include <winnow/core/volumes.h>
#include "core/threads/float_environment.h"
#include "pipeline/motion/body_impact.h"
#include "pipeline/motion/relative_motion_bounds.h"
#include "pipeline/scene/queries/observed_filter.h"
#include "pipeline/scene/queries/queries.h"

#include <algorithm>
#include <tuple>

namespace winnow {
namespace {

[[nodiscard]] auto by_time(const SceneHit& hit) noexcept {
  return std::tuple(hit.t, hit.key.id);
}

[[nodiscard]] auto by_body(const SceneHit& hit) noexcept {
  return std::tuple(hit.key.id, hit.t);
}

/// One query: a shape that moves and turns through the scene.
class MotionQuery {
 public:
  MotionQuery(QueryState& state, const MotionCast& cast, const SceneFilter& filter,
              double tolerance) noexcept
      : state_(state),
        cast_(cast),
        filter_(filter),
        tolerance_(tolerance),
        frame_(RigidMotion::stationary(
            Pose::at(state.scene.origin.x(), state.scene.origin.y(), state.scene.origin.z()))),
        moving_(impact::whole_shape(state.parts, cast.shape, cast.motion)),
        way_(state.parts, frame_, moving_) {}

  Answer<SceneHit> closest();
  Status all();

 private:
  /// Calls test_body(body, within) for the candidate bodies of each piece of the path, in order,
  /// until a piece begins after `limit`.
  template <typename TestBody>
  [[nodiscard]] Status each_piece(const double& limit, TestBody&& test_body);
  /// Returns the first impact with a body within an interval, or a null hit if there is none; the
  /// hit may also be null if the impact is after `until`.
  [[nodiscard]] SceneHit hit_of(std::uint32_t body, const impact::Interval& within,
                                double until = 1.0) const;

  QueryState& state_;
  const MotionCast& cast_;
  const SceneFilter& filter_;
  const double tolerance_;
  const RigidMotion frame_;
  const impact::MovingShape moving_;
  const impact::RelativeMotionBounds way_;
};

template <typename TestBody>
Status MotionQuery::each_piece(const double& limit, TestBody&& test_body) {
  const std::uint32_t pieces = way_.piece_count();
  for (std::uint32_t i = 0; i < pieces; ++i) {
    const impact::Interval within = impact::piece_of(i, pieces);
    if (within.first > limit) break;
    const mid::Box3 box = way_.box(within);
    auto test_candidate = [&](std::uint32_t body) {
      test_body(body, within);
      return false;
    };
    BodyCandidateFilter body_filter(state_.scene, filter_, test_candidate);
    const Aabb region = Aabb::outward(box.min, box.max);
    const Status status = state_.each_partition([&](const Partition& partition) {
      return partition.overlap(region, state_.objects, body_filter.filter());
    });
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

SceneHit MotionQuery::hit_of(std::uint32_t body, const impact::Interval& within,
                             double until) const {
  const PlacedShape placed = state_.placed(body);
  const RigidMotion at_rest = RigidMotion::stationary(placed.pose);
  const impact::StartTouch touch =
      cast_.touching ? impact::StartTouch::impact : impact::StartTouch::impact_unless_sliding;
  const impact::BodyImpact found =
      impact::find_body_impact(state_.parts, {cast_.shape, cast_.motion}, {placed.shape, at_rest},
                               {tolerance_, within, until, touch});
  SceneHit hit;
  const impact::Impact& impact = found.impact;
  if (!impact.hit) return hit;
  hit.key = state_.scene.keys.key_of(body);
  hit.data = state_.scene.keys.client_data(body);
  hit.part = found.part_b;
  hit.t = impact.time;
  for (int i = 0; i < 3; ++i) {
    const double at = cast_.motion.start.position[i] + impact.time * cast_.motion.travel[i];
    hit.normal[i] = 0.0 - impact.normal[i];
    hit.point[i] = at + (impact.point[i] + impact.gap * impact.normal[i]);
  }
  return hit;
}

Answer<SceneHit> MotionQuery::closest() {
  SceneHit best;
  best.t = 1.0;
  const Status status = each_piece(best.t, [&](std::uint32_t body, const impact::Interval& within) {
    const SceneHit found = hit_of(body, within, best.t);
    if (found && (!best || by_time(found) < by_time(best))) best = found;
  });
  if (status != Status::ok) return status;
  return best ? best : SceneHit{};
}

/// A body may be hit in two consecutive pieces; the first hit counts.
Status MotionQuery::all() {
  Column<SceneHit>& hits = state_.hits;
  hits.clear();
  bool has_room = true;
  const Status status = each_piece(1.0, [&](std::uint32_t body, const impact::Interval& within) {
    const SceneHit found = hit_of(body, within);
    if (found) has_room = hits.push_back(found) && has_room;
  });
  if (status != Status::ok || !has_room) return has_room ? status : Status::out_of_memory;
  std::sort(hits.begin(), hits.end(),
            [](const SceneHit& a, const SceneHit& b) { return by_body(a) < by_body(b); });
  SceneHit* const end =
      std::unique(hits.begin(), hits.end(),
                  [](const SceneHit& a, const SceneHit& b) { return a.key == b.key; });
  hits.set_size(static_cast<std::size_t>(end - hits.begin()));
  std::sort(hits.begin(), hits.end(),
            [](const SceneHit& a, const SceneHit& b) { return by_time(a) < by_time(b); });
  return Status::ok;
}

Status check(const QueryState* state, const MotionCast& cast, double tolerance) noexcept {
  if (const Status status = QueryState::check_state(state); status != Status::ok) return status;
  if (!state->parts.contains(cast.shape)) return Status::invalid_key;
  if (!cast.shape.is_composite() && cast.shape.kind() == ShapeKind::half_space) {
    return Status::unsupported;
  }
  if (!cast.motion.is_valid()) return Status::invalid_pose;
  return tolerance > 0.0 && tolerance <= 1.0 ? Status::ok : Status::invalid_argument;
}

}  // namespace

Answer<SceneHit> SceneQueries::closest(const MotionCast& cast, const SceneFilter& filter,
                                       double tolerance) {
  const DefaultFloatEnvironment environment;
  const Status status = check(state_, cast, tolerance);
  if (status != Status::ok) return status;
  ObservedFilter observed(state_, filter);
  const Answer<SceneHit> hit = MotionQuery(*state_, cast, observed.used(), tolerance).closest();
  if (is_observed(hit.status, state_))
    state_->observer->cast(HitForm::closest, cast, observed, tolerance, one_hit(hit));
  return hit;
}

Answer<std::span<const SceneHit>> SceneQueries::all(const MotionCast& cast,
                                                    const SceneFilter& filter, double tolerance) {
  const DefaultFloatEnvironment environment;
  ObservedFilter observed(state_, filter);
  Status status = check(state_, cast, tolerance);
  if (status == Status::ok) status = MotionQuery(*state_, cast, observed.used(), tolerance).all();
  if (status != Status::ok) return status;
  const std::span<const SceneHit> hits(state_->hits.data(), state_->hits.size());
  if (state_->observer != nullptr)
    state_->observer->cast(HitForm::all, cast, observed, tolerance, hits);
  return hits;
}

}  // namespace winnow
