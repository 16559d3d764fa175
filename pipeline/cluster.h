#pragma once

#include <winnow/core/box_view.h>
#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/pair_buffer.h>
#include <winnow/core/status.h>
#include <winnow/partitions/partition.h>
#include <winnow/partitions/structures.h>
#include <winnow/pipeline/cluster_transport.h>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>  // iterator tags, too: <iterator> would read all of streams

namespace winnow {

struct ClusterState;

/// What a body is called on every rank: yours, and no two bodies of a cluster have the same.
using BodyName = std::uint64_t;

/// Two bodies whose boxes overlap, first < second.
struct NamePair {
  BodyName first = 0;   ///< the smaller name
  BodyName second = 0;  ///< the larger name

  /// By the first body, then by the second.
  friend constexpr auto operator<=>(const NamePair&, const NamePair&) noexcept = default;
};

/// Pairs that a rank reports, read front to back or by place. A rank holds them by its own numbers
/// of bodies, 8 bytes a pair, and names are looked up as a pair is read: nothing is written for
/// pairs that nobody looks at.
class NamePairs {
 public:
  /// Reads one pair after another.
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;   ///< pairs are made as they are read
    using iterator_concept = std::forward_iterator_tag;  ///< it may be copied and read again
    using value_type = NamePair;                         ///< what it reads
    using difference_type = std::ptrdiff_t;              ///< pairs between two of them
    using pointer = const NamePair*;                     ///< of no use: pairs lie nowhere
    using reference = NamePair;                          ///< a pair by value

    /// Of no pairs.
    Iterator() noexcept = default;
    /// At a pair of numbers, and the names of numbers.
    Iterator(const Pair* at, const BodyName* names) noexcept : at_(at), names_(names) {}
    /// The pair, its smaller name first.
    [[nodiscard]] NamePair operator*() const noexcept {
      const BodyName a = names_[at_->first];
      const BodyName b = names_[at_->second];
      return a < b ? NamePair{a, b} : NamePair{b, a};
    }
    /// Goes on to the next pair.
    Iterator& operator++() noexcept {
      ++at_;
      return *this;
    }
    /// Goes on to the next pair, and gives back where it was.
    Iterator operator++(int) noexcept { return {at_++, names_}; }
    /// At the same pair.
    friend bool operator==(const Iterator& a, const Iterator& b) noexcept { return a.at_ == b.at_; }

   private:
    const Pair* at_ = nullptr;
    const BodyName* names_ = nullptr;
  };

  /// No pairs.
  NamePairs() noexcept = default;
  /// Pairs of numbers, and the names of numbers.
  NamePairs(std::span<const Pair> pairs, const BodyName* names) noexcept
      : pairs_(pairs), names_(names) {}
  /// How many there are.
  [[nodiscard]] std::size_t size() const noexcept { return pairs_.size(); }
  /// True if there are none.
  [[nodiscard]] bool empty() const noexcept { return pairs_.empty(); }
  /// At the first pair.
  [[nodiscard]] Iterator begin() const noexcept { return {pairs_.data(), names_}; }
  /// Behind the last pair.
  [[nodiscard]] Iterator end() const noexcept { return {pairs_.data() + size(), names_}; }
  /// Pair i, below `size()`; nothing is checked.
  [[nodiscard]] NamePair operator[](std::size_t i) const noexcept {
    return *Iterator(pairs_.data() + i, names_);
  }

 private:
  std::span<const Pair> pairs_;
  const BodyName* names_ = nullptr;
};

/// A body where it belongs.
struct ClusterBody {
  BodyName name = 0;  ///< everywhere
  Key key;            ///< on the rank that it belongs to, for as long as it does
};

/// Bodies that one rank adds.
struct ClusterBatch {
  std::span<const BodyName> names;  ///< new ones
  BoxView boxes;                    ///< one of each
};

/// 128 bits that tell sets of pairs apart.
struct ClusterDigest {
  std::uint64_t high = 0;  ///< one sum of hashes over all pairs
  std::uint64_t low = 0;   ///< and another

  /// The same pairs.
  friend constexpr bool operator==(const ClusterDigest&, const ClusterDigest&) noexcept = default;
};

/// What a cluster is made with.
struct ClusterOptions {
  /// Partitions and bodies of hosted ranks are allocated here. It must outlive the cluster.
  std::pmr::memory_resource* memory = default_memory();
  /// On whose threads each rank's partition works.
  Execution execution = Execution::parallel();
  /// Of each rank's partition.
  StructureKind structure = linear_bvh();
  /// Space is cut anew after a frame in which the rank with most work had more than this times the
  /// mean, unless the last cut did no better. At least 1.
  double imbalance = 1.1;
};

/// Counters of all ranks, the same on every one; never timings. Those of messages are of the last
/// `self_pairs`, and of what was added since the one before.
struct ClusterStatistics {
  std::uint64_t bodies = 0;    ///< each once
  std::uint64_t ghosts = 0;    ///< copies of bodies on ranks that they do not belong to
  std::uint64_t pairs = 0;     ///< each once
  std::uint64_t bytes = 0;     ///< sent from one rank to another
  std::uint64_t messages = 0;  ///< from one rank to another
  std::uint64_t migrated = 0;  ///< bodies that belong to another rank since
  std::uint64_t cuts = 0;      ///< how often space was cut so far
  /// Work of the rank that has most, over the mean. A rank's work is the boxes that it holds and
  /// the pairs that it finds.
  double imbalance = 1.0;
};

/// Boxes on any number of ranks, and which of them overlap: the pairs of one Partition of all of
/// them, each once, whatever the number of ranks and wherever space is cut.
///
///     winnow::LoopbackTransport transport(64);  // or make_mpi_transport: one rank in each process
///     winnow::Cluster cluster(transport);
///     cluster.add(batches, answers);
///     cluster.self_pairs();
///     for (const winnow::NamePair pair : cluster.pairs(rank)) ...
///
/// A body belongs to the rank in whose region its centre lies, and is told of there: it is moved
/// and removed on that rank alone. It is copied to every rank whose region its box meets, so there
/// is no width of halo to choose, and a box may be of any size; a copy is sent again only when the
/// box moved. Two boxes that overlap do so at the point that on each axis is the larger of their
/// low corners: the rank in whose region this lies holds both, and it alone reports them.
///
/// Calls that are collective are made by every process, in the same order; others are a rank's own.
/// A refused call changed nothing on any rank. Where a collective call answers
/// `communication_failed`, or `out_of_memory` on any rank, all ranks get an error, and the cluster
/// answers every later call with it. Nothing throws.
class WINNOW_API Cluster {
 public:
  /// An empty cluster of the ranks of `transport`, which must outlive it. Collective.
  explicit Cluster(Transport& transport, const ClusterOptions& options = {}) noexcept;
  ~Cluster();
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

  /// `ok`; `invalid_argument` for options out of range; or what ended the cluster.
  [[nodiscard]] Status status() const noexcept;
  /// Of all processes.
  [[nodiscard]] std::uint32_t ranks() const noexcept;
  /// The first that this process hosts.
  [[nodiscard]] std::uint32_t first_hosted() const noexcept;
  /// How many it hosts.
  [[nodiscard]] std::uint32_t hosted() const noexcept;

  /// Adds a batch on each hosted rank, which may be empty, and answers each: `invalid_bounds`,
  /// `size_mismatch`, or `invalid_key` where a name is there already, on whatever rank, or another
  /// rank adds it in this call (then both are refused). A batch that is refused adds nothing;
  /// others do. Bodies belong to the rank that added them until the next `self_pairs`. Collective;
  /// O(bodies added), in four exchanges.
  Status add(std::span<const ClusterBatch> batches, std::span<Status> answers);

  /// Gives bodies that belong to `rank` new boxes, all or none: `invalid_key` for any other, and
  /// where one is named twice; `invalid_bounds`; `size_mismatch`. Takes effect with the next
  /// `self_pairs`.
  Status move(std::uint32_t rank, std::span<const BodyName> names, const BoxView& boxes);
  /// The same by keys, which saves looking for names, and is fastest where ids ascend. Of one that
  /// is there twice the last box counts.
  Status move(std::uint32_t rank, std::span<const Key> keys, const BoxView& boxes);
  /// Removes bodies that belong to `rank`, all or none; `invalid_key` as above.
  Status remove(std::uint32_t rank, std::span<const BodyName> names);

  /// Finds all pairs. Before, bodies go where they belong, and copies to where they are met; after
  /// a frame that was out of balance space is cut anew first. Collective.
  Status self_pairs(Order order = Order::fast);
  /// Those that a hosted rank reports, each oriented by name; together, the ranks' are all. With
  /// Order::canonical each rank's are sorted. To be read before the next `add`, from when on there
  /// are none, or `self_pairs`.
  [[nodiscard]] NamePairs pairs(std::uint32_t rank) const noexcept;
  /// Of all that `pairs` gives: the same on 1 to N ranks, wherever space is cut.
  /// Collective; O(pairs).
  Status digest(ClusterDigest& digest);

  /// How many bodies belong to a hosted rank.
  [[nodiscard]] std::size_t size(std::uint32_t rank) const noexcept;
  /// The bodies of a hosted rank, in no order, with their boxes: what a checkpoint keeps. Added to
  /// a cluster of any number of ranks they have the same pairs. `size_mismatch` unless both spans
  /// have `size(rank)` entries. O(size).
  Status bodies(std::uint32_t rank, std::span<ClusterBody> bodies, std::span<Aabb> boxes) const;
  /// The key of a body that belongs to `rank`; `invalid_key` if none of this name does. O(1).
  Status key_of(std::uint32_t rank, BodyName name, Key& key) const noexcept;
  /// Bodies that the last `self_pairs` made a hosted rank's: new ones, and those of other ranks.
  [[nodiscard]] std::span<const ClusterBody> arrived(std::uint32_t rank) const noexcept;
  /// Names of those that the last `self_pairs` made another rank's.
  [[nodiscard]] std::span<const BodyName> departed(std::uint32_t rank) const noexcept;

  /// Counters as they stand.
  [[nodiscard]] ClusterStatistics statistics() const noexcept;
  /// Bytes that the partitions and bodies of hosted ranks take.
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  /// Null where memory was refused.
  ClusterState* state_ = nullptr;
};

}  // namespace winnow
