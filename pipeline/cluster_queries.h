#pragma once

#include <winnow/core/export.h>
#include <winnow/core/filter.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/cluster_scene.h>
#include <winnow/pipeline/shape_rays.h>
#include <winnow/pipeline/shapes.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace winnow {

struct ClusterQueryState;

/// Hit of a ray on a body of any rank; see SceneHit.
struct ClusterHit {
  BodyName name = 0;                 ///< the body
  double t = 0.0;                    ///< parameter of the hit, in units of the direction
  Vec3d normal{};                    ///< unit normal of the surface, against the ray
  Vec3d point{};                     ///< point of the hit, in the world
  std::uint32_t part = kWholeShape;  ///< triangle or child; kWholeShape for a convex body
};

/// A body that overlaps a query shape; see SceneOverlap.
struct ClusterOverlap {
  BodyName name = 0;                 ///< the body
  std::uint32_t part = kWholeShape;  ///< one of its parts that overlap
};

/// Distance from a point to a body; see SceneDistance.
struct ClusterDistance {
  BodyName name = 0;                 ///< the body
  double distance = 0.0;             ///< negative inside a solid
  double error_bound = 0.0;          ///< the true distance is within distance +- this
  Vec3d normal{};                    ///< unit vector from the point to the body
  Vec3d point{};                     ///< closest point of the body, in the world
  std::uint32_t part = kWholeShape;  ///< closest part
};

/// A shape at a pose, for overlap queries.
struct ShapeProbe {
  ShapeId shape;  ///< convex or composite
  Pose pose;      ///< pose in the world
};

/// A point, for nearest-body queries.
struct NearestProbe {
  Vec3d point{};                                            ///< finite
  std::size_t count = 1;                                    ///< largest number of bodies
  double radius = std::numeric_limits<double>::infinity();  ///< largest distance; >= 0
};

/// Queries of one rank. The filter must not have a predicate (`unsupported`).
template <typename Query>
struct ClusterQueryBatch {
  std::span<const Query> queries;  ///< queries of that rank
  Filter filter{};                 ///< filter of all of them
};

/// Results of one rank: answers [first[i], first[i + 1]) belong to query i.
template <typename Answer>
struct ClusterResults {
  std::span<const Answer> answers;     ///< results of all queries, in the order of the queries
  std::span<const std::size_t> first;  ///< number of queries + 1 entries
};

/// Queries against the exact shapes of all ranks of a ClusterScene. Results equal, bit for bit, the
/// results of SceneQueries on one Scene to which the bodies were added in the order of their names.
/// Each hosted rank passes a batch of queries, possibly empty, and gets its own results. Queries
/// use the poses of the last `move` of each body: as in `collide`, bodies first move to the ranks
/// that own them.
///
/// All queries are collective: a rank without queries must make the call too. A batch with an
/// invalid query is refused as by SceneQueries; the other batches are computed. Results are valid
/// until the next query of the same kind.
class WINNOW_API ClusterQueries {
 public:
  /// Creates queries on `cluster`, which must outlive this object.
  explicit ClusterQueries(ClusterScene& cluster) noexcept;
  ~ClusterQueries();
  ClusterQueries(const ClusterQueries&) = delete;
  ClusterQueries& operator=(const ClusterQueries&) = delete;

  /// Finds the hit of least t of each ray; among equal t, the least name. A ray is sent to the
  /// ranks whose regions it crosses.
  Status closest(std::span<const ClusterQueryBatch<ShapeRay>> rays, std::span<Status> answers);
  /// Finds the first hit on every body that each ray hits, sorted by t, then by name.
  Status all(std::span<const ClusterQueryBatch<ShapeRay>> rays, std::span<Status> answers);
  /// Finds out for each ray whether it hits anything.
  Status any(std::span<const ClusterQueryBatch<ShapeRay>> rays, std::span<Status> answers);
  /// Finds every body that shares a point with each shape, sorted by name. A shape is sent to the
  /// ranks whose regions its box overlaps.
  Status overlap(std::span<const ClusterQueryBatch<ShapeProbe>> shapes, std::span<Status> answers);
  /// Finds the bodies nearest to each point, sorted by distance, then by name. A point is sent to
  /// all ranks.
  Status nearest(std::span<const ClusterQueryBatch<NearestProbe>> points,
                 std::span<Status> answers);

  /// Returns the results of the last `closest` or `all` of a hosted rank.
  [[nodiscard]] ClusterResults<ClusterHit> hits(std::uint32_t rank) const noexcept;
  /// Returns the results of the last `any` of a hosted rank: nonzero for each ray that hits
  /// something.
  [[nodiscard]] std::span<const std::uint8_t> blocked(std::uint32_t rank) const noexcept;
  /// Returns the results of the last `overlap` of a hosted rank.
  [[nodiscard]] ClusterResults<ClusterOverlap> overlaps(std::uint32_t rank) const noexcept;
  /// Returns the results of the last `nearest` of a hosted rank.
  [[nodiscard]] ClusterResults<ClusterDistance> neighbours(std::uint32_t rank) const noexcept;

 private:
  /// Null if memory was refused.
  ClusterQueryState* state_ = nullptr;
};

}  // namespace winnow
