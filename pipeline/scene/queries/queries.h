#pragma once

// Shared by the queries of a scene: the state of SceneQueries, filters and ray hits.
// ray_query.cpp, crossings.cpp, shape_cast_query.cpp, scene_queries.cpp, motion_casts.cpp and
// set_distance.cpp implement the queries.

#include <winnow/pipeline/scene_queries.h>
#include "pipeline/composites/mid_phase.h"
#include "pipeline/composites/parts.h"
#include "pipeline/scene/scene_observer.h"
#include "pipeline/scene/scene_state.h"

namespace winnow {

class QueryObserver;

/// A ray's hit on a body; `body` is kNoObject if there is none.
struct BodyRayHit {
  std::uint32_t body;
  std::uint32_t part;
  double t;
  double normal[3];

  [[nodiscard]] static BodyRayHit of(std::uint32_t body, const PartHit& hit) noexcept {
    return {body, hit.part, hit.t, {hit.normal[0], hit.normal[1], hit.normal[2]}};
  }
  /// Replaces this hit with `other` if `other` is within the limit and earlier, or equally early
  /// with a lower body id or part. Lowers the limit to the t of `other`, or with `any` to below
  /// zero, which ends the query.
  void improve(const BodyRayHit& other, bool any, double& limit) noexcept {
    if (other.t > limit) return;
    // Equal t are ordered by the bodies' ids, then by part.
    if (body != kNoObject && other.t == t &&
        (body != other.body ? body < other.body : part < other.part)) {
      return;
    }
    *this = other;
    limit = any ? -1.0 : other.t;
  }
};

/// A hit of one ray of several.
struct RayHit {
  std::size_t ray;
  BodyRayHit at;
};

/// Meshes that mid::cast_rays prepared for single rays, in a small direct-mapped cache.
class RaySurfaces {
 public:
  [[nodiscard]] RaySurface& of(std::uint32_t body) noexcept { return kept_[body % kEntries]; }

 private:
  static constexpr std::size_t kEntries = 8;
  RaySurface kept_[kEntries];
};

struct QueryState {
  QueryState(const SceneState& queried, std::pmr::memory_resource* memory) noexcept
      : scene(queried),
        observer(queried.observer == nullptr ? nullptr : &queried.observer->queries()),
        parts(scene.shapes, scene.options.composites),
        boxes(memory),
        objects(memory),
        hits(memory),
        hits_first(memory),
        small_set_hits(memory),
        crossings(memory),
        overlaps(memory),
        distances(memory),
        bounds(memory),
        gaps(memory),
        overlapping(memory),
        accepted(memory) {}

  const SceneState& scene;
  /// Null if the scene is not recorded.
  QueryObserver* const observer;
  SubShapeQuery parts;
  RaySurfaces surfaces;
  /// Results of the partitions. Bodies are tested inside the partition's query, by
  /// BodyCandidateFilter.
  HitBuffer boxes;
  OverlapBuffer objects;
  /// Results of the last query.
  Column<SceneHit> hits;
  /// For a batch of rays: where the hits of each ray begin, and the end.
  Column<std::size_t> hits_first;
  /// Hits of a group of rays on the bodies of small sets (cast_query.h), before they are sorted by
  /// ray.
  Column<RayHit> small_set_hits;
  Column<SceneCrossing> crossings;
  Column<SceneOverlap> overlaps;
  Column<SceneDistance> distances;
  /// Boxes of the second set of bodies, one column for each bound, and their squared distances from
  /// one body's box.
  Column<float> bounds;
  Column<float> gaps;
  Column<KeyPair> overlapping;
  /// Bodies that the predicate of the current query accepted, if the scene is recorded.
  Column<ObjectId> accepted;

  /// Bytes of results and scratch, without the object itself.
  [[nodiscard]] Footprint footprint() const noexcept;
  [[nodiscard]] PlacedShape placed(std::uint32_t body) const noexcept {
    return {scene.shape[body], scene.pose[body]};
  }
  /// The check that every query begins with: refuses a scene that changed after its last refresh.
  [[nodiscard]] static Status check_state(const QueryState* state) noexcept {
    if (state == nullptr) return Status::out_of_memory;
    const SceneState& scene = state->scene;
    const CompositePool* const composites = scene.options.composites;
    const bool has_changed =
        composites != nullptr && composites->revision() != scene.composites_seen;
    return scene.is_up_to_date() && !has_changed ? Status::ok : Status::invalid_argument;
  }
  /// Calls query(partition) for each partition until a call does not return ok.
  template <typename Query>
  [[nodiscard]] Status each_partition(Query&& query) const {
    for (const SceneSet& set : scene.sets) {
      if (!set.partition.has_value()) continue;
      if (const Status status = query(*set.partition); status != Status::ok) return status;
    }
    return Status::ok;
  }
};

/// Implements SceneQueries::overlap (scene_queries.cpp).
[[nodiscard]] Answer<std::span<const SceneOverlap>> find_overlaps(QueryState& state, ShapeId shape,
                                                                  const Pose& pose,
                                                                  const SceneFilter& filter);

/// Returns whether the layer, the ignored body and the predicate of a filter let a body pass.
[[nodiscard]] inline bool passes(const SceneState& scene, const SceneFilter& filter,
                                 std::uint32_t body) noexcept {
  if (filter.layer != kEveryLayer &&
      !scene.rules.layers.collide(filter.layer, scene.rules.layer_of(body)))
    return false;
  if (filter.ignored.id == body && filter.ignored == scene.keys.key_of(body)) return false;
  const ObjectPredicate& predicate = filter.predicate;
  return predicate.accept == nullptr ||
         predicate.accept(predicate.context, scene.keys.key_of(body), scene.keys.client_data(body));
}

/// Converts the caller's filter to one for partitions, whose client data are ids of bodies. Calls
/// `TestBody`, bool(std::uint32_t body), for each body that passes, and returns the result to the
/// partition. So no list of candidates is needed.
template <typename TestBody>
class BodyCandidateFilter {
 public:
  BodyCandidateFilter(const SceneState& scene, const SceneFilter& filter,
                      TestBody& test_body) noexcept
      : scene_(scene), filter_(filter), test_body_(test_body) {}
  BodyCandidateFilter(const BodyCandidateFilter&) = delete;
  BodyCandidateFilter& operator=(const BodyCandidateFilter&) = delete;

  [[nodiscard]] Filter filter() noexcept {
    return {filter_.layers,
            filter_.mask,
            filter_.environment,
            {[](void* context, Key, ClientData body) {
               return static_cast<BodyCandidateFilter*>(context)->accept(
                   static_cast<std::uint32_t>(body));
             },
             this}};
  }

  /// Applies the filters to a body without a query of its partition, as if its box were hit.
  void test(const Partition& partition, std::uint32_t body) const {
    const Answer<ObjectFilter> own = partition.filter(scene_.place[body]);
    if (own.status == Status::ok && filters_allow(filter_.object(), own)) (void)accept(body);
  }

 private:
  [[nodiscard]] bool accept(std::uint32_t body) const noexcept {
    return passes(scene_, filter_, body) && test_body_(body);
  }

  const SceneState& scene_;
  const SceneFilter& filter_;
  TestBody& test_body_;
};

}  // namespace winnow
