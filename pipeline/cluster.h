#pragma once

// Boxes distributed over ranks (processes): the broad phase of a cluster. Ranks communicate through
// a Transport (cluster_transport.h); ClusterScene (cluster_scene.h) adds shapes and contacts. The
// implementation is in cluster/.

#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/indexed_view.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include <winnow/core/results.h>
#include <winnow/core/status.h>
#include <winnow/core/volumes.h>
#include <winnow/partitions/partition.h>
#include <winnow/partitions/structures.h>
#include <winnow/pipeline/cluster_transport.h>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct ClusterState;

/// Name of a body on every rank: chosen by the caller, unique within a cluster.
using BodyName = std::uint64_t;

/// Names of two bodies whose boxes overlap, first < second.
struct NamePair {
  BodyName first = 0;   ///< the smaller name
  BodyName second = 0;  ///< the larger name

  /// Orders by the first name, then by the second.
  friend constexpr auto operator<=>(const NamePair&, const NamePair&) noexcept = default;
};

namespace detail {

/// Function that returns the names of a pair of local body numbers, the smaller one first.
struct NamePairLookup {
  const Pair* pairs = nullptr;      ///< pairs of body numbers
  const BodyName* names = nullptr;  ///< by body number

  [[nodiscard]] NamePair operator()(std::size_t i) const noexcept {
    const BodyName a = names[pairs[i].first];
    const BodyName b = names[pairs[i].second];
    return a < b ? NamePair{a, b} : NamePair{b, a};
  }
};

}  // namespace detail

/// Pairs that a rank reports. Used like a span. The rank stores a pair as two local body numbers (8
/// bytes); names are looked up only when a pair is read.
using NamePairs = IndexedView<detail::NamePairLookup>;

/// A body on the rank that owns it.
struct ClusterBody {
  BodyName name = 0;  ///< name on all ranks
  Key key;            ///< key on the owning rank, valid while it owns the body
};

/// Bodies to be added by one rank.
struct ClusterBatch {
  std::span<const BodyName> names;  ///< names not in use
  BoxView boxes;                    ///< one box per name
};

/// 128-bit digest of a set of pairs.
struct ClusterDigest {
  std::uint64_t high = 0;  ///< sum of a hash over all pairs
  std::uint64_t low = 0;   ///< sum of a second hash

  /// True if both halves are equal, as they are for equal sets of pairs.
  friend constexpr bool operator==(const ClusterDigest&, const ClusterDigest&) noexcept = default;
};

/// Options of a cluster, fixed at construction.
struct ClusterOptions {
  /// Source of the memory for partitions and bodies of hosted ranks. It must outlive the cluster.
  std::pmr::memory_resource* memory = default_memory();
  /// How the partition of each rank runs work in parallel.
  Execution execution = Execution::parallel();
  /// Structure of the partition of each rank.
  StructureKind structure = linear_bvh();
  /// Largest accepted load imbalance. After a frame in which the work of the busiest rank exceeds
  /// this multiple of the mean, space is partitioned again. If a repartitioning reduces the
  /// imbalance by less than 2 %, the next one waits until the imbalance has grown by more than 5 %.
  /// At least 1.
  double imbalance = 1.1;
};

/// Counters of all ranks, equal on every rank. They contain no timings. Messages are counted from
/// the previous `self_pairs` to the end of the last one, including messages of `add`.
struct ClusterStatistics {
  std::uint64_t bodies = 0;    ///< bodies, each counted once
  std::uint64_t ghosts = 0;    ///< copies of bodies on ranks that do not own them
  std::uint64_t pairs = 0;     ///< pairs, each counted once
  std::uint64_t bytes = 0;     ///< bytes sent between ranks
  std::uint64_t messages = 0;  ///< messages sent between ranks
  std::uint64_t migrated = 0;  ///< bodies whose owning rank changed
  std::uint64_t cuts = 0;      ///< number of repartitionings so far
  /// Work of the busiest rank divided by the mean. The work of a rank is the number of boxes that
  /// it stores plus the number of pairs that it finds.
  double imbalance = 1.0;
};

/// Boxes distributed over any number of ranks, and the overlaps between them. The pairs are the
/// same as in a single Partition of all boxes, each reported once, for any number of ranks and any
/// partitioning of space.
///
///     winnow::LoopbackTransport transport(64);  // or make_mpi_transport: one rank in each process
///     winnow::Cluster cluster(transport);
///     cluster.add(batches, answers);
///     cluster.self_pairs();
///     for (const winnow::NamePair pair : cluster.pairs(rank)) ...
///
/// The rank whose region contains the centre of a body owns the body; only this rank moves and
/// removes it. A body is copied (as a ghost) to every rank whose region its box overlaps, so there
/// is no halo width to choose, and boxes may be of any size. A copy is sent again only if the box
/// moved. Two overlapping boxes share the point whose coordinates are the larger of their low
/// corners on each axis; the rank whose region contains this point stores both boxes, and only this
/// rank reports the pair (reference point method, Dittrich and Seeger 2000).
///
/// Collective calls must be made by every process, in the same order; other calls concern one rank.
/// A failed call changes nothing on any rank. If a collective call returns `communication_failed`,
/// or `out_of_memory` on any rank, all ranks get an error, and every later call on the cluster
/// returns this error. Nothing throws.
class WINNOW_API Cluster {
 public:
  /// Creates an empty cluster on the ranks of `transport`, which must outlive it. Collective.
  explicit Cluster(Transport& transport, const ClusterOptions& options = {}) noexcept;
  ~Cluster();
  Cluster& operator=(Cluster&&) = delete;  // neither copied nor moved

  /// Returns `ok`; `invalid_argument` for options out of range; or the error that ended the
  /// cluster.
  [[nodiscard]] Status status() const noexcept;
  /// Returns the number of ranks of all processes.
  [[nodiscard]] std::uint32_t ranks() const noexcept;
  /// Returns the first rank that this process hosts.
  [[nodiscard]] std::uint32_t first_hosted() const noexcept;
  /// Returns the number of ranks that this process hosts.
  [[nodiscard]] std::uint32_t hosted() const noexcept;

  /// Adds a batch, possibly empty, on each hosted rank, and returns a status for each:
  /// `invalid_bounds`; `size_mismatch`; `invalid_key` if a name is in use on any rank, or is added
  /// by two ranks in this call (both batches are then refused). A refused batch adds nothing; the
  /// other batches are added. The rank that added a body owns it until the next `self_pairs`.
  /// Collective; O(bodies added), in four exchanges.
  Status add(std::span<const ClusterBatch> batches, std::span<Status> answers);

  /// Sets the boxes of bodies that `rank` owns, all or none: `invalid_key` for any other name, or a
  /// name that occurs twice; `invalid_bounds`; `size_mismatch`. Takes effect with the next
  /// `self_pairs`.
  Status move(std::uint32_t rank, std::span<const BodyName> names, const BoxView& boxes);
  /// As above, by keys. This avoids the lookup of names and is fastest if ids ascend. If a key
  /// occurs twice, its last box is used.
  Status move(std::uint32_t rank, std::span<const Key> keys, const BoxView& boxes);
  /// Removes bodies that `rank` owns, all or none; `invalid_key` as above.
  Status remove(std::uint32_t rank, std::span<const BodyName> names);

  /// Finds all pairs. First, bodies move to the ranks that own them, and copies are sent to the
  /// ranks whose regions their boxes overlap. If the previous frame was unbalanced (see
  /// ClusterOptions), space is partitioned again before that. Collective.
  Status self_pairs(Order order = Order::fast);
  /// Returns the pairs that a hosted rank reports, each with the smaller name first. All ranks
  /// together report all pairs. With Order::canonical, the pairs of each rank are sorted. Valid
  /// until the next `add` (after which there are none) or `self_pairs`.
  [[nodiscard]] NamePairs pairs(std::uint32_t rank) const noexcept;
  /// Computes a digest of all pairs, which is the same for any number of ranks and any partitioning
  /// of space. Collective; O(pairs).
  Answer<ClusterDigest> digest();

  /// Returns the number of bodies that a hosted rank owns.
  [[nodiscard]] std::size_t size(std::uint32_t rank) const noexcept;
  /// Writes the bodies that a hosted rank owns, in no particular order, with their boxes: the
  /// contents of a checkpoint. If they are added to a cluster of any number of ranks, its pairs are
  /// the same. `size_mismatch` unless both spans have `size(rank)` entries. O(size).
  Status bodies(std::uint32_t rank, std::span<ClusterBody> bodies, std::span<Aabb> boxes) const;
  /// Returns the key of a body that `rank` owns; `invalid_key` if it owns no body of this name.
  /// O(1).
  Answer<Key> key_of(std::uint32_t rank, BodyName name) const noexcept;
  /// Returns the bodies that a hosted rank owns since the last `self_pairs`: new ones, and bodies
  /// from other ranks.
  [[nodiscard]] std::span<const ClusterBody> arrived(std::uint32_t rank) const noexcept;
  /// Returns the names of the bodies that moved to other ranks in the last `self_pairs`.
  [[nodiscard]] std::span<const BodyName> departed(std::uint32_t rank) const noexcept;

  /// Returns the current counters.
  [[nodiscard]] ClusterStatistics statistics() const noexcept;
  /// Returns the bytes of partitions and bodies of the hosted ranks.
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  /// Null if memory was refused.
  ClusterState* state_ = nullptr;
};

}  // namespace winnow
