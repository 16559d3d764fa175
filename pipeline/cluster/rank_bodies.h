#pragma once

#include <winnow/partitions/partition.h>
#include <winnow/pipeline/cluster.h>
#include "pipeline/cluster/name_table.h"
#include "pipeline/cluster/regions.h"
#include "pipeline/cluster/send_queue.h"

#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

namespace winnow {

/// The bodies of one rank of a Cluster: bodies that belong to it, and copies (ghosts) of bodies of
/// other ranks whose boxes overlap its region, all in one partition. Throws std::bad_alloc if
/// memory is refused.
class RankBodies {
 public:
  RankBodies(std::uint32_t rank, bool is_single_rank, const ClusterOptions& options);

  // Changes by the caller. A refused call changes nothing.

  /// Checks a batch, except for names on other ranks.
  [[nodiscard]] Status check(const ClusterBatch& batch);
  /// Adds a checked batch. Its bodies belong to this rank until the next `send`.
  [[nodiscard]] Status insert(const ClusterBatch& batch);
  [[nodiscard]] Status move(std::span<const Key> keys, const BoxView& boxes);
  [[nodiscard]] Status move(std::span<const BodyName> names, const BoxView& boxes);
  [[nodiscard]] Status remove(std::span<const BodyName> names);

  // Migration: each body goes to the rank that it belongs to, and copies go to the other ranks
  // whose regions its box overlaps.

  /// Prepares messages to other ranks about removed bodies only.
  void send_removals(const Regions& regions);
  /// Prepares messages to other ranks about the bodies and copies that they must add, update or
  /// remove: for changed bodies, or for all bodies if the regions changed.
  void send(const Regions& before, const Regions& now, bool regions_changed);
  void pack(std::vector<RankMessage>& messages) { send_queue_.pack(rank_, messages); }
  /// Applies messages of other ranks, and removes the bodies and copies that left this rank.
  [[nodiscard]] Status receive(std::span<const RankMessage> messages);

  /// Updates the structure while messages are in transit. After `receive`, only the received
  /// changes remain to be done.
  void refresh() noexcept { (void)partition_.refresh(); }
  /// Finds the pairs that this rank reports.
  [[nodiscard]] Status find_pairs(Order order);
  /// Pairs of the last `find_pairs`; valid until rows are added or `forget_pairs` is called.
  [[nodiscard]] NamePairs pairs() const noexcept {
    return {{reported_.data(), names_.data()}, reported_.size()};
  }
  void forget_pairs() noexcept { reported_ = {}; }
  /// Number of boxes plus number of pairs found, in the last `find_pairs`.
  [[nodiscard]] std::uint64_t work() const noexcept { return partition_.size() + found_.size(); }
  /// Distributes the work of the last `find_pairs` over the bodies that caused it. `send` resets
  /// it.
  void measure_work();
  /// Boxes of the bodies that belong to this rank, and the work of each; 1 if it was not measured.
  [[nodiscard]] CutWork cut_work();

  [[nodiscard]] std::size_t size() const noexcept { return table_.size() - ghosts_; }
  [[nodiscard]] std::size_t ghosts() const noexcept { return ghosts_; }
  [[nodiscard]] Status bodies(std::span<ClusterBody> bodies, std::span<Aabb> boxes) const;
  [[nodiscard]] Status key_of(BodyName name, Key& key) const noexcept;
  [[nodiscard]] std::span<const ClusterBody> arrived() const noexcept { return arrived_; }
  [[nodiscard]] std::span<const BodyName> departed() const noexcept { return departed_; }
  /// Returns the names of bodies that were removed since the last call.
  [[nodiscard]] std::vector<BodyName> take_removed() { return std::exchange(removed_, {}); }
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  /// State of a row, indexed by the id of its key.
  enum Flag : std::uint8_t {
    kOwned = 1,    // belongs to this rank
    kCrosses = 2,  // its box is not contained in this rank's region
    kMoved = 4,    // is in moved_
    kRemoved = 8,  // to be removed here and on other ranks
    // For boxes that cross: the axes on which the low corner is below the region.
    kBelowX = 16,
    kBelowY = 32,
    kBelowZ = 64,
    kBelow = kBelowX | kBelowY | kBelowZ,
  };
  /// A body whose box may differ from the box that was last sent to other ranks.
  struct MovedBox {
    Key key;
    Aabb sent_box;  // the box last sent; empty if there is none
  };

  [[nodiscard]] bool is_owned(Key key) const noexcept {
    return partition_.contains(key) && (flags_[key.id] & (kOwned | kRemoved)) == kOwned;
  }
  [[nodiscard]] Aabb box_of(Key key) const noexcept;
  [[nodiscard]] bool find_boxes();
  [[nodiscard]] bool is_within(const Aabb& box) const noexcept;
  [[nodiscard]] std::uint8_t flags_of(const Aabb& box, bool owned) const noexcept;
  [[nodiscard]] Status find_keys(std::span<const BodyName> names, std::vector<Key>& keys) const;
  void find_beyond(const BoxView& boxes);
  [[nodiscard]] bool note_moves(std::span<const Key> keys, const BoxView& boxes);
  [[nodiscard]] std::size_t put_reported_first() noexcept;
  void sort_by_names();
  void add_rows(std::span<const BodyName> names, std::span<const Key> keys);
  void note_all_that_cross();
  /// Adds messages about one body. `box` is its current box; empty if the body was removed.
  void add_messages(const MovedBox& moved, const Aabb& box, const Regions& before,
                    const Regions& now);
  void take(const BodyMessages<Aabb>& incoming);
  [[nodiscard]] Status apply_changes();

  std::uint32_t rank_;
  bool is_single_rank_;
  Aabb region_;
  Partition partition_;
  PairBuffer found_;
  std::pmr::vector<BodyName> names_;      // by id
  std::pmr::vector<std::uint8_t> flags_;  // by id
  NameTable table_;                       // to ids
  std::size_t ghosts_ = 0;
  std::vector<MovedBox> moved_;
  std::vector<BodyName> removed_;
  std::vector<ClusterBody> arrived_;
  std::vector<BodyName> departed_;
  std::pmr::vector<Pair> sorted_;   // the pairs in canonical order, if that is requested
  std::span<const Pair> reported_;  // in found_ or sorted_
  SendQueue<Aabb> send_queue_;
  BodyChanges<Aabb, Aabb> changes_;
  std::vector<std::uint32_t> works_;  // by id
  std::vector<std::uint32_t> works_of_owned_;
  // Scratch.
  std::vector<std::uint32_t> ranks_before_;
  std::vector<std::uint32_t> ranks_now_;
  std::vector<Key> keys_;
  std::vector<std::uint32_t> beyond_;
  std::vector<Key> box_keys_;  // keys whose boxes are looked up
  std::vector<Aabb> boxes_;    // the boxes of box_keys_
};

}  // namespace winnow
