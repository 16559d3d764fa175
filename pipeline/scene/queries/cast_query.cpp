#include "pipeline/scene/queries/cast_query.h"

#include <algorithm>

namespace winnow {
namespace {

using Eigen::Vector3d;

bool is_before(const SceneHit& a, const SceneHit& b) noexcept {
  return a.t != b.t ? a.t < b.t : a.key.id < b.key.id;
}

}  // namespace

bool is_small_set(const SceneState& scene, const SceneSet& set) noexcept {
  return set.partition.has_value() && set.body_of.size() <= kMaxSmallSet &&
         std::all_of(set.body_of.begin(), set.body_of.end(),
                     [&](std::uint32_t body) { return scene.shape[body].is_composite(); });
}

void order_hits(Column<SceneHit>& hits, std::size_t before) noexcept {
  if (hits.size() - before < 2) return;
  SceneHit* const own = hits.begin() + before;
  std::sort(own, hits.end(), is_before);
  const SceneHit* const end = std::unique(
      own, hits.end(), [](const SceneHit& a, const SceneHit& b) { return a.key == b.key; });
  hits.set_size(static_cast<std::size_t>(end - hits.begin()));
}

BoxPath CastQuery::box_path() const noexcept {
  // The slack of the path covers the rounding.
  const Vector3d start = Vector3d::Map(linear_cast_.start());
  return {{start + linear_cast_.extent().min, start + linear_cast_.extent().max},
          state_.scene.origin,
          linear_cast_.direction(),
          linear_cast_.max_t()};
}

SceneHit CastQuery::hit_of(std::uint32_t body, const BodyContact& contact) const noexcept {
  SceneHit hit = contact.hit(linear_cast_);
  hit.key = state_.scene.keys.key_of(body);
  hit.data = state_.scene.keys.client_data(body);
  return hit;
}

bool CastQuery::improves(std::uint32_t body) noexcept {
  if (const bool* const known = tested_.find(body)) return *known;
  BodyContact contact;
  bool better = find_contact(body, limit_, false, contact);
  // Equal t are ordered by the bodies' ids.
  if (better && found() && contact.t() == limit_) better = body < body_;
  if (better) {
    body_ = body;
    best_ = contact;
    limit_ = contact.t();
  }
  return tested_.note(body, better);
}

template <typename Query>
Status CastQuery::each_large_set(Query&& query) const {
  for (const SceneSet& set : state_.scene.sets) {
    if (!set.partition.has_value() || is_small_set(state_.scene, set)) continue;
    if (const Status status = query(*set.partition); status != Status::ok) return status;
  }
  return Status::ok;
}

/// Tests bodies on the rest of a path that is too long for casts.
template <typename TestBody>
Status CastQuery::test_rest(const Partition& partition, const BoxPath& path, TestBody& test_body) {
  auto test_and_reject = [&](std::uint32_t body) {
    test_body(body);
    return false;
  };
  BodyCandidateFilter body_filter(state_.scene, filter_, test_and_reject);
  return partition.overlap(path.rest(limit_), state_.objects, body_filter.filter());
}

/// Makes two traversals per partition and piece of the path. In the first traversal only bodies
/// that improve the result count as hits, so the partition skips boxes beyond the nearest box of
/// such a body. The traversal returns this box, and every box before it has been tested. The second
/// traversal tests the remaining boxes, from this box to the hit on the exact shape. Both
/// traversals are short if boxes are tight.
Status CastQuery::closest_in_large_sets() {
  BoxPath path = box_path();
  auto test_body = [&](std::uint32_t body) { return improves(body); };
  auto test_and_reject = [&](std::uint32_t body) {
    improves(body);
    return false;
  };
  BodyCandidateFilter first(state_.scene, filter_, test_body);
  BodyCandidateFilter second(state_.scene, filter_, test_and_reject);
  while (path.next() && !(found() && limit_ < path.begin())) {
    const Status status = each_large_set([&](const Partition& partition) {
      if (path.is_rest()) return test_rest(partition, path, test_body);
      const Answer<Hit> box = partition.closest(path.cast(limit_), first.filter());
      if (!box) return box.status;
      BoxCast cast = path.cast(limit_);
      cast.min_t = box.t;
      if (cast.max_t < cast.min_t) return Status::ok;
      return partition.closest(cast, second.filter()).status;
    });
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

Status CastQuery::closest(SceneHit& hit) {
  auto test_body = [&](std::uint32_t body) { return improves(body); };
  const bool has_large_set = test_small_sets(state_.scene, filter_, test_body);
  const Status status = has_large_set ? closest_in_large_sets() : Status::ok;
  if (status == Status::ok) hit = found() ? hit_of(body_, best_) : SceneHit{};
  return status;
}

Status CastQuery::closest_in_large_sets(const BodyRayHit& found_before, SceneHit& hit) {
  body_ = found_before.body;
  if (found()) limit_ = found_before.t;
  const Status status = closest_in_large_sets();
  if (status == Status::ok && body_ != found_before.body) hit = hit_of(body_, best_);
  return status;
}

Status CastQuery::any_in_large_sets(SceneHit& hit) {
  auto test_body = [&](std::uint32_t body) {
    if (found()) return true;
    if (const bool* const known = tested_.find(body)) return *known;
    if (!find_contact(body, limit_, true, best_)) return tested_.note(body, false);
    body_ = body;
    return true;
  };
  BoxPath path = box_path();
  BodyCandidateFilter body_filter(state_.scene, filter_, test_body);
  while (!found() && path.next()) {
    const Status status = each_large_set([&](const Partition& partition) {
      if (found()) return Status::ok;
      if (path.is_rest()) return test_rest(partition, path, test_body);
      return partition.any(path.cast(limit_), body_filter.filter()).status;
    });
    if (status != Status::ok) return status;
  }
  if (found()) hit = hit_of(body_, best_);
  return Status::ok;
}

Status CastQuery::visit_large_sets(const BodyVisitor& visitor) {
  auto test_body = [&](std::uint32_t body) {
    visitor.visit(visitor.context, body);
    return false;
  };
  BoxPath path = box_path();
  BodyCandidateFilter body_filter(state_.scene, filter_, test_body);
  while (path.next()) {
    const Status status = each_large_set([&](const Partition& partition) {
      if (path.is_rest()) return test_rest(partition, path, test_body);
      return partition.all(path.cast(linear_cast_.max_t()), state_.boxes, body_filter.filter());
    });
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

Status CastQuery::visit_all(const BodyVisitor& visitor) {
  auto visit_body = [&](std::uint32_t body) {
    visitor.visit(visitor.context, body);
    return false;
  };
  const bool has_large_set = test_small_sets(state_.scene, filter_, visit_body);
  return has_large_set ? visit_large_sets(visitor) : Status::ok;
}

bool CastQuery::adds(std::uint32_t body) {
  if (tested_.find(body) != nullptr) return true;
  tested_.note(body, false);
  BodyContact contact;
  return !find_contact(body, linear_cast_.max_t(), false, contact) ||
         state_.hits.push_back(hit_of(body, contact));
}

Status CastQuery::all() {
  const std::size_t before = state_.hits.size();
  bool has_room = true;
  auto add = [&](std::uint32_t body) { has_room = adds(body) && has_room; };
  const Status status = visit_all(BodyVisitor::of(add));
  if (status != Status::ok || !has_room) return has_room ? status : Status::out_of_memory;
  order_hits(state_.hits, before);
  return Status::ok;
}

Status CastQuery::all_in_large_sets(std::size_t before) {
  bool has_room = true;
  auto add = [&](std::uint32_t body) { has_room = adds(body) && has_room; };
  const Status status = visit_large_sets(BodyVisitor::of(add));
  if (status != Status::ok || !has_room) return has_room ? status : Status::out_of_memory;
  order_hits(state_.hits, before);
  return Status::ok;
}

}  // namespace winnow
