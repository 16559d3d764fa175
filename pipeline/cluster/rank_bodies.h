#pragma once

#include <winnow/partitions/partition.h>
#include <winnow/pipeline/cluster.h>
#include "pipeline/cluster/name_table.h"
#include "pipeline/cluster/outbox.h"
#include "pipeline/cluster/regions.h"

#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

namespace winnow {

/// What one rank holds: the bodies that belong to it, and copies of those of others that its region
/// meets, all in one partition. Throws std::bad_alloc where memory is refused.
class RankBodies {
 public:
  RankBodies(std::uint32_t rank, bool alone, const ClusterOptions& options);

  // What the rank is told. Refused calls change nothing.

  /// Whether a batch may be added, as far as this rank knows.
  [[nodiscard]] Status check(const ClusterBatch& batch);
  /// Adds a batch that was checked. Its bodies belong to this rank until they are settled.
  [[nodiscard]] Status insert(const ClusterBatch& batch);
  [[nodiscard]] Status move(std::span<const Key> keys, const BoxView& boxes);
  [[nodiscard]] Status move(std::span<const BodyName> names, const BoxView& boxes);
  [[nodiscard]] Status remove(std::span<const BodyName> names);

  // How bodies go where they belong, and copies to where they are met.

  /// Tells other ranks what was removed, and nothing else.
  void send_removals(const Regions& regions);
  /// Tells other ranks what they hold from now on and what no more, of bodies that changed, or of
  /// all where regions did.
  void send(const Regions& before, const Regions& now, bool regions_changed);
  void pack(std::vector<Parcel>& parcels) { outbox_.pack(rank_, parcels); }
  /// Takes what others tell, and drops what this rank holds no more.
  [[nodiscard]] Status receive(std::span<const Parcel> parcels);

  /// Brings the structure to where own bodies are, before copies come: what is left then is little.
  void refresh() noexcept { (void)partition_.refresh(); }
  /// Finds those that this rank reports.
  [[nodiscard]] Status find_pairs(Order order);
  /// Of the last `find_pairs`, until rows are added or they are forgotten.
  [[nodiscard]] NamePairs pairs() const noexcept { return {reported_, names_.data()}; }
  void forget_pairs() noexcept { reported_ = {}; }
  /// Boxes held and pairs found by the last `find_pairs`.
  [[nodiscard]] std::uint64_t work() const noexcept { return partition_.size() + found_.size(); }
  /// Shares the work of the last `find_pairs` among the bodies that made it; forgotten by `send`.
  void measure_work();
  /// Boxes of the bodies that belong here, and the work of each: 1 where it was not measured.
  [[nodiscard]] CutWork cut_work();

  [[nodiscard]] std::size_t size() const noexcept { return table_.size() - ghosts_; }
  [[nodiscard]] std::size_t ghosts() const noexcept { return ghosts_; }
  [[nodiscard]] Status bodies(std::span<ClusterBody> bodies, std::span<Aabb> boxes) const;
  [[nodiscard]] Status key_of(BodyName name, Key& key) const noexcept;
  [[nodiscard]] std::span<const ClusterBody> arrived() const noexcept { return arrived_; }
  [[nodiscard]] std::span<const BodyName> departed() const noexcept { return departed_; }
  /// Names of removed bodies, since the last call of this.
  [[nodiscard]] std::vector<BodyName> take_removed() { return std::exchange(removed_, {}); }
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  /// What is known of a row, by the id of its key.
  enum Flag : std::uint8_t {
    kOwned = 1,    // belongs here
    kCrosses = 2,  // its box does not lie within this rank's region
    kMoved = 4,    // in moved_
    kRemoved = 8,  // to be told to others and dropped
    // Of boxes that cross: where the low corner is below the region.
    kBelowX = 16,
    kBelowY = 32,
    kBelowZ = 64,
    kBelow = kBelowX | kBelowY | kBelowZ,
  };
  /// A body whose box is not the one that others were last told.
  struct Moved {
    Key key;
    Aabb told;  // empty: they know nothing of it
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
  /// Of a body and where it is now: an empty box for one that was removed.
  void tell(const Moved& moved, const Aabb& box, const Regions& before, const Regions& now);
  void take(const BodyNews<Aabb>& news);
  [[nodiscard]] Status apply_changes();

  std::uint32_t rank_;
  bool alone_;
  Aabb region_;
  Partition partition_;
  PairBuffer found_;
  std::pmr::vector<BodyName> names_;      // by id
  std::pmr::vector<std::uint8_t> flags_;  // by id
  NameTable table_;                       // to ids
  std::size_t ghosts_ = 0;
  std::vector<Moved> moved_;
  std::vector<BodyName> removed_;
  std::vector<ClusterBody> arrived_;
  std::vector<BodyName> departed_;
  std::pmr::vector<Pair> sorted_;   // of those found, where they are not reported as they come
  std::span<const Pair> reported_;  // in one of these
  Outbox<Aabb> outbox_;
  BodyChanges<Aabb, Aabb> changes_;
  std::vector<std::uint32_t> works_;  // by id
  std::vector<std::uint32_t> works_of_owned_;
  // Scratch.
  std::vector<std::uint32_t> ranks_before_;
  std::vector<std::uint32_t> ranks_now_;
  std::vector<Key> keys_;
  std::vector<std::uint32_t> beyond_;
  std::vector<Key> asked_;   // for their boxes
  std::vector<Aabb> boxes_;  // of these
};

}  // namespace winnow
