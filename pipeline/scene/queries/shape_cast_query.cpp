// SceneQueries: convex and composite shapes that move along a line (ShapeCast).

#include "core/threads/float_environment.h"
#include "pipeline/scene/queries/cast_query.h"
#include "pipeline/scene/queries/composite_cast.h"
#include "pipeline/scene/queries/observed_filter.h"

#include <limits>

namespace winnow {
namespace {

Status check(const QueryState* state, const ShapeCast& cast, double tolerance) noexcept {
  if (const Status status = QueryState::check_state(state); status != Status::ok) {
    return status;
  }
  if (!state->parts.contains(cast.shape)) return Status::invalid_key;
  if (!cast.shape.is_composite() && cast.shape.kind() == ShapeKind::half_space) {
    return Status::unsupported;
  }
  if (!cast.pose.is_valid()) return Status::invalid_pose;
  const auto& way = cast.direction;
  const bool moves = way[0] != 0.0 || way[1] != 0.0 || way[2] != 0.0;
  const bool valid = is_finite(way) && moves && cast.max_t >= 0.0 && tolerance >= 0.0 &&
                     tolerance <= std::numeric_limits<double>::max();
  return valid ? Status::ok : Status::invalid_argument;
}

/// Calls query(linear_cast) for the cast.
template <typename Query>
Status query_cast(QueryState* state, const ShapeCast& cast, double tolerance, Query&& query) {
  if (const Status status = check(state, cast, tolerance); status != Status::ok) return status;
  if (cast.shape.is_composite()) return query(CompositeCast(state->parts, cast, tolerance));
  return query(ConvexCast(state->parts, cast, tolerance));
}

}  // namespace

Answer<SceneHit> SceneQueries::closest(const ShapeCast& cast, const SceneFilter& filter,
                                       double tolerance) {
  const DefaultFloatEnvironment environment;
  ObservedFilter observed(state_, filter);
  Answer<SceneHit> hit;
  hit.status = query_cast(state_, cast, tolerance, [&](const LinearCast& linear_cast) {
    return CastQuery(*state_, linear_cast, observed.used()).closest(hit);
  });
  if (is_observed(hit.status, state_))
    state_->observer->cast(HitForm::closest, cast, observed, tolerance, one_hit(hit));
  return hit;
}

Answer<std::span<const SceneHit>> SceneQueries::all(const ShapeCast& cast,
                                                    const SceneFilter& filter, double tolerance) {
  const DefaultFloatEnvironment environment;
  ObservedFilter observed(state_, filter);
  const Status status = query_cast(state_, cast, tolerance, [&](const LinearCast& linear_cast) {
    state_->hits.clear();
    return CastQuery(*state_, linear_cast, observed.used()).all();
  });
  if (status != Status::ok) return status;
  const std::span<const SceneHit> hits(state_->hits.data(), state_->hits.size());
  if (state_->observer != nullptr)
    state_->observer->cast(HitForm::all, cast, observed, tolerance, hits);
  return hits;
}

}  // namespace winnow
