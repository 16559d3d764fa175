#pragma once

// A ray or a moving shape in the sets of a scene. Small sets, of at most four bodies, all
// composite, are tested directly, without their partitions (`test_small_sets`), as with a terrain.
// The partitions of all other sets (large sets) find the bodies whose boxes the moving box overlaps
// (see BoxPath for why none is missed) and call a predicate, which tests the exact shape by
// BodyContact (CastQuery).

#include "pipeline/scene/queries/box_path.h"
#include "pipeline/scene/queries/linear_casts.h"
#include "pipeline/scene/queries/queries.h"

namespace winnow {

inline constexpr std::size_t kMaxSmallSet = 4;

/// True for a set with at most kMaxSmallSet bodies, all composite: a traversal of its partition
/// is not worth its cost, because the bodies have their own trees.
[[nodiscard]] bool is_small_set(const SceneState& scene, const SceneSet& set) noexcept;

/// Calls test_body(body), whose result is ignored, for all bodies of small sets that pass the
/// filter. Returns true if there are large sets, whose partitions must be queried.
template <typename TestBody>
[[nodiscard]] bool test_small_sets(const SceneState& scene, const SceneFilter& filter,
                                   TestBody& test_body) {
  const BodyCandidateFilter body_filter(scene, filter, test_body);
  bool has_large_set = false;
  for (const SceneSet& set : scene.sets) {
    if (!is_small_set(scene, set)) {
      has_large_set = has_large_set || set.partition.has_value();
      continue;
    }
    for (std::size_t id = 0; id < set.body_of.size(); ++id) {
      // Ids of removed objects keep their entry; skip them.
      const std::uint32_t body = set.body_of[id];
      if (scene.place[body].id == id) body_filter.test(*set.partition, body);
    }
  }
  return has_large_set;
}

/// Sorts the hits from `before` on and removes duplicates: a body whose box extends over two pieces
/// of the path is found in both.
void order_hits(Column<SceneHit>& hits, std::size_t before) noexcept;

/// Results for bodies that were tested and may be found again, because a partition calls the
/// predicate once per traversal and piece of the path. The cache is direct-mapped: if two bodies
/// have the same entry, the later one stays.
class ResultCache {
 public:
  /// Returns the result for the body, or null.
  [[nodiscard]] const bool* find(std::uint32_t body) const noexcept {
    const std::size_t at = body % kEntries;
    return (used_ >> at & 1U) != 0 && entries_[at].body == body ? &entries_[at].is_hit : nullptr;
  }
  bool note(std::uint32_t body, bool is_hit) noexcept {
    const std::size_t at = body % kEntries;
    used_ |= std::uint64_t{1} << at;
    entries_[at] = {body, is_hit};
    return is_hit;
  }

 private:
  static constexpr std::size_t kEntries = 64;
  struct Entry {
    std::uint32_t body;
    bool is_hit;
  };
  std::uint64_t used_ = 0;
  Entry entries_[kEntries];
};

/// Callback for the bodies whose boxes a cast hits.
struct BodyVisitor {
  void (*visit)(void* context, std::uint32_t body) = nullptr;
  void* context = nullptr;

  /// Makes a visitor that calls visit(body).
  template <typename Visit>
  [[nodiscard]] static BodyVisitor of(Visit& visit) noexcept {
    return {[](void* called, std::uint32_t body) { (*static_cast<Visit*>(called))(body); }, &visit};
  }
};

/// One query: a linear cast in the scene.
class CastQuery {
 public:
  CastQuery(QueryState& state, const LinearCast& linear_cast, const SceneFilter& filter) noexcept
      : state_(state), linear_cast_(linear_cast), filter_(filter), limit_(linear_cast.max_t()) {}

  // For moving shapes: small and large sets.
  Status closest(SceneHit& hit);
  /// Appends the hits to the results.
  Status all();
  /// Calls the visitor for all bodies that pass the filter and whose boxes the cast hits; in large
  /// sets maybe more than once.
  Status visit_all(const BodyVisitor& visitor);

  // For rays, which are tested on small sets in groups (ray_query.cpp): only large sets.
  /// Small sets contain the hits from `before` on.
  Status all_in_large_sets(std::size_t before);
  /// `found_before` is the hit in small sets; its body is kNoObject if there is none. Leaves `hit`
  /// unchanged unless there is a better one.
  Status closest_in_large_sets(const BodyRayHit& found_before, SceneHit& hit);
  Status any_in_large_sets(SceneHit& hit);

 private:
  [[nodiscard]] BoxPath box_path() const noexcept;
  [[nodiscard]] bool found() const noexcept { return body_ != kNoObject; }
  [[nodiscard]] bool find_contact(std::uint32_t body, double limit, bool any,
                                  BodyContact& contact) const noexcept {
    return contact.find(state_.parts, linear_cast_, state_.placed(body), limit, any);
  }
  [[nodiscard]] SceneHit hit_of(std::uint32_t body, const BodyContact& contact) const noexcept;
  Status closest_in_large_sets();
  Status visit_large_sets(const BodyVisitor& visitor);
  /// Returns true if this body becomes the closest hit.
  bool improves(std::uint32_t body) noexcept;
  /// Appends the body's hit if there is one and the body was not tested before; returns false if
  /// memory is refused.
  [[nodiscard]] bool adds(std::uint32_t body);
  /// Calls query(partition) for each large set until a call does not return ok.
  template <typename Query>
  [[nodiscard]] Status each_large_set(Query&& query) const;
  template <typename TestBody>
  [[nodiscard]] Status test_rest(const Partition& partition, const BoxPath& path,
                                 TestBody& test_body);

  QueryState& state_;
  const LinearCast& linear_cast_;
  const SceneFilter& filter_;
  /// The body of the earliest hit so far, or kNoObject; and the largest t that still counts, which
  /// is the time of that hit or, at first, the end of the path.
  std::uint32_t body_ = kNoObject;
  double limit_;
  BodyContact best_;
  ResultCache tested_;
};

}  // namespace winnow
