#pragma once

// Bodies distributed over ranks (processes), and their contacts. Each rank has a Scene; ranks
// communicate through a Transport (cluster_transport.h). The implementation is in cluster/.

#include <winnow/core/export.h>
#include <winnow/core/filter.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/cluster.h>
#include <winnow/pipeline/cluster_transport.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/shape_rays.h>
#include <winnow/pipeline/shapes.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace winnow {

struct ClusterSceneState;

/// Bodies to be added by one rank.
struct ClusterSceneBatch {
  std::span<const BodyName> names;         ///< names not in use
  std::span<const BodyDefinition> bodies;  ///< one per name; client data are ignored
};

/// Options of a cluster of scenes, fixed at construction.
struct ClusterSceneOptions {
  /// Options of the scene of each rank. `cache_tolerance` must be 0, `warm_start` and
  /// `suppress_ghost_contacts` must be false, `recorder` must be null; otherwise the status of the
  /// cluster is `invalid_argument`.
  SceneOptions scene{};
  /// See ClusterOptions::imbalance.
  double imbalance = 1.1;
};

/// Bodies with shapes and poses distributed over any number of ranks, and the contacts between
/// them. The contacts equal, bit for bit, the contacts of one Scene to which the same bodies were
/// added in the order of their names. Each contact is on one rank. This holds for any number of
/// ranks, any partitioning of space, and while bodies migrate.
///
///     winnow::ClusterScene cluster(transport, shapes);
///     cluster.replicate(ground_names, ground);   // the same on every process
///     cluster.add(batches, answers);             // one batch for each hosted rank
///     cluster.collide(winnow::ContactLevel::manifold);
///     const winnow::Contacts& contacts = cluster.contacts(rank);  // client data are names
///
/// Bodies are distributed like the boxes of a Cluster, by the boxes around their shapes, enlarged
/// by half of the margin. Bodies that many others touch, such as the ground, can be replicated:
/// they are on every rank and never sent, and their contacts are reported by the rank that owns the
/// other body. ShapeIds are the same everywhere: each process must create the same shapes in the
/// same order. Boxes are relative to (0, 0, 0). Results at level pairs therefore equal the results
/// of a Scene only if the origin of the Scene is (0, 0, 0) too; results at the other levels do not
/// depend on the origin. Bodies are fixed or dynamic; none sleeps.
///
/// Collective calls, refused calls and failures work as in Cluster.
class WINNOW_API ClusterScene {
 public:
  /// Creates an empty cluster. `transport`, `shapes` and everything that the options point to must
  /// outlive it. Collective.
  ClusterScene(Transport& transport, const ShapePool& shapes,
               const ClusterSceneOptions& options = {}) noexcept;
  ~ClusterScene();
  ClusterScene& operator=(ClusterScene&&) = delete;  // neither copied nor moved

  /// Returns `ok`; `invalid_argument` for options out of range; or the error that ended the
  /// cluster.
  [[nodiscard]] Status status() const noexcept;
  /// Returns the number of ranks of all processes.
  [[nodiscard]] std::uint32_t ranks() const noexcept;
  /// Returns the first rank that this process hosts.
  [[nodiscard]] std::uint32_t first_hosted() const noexcept;
  /// Returns the number of ranks that this process hosts.
  [[nodiscard]] std::uint32_t hosted() const noexcept;

  /// Adds a batch, possibly empty, on each hosted rank, and returns a status for each: errors of
  /// Scene::add; `unsupported` for a body that sleeps or has offsets or a layer; `invalid_key` also
  /// if a name is in use on any rank, or is added by two ranks in this call (both batches are then
  /// refused). A refused batch adds nothing; the other batches are added. Collective; O(bodies
  /// added), in four exchanges.
  Status add(std::span<const ClusterSceneBatch> batches, std::span<Status> answers);
  /// Adds bodies to every rank, all or none. Every process must pass the same bodies, otherwise all
  /// get `invalid_argument`. Other errors as for `add`. The bodies are fixed (`unsupported` for
  /// others) and cannot be removed. Collective; O(bodies added) on each rank.
  Status replicate(const ClusterSceneBatch& batch);
  /// Sets the poses of replicated bodies, all or none. Every process must pass the same ones,
  /// otherwise all get `invalid_argument`. `invalid_key` for any other body. Collective.
  Status move_replicated(std::span<const BodyName> names, std::span<const Pose> poses);

  /// Sets the poses of bodies that `rank` owns, all or none: `invalid_key` for any other name, or a
  /// name that occurs twice; `invalid_pose`; `size_mismatch`. Takes effect with the next `collide`.
  Status move(std::uint32_t rank, std::span<const BodyName> names, const PoseView& poses);
  /// As above, by keys, which avoids the lookup of names. If a key occurs twice, its last pose is
  /// used.
  Status move(std::uint32_t rank, std::span<const Key> keys, const PoseView& poses);
  /// Removes bodies that `rank` owns, all or none; `invalid_key` as above.
  Status remove(std::uint32_t rank, std::span<const BodyName> names);

  /// Finds all contacts. First, bodies move to the ranks that own them, and copies are sent to the
  /// ranks whose regions their boxes overlap. If the previous frame was unbalanced (see
  /// ClusterOptions), space is partitioned again before that. Collective.
  Status collide(ContactLevel level);
  /// Returns the contacts that a hosted rank reports; all ranks together report all contacts. Pairs
  /// are sorted by the kinds of their shapes, then by name. In a pair, a is the body with the
  /// smaller kind of shape, or with the smaller name if the kinds are equal. Client data are names;
  /// keys are local to the rank. Events are the same as in a single process, even if another rank
  /// reported the pair in the previous frame. An ended pair is reported by the rank that reported
  /// it last, with null keys for bodies that it no longer has. Valid until the next collective
  /// call; empty for a rank of another process.
  [[nodiscard]] const Contacts& contacts(std::uint32_t rank) const noexcept;
  /// Computes the digest of all contacts (see `digest_of`), which is the same for any number of
  /// ranks. Collective; O(contacts).
  Answer<ClusterDigest> digest();

  /// Appends a checkpoint of a hosted rank: its bodies, and which pairs touched, so that events
  /// continue. Replicated bodies are not included. O(bodies + pairs).
  Status save(std::uint32_t rank, std::vector<std::byte>& bytes) const;
  /// Adds the bodies of checkpoints, written by any number of ranks: each hosted rank passes the
  /// bytes of some or none of them, one after another, and gets a status as from `add`, or
  /// `invalid_argument` for bytes that `save` did not write. Replicate the replicated bodies again
  /// before the first `collide`. Its results, including events, are then the same as in an
  /// uninterrupted run. Collective.
  Status restore(std::span<const std::span<const std::byte>> bytes, std::span<Status> answers);

  /// Returns the number of bodies that a hosted rank owns.
  [[nodiscard]] std::size_t size(std::uint32_t rank) const noexcept;
  /// Writes the bodies that a hosted rank owns, in no particular order; `size_mismatch` unless
  /// there are `size(rank)` entries. O(size).
  Status bodies(std::uint32_t rank, std::span<ClusterBody> bodies) const;
  /// Returns the key of a body that `rank` owns; `invalid_key` if it owns no body of this name.
  /// O(1).
  Answer<Key> key_of(std::uint32_t rank, BodyName name) const noexcept;
  /// Returns the current state of a body that `rank` owns; its client data are its name. O(1).
  Answer<BodyDefinition> body(std::uint32_t rank, BodyName name) const noexcept;
  /// Returns the bodies that a hosted rank owns since the last `collide` or query of
  /// ClusterQueries: new ones, and bodies from other ranks.
  [[nodiscard]] std::span<const ClusterBody> arrived(std::uint32_t rank) const noexcept;
  /// Returns the names of the bodies that moved to other ranks in that call.
  [[nodiscard]] std::span<const BodyName> departed(std::uint32_t rank) const noexcept;

  /// Returns the current counters. `pairs` counts pairs that touch; `ghosts` does not count
  /// replicated bodies.
  [[nodiscard]] const ClusterStatistics& statistics() const noexcept;
  /// Returns the bytes of scenes, bodies and contacts of the hosted ranks.
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  friend class ClusterQueries;

  /// Null if memory was refused.
  ClusterSceneState* state_ = nullptr;
};

/// Computes a digest of contacts whose client data are the names of the bodies. It covers all bits
/// of pairs, parts, distances, normals and points, in any order of the pairs, but no events.
/// Digests of contacts that have no pair in common add up (each half, modulo 2^64) to the digest of
/// all. O(contacts).
[[nodiscard]] WINNOW_API ClusterDigest digest_of(const Contacts& contacts) noexcept;

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

/// Queries of one rank. The filter must not have a layer, an ignored body or a predicate
/// (`unsupported`).
template <typename Query>
struct ClusterQueryBatch {
  std::span<const Query> queries;  ///< queries of that rank
  SceneFilter filter{};            ///< filter of all of them
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
  ClusterQueries& operator=(ClusterQueries&&) = delete;  // neither copied nor moved

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
