// Pair queries of a partition. run_self_pairs chooses one of four strategies to find all pairs:
//
//   resting      boxes are deferred, at most 1/16 of the objects left their skin, no predicate
//   linked       nothing moved, or few objects moved in two consecutive frames (LinkedPairs)
//   incremental  the buffer is tracked, and few objects moved or events are reported
//   full         otherwise
//
// Resting and linked also require a tracked buffer, Order::fast, and events that describe the frame
// of the buffer, if there are any. The strategy `resting` is in resting_pairs.cpp. Tasks write
// through PairWriter; EventWriter finds events.

#include "core/hooks/log.h"
#include "core/hooks/stage_scope.h"
#include "core/threads/float_environment.h"
#include "partitions/pairs/event_writer.h"
#include "partitions/pairs/linked_pairs.h"
#include "partitions/pairs/pair_tracker.h"
#include "partitions/pairs/pair_writer.h"
#include "partitions/state/partition_state.h"
#include "partitions/structures/costs.h"
#include "partitions/structures/tasks.h"

#include <algorithm>

namespace winnow {
namespace {

constexpr const char* kSelfPairs = "Partition::self_pairs";
constexpr std::size_t kQueriesPerTask = 64;
constexpr std::size_t kTreeTasks = 64;
// Cost of a full pair query per object, relative to other work per object.
constexpr std::size_t kPairWork = 2;

constexpr std::size_t ceil_divide(std::size_t a, std::size_t b) {
  return (a + b - 1) / b;
}

/// Rows [begin, end) of a partition as queries with their own volumes.
QueryBatch volume_batch(const Rows& rows, std::size_t begin, std::size_t end) noexcept {
  const RowView view = rows.view();
  QueryBatch batch;
  std::copy_n(view.column, kMaxColumns, batch.column);
  batch.is_box = rows.pool().volume() == Volume::aabb;
  batch.id = view.id;
  batch.filter = view.filter;
  batch.environments = view.environments;
  batch.matches_all = view.all_match;
  batch.begin = static_cast<std::uint32_t>(begin);
  batch.end = static_cast<std::uint32_t>(end);
  return batch;
}

}  // namespace

/// Tasks of a full pair query in order: the structure's tasks for regular rows, tasks over the
/// tree, and the rows of the tree against the regular rows.
struct PartitionState::SelfTasks {
  std::size_t regular = 0;
  std::size_t tree = 0;
  std::size_t cross = 0;
  std::size_t groups_per_task = 1;
  std::size_t queries_per_task = kQueriesPerTask;
  std::size_t first_tree_row = 0;

  explicit SelfTasks(const PartitionState& p) noexcept
      : regular(p.index.structure().pair_tasks()),
        groups_per_task(std::max<std::size_t>(1, p.index.tree().groups() / kTreeTasks)),
        first_tree_row(p.index.tree().first_block() * kBlockRows) {
    if (p.index.structure().is_flat() || p.index.tree().blocks() == 0) return;
    tree = ceil_divide(p.index.tree().groups(), groups_per_task);
    if (p.rows.regions().regular != 0) {
      const std::size_t query_rows = p.rows.pool().rows() - first_tree_row;
      // Each task gets whole blocks.
      queries_per_task *= ceil_divide(query_rows, kTreeTasks * kQueriesPerTask);
      cross = ceil_divide(query_rows, queries_per_task);
    }
  }
  /// Returns the largest number of tasks for that many rows.
  [[nodiscard]] static std::size_t max_count(std::size_t rows) noexcept {
    const std::size_t groups = rows / (16 * kBlockRows) + 2;
    return std::min(kMaxTasks, rows) + std::min(2 * kTreeTasks, groups) +
           std::min(kTreeTasks, rows / kQueriesPerTask + 1);
  }
  [[nodiscard]] std::size_t count() const noexcept { return regular + tree + cross; }
};

Status Partition::self_pairs(PairBuffer& out, const PairOptions& options) const {
  const DefaultFloatEnvironment environment;
  if (state_ != nullptr) return state_->find_self_pairs(out, options, nullptr);
  out.clear();
  return status_;
}

Status Partition::self_pairs(PairBuffer& out, PairEvents& events,
                             const PairOptions& options) const {
  const DefaultFloatEnvironment environment;
  if (state_ != nullptr) return state_->find_self_pairs(out, options, &events);
  out.clear();
  events.clear();
  return status_;
}

Status Partition::reserve_pairs(PairBuffer& out, std::size_t pairs, Pages pages) const {
  const DefaultFloatEnvironment environment;
  return state_ == nullptr ? status_ : state_->reserve_pairs(out, pairs, pages);
}

Status Partition::reserve_events(PairEvents& out, std::size_t pairs, bool with_pairs,
                                 Pages pages) const {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return status_;
  if (!state_->reserve_events(out, pairs, pages)) return Status::out_of_memory;
  return with_pairs ? reserve_pairs(EventWriter::own_buffer(out), pairs, pages) : Status::ok;
}

Status Partition::self_pairs(PairEvents& events, const PairOptions& options) const {
  const DefaultFloatEnvironment environment;
  // Order::fast: events are sorted anyway, and the pairs are not returned.
  return self_pairs(EventWriter::own_buffer(events), events,
                    {Order::fast, options.incremental, options.predicate});
}

Status PartitionState::reserve_pairs(PairBuffer& out, std::size_t pairs,
                                     Pages pages) const noexcept {
  const std::size_t tasks =
      SelfTasks::max_count(with_stable_index([this] { return rows.pool().capacity(); }));
  return PairWriter::reserve(out, pairs, tasks, rows.execution(), pages) ? Status::ok
                                                                         : Status::out_of_memory;
}

bool PartitionState::reserve_events(PairEvents& out, std::size_t pairs,
                                    Pages pages) const noexcept {
  const std::size_t objects = with_stable_index([this] { return rows.keys().capacity(); });
  return EventWriter::reserve(out, pairs, objects, pages);
}

Status PartitionState::find_self_pairs(PairBuffer& out, const PairOptions& options,
                                       PairEvents* events) const {
  const StageScope stage(WorkStage::pairs);
  if (events == nullptr) return logged(run_self_pairs(out, options, nullptr), kSelfPairs);
  EventWriter writer(*events, rows.keys(), out, pairs_.identity, rows.execution());
  return logged(run_self_pairs(out, options, &writer), kSelfPairs);
}

Status PartitionState::run_self_pairs(PairBuffer& out, const PairOptions& options,
                                      EventWriter* events) const {
  // Only one buffer is tracked at a time. A query concurrent with a tracked one is not tracked.
  Lock lock = Lock::try_acquire(tracker_mutex_);
  const bool all = !options.incremental || out.empty();
  const bool tracked = lock.owns_lock() && options.incremental;
  Status status = refresh();
  const bool resting = status == Status::ok && tracked && can_stay_deferred(out, options, events);
  if (status == Status::ok && deferred_.active() && !resting) {
    if (!lock.owns_lock()) lock.lock();
    end_deferring();
    status = refresh();
  }
  const bool all_anew = tracked && !can_update(out);
  if (status == Status::ok) {
    count_queries(QueryKind::pairs, 1);
    status =
        resting ? resting_self_pairs(out, events) : track_self_pairs(out, options, tracked, events);
  }
  if (status != Status::ok) {
    undo_self_pairs(out, resting, events);
    return status;
  }
  pairs_.last_pairs.store(out.size(), std::memory_order_relaxed);
  if (tracked || events != nullptr) finish_frame(out, tracked, events);
  if (all_anew) try_start_resting(out, options);
  if (chooser_ == nullptr) return Status::ok;
  if (all) count_queries(QueryKind::all_pairs, 1);
  // The number of pairs that pass a predicate is not a property of the scene.
  if (options.predicate.accept == nullptr) chooser_->note_pairs(out.size());
  return Status::ok;
}

// Marks the pairs in the buffer, and the events, as those of this frame.
void PartitionState::finish_frame(PairBuffer& out, bool tracked,
                                  EventWriter* events) const noexcept {
  // Even if the buffer is not tracked, events compare its serial.
  const PairBuffer::Provenance provenance{pairs_.identity, ++pairs_.last_serial};
  PairTracker::set_provenance(out, provenance);
  if (events != nullptr) events->finish_frame(provenance);
  if (!tracked) return;
  rows.forget_moves();
  pairs_.tracked_serial = provenance.serial;
}

// After a failure the buffer is empty or, if events follow it, contains the pairs of the last
// frame. In both cases the next query is a full one, so that its result does not depend on which
// allocation failed.
void PartitionState::undo_self_pairs(PairBuffer& out, bool resting,
                                     EventWriter* events) const noexcept {
  // Some watched pairs may already have the state of the frame that failed.
  if (resting) pairs_.tracked_serial = 0;
  const PairBuffer::Provenance untracked{pairs_.identity, ++pairs_.last_serial};
  if (events == nullptr || !events->undo(out, untracked)) return out.clear();
  LinkedPairs(out).unlink_pairs();
}

bool PartitionState::can_update_in_place(const PairBuffer& out, const PairOptions& options,
                                         const EventWriter* events) const noexcept {
  // An update in place changes the order of the pairs. The events, if there are any, must describe
  // the frame whose pairs `out` contains.
  return can_update(out) && options.order == Order::fast &&
         (events == nullptr || events->follows());
}

Status PartitionState::track_self_pairs(PairBuffer& out, const PairOptions& options, bool tracked,
                                        EventWriter* events) const {
  if (tracked && can_update_in_place(out, options, events) && update_in_place(out)) {
    return linked_self_pairs(out, options.predicate, events);
  }
  const bool update = tracked && can_update(out) && (events != nullptr || is_update_cheaper(out));
  return redo_self_pairs(out, options, update, events);
}

// True if querying with the moved objects costs less than a full query. Without pruning a full
// query is O(n^2). Otherwise the limit is lower if objects have many pairs, which are dropped and
// found again, and if the structure has cells, because a full query visits consecutive cells
// without searching them.
bool PartitionState::is_update_cheaper(const PairBuffer& out) const noexcept {
  constexpr std::size_t kFlat = 4;
  constexpr std::size_t kTree = 8;
  constexpr std::size_t kCells = 10;
  const StructureCosts* const costs = index.kind().info()->costs;
  const std::size_t base = costs != nullptr && costs->has_cells ? kCells : kTree;
  const std::size_t share =
      index.structure().is_flat() ? kFlat : base + 3 * out.size() / (4 * rows.size() + 1);
  return share * rows.moved().ids().size() <= rows.size() + 64;
}

// True if nothing moved, or if few objects moved (LinkedPairs::is_due) and the buffer is linked.
// Links the buffer if necessary; false if memory for that is refused.
bool PartitionState::update_in_place(PairBuffer& out) const noexcept {
  const std::size_t moved = rows.moved().ids().size();
  LinkedPairs linked(out);
  return moved == 0 || (linked.is_due(moved, rows.size()) && linked.link(rows.keys().slot_count()));
}

Status PartitionState::linked_self_pairs(PairBuffer& out, const PairPredicate& predicate,
                                         EventWriter* events) const {
  pairs_.incremental_queries.fetch_add(1, std::memory_order_relaxed);
  const std::span<const ObjectId> moved = rows.moved().ids();
  if (moved.empty()) {
    pairs_.last_tests.store(0, std::memory_order_relaxed);
    return events == nullptr || events->store_changes(out, {}, {}, {}) ? Status::ok
                                                                       : Status::out_of_memory;
  }
  const std::size_t kept = out.size();
  if (events != nullptr) events->hold_none(out);
  if (const Status status = query_moved(out, predicate); status != Status::ok) return status;
  if (events != nullptr) events->find_reused(moved);
  const auto reused = [&](ObjectId id) { return events != nullptr && events->is_reused(id); };
  LinkedPairs linked(out);
  if (!linked.compare(kept, moved, rows.moved().bits(), reused) || !linked.sort() ||
      (events != nullptr && !events->store_changes(out, linked.begun(), linked.ended(), moved))) {
    return Status::out_of_memory;
  }
  linked.apply();
  return Status::ok;
}

Status PartitionState::redo_self_pairs(PairBuffer& out, const PairOptions& options, bool update,
                                       EventWriter* events) const {
  LinkedPairs linked(out);
  if (update) {
    linked.unlink_pairs(rows.moved().ids().size(), rows.size());
  } else {
    linked.unlink_pairs();
  }
  const Status status = update ? incremental_self_pairs(out, options.predicate, events)
                               : full_self_pairs(out, options.predicate, events);
  if (status != Status::ok) return status;
  return finish_pairs(out, options.order, !update, events) ? Status::ok : Status::out_of_memory;
}

bool PartitionState::finish_pairs(PairBuffer& out, Order order, bool all,
                                  EventWriter* events) const noexcept {
  std::size_t unsorted = out.size();
  if (events != nullptr) {
    const auto moved = all ? std::span<const ObjectId>() : rows.moved().ids();
    if (!events->compare(out, moved, all)) return false;
    unsorted = events->persisting();
  }
  return order == Order::fast || PairTracker::sort(out, rows.keys().slot_count(), 0, unsorted);
}

bool PartitionState::can_update(const PairBuffer& out) const noexcept {
  return pairs_.tracked_serial != 0 && !rows.moved().all() &&
         PairTracker::provenance(out) ==
             PairBuffer::Provenance{pairs_.identity, pairs_.tracked_serial};
}

Status PartitionState::full_self_pairs(PairBuffer& out, const PairPredicate& predicate,
                                       EventWriter* events) const {
  if (events != nullptr && !events->hold_all(out)) return Status::out_of_memory;
  out.clear();
  const SelfTasks tasks(*this);
  const Execution execution = rows.execution_for(kPairWork * rows.pool().rows());
  PairWriter writer(out, execution, predicate);
  const Status status = writer.append(tasks.count(), [&](std::size_t task, PairSink& sink) {
    return run_self_task(tasks, task, sink);
  });
  if (status != Status::ok) return status;
  pairs_.full_queries.fetch_add(1, std::memory_order_relaxed);
  note_work(writer.tests(), 1, SpatialIndex::PairQueryKind::all);
  return Status::ok;
}

bool PartitionState::run_self_task(const SelfTasks& tasks, std::size_t task,
                                   PairSink& sink) const noexcept {
  if (task < tasks.regular) return index.structure().run_pair_task(task, sink);
  task -= tasks.regular;
  if (task < tasks.tree) {
    const BlockTree& tree = index.tree();
    const std::size_t begin = task * tasks.groups_per_task;
    const std::size_t end = std::min(tree.groups(), begin + tasks.groups_per_task);
    return block_tree_kernels().self_pairs(tree.view(rows.view()),
                                           static_cast<std::uint32_t>(begin),
                                           static_cast<std::uint32_t>(end), sink);
  }
  task -= tasks.tree;
  const std::size_t begin = tasks.first_tree_row + task * tasks.queries_per_task;
  const std::size_t end = std::min(rows.pool().rows(), begin + tasks.queries_per_task);
  return index.structure().query(volume_batch(rows, begin, end), sink);
}

Status PartitionState::incremental_self_pairs(PairBuffer& out, const PairPredicate& predicate,
                                              EventWriter* events) const {
  pairs_.incremental_queries.fetch_add(1, std::memory_order_relaxed);
  if (rows.moved().empty()) {
    if (events != nullptr) events->hold_none(out);
    pairs_.last_tests.store(0, std::memory_order_relaxed);
    return Status::ok;
  }
  if (events == nullptr) {
    PairTracker::drop(out, rows.moved().bits());
  } else if (!events->hold_moved(out, rows.moved().bits())) {
    return Status::out_of_memory;
  }
  return query_moved(out, predicate);
}

// Selects the rows of the live objects that moved. False if memory is refused.
bool PartitionState::select_moved_rows() const noexcept {
  const std::span<const ObjectId> moved = rows.moved().ids();
  const std::size_t limit = rows.pool().rows();
  RowSelection& query_rows = rows.selection();
  if (!query_rows.start(moved.size()) || !query_rows.reserve_bits(limit)) return false;
  for (const ObjectId id : moved) {
    if (rows.keys().is_live(id)) query_rows.add(rows.keys().row_of(id));
  }
  // Neighbours in the pool are neighbours in space: queries in row order share cache lines.
  query_rows.sort(limit);
  return true;
}

// Appends all pairs of the objects that moved.
Status PartitionState::query_moved(PairBuffer& out, const PairPredicate& predicate) const {
  if (!select_moved_rows()) return Status::out_of_memory;
  RowSelection& query_rows = rows.selection();
  const std::size_t count = query_rows.list.size();
  const Execution execution = rows.execution_for(count);
  PairWriter writer(out, execution, predicate);
  query_rows.mark();
  const std::size_t tasks = ceil_divide(count, kQueriesPerTask);
  const Status status = writer.append(tasks, [&](std::size_t task, PairSink& sink) {
    const std::size_t begin = task * kQueriesPerTask;
    QueryBatch batch = volume_batch(rows, begin, std::min(count, begin + kQueriesPerTask));
    batch.rows = query_rows.list.data();
    batch.mode = HitMode::moved;
    batch.moved = query_rows.bits.data();
    return index.query(batch, sink);
  });
  query_rows.unmark();
  if (status != Status::ok) return status;
  note_work(writer.tests(), std::max<std::size_t>(1, count), SpatialIndex::PairQueryKind::moved);
  return Status::ok;
}

void PartitionState::note_work(std::uint64_t tests, std::uint64_t queries,
                               SpatialIndex::PairQueryKind kind) const noexcept {
  pairs_.last_tests.store(tests, std::memory_order_relaxed);
  index.note_work(tests, queries, kind);
}

Status Partition::pairs_with(const Partition& other, PairBuffer& out,
                             const PairOptions& options) const {
  const DefaultFloatEnvironment environment;
  out.clear();
  if (state_ == nullptr || other.state_ == nullptr) {
    return state_ == nullptr ? status_ : other.status_;
  }
  const StageScope stage(WorkStage::pairs);
  const PartitionState& mine = *state_;
  const PartitionState& theirs = *other.state_;
  if (const Status status = mine.settle(); status != Status::ok) return status;
  if (const Status status = theirs.settle(); status != Status::ok) return status;
  // Query with the smaller side: each query costs about the logarithm of the other side.
  const Status status =
      size() <= other.size()
          ? mine.query_other(theirs, HitMode::query_first, options.predicate, out)
          : theirs.query_other(mine, HitMode::query_second, options.predicate, out);
  const std::size_t slots =
      std::max(mine.rows.keys().slot_count(), theirs.rows.keys().slot_count());
  if (status == Status::ok && (options.order == Order::fast || PairTracker::sort(out, slots))) {
    return Status::ok;
  }
  out.clear();
  return Status::out_of_memory;
}

Status PartitionState::query_other(const PartitionState& other, HitMode mode,
                                   const PairPredicate& predicate, PairBuffer& out) const {
  const Execution execution = rows.execution_for(rows.pool().rows());
  PairWriter writer(out, execution, predicate);
  const std::size_t tasks = ceil_divide(rows.pool().rows(), kQueriesPerTask);
  const RowView view = rows.view();
  const bool matches_all = surely_match(view.span, other.rows.view().span);
  return writer.append(tasks, [&](std::size_t task, PairSink& sink) {
    const std::size_t begin = task * kQueriesPerTask;
    QueryBatch batch;
    std::copy_n(view.column, 6, batch.column);
    batch.filter = view.filter;
    batch.environments = view.environments;
    batch.matches_all = matches_all;
    batch.id = view.id;
    batch.begin = static_cast<std::uint32_t>(begin);
    batch.end = static_cast<std::uint32_t>(std::min(rows.pool().rows(), begin + kQueriesPerTask));
    batch.mode = mode;
    return other.index.query(batch, sink);
  });
}

}  // namespace winnow
