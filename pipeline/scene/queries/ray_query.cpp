// SceneQueries: rays. Up to kRaysAtOnce rays are tested together, a single ray as a group of one.
// Bodies of small sets (cast_query.h) are tested by mid::cast_rays, which traces the rays of a
// group through a mesh side by side; then each ray is tested on large sets by CastQuery.

#include "core/threads/float_environment.h"
#include "pipeline/mesh/mesh_rays.kernel.h"
#include "pipeline/rays/shape_entries.h"
#include "pipeline/scene/queries/cast_query.h"
#include "pipeline/scene/queries/observed_filter.h"

#include <algorithm>

namespace winnow {
namespace {

using mid::kInfinity;

/// Up to `Room` rays that are tested together, which is cheaper than one by one if they reach the
/// same surfaces. The closest hit and all hits of a ray depend only on the ray; which hit `any`
/// finds may depend on the group.
template <std::size_t Room>
class RayGroup {
 public:
  RayGroup(QueryState& state, const SceneFilter& filter) noexcept
      : state_(state), filter_(filter) {}
  RayGroup(const RayGroup&) = delete;
  RayGroup& operator=(const RayGroup&) = delete;

  /// Begins a group of at most `Room` rays, which must be valid and outlive it.
  void start(std::span<const ShapeRay> rays) noexcept { rays_ = rays; }
  /// Calls visit(i, hit) for ray i of the group with its first hit in the scene, or with `any` some
  /// hit. The null hit if there is none.
  template <typename Visit>
  Status find_each(bool any, Visit&& visit);
  /// Appends all hits of the rays to the state's `hits`, and where the hits of each ray end to its
  /// `hits_first`.
  Status find_all(std::size_t first);

 private:
  void reset_hits() noexcept;
  /// Improves the hits of all rays with their hits on a body.
  void test_rays(std::uint32_t body, bool any);
  /// Lists each ray's first hits on all bodies of small sets, sorted by ray, in the state's
  /// `small_set_hits`, and sets whether there are large sets.
  Status list_small_sets(bool& has_large_set);
  /// Tests a ray on large sets; `hit` is the result so far.
  Status query_large_sets(std::size_t i, bool any, SceneHit& hit);
  /// Fills in a hit, which must be a null hit.
  [[gnu::always_inline]] void fill_in(std::size_t i, const BodyRayHit& at,
                                      SceneHit& hit) const noexcept;

  QueryState& state_;
  const SceneFilter& filter_;
  std::span<const ShapeRay> rays_;
  /// t of the first hit so far, or max_t; with `any`, negative after a hit.
  double limit_[Room];
  BodyRayHit best_[Room];
};

template <std::size_t Room>
void RayGroup<Room>::reset_hits() noexcept {
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    limit_[i] = rays_[i].max_t;
    best_[i].body = kNoObject;
  }
}

template <std::size_t Room>
void RayGroup<Room>::test_rays(std::uint32_t body, bool any) {
  PartHit hits[Room];
  RaySurface* const prepared = rays_.size() == 1 ? &state_.surfaces.of(body) : nullptr;
  state_.parts.cast_rays(state_.placed(body), rays_, limit_, any, prepared, hits);
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    if (hits[i].found) best_[i].improve(BodyRayHit::of(body, hits[i]), any, limit_[i]);
  }
}

template <std::size_t Room>
inline void RayGroup<Room>::fill_in(std::size_t i, const BodyRayHit& at,
                                    SceneHit& hit) const noexcept {
  if (at.body == kNoObject) return;
  hit.key = state_.scene.keys.key_of(at.body);
  hit.data = state_.scene.keys.client_data(at.body);
  hit.part = at.part;
  hit.t = at.t;
  // Summed in an order that keeps precision for distant bodies.
  const double* const base = state_.scene.pose[at.body].position.data();
  const TwoDiff from = difference(rays_[i].origin.data(), base);
  for (int k = 0; k < 3; ++k) {
    hit.normal[k] = at.normal[k];
    hit.point[k] = base[k] + (from.difference[k] + at.t * rays_[i].direction[k]);
  }
}

template <std::size_t Room>
Status RayGroup<Room>::query_large_sets(std::size_t i, bool any, SceneHit& hit) {
  if (any && best_[i].body != kNoObject) return Status::ok;
  const RayCast linear_cast(state_.scene.shapes, rays_[i]);
  CastQuery query(state_, linear_cast, filter_);
  return any ? query.any_in_large_sets(hit) : query.closest_in_large_sets(best_[i], hit);
}

template <std::size_t Room>
template <typename Visit>
Status RayGroup<Room>::find_each(bool any, Visit&& visit) {
  reset_hits();
  auto test_body = [&](std::uint32_t body) {
    test_rays(body, any);
    return false;
  };
  const bool has_large_set = test_small_sets(state_.scene, filter_, test_body);
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    SceneHit hit;
    fill_in(i, best_[i], hit);
    const Status status = has_large_set ? query_large_sets(i, any, hit) : Status::ok;
    if (status != Status::ok) return status;
    visit(i, hit);
  }
  return Status::ok;
}

template <std::size_t Room>
Status RayGroup<Room>::list_small_sets(bool& has_large_set) {
  Column<RayHit>& list = state_.small_set_hits;
  list.clear();
  bool has_room = true;
  auto test_body = [&](std::uint32_t body) {
    reset_hits();
    test_rays(body, false);
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      if (best_[i].body != kNoObject) has_room = list.push_back({i, best_[i]}) && has_room;
    }
    return false;
  };
  has_large_set = test_small_sets(state_.scene, filter_, test_body);
  const auto is_earlier = [](const RayHit& a, const RayHit& b) { return a.ray < b.ray; };
  // The hits of one body are in order already.
  const bool is_ordered = std::is_sorted(list.begin(), list.end(), is_earlier);
  if (!is_ordered) std::sort(list.begin(), list.end(), is_earlier);
  return has_room ? Status::ok : Status::out_of_memory;
}

template <std::size_t Room>
Status RayGroup<Room>::find_all(std::size_t first) {
  bool has_large_set = false;
  if (const Status status = list_small_sets(has_large_set); status != Status::ok) return status;
  const RayHit* next = state_.small_set_hits.begin();
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    const std::size_t before = state_.hits.size();
    for (; next != state_.small_set_hits.end() && next->ray == i; ++next) {
      SceneHit hit;
      fill_in(i, next->at, hit);
      if (!state_.hits.push_back(hit)) return Status::out_of_memory;
    }
    if (has_large_set) {
      const RayCast linear_cast(state_.scene.shapes, rays_[i]);
      const Status status = CastQuery(state_, linear_cast, filter_).all_in_large_sets(before);
      if (status != Status::ok) return status;
    } else {
      order_hits(state_.hits, before);
    }
    state_.hits_first[first + i + 1] = state_.hits.size();
  }
  return Status::ok;
}

/// Divides a batch of rays into groups.
class RayGroups {
 public:
  explicit RayGroups(const ShapeRayBatch& rays) noexcept : rays_(rays) {}

  [[nodiscard]] std::size_t first() const noexcept { return first_; }
  /// Returns the next rays; empty if there are none.
  [[nodiscard]] std::span<const ShapeRay> next() noexcept {
    first_ += count_;
    count_ = std::min<std::size_t>(kRaysAtOnce, rays_.count - first_);
    for (std::size_t i = 0; i < count_; ++i) ray_[i] = rays_[first_ + i];
    return {ray_, count_};
  }

 private:
  const ShapeRayBatch& rays_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  ShapeRay ray_[kRaysAtOnce];
};

Status check(const QueryState* state, const ShapeRay& ray) noexcept {
  if (const Status status = QueryState::check_state(state); status != Status::ok) return status;
  return is_valid(ray) ? Status::ok : Status::invalid_argument;
}

Status check(const QueryState* state, const ShapeRayBatch& rays) noexcept {
  if (const Status status = QueryState::check_state(state); status != Status::ok) {
    return status;
  }
  for (std::size_t i = 0; i < rays.count; ++i) {
    if (!is_valid(rays[i])) return Status::invalid_argument;
  }
  return Status::ok;
}

template <typename T>
void put(T* column, std::size_t row, const T& value) noexcept {
  if (column != nullptr) column[row] = value;
}

void put(const SceneHitColumns& columns, std::size_t row, const SceneHit& hit) noexcept {
  put(columns.key, row, hit.key);
  put(columns.data, row, hit.data);
  put(columns.part, row, hit.part);
  put(columns.t, row, hit ? hit.t : kInfinity);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put(columns.normal[axis], row, hit.normal[axis]);
    put(columns.point[axis], row, hit.point[axis]);
  }
}

Answer<SceneHit> find_one(QueryState* state, const ShapeRay& ray, const SceneFilter& filter,
                          bool any) {
  if (const Status status = check(state, ray); status != Status::ok) return status;
  RayGroup<1> group(*state, filter);
  group.start({&ray, 1});
  Answer<SceneHit> hit;
  hit.status = group.find_each(any, [&](std::size_t, const SceneHit& found) { hit = found; });
  return hit;
}

Status find_many(QueryState* state, const ShapeRayBatch& rays, const SceneFilter& filter, bool any,
                 const SceneHitColumns& hits) {
  if (const Status status = check(state, rays); status != Status::ok) return status;
  RayGroups groups(rays);
  RayGroup<kRaysAtOnce> group(*state, filter);
  for (auto some = groups.next(); !some.empty(); some = groups.next()) {
    group.start(some);
    const Status status = group.find_each(
        any, [&](std::size_t i, const SceneHit& hit) { put(hits, groups.first() + i, hit); });
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

/// Prepares the state for all hits of n rays.
Status start_all(QueryState& state, std::size_t rays) {
  state.hits.clear();
  if (!state.hits_first.resize(rays + 1)) return Status::out_of_memory;
  state.hits_first[0] = 0;
  return Status::ok;
}

}  // namespace

Answer<SceneHit> SceneQueries::closest(const ShapeRay& ray, const SceneFilter& filter) {
  const DefaultFloatEnvironment environment;
  ObservedFilter observed(state_, filter);
  const Answer<SceneHit> hit = find_one(state_, ray, observed.used(), false);
  if (is_observed(hit.status, state_))
    state_->observer->ray(HitForm::closest, ray, observed, one_hit(hit));
  return hit;
}

Answer<SceneHit> SceneQueries::any(const ShapeRay& ray, const SceneFilter& filter) {
  const DefaultFloatEnvironment environment;
  ObservedFilter observed(state_, filter);
  const Answer<SceneHit> hit = find_one(state_, ray, observed.used(), true);
  if (is_observed(hit.status, state_))
    state_->observer->ray(HitForm::any, ray, observed, one_hit(hit));
  return hit;
}

Answer<std::span<const SceneHit>> SceneQueries::all(const ShapeRay& ray,
                                                    const SceneFilter& filter) {
  const DefaultFloatEnvironment environment;
  Status status = check(state_, ray);
  if (status == Status::ok) status = start_all(*state_, 1);
  if (status != Status::ok) return status;
  ObservedFilter observed(state_, filter);
  RayGroup<1> group(*state_, observed.used());
  group.start({&ray, 1});
  status = group.find_all(0);
  if (status != Status::ok) return status;
  const std::span<const SceneHit> hits(state_->hits.data(), state_->hits.size());
  if (state_->observer != nullptr) state_->observer->ray(HitForm::all, ray, observed, hits);
  return hits;
}

Status SceneQueries::closest(const ShapeRayBatch& rays, const SceneHitColumns& hits,
                             const SceneFilter& filter) {
  const DefaultFloatEnvironment environment;
  ObservedFilter observed(state_, filter);
  const Status status = find_many(state_, rays, observed.used(), false, hits);
  if (is_observed(status, state_)) state_->observer->rays(HitForm::closest, rays, observed, hits);
  return status;
}

Status SceneQueries::any(const ShapeRayBatch& rays, const SceneHitColumns& hits,
                         const SceneFilter& filter) {
  const DefaultFloatEnvironment environment;
  ObservedFilter observed(state_, filter);
  const Status status = find_many(state_, rays, observed.used(), true, hits);
  if (is_observed(status, state_)) state_->observer->rays(HitForm::any, rays, observed, hits);
  return status;
}

Answer<SceneHitLists> SceneQueries::all(const ShapeRayBatch& rays, const SceneFilter& filter) {
  const DefaultFloatEnvironment environment;
  Status status = check(state_, rays);
  if (status == Status::ok) status = start_all(*state_, rays.count);
  if (status != Status::ok) return status;
  ObservedFilter observed(state_, filter);
  RayGroups groups(rays);
  RayGroup<kRaysAtOnce> group(*state_, observed.used());
  for (auto some = groups.next(); !some.empty(); some = groups.next()) {
    group.start(some);
    status = group.find_all(groups.first());
    if (status != Status::ok) return status;
  }
  const Column<std::size_t>& first = state_->hits_first;
  const SceneHitLists lists{{state_->hits.data(), state_->hits.size()},
                            {first.data(), first.size()}};
  if (state_->observer != nullptr) state_->observer->rays(rays, observed, lists);
  return lists;
}

}  // namespace winnow
