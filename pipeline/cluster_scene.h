#pragma once

#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
#include <winnow/core/pose.h>
#include <winnow/core/pose_view.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/cluster.h>
#include <winnow/pipeline/cluster_transport.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace winnow {

struct ClusterSceneState;

/// Bodies that one rank adds.
struct ClusterSceneBatch {
  std::span<const BodyName> names;         ///< new ones
  std::span<const BodyDefinition> bodies;  ///< one of each; their client data are not looked at
};

/// What a cluster of scenes is made with.
struct ClusterSceneOptions {
  /// Of each rank's scene. Contacts are not carried over, and where they were is not told:
  /// `carry_over` is 0, `warm_start` and `seamless_floors` are off.
  SceneOptions scene{};
  /// As ClusterOptions::imbalance.
  double imbalance = 1.1;
};

/// Bodies with shapes and poses on any number of ranks, and what touches what: the contacts of one
/// Scene to which the same bodies were added in the order of their names, bit for bit, each on one
/// rank, whatever the number of ranks, wherever space is cut and whoever migrates.
///
///     winnow::ClusterScene cluster(transport, shapes);
///     cluster.replicate(ground_names, ground);   // on every process the same
///     cluster.add(batches, answers);             // on each rank what it has
///     cluster.collide(winnow::ContactLevel::manifold);
///     const winnow::Contacts& contacts = cluster.contacts(rank);  // client data are names
///
/// Bodies go where they belong as those of a Cluster do, by the boxes around their shapes, grown by
/// half of the margin. What many bodies meet is replicated: it is on every rank, is sent to none,
/// and its contacts are reported where the other body belongs. ShapeIds are the same everywhere:
/// each process has made the same shapes in the same order. Boxes are measured from (0, 0, 0), so
/// that at level pairs a Scene finds the same where its own origin is there; no other level depends
/// on it. Bodies are fixed or dynamic; none sleeps.
///
/// Collective calls, refusals and failures are as those of a Cluster.
class WINNOW_API ClusterScene {
 public:
  /// An empty cluster. `transport`, `shapes` and what the options name must outlive it. Collective.
  ClusterScene(Transport& transport, const ShapePool& shapes,
               const ClusterSceneOptions& options = {}) noexcept;
  ~ClusterScene();
  ClusterScene(const ClusterScene&) = delete;
  ClusterScene& operator=(const ClusterScene&) = delete;

  /// `ok`; `invalid_argument` for options out of range; or what ended the cluster.
  [[nodiscard]] Status status() const noexcept;
  /// Of all processes.
  [[nodiscard]] std::uint32_t ranks() const noexcept;
  /// The first that this process hosts.
  [[nodiscard]] std::uint32_t first_hosted() const noexcept;
  /// How many it hosts.
  [[nodiscard]] std::uint32_t hosted() const noexcept;

  /// Adds a batch on each hosted rank, which may be empty, and answers each: as Scene::add;
  /// `unsupported` for a body that sleeps or has offsets or a layer; `invalid_key` also where a
  /// name is there already, on whatever rank, or another rank adds it in this call (then both are
  /// refused). A batch that is refused adds nothing; others do. Collective; O(bodies added), in
  /// four exchanges.
  Status add(std::span<const ClusterSceneBatch> batches, std::span<Status> answers);
  /// Adds bodies that are on every rank, or none: every process gives the same ones, else
  /// `invalid_argument` on all. Otherwise as `add`. They are fixed (`unsupported` for others) and
  /// stay. Collective; O(bodies added) on each rank.
  Status replicate(const ClusterSceneBatch& batch);
  /// Gives replicated bodies new poses, all or none: every process gives the same ones, else
  /// `invalid_argument` on all; `invalid_key` for any other body. Collective.
  Status move_replicated(std::span<const BodyName> names, std::span<const Pose> poses);

  /// Gives bodies that belong to `rank` new poses, all or none: `invalid_key` for any other, and
  /// where one is named twice; `invalid_pose`; `size_mismatch`. Counts from the next `collide` on.
  Status move(std::uint32_t rank, std::span<const BodyName> names, const PoseView& poses);
  /// The same by keys, which saves looking for names. Of one that is there twice the last pose
  /// counts.
  Status move(std::uint32_t rank, std::span<const Key> keys, const PoseView& poses);
  /// Removes bodies that belong to `rank`, all or none; `invalid_key` as above.
  Status remove(std::uint32_t rank, std::span<const BodyName> names);

  /// Finds everything that touches. Before, bodies go where they belong, and copies to where they
  /// are met; after a frame that was out of balance space is cut anew first. Collective.
  Status collide(ContactLevel level);
  /// What a hosted rank reports; together, the ranks' are all. Pairs are sorted by the kinds of
  /// their shapes and then by name; in a pair, a is the body with the smaller kind of shape, or the
  /// smaller name. Client data are names; keys are the rank's own. Whether a pair has begun or
  /// ended is told as if one process had seen it all, also when another rank reported it before: of
  /// a pair that ended by the rank that did, with null keys of bodies that it has no more. Valid
  /// until the next collective call; empty for a rank of another process.
  [[nodiscard]] const Contacts& contacts(std::uint32_t rank) const noexcept;
  /// Of all contacts, as `digest_of`: the same on 1 to N ranks. Collective; O(contacts).
  Status digest(ClusterDigest& digest);

  /// Appends all that is to be kept of a hosted rank: its bodies, and which pairs touched, so that
  /// events go on. Not what is replicated. O(bodies + pairs).
  Status save(std::uint32_t rank, std::vector<std::byte>& bytes) const;
  /// Adds what ranks of any number kept: each hosted rank takes the bytes of some or of none, one
  /// after the other, and is answered as by `add`, or `invalid_argument` for bytes that `save` did
  /// not write. What is replicated is replicated again before the first `collide`, which then finds
  /// what it would have found without the break, events included. Collective.
  Status restore(std::span<const std::span<const std::byte>> bytes, std::span<Status> answers);

  /// How many bodies belong to a hosted rank.
  [[nodiscard]] std::size_t size(std::uint32_t rank) const noexcept;
  /// The bodies of a hosted rank, in no order; `size_mismatch` unless there are `size(rank)`
  /// entries. O(size).
  Status bodies(std::uint32_t rank, std::span<ClusterBody> bodies) const;
  /// The key of a body that belongs to `rank`; `invalid_key` if none of this name does. O(1).
  Status key_of(std::uint32_t rank, BodyName name, Key& key) const noexcept;
  /// A body that belongs to `rank`, as it stands; its client data are its name. O(1).
  Status body(std::uint32_t rank, BodyName name, BodyDefinition& body) const noexcept;
  /// Bodies that the last `collide`, or question of ClusterQueries, made a hosted rank's: new ones,
  /// and those of other ranks.
  [[nodiscard]] std::span<const ClusterBody> arrived(std::uint32_t rank) const noexcept;
  /// Names of those that it made another rank's.
  [[nodiscard]] std::span<const BodyName> departed(std::uint32_t rank) const noexcept;

  /// Counters as they stand; pairs are those that touch, ghosts leave out what is replicated.
  [[nodiscard]] const ClusterStatistics& statistics() const noexcept;
  /// Bytes that the scenes, bodies and contacts of hosted ranks take.
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  friend class ClusterQueries;

  /// Null where memory was refused.
  ClusterSceneState* state_ = nullptr;
};

/// What tells the contacts of bodies whose client data are their names from any others: their
/// pairs, parts, distances, normals and points, every bit of them, whatever order pairs are in, but
/// no events. Digests of contacts that have no pair in common add up (each half, modulo 2^64) to
/// that of all. O(contacts).
[[nodiscard]] WINNOW_API ClusterDigest digest_of(const Contacts& contacts) noexcept;

}  // namespace winnow
