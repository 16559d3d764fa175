#pragma once

// What questions to a scene are made of; see casts.cpp and scene_queries.cpp for the questions.

#include <winnow/pipeline/scene_queries.h>
#include "pipeline/composites/parts.h"
#include "pipeline/scene/scene_state.h"

#include <array>
#include <bit>

namespace winnow {

/// Where a ray meets a body: kNoObject if it meets none.
struct RayMeetsBody {
  std::uint32_t body;
  std::uint32_t part;
  double t;
  double normal[3];

  [[nodiscard]] static RayMeetsBody at(std::uint32_t body, std::uint32_t part, double t,
                                       const double (&normal)[3]) noexcept {
    return {body, part, t, {normal[0], normal[1], normal[2]}};
  }
  /// Takes another meeting if it is the first one by the limit, up to which the ray goes on then;
  /// with `any`, no farther.
  void improve(const RayMeetsBody& other, bool any, double& limit) noexcept {
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

/// The same of one of several rays.
struct RayHit {
  std::size_t ray;
  RayMeetsBody at;
};

/// Meshes that rays came to one by one, each as MidPhase::place made it ready where it stood. Of
/// two bodies that want the same place the later one is kept.
class RaySurfaces {
 public:
  /// That of a body where it stands now; null if it is no mesh.
  [[nodiscard]] const RaySurface* find(const PartTraversal& parts, const SceneState& scene,
                                       std::uint32_t body) {
    RaySurface& kept = kept_[body % kEntries];
    const ShapeId shape = scene.shape[body];
    const Pose& pose = scene.pose[body];
    if (kept.shape == shape && kept.revision == scene.composites_seen && is_same(kept.pose, pose)) {
      return &kept;
    }
    return parts.place({shape, pose}, kept) ? &kept : nullptr;
  }

 private:
  static constexpr std::size_t kEntries = 8;

  /// Bit by bit.
  [[nodiscard]] static bool is_same(const Pose& a, const Pose& b) noexcept {
    using Bits = std::array<std::uint64_t, sizeof(Pose) / sizeof(std::uint64_t)>;
    const auto of_a = std::bit_cast<Bits>(a);
    const auto of_b = std::bit_cast<Bits>(b);
    std::uint64_t differ = 0;
    for (std::size_t i = 0; i < of_a.size(); ++i) differ |= of_a[i] ^ of_b[i];
    return differ == 0;
  }

  RaySurface kept_[kEntries];
};

struct QueryState {
  QueryState(const SceneState& asked, std::pmr::memory_resource* memory) noexcept
      : scene(asked),
        parts(scene.shapes, scene.options.composites),
        boxes(memory),
        objects(memory),
        hits(memory),
        hits_first(memory),
        few(memory),
        overlaps(memory),
        distances(memory),
        bounds(memory),
        gaps(memory),
        overlapping(memory) {}

  const SceneState& scene;
  PartTraversal parts;
  RaySurfaces surfaces;
  /// What partitions find; bodies that they show are looked at at once, by their predicates.
  HitBuffer boxes;
  OverlapBuffer objects;
  /// Answers of the last question.
  Column<SceneHit> hits;
  /// Of a batch: where the hits of each ray begin, and the end.
  Column<std::size_t> hits_first;
  /// Those of rays that were asked together, before they are listed.
  Column<RayHit> few;
  Column<SceneOverlap> overlaps;
  Column<SceneDistance> distances;
  /// Boxes of the second of two sets, a column for each bound, and how far one body is from them.
  Column<float> bounds;
  Column<float> gaps;
  Column<KeyPair> overlapping;

  [[nodiscard]] PlacedShape placed(std::uint32_t body) const noexcept {
    return {scene.shape[body], scene.pose[body]};
  }
  /// What every question begins with.
  [[nodiscard]] static Status may_ask(const QueryState* state) noexcept {
    if (state == nullptr) return Status::out_of_memory;
    const SceneState& scene = state->scene;
    const MidPhase* const composites = scene.options.composites;
    const bool has_changed =
        composites != nullptr && composites->revision() != scene.composites_seen;
    return scene.is_fresh() && !has_changed ? Status::ok : Status::invalid_argument;
  }
  /// Calls ask(partition) for every set that has one, until it does not answer ok.
  template <typename Ask>
  [[nodiscard]] Status each_partition(Ask&& ask) const {
    for (const SceneSet& set : scene.sets) {
      if (!set.partition.has_value()) continue;
      if (const Status status = ask(*set.partition); status != Status::ok) return status;
    }
    return Status::ok;
  }
};

/// A caller's filter as the partitions take it: their client data are ids of bodies. Bodies that it
/// lets pass are shown to `Look`, bool(std::uint32_t body), whose answer the partition gets; so no
/// list of candidates is ever made.
template <typename Look>
class LookingFilter {
 public:
  LookingFilter(const SceneState& scene, const Filter& filter, Look& look) noexcept
      : scene_(scene), filter_(filter), look_(look) {}
  LookingFilter(const LookingFilter&) = delete;
  LookingFilter& operator=(const LookingFilter&) = delete;

  [[nodiscard]] Filter filter() noexcept {
    Filter result = filter_;
    result.predicate.context = this;
    result.predicate.accept = [](void* context, Key, ClientData body) {
      return static_cast<LookingFilter*>(context)->accept(static_cast<std::uint32_t>(body));
    };
    return result;
  }

  /// What the partition would do with a body of one whose box is met.
  void show(const Partition& partition, std::uint32_t body) const {
    ObjectFilter own;
    const Status status = partition.filter(scene_.place[body], own);
    if (status == Status::ok && may_meet(filter_.object(), own)) (void)accept(body);
  }

 private:
  [[nodiscard]] bool accept(std::uint32_t body) const noexcept {
    const ObjectPredicate& predicate = filter_.predicate;
    if (predicate.accept != nullptr &&
        !predicate.accept(predicate.context, scene_.keys.key_of(body),
                          scene_.keys.client_data(body))) {
      return false;
    }
    return look_(body);
  }

  const SceneState& scene_;
  const Filter& filter_;
  Look& look_;
};

}  // namespace winnow
