#pragma once

// The implementation of Partition: PartitionState owns the rows, the index over them, the tracking
// of pairs and the chooser of the structure. partition.cpp and queries/ call it.

#include <winnow/partitions/partition.h>
#include "core/threads/mutex.h"
#include "partitions/choice/chooser.h"
#include "partitions/index/query_view.h"
#include "partitions/index/spatial_index.h"
#include "partitions/rows/rows.h"
#include "partitions/rows/verlet_skin.h"
#include "partitions/state/resting.h"

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace winnow {

class EventWriter;
class LinkedPairs;

/// The pair buffer that is updated incrementally, and counters of pair queries.
struct PairTracking {
  explicit PairTracking(std::pmr::memory_resource* memory) noexcept;

  const std::uint64_t identity;      // of the partition
  std::uint64_t tracked_serial = 0;  // 0: no buffer is tracked
  // Only grows, so that an old buffer cannot match.
  std::atomic<std::uint64_t> last_serial{0};
  std::atomic<std::uint64_t> full_queries{0};
  std::atomic<std::uint64_t> incremental_queries{0};
  std::atomic<std::uint64_t> last_tests{0};
  std::atomic<std::uint64_t> last_pairs{0};
  RestDetector resting;
};

/// All data of a partition.
class PartitionState {
 public:
  PartitionState(std::pmr::memory_resource* memory, const PartitionOptions& options,
                 const VolumeInput& input) noexcept;
  ~PartitionState();
  PartitionState(const PartitionState&) = delete;
  PartitionState& operator=(const PartitionState&) = delete;

  /// `input` must be the one for the volume and margin of the options. Null if memory is refused.
  [[nodiscard]] static PartitionState* make(StructureKind kind, const PartitionOptions& options,
                                            const VolumeInput& input) noexcept;
  /// False, and nothing changed, if memory is refused.
  [[nodiscard]] bool set_structure(StructureKind kind) noexcept;

  Status insert(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys);
  Status remove(std::span<const Key> keys);
  /// Requires a state that never contained an object; see Rows::restore.
  Status restore(const SavedRows& saved, PartitionState& other);
  Status reserve(std::size_t objects, Pages pages);
  Status reserve_pairs(PairBuffer& out, std::size_t pairs, Pages pages) const noexcept;
  [[nodiscard]] bool reserve_events(PairEvents& out, std::size_t pairs, Pages pages) const noexcept;
  Status set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters);
  Status update(const UpdateSubset& entries, const BoxView& boxes);
  Status update(std::span<const Key> keys, const BoxView& boxes, const IndexSubset& entries);
  Status update(Key key, const Aabb& box);
  Status bounds(std::span<const Key> keys, std::span<Aabb> boxes) const noexcept;

  /// Called at the end of a mutation of `count` objects: marks the structure as stale if rows
  /// changed.
  void note_changes(std::size_t count) noexcept;
  /// Brings the structure up to date, except that deferred boxes stay deferred; for pair queries of
  /// a tracked buffer.
  Status refresh() const;
  /// Refreshes for unknown queries: `Partition::refresh`.
  Status refresh_for_queries() const;
  /// Writes deferred boxes to the rows, for functions that read them.
  void write_deferred() const;
  /// Calls `write_deferred` and `refresh`.
  Status settle() const;
  /// Calls `settle`, updates the trees that casts, regions and nearest queries use, counts `count`
  /// queries of this kind, and fills in the view of rows and trees.
  Status prepare(QueryKind kind, std::size_t count, QueryView& view) const;
  void count_queries(QueryKind kind, std::size_t count) const noexcept;

  /// Calls call() while no other thread can reorder rows or exchange the structure.
  template <typename Call>
  auto with_stable_index(Call&& call) const {
    Lock lock = Lock::deferred(refresh_mutex_);
    if (stale_.load(std::memory_order_acquire)) lock.lock();
    return call();
  }

  [[nodiscard]] Status find_self_pairs(PairBuffer& out, const PairOptions& options,
                                       PairEvents* events) const;
  /// Appends the pairs (object of this, object of other). Queries `other` with every object of
  /// this.
  Status query_other(const PartitionState& other, HitMode mode, const PairPredicate& predicate,
                     PairBuffer& out) const;

  [[nodiscard]] bool is_exact() const noexcept;
  [[nodiscard]] Footprint footprint() const noexcept;
  [[nodiscard]] Statistics statistics() const noexcept;
  [[nodiscard]] StructureChoice choice() const noexcept;
  void clear() noexcept;
  void release_memory() noexcept;

  std::pmr::memory_resource* const memory;
  StructureKind structure;  // as given by the caller
  Rows rows;
  SpatialIndex index;

 private:
  struct SelfTasks;

  Status refresh_now();
  void end_deferring() const noexcept;
  Status full_self_pairs(PairBuffer& out, const PairPredicate& predicate,
                         EventWriter* events) const;
  Status incremental_self_pairs(PairBuffer& out, const PairPredicate& predicate,
                                EventWriter* events) const;
  Status linked_self_pairs(PairBuffer& out, const PairPredicate& predicate,
                           EventWriter* events) const;
  Status query_moved(PairBuffer& out, const PairPredicate& predicate) const;
  [[nodiscard]] bool select_moved_rows() const noexcept;
  void try_start_resting(PairBuffer& out, const PairOptions& options) const noexcept;
  [[nodiscard]] bool watch_all(std::size_t most) const noexcept;
  [[nodiscard]] bool can_stay_deferred(const PairBuffer& out, const PairOptions& options,
                                       const EventWriter* events) const noexcept;
  Status resting_self_pairs(PairBuffer& out, EventWriter* events) const;
  [[nodiscard]] bool keep_near(PairBuffer& out, std::size_t kept) const noexcept;
  Status query_near(std::span<const std::uint32_t> query_rows, PairBuffer& out,
                    std::uint64_t& tests) const;
  [[nodiscard]] bool watch_rows(std::size_t begin, std::size_t end,
                                std::size_t stride) const noexcept;
  [[nodiscard]] bool is_watched(const Pair& pair) const noexcept;
  [[nodiscard]] bool note_watched(LinkedPairs& linked) const noexcept;
  [[nodiscard]] bool update_in_place(PairBuffer& out) const noexcept;
  Status redo_self_pairs(PairBuffer& out, const PairOptions& options, bool update,
                         EventWriter* events) const;
  Status run_self_pairs(PairBuffer& out, const PairOptions& options, EventWriter* events) const;
  Status track_self_pairs(PairBuffer& out, const PairOptions& options, bool tracked,
                          EventWriter* events) const;
  void finish_frame(PairBuffer& out, bool tracked, EventWriter* events) const noexcept;
  void undo_self_pairs(PairBuffer& out, bool resting, EventWriter* events) const noexcept;
  [[nodiscard]] bool can_update_in_place(const PairBuffer& out, const PairOptions& options,
                                         const EventWriter* events) const noexcept;
  bool finish_pairs(PairBuffer& out, Order order, bool all, EventWriter* events) const noexcept;
  [[nodiscard]] bool can_update(const PairBuffer& out) const noexcept;
  [[nodiscard]] bool is_update_cheaper(const PairBuffer& out) const noexcept;
  bool run_self_task(const SelfTasks& tasks, std::size_t task, PairSink& sink) const noexcept;
  void note_work(std::uint64_t tests, std::uint64_t queries,
                 SpatialIndex::PairQueryKind kind) const noexcept;

  Chooser* chooser_ = nullptr;
  mutable PairTracking pairs_;
  mutable VerletSkin deferred_;
  mutable PairBuffer near_;       // scratch for finding the pairs to watch
  Column<std::uint32_t> listed_;  // entries of a mask
  mutable Mutex refresh_mutex_;
  mutable Mutex tracker_mutex_;
  // True from a change until a refresh has finished. Rows are reordered and structures exchanged
  // only in between, under refresh_mutex_.
  mutable std::atomic<bool> stale_{true};
};

}  // namespace winnow
