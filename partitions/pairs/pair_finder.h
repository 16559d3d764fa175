#pragma once

// Pair queries of a partition. PartitionState owns the finder, and refreshes the index before it
// calls `find`.

#include <winnow/partitions/partition.h>
#include "partitions/index/spatial_index.h"
#include "partitions/pairs/event_writer.h"
#include "partitions/pairs/resting_pairs.h"
#include "partitions/rows/rows.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <optional>

namespace winnow {

/// One call of `self_pairs`.
struct SelfPairsQuery {
  PairBuffer& out;
  const PairOptions& options;
  std::optional<EventWriter> events{};  ///< if the caller wants events
  bool tracked = false;                 ///< `out` will be the tracked buffer
  bool resting = false;                 ///< the result of `can_stay_resting`
};

/// Finds all pairs of a partition, by the cheapest of four strategies (`choose`), and
/// tracks the buffer that the next query can update. One buffer is tracked at a time: it contains
/// the pairs of the last tracked query, as its serial shows, and Rows collects the objects that
/// moved since. A query that is not tracked may run concurrently with others.
class PairFinder {
 public:
  PairFinder(std::pmr::memory_resource* memory, Rows& rows, const SpatialIndex& index) noexcept;

  /// Returns the writer of events for a query that updates `out`.
  [[nodiscard]] EventWriter events_of(PairEvents& events, const PairBuffer& out) const noexcept {
    return {events, rows_.keys(), out, identity_, rows_.execution()};
  }
  /// True if the query can use the active list of resting pairs. If not, the caller writes deferred
  /// boxes to the rows and refreshes again.
  [[nodiscard]] bool can_stay_resting(const SelfPairsQuery& query) const noexcept;
  /// Writes all pairs and events. Requires an index that is up to date. If this fails, the caller
  /// calls `undo`.
  Status find(SelfPairsQuery& query);
  /// Restores the buffer and the events after a failed query.
  void undo(SelfPairsQuery& query) noexcept;
  /// Appends the pairs (object of this, object of other). Queries `other` with every object of
  /// this.
  Status find_with(const PairFinder& other, HitMode mode, const PairPredicate& predicate,
                   PairBuffer& out) const;

  /// Makes room in `out` for `pairs` pairs of up to `rows` rows. False if memory is refused.
  [[nodiscard]] bool reserve(PairBuffer& out, std::size_t pairs, std::size_t rows,
                             Pages pages) const noexcept;

  /// True if Rows must collect the objects that move, for the tracked buffer.
  [[nodiscard]] bool tracks() const noexcept { return tracked_serial_ != 0; }
  /// Forgets the tracked buffer, so that the next query is a full one.
  void forget_buffer() noexcept { tracked_serial_ = 0; }
  [[nodiscard]] RestingPairs& resting() noexcept { return resting_; }
  /// See Partition::is_exact.
  [[nodiscard]] bool is_exact() const noexcept;
  void add_statistics(Statistics& statistics) const noexcept;

 private:
  enum class Strategy : std::uint8_t { resting, linked, incremental, full };
  struct FullTasks;

  [[nodiscard]] Strategy choose(const SelfPairsQuery& query) const noexcept;
  [[nodiscard]] bool can_update(const PairBuffer& out) const noexcept;
  [[nodiscard]] bool may_reorder(const SelfPairsQuery& query) const noexcept;
  [[nodiscard]] bool link_if_due(PairBuffer& out) const noexcept;
  [[nodiscard]] bool is_update_cheaper(const PairBuffer& out) const noexcept;

  Status find_resting(SelfPairsQuery& query);
  Status find_linked(SelfPairsQuery& query);
  Status find_incremental(SelfPairsQuery& query);
  Status find_full(SelfPairsQuery& query);
  Status finish_in_place(SelfPairsQuery& query, std::size_t kept, bool resting);
  Status finish_found(SelfPairsQuery& query, bool all) noexcept;
  void finish_frame(SelfPairsQuery& query) noexcept;

  // Queries, in pair_queries.cpp.
  Status query_all(PairBuffer& out, const PairPredicate& predicate);
  bool run_task(const FullTasks& tasks, std::size_t task, PairSink& sink) const noexcept;
  Status query_moved(PairBuffer& out, const PairPredicate& predicate);
  [[nodiscard]] bool select_moved_rows() const noexcept;
  void note_work(std::uint64_t tests, std::uint64_t queries,
                 RebuildPlanner::PairQueryKind kind) noexcept;

  Rows& rows_;
  const SpatialIndex& index_;
  RestingPairs resting_;
  const std::uint64_t identity_;      // of the partition
  std::uint64_t tracked_serial_ = 0;  // 0: no buffer is tracked
  // Only grows, so that an old buffer cannot match.
  std::atomic<std::uint64_t> last_serial_{0};
  std::atomic<std::uint64_t> full_queries_{0};
  std::atomic<std::uint64_t> incremental_queries_{0};
  std::atomic<std::uint64_t> last_tests_{0};
  std::atomic<std::uint64_t> last_pairs_{0};
};

}  // namespace winnow
