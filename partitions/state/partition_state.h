#pragma once

// The implementation of Partition: the rows, the index over them, the finder of pairs and the
// chooser of the structure. partition.cpp and queries/ call it.

#include <winnow/partitions/partition.h>
#include "core/threads/mutex.h"
#include "partitions/choice/chooser.h"
#include "partitions/index/query_view.h"
#include "partitions/index/spatial_index.h"
#include "partitions/pairs/pair_finder.h"
#include "partitions/rows/rows.h"

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace winnow {

class PartitionObserver;
struct UpdateSubset;

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
  Status remove(Key key);
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

  /// Called at the end of a mutation with its status, also if it was refused: marks the structure
  /// as stale if rows changed. `count` objects changed, unless the mutation was refused.
  void note_changes(Status status, std::size_t count) const noexcept;
  /// Brings the structure up to date, except that deferred boxes stay deferred; for pair queries of
  /// a tracked buffer.
  Status refresh() const;
  /// Refreshes before the kind of the first query is known: `Partition::refresh`.
  Status refresh_early() const;
  /// Writes deferred boxes to the rows, for functions that read them.
  void write_deferred() const;
  /// Calls `write_deferred` and `refresh`.
  Status settle() const;
  /// Prepares casts, regions or nearest queries: notes them for the precision of the next build,
  /// calls `settle`, counts `count` queries of this kind, updates the trees that only these queries
  /// use, and fills in the view of rows and trees.
  Status prepare(QueryKind kind, std::size_t count, QueryView& view) const;
  void count_queries(QueryKind kind, std::size_t count) const noexcept;

  /// Calls call() while no other thread can reorder rows or exchange the structure.
  template <typename Call>
  auto with_stable_index(Call&& call) const {
    Lock lock = Lock::deferred(refresh_mutex_);
    if (stale_.load(std::memory_order_acquire)) lock.lock();
    return call();
  }

  Status self_pairs(PairBuffer& out, const PairOptions& options, PairEvents* events) const;
  /// `out` must be empty.
  Status pairs_with(const PartitionState& other, const PairOptions& options, PairBuffer& out) const;

  [[nodiscard]] bool is_exact() const noexcept;
  [[nodiscard]] Footprint footprint() const noexcept;
  [[nodiscard]] Statistics statistics() const noexcept;
  [[nodiscard]] StructureChoice choice() const noexcept;
  void clear() noexcept;
  void release_memory() noexcept;

  std::pmr::memory_resource* const memory;
  StructureKind structure;                // as given by the caller
  PartitionObserver* observer = nullptr;  // null if the partition is not recorded
  Rows rows;
  SpatialIndex index;

 private:
  Status refresh_now();
  void end_deferring() const noexcept;

  Chooser* chooser_ = nullptr;
  mutable PairFinder pairs_;
  Column<std::uint32_t> listed_;  // entries of a mask
  mutable Mutex refresh_mutex_;
  mutable Mutex tracker_mutex_;
  // True from a change until a refresh has finished. Rows are reordered and structures exchanged
  // only in between, under refresh_mutex_.
  mutable std::atomic<bool> stale_{true};
};

}  // namespace winnow
