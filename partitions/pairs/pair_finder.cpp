// Chooses how a query finds all pairs, by one of the four strategies that the table in
// .github/ARCHITECTURE.md compares, and tracks the buffer for the next query.

#include "partitions/pairs/pair_finder.h"

#include "partitions/pairs/linked_pairs.h"
#include "partitions/pairs/pair_tracker.h"
#include "partitions/structures/costs.h"

namespace winnow {
namespace {

std::uint64_t next_identity() noexcept {
  static std::atomic<std::uint64_t> counter{0};
  return 1 + counter.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

PairFinder::PairFinder(std::pmr::memory_resource* memory, Rows& rows,
                       const SpatialIndex& index) noexcept
    : rows_(rows), index_(index), resting_(memory, rows, index), identity_(next_identity()) {}

Status PairFinder::find(SelfPairsQuery& query) {
  // If the buffer was not the tracked one, or most objects moved, the query is full.
  const bool starts_tracking = query.tracked && !can_update(query.out);
  Status status = Status::ok;
  switch (choose(query)) {
    case Strategy::resting:
      status = find_resting(query);
      break;
    case Strategy::linked:
      status = find_linked(query);
      break;
    case Strategy::incremental:
      status = find_incremental(query);
      break;
    case Strategy::full:
      status = find_full(query);
      break;
  }
  if (status != Status::ok) return status;
  last_pairs_.store(query.out.size(), std::memory_order_relaxed);
  if (query.tracked || query.events) finish_frame(query);
  const PairOptions& options = query.options;
  if (starts_tracking && options.order == Order::fast && options.predicate.accept == nullptr &&
      is_exact()) {
    resting_.try_start(query.out);
  }
  return Status::ok;
}

// Choice.

PairFinder::Strategy PairFinder::choose(const SelfPairsQuery& query) const noexcept {
  if (query.resting) return Strategy::resting;
  if (!query.tracked || !can_update(query.out)) return Strategy::full;
  if (may_reorder(query) && link_if_due(query.out)) return Strategy::linked;
  return query.events || is_update_cheaper(query.out) ? Strategy::incremental : Strategy::full;
}

bool PairFinder::can_stay_resting(const SelfPairsQuery& query) const noexcept {
  return query.tracked && resting_.active() && query.options.predicate.accept == nullptr &&
         can_update(query.out) && may_reorder(query) && resting_.is_cheaper(query.out);
}

// True if the buffer contains the pairs of the last tracked query, and the objects that moved since
// are known.
bool PairFinder::can_update(const PairBuffer& out) const noexcept {
  return tracks() && !rows_.changes().moved.all() &&
         PairTracker::provenance(out) == PairBuffer::Provenance{identity_, tracked_serial_};
}

// An update in place changes the order of the pairs. The events, if there are any, must describe
// the frame whose pairs the buffer contains.
bool PairFinder::may_reorder(const SelfPairsQuery& query) const noexcept {
  return query.options.order == Order::fast && (!query.events || query.events->follows());
}

// True if nothing moved, or if few objects moved (LinkedPairs::is_due) and the buffer is linked.
// Links the buffer if necessary; false if memory for that is refused.
bool PairFinder::link_if_due(PairBuffer& out) const noexcept {
  const std::size_t moved = rows_.changes().moved.ids().size();
  LinkedPairs linked(out);
  return moved == 0 ||
         (linked.is_due(moved, rows_.size()) && linked.link(rows_.keys().slot_count()));
}

// True if querying with the moved objects costs less than a full query. Without pruning a full
// query is O(n^2). Otherwise the limit is lower if objects have many pairs, which are dropped and
// found again, and if the structure has cells, because a full query visits consecutive cells
// without searching them.
bool PairFinder::is_update_cheaper(const PairBuffer& out) const noexcept {
  constexpr std::size_t kFlat = 4;
  constexpr std::size_t kTree = 8;
  constexpr std::size_t kCells = 10;
  const StructureCosts* const costs = index_.kind().info()->costs;
  const std::size_t base = costs != nullptr && costs->has_cells ? kCells : kTree;
  const std::size_t share =
      index_.structure().is_flat() ? kFlat : base + 3 * out.size() / (4 * rows_.size() + 1);
  return share * rows_.changes().moved.ids().size() <= rows_.size() + 64;
}

// Strategies.

Status PairFinder::find_resting(SelfPairsQuery& query) {
  incremental_queries_.fetch_add(1, std::memory_order_relaxed);
  resting_.note_frame();
  PairBuffer& out = query.out;
  std::uint64_t tests = 0;
  const std::size_t kept = out.size();
  if (query.events) query.events->hold_none(out);
  if (!rows_.changes().moved.empty()) {
    if (!LinkedPairs(out).link(rows_.keys().slot_count()) || !select_moved_rows()) {
      return Status::out_of_memory;
    }
    const Status status = resting_.query_moved(out, tests);
    if (status != Status::ok) return status;
  }
  last_tests_.store(tests, std::memory_order_relaxed);
  return finish_in_place(query, kept, true);
}

Status PairFinder::find_linked(SelfPairsQuery& query) {
  incremental_queries_.fetch_add(1, std::memory_order_relaxed);
  PairBuffer& out = query.out;
  if (rows_.changes().moved.empty()) {
    last_tests_.store(0, std::memory_order_relaxed);
    return !query.events || query.events->store_changes(out, {}, {}, {}) ? Status::ok
                                                                         : Status::out_of_memory;
  }
  const std::size_t kept = out.size();
  if (query.events) query.events->hold_none(out);
  const Status status = query_moved(out, query.options.predicate);
  return status == Status::ok ? finish_in_place(query, kept, false) : status;
}

// Updates a linked buffer in place. Its pairs from `kept` on were found for moved objects.
Status PairFinder::finish_in_place(SelfPairsQuery& query, std::size_t kept, bool resting) {
  const std::span<const ObjectId> moved = rows_.changes().moved.ids();
  std::optional<EventWriter>& events = query.events;
  if (events) events->find_reused(moved);
  const auto reused = [&](ObjectId id) { return events && events->is_reused(id); };
  LinkedPairs linked(query.out);
  if (!linked.compare(kept, moved, rows_.changes().moved.bits(), reused) ||
      (resting && !resting_.note_watched(linked)) || !linked.sort() ||
      (events && !events->store_changes(query.out, linked.begun(), linked.ended(), moved))) {
    return Status::out_of_memory;
  }
  linked.apply();
  return Status::ok;
}

Status PairFinder::find_incremental(SelfPairsQuery& query) {
  incremental_queries_.fetch_add(1, std::memory_order_relaxed);
  PairBuffer& out = query.out;
  const ChangeList& moved = rows_.changes().moved;
  LinkedPairs(out).unlink_pairs(moved.ids().size(), rows_.size());
  Status status = Status::ok;
  if (moved.empty()) {
    if (query.events) query.events->hold_none(out);
    last_tests_.store(0, std::memory_order_relaxed);
  } else {
    if (!query.events) {
      PairTracker::drop(out, moved.bits());
    } else if (!query.events->hold_moved(out, moved.bits())) {
      return Status::out_of_memory;
    }
    status = query_moved(out, query.options.predicate);
  }
  return status == Status::ok ? finish_found(query, false) : status;
}

Status PairFinder::find_full(SelfPairsQuery& query) {
  LinkedPairs(query.out).unlink_pairs();
  if (query.events && !query.events->hold_all(query.out)) return Status::out_of_memory;
  query.out.clear();
  const Status status = query_all(query.out, query.options.predicate);
  return status == Status::ok ? finish_found(query, true) : status;
}

// Compares the pairs with those of the last frame for events, and sorts them. `all`: any object may
// have moved.
Status PairFinder::finish_found(SelfPairsQuery& query, bool all) noexcept {
  PairBuffer& out = query.out;
  std::size_t unsorted = out.size();
  if (query.events) {
    const auto moved = all ? std::span<const ObjectId>() : rows_.changes().moved.ids();
    if (!query.events->compare(out, moved, all)) return Status::out_of_memory;
    unsorted = query.events->persisting();
  }
  return query.options.order == Order::fast ||
                 PairTracker::sort(out, rows_.keys().slot_count(), 0, unsorted)
             ? Status::ok
             : Status::out_of_memory;
}

// Tracking.

// Marks the pairs in the buffer, and the events, as those of this frame.
void PairFinder::finish_frame(SelfPairsQuery& query) noexcept {
  // Even if the buffer is not tracked, events compare its serial.
  const PairBuffer::Provenance provenance{identity_, ++last_serial_};
  PairTracker::set_provenance(query.out, provenance);
  if (query.events) query.events->finish_frame(provenance);
  if (!query.tracked) return;
  rows_.changes().moved.clear();
  tracked_serial_ = provenance.serial;
}

// After a failure the buffer is empty or, if events follow it, contains the pairs of the last
// frame. In both cases the next query is a full one, so that its result does not depend on which
// allocation failed.
void PairFinder::undo(SelfPairsQuery& query) noexcept {
  // Some watched pairs may already have the state of the frame that failed.
  if (query.resting) forget_buffer();
  const PairBuffer::Provenance untracked{identity_, ++last_serial_};
  if (!query.events || !query.events->undo(query.out, untracked)) return query.out.clear();
  LinkedPairs(query.out).unlink_pairs();
}

bool PairFinder::is_exact() const noexcept {
  return rows_.pool().volume() == Volume::aabb && !rows_.has_margin() &&
         index_.structure().tests_volumes();
}

void PairFinder::add_statistics(Statistics& s) const noexcept {
  s.full_queries = full_queries_.load(std::memory_order_relaxed);
  s.incremental_queries = incremental_queries_.load(std::memory_order_relaxed);
  s.last_tests = last_tests_.load(std::memory_order_relaxed);
  s.last_pairs = last_pairs_.load(std::memory_order_relaxed);
}

}  // namespace winnow
