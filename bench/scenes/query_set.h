#pragma once

#include <winnow/core/rays.h>
#include <winnow/core/regions.h>
#include <winnow/core/volumes.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Returns the bounds of all bounded boxes; a unit box if there are none.
[[nodiscard]] Aabb world_of(std::span<const Aabb> boxes) noexcept;

/// The result that each query of a set returns.
enum class QueryType {
  closest,  ///< ray or swept volume: the first object hit
  any,      ///< ray: whether it hits an object
  all,      ///< ray: all objects hit, sorted by distance
  overlap,  ///< box, ball or frustum: all objects that overlap it
  nearest,  ///< point: the `count` nearest objects
};

/// Queries of one kind about the same objects.
struct QuerySet {
  std::string name{};
  QueryType query_type = QueryType::closest;
  std::vector<Ray> rays{};
  std::vector<Aabb> boxes{};  ///< for `nearest`: points, as boxes of zero extent
  std::vector<Region> regions{};
  std::vector<Cast> casts{};
  std::size_t count = 0;  ///< number of objects that each query of `nearest` returns

  /// Returns the number of queries. Only one of the columns is filled.
  [[nodiscard]] std::size_t size() const noexcept {
    return rays.size() + boxes.size() + regions.size() + casts.size();
  }
};

/// An object that was found. t is the ray parameter of the hit, or the distance; 0 for an overlap.
struct Found {
  std::uint32_t row = 0;
  float t = 0.0F;

  friend bool operator==(const Found&, const Found&) noexcept = default;
};

/// Results of a run of queries.
class QueryResults {
 public:
  [[nodiscard]] std::size_t questions() const noexcept { return start_.size() - 1; }
  [[nodiscard]] std::span<const Found> of(std::size_t question) const noexcept {
    return std::span(found_).subspan(start_[question], start_[question + 1] - start_[question]);
  }

  void add(Found found) { found_.push_back(found); }
  /// Ends the results of the current query.
  void next() { start_.push_back(found_.size()); }

 private:
  std::vector<Found> found_;
  std::vector<std::size_t> start_{0};
};

/// Returns the number of queries whose results differ, of those that both ran. QueryType::any
/// compares only whether there is a hit. `rounding` is the largest relative difference of t; if it
/// is positive, hits with equal t may be in another order, and one of them may stand for another.
[[nodiscard]] std::size_t count_differing(QueryType query_type, const QueryResults& expected,
                                          const QueryResults& got, float rounding = 0.0F);

/// Returns the names of the query sets, in the order of reports.
[[nodiscard]] std::span<const std::string_view> query_set_names() noexcept;

/// Returns the set of a name about these boxes; the same seed gives the same queries. Rays start
/// uniformly in the bounds of the boxes and have uniform directions of unit length; all other
/// positions are uniform as well. Sizes and distances are relative to the mean edge of the boxes.
/// `rays` is the number of rays in a set, >= 1; sets of slower queries are smaller.
[[nodiscard]] QuerySet make_query_set(std::string_view name, std::span<const Aabb> boxes,
                                      std::size_t rays, std::uint64_t seed);
/// Returns all sets.
[[nodiscard]] std::vector<QuerySet> make_query_sets(std::span<const Aabb> boxes, std::size_t rays,
                                                    std::uint64_t seed);

}  // namespace winnow::bench
