// RowPartition: pairs.

#include "core/sort/bitmap_sort.h"
#include "partitions/pairs/event_writer.h"
#include "partitions/pairs/pair_tracker.h"
#include "partitions/pairs/pair_writer.h"
#include "partitions/rows/row_partition.h"

#include <algorithm>

namespace winnow {
namespace {

constexpr std::size_t kBlock = BoundsPool::kBlock;
constexpr std::size_t kQueriesPerTask = 64;
constexpr std::size_t kTreeTasks = 64;

constexpr std::size_t ceil_divide(std::size_t a, std::size_t b) {
  return (a + b - 1) / b;
}

}  // namespace

/// How the tasks of a full pair query are numbered: the regular region's own, then the tree's, then
/// the tree's rows against the regular region.
struct RowPartition::SelfTasks {
  std::size_t regular = 0;
  std::size_t tree = 0;
  std::size_t cross = 0;
  std::size_t groups_per_task = 1;
  std::size_t first_tree_row = 0;

  explicit SelfTasks(const RowPartition& p) noexcept
      : regular(p.regular_tasks()),
        groups_per_task(std::max<std::size_t>(1, p.tree_.groups() / kTreeTasks)),
        first_tree_row(p.tree_.first_block() * kBlock) {
    if (p.is_flat() || p.tree_.blocks() == 0) return;
    tree = ceil_divide(p.tree_.groups(), groups_per_task);
    if (p.regular_rows_ != 0) {
      cross = ceil_divide(p.pool_.rows() - first_tree_row, kQueriesPerTask);
    }
  }
  [[nodiscard]] std::size_t count() const noexcept { return regular + tree + cross; }
};

Status RowPartition::self_pairs(PairBuffer& out, const PairOptions& options) const {
  return find_self_pairs(out, options, nullptr);
}

Status RowPartition::self_pairs(PairBuffer& out, PairEvents& events,
                                const PairOptions& options) const {
  EventWriter writer(events, keys_, out, identity_, execution_);
  const Status status = find_self_pairs(out, options, &writer);
  if (status != Status::ok) writer.fail();
  return status;
}

Status RowPartition::find_self_pairs(PairBuffer& out, const PairOptions& options,
                                     EventWriter* events) const {
  if (const Status status = refresh(); status != Status::ok) {
    out.clear();
    return status;
  }
  // One buffer at a time is tracked; a query that runs beside a tracked one does without.
  const std::unique_lock lock(tracker_mutex_, std::try_to_lock);
  const bool tracked = lock.owns_lock() && options.incremental;
  const bool update = tracked && can_update(out);
  Status status = update ? incremental_self_pairs(out, options.predicate, events)
                         : full_self_pairs(out, options.predicate, events);
  if (status == Status::ok && !finish_pairs(out, options.order, !update, events)) {
    status = Status::out_of_memory;
  }
  if (status != Status::ok) {
    out.clear();
    return status;
  }
  last_pairs_.store(out.size(), std::memory_order_relaxed);
  if (!tracked && events == nullptr) return Status::ok;
  // Untracked, the serial still tells the events whose frame the buffer holds.
  const PairBuffer::Provenance provenance{identity_, ++last_serial_};
  PairTracker::set_provenance(out, provenance);
  if (events != nullptr) events->set_provenance(provenance);
  if (tracked) {
    moved_.clear();
    tracked_serial_ = provenance.serial;
  }
  return Status::ok;
}

bool RowPartition::finish_pairs(PairBuffer& out, Order order, bool all,
                                EventWriter* events) const noexcept {
  std::size_t unsorted = out.size();
  if (events != nullptr) {
    const auto moved = all ? std::span<const ObjectId>() : moved_.ids();
    if (!events->compare(out, moved, all)) return false;
    unsorted = events->persisting();
  }
  return order == Order::fast || PairTracker::sort(out, keys_.slot_count(), unsorted);
}

bool RowPartition::can_update(const PairBuffer& out) const noexcept {
  return tracked_serial_ != 0 && !moved_.all() &&
         PairTracker::provenance(out) == PairBuffer::Provenance{identity_, tracked_serial_};
}

Status RowPartition::full_self_pairs(PairBuffer& out, const PairPredicate& predicate,
                                     EventWriter* events) const {
  if (events != nullptr && !events->hold_all(out)) return Status::out_of_memory;
  out.clear();
  const SelfTasks tasks(*this);
  const Execution execution = execution_for(pool_.rows());
  PairWriter writer(out, execution, predicate);
  const Status status = writer.append(tasks.count(), [&](std::size_t task, PairSink& sink) {
    return run_self_task(tasks, task, sink);
  });
  if (status != Status::ok) return status;
  full_queries_.fetch_add(1, std::memory_order_relaxed);
  note_work(writer.tests(), 1, full_base_);
  return Status::ok;
}

bool RowPartition::run_self_task(const SelfTasks& tasks, std::size_t task,
                                 PairSink& sink) const noexcept {
  if (task < tasks.regular) return run_regular_task(task, sink);
  task -= tasks.regular;
  const RowView rows = row_view();
  if (task < tasks.tree) {
    const std::size_t begin = task * tasks.groups_per_task;
    const std::size_t end = std::min(tree_.groups(), begin + tasks.groups_per_task);
    return block_tree_kernels().self_pairs(tree_.view(rows), static_cast<std::uint32_t>(begin),
                                           static_cast<std::uint32_t>(end), sink);
  }
  task -= tasks.tree;
  const std::size_t begin = tasks.first_tree_row + task * kQueriesPerTask;
  QueryBatch batch;
  std::copy_n(rows.column, kMaxColumns, batch.column);
  batch.is_box = pool_.volume() == Volume::aabb;
  batch.id = rows.id;
  batch.filter = rows.filter;
  batch.begin = static_cast<std::uint32_t>(begin);
  batch.end = static_cast<std::uint32_t>(std::min(pool_.rows(), begin + kQueriesPerTask));
  return query_regular(batch, sink);
}

Status RowPartition::incremental_self_pairs(PairBuffer& out, const PairPredicate& predicate,
                                            EventWriter* events) const {
  incremental_queries_.fetch_add(1, std::memory_order_relaxed);
  if (moved_.ids().empty()) {
    if (events != nullptr) events->hold_none(out);
    last_tests_.store(0, std::memory_order_relaxed);
    return Status::ok;
  }
  list_.clear();
  if (!list_.grow(moved_.ids().size()) || !words_.grow(bitmap_words(pool_.rows()))) {
    return Status::out_of_memory;
  }
  for (const ObjectId id : moved_.ids()) {
    if (keys_.is_live(id)) (void)list_.push_back(keys_.row_of(id));
  }
  // Neighbours in the pool are neighbours in space: in row order queries share cache lines.
  list_.set_size(sort_unique({list_.data(), list_.size()}, pool_.rows(), words_));
  if (events == nullptr) {
    PairTracker::drop(out, moved_.bits());
  } else if (!events->hold_moved(out, moved_.bits())) {
    return Status::out_of_memory;
  }
  const Execution execution = execution_for(list_.size());
  PairWriter writer(out, execution, predicate);
  const std::size_t tasks = ceil_divide(list_.size(), kQueriesPerTask);
  const Status status = writer.append(tasks, [&](std::size_t task, PairSink& sink) {
    QueryBatch batch;
    std::copy_n(row_view().column, kMaxColumns, batch.column);
    batch.is_box = pool_.volume() == Volume::aabb;
    batch.id = pool_.ids();
    batch.filter = filters_.data();
    batch.rows = list_.data();
    batch.begin = static_cast<std::uint32_t>(task * kQueriesPerTask);
    batch.end = static_cast<std::uint32_t>(std::min(list_.size(), (task + 1) * kQueriesPerTask));
    batch.mode = HitMode::moved;
    batch.moved = words_.data();
    return query_all(batch, sink);
  });
  if (status != Status::ok) return status;
  note_work(writer.tests(), std::max<std::size_t>(1, list_.size()), moved_base_);
  return Status::ok;
}

bool RowPartition::query_all(const QueryBatch& batch, PairSink& sink) const noexcept {
  if (regular_rows_ != 0 && !query_regular(batch, sink)) return false;
  if (is_flat() || tree_.blocks() == 0) return true;
  return block_tree_kernels().query(tree_.view(row_view()), batch, sink);
}

Status RowPartition::pairs_with(const Partition& other, PairBuffer& out,
                                const PairOptions& options) const {
  out.clear();
  if (const Status status = refresh(); status != Status::ok) return status;
  if (const Status status = other.refresh(); status != Status::ok) return status;
  // Only now: a refresh may hand the other's objects from one partition to another.
  const RowPartition* const rows = other.row_partition();
  if (rows == nullptr) return Status::invalid_argument;
  // The smaller side asks: each question costs about the logarithm of the side that is asked.
  const Status status = size() <= rows->size()
                            ? ask(*rows, HitMode::query_first, options.predicate, out)
                            : rows->ask(*this, HitMode::query_second, options.predicate, out);
  const std::size_t slots = std::max(keys_.slot_count(), rows->keys_.slot_count());
  if (status == Status::ok && (options.order == Order::fast || PairTracker::sort(out, slots))) {
    return Status::ok;
  }
  out.clear();
  return Status::out_of_memory;
}

Status RowPartition::ask(const RowPartition& other, HitMode mode, const PairPredicate& predicate,
                         PairBuffer& out) const {
  const Execution execution = execution_for(pool_.rows());
  PairWriter writer(out, execution, predicate);
  const std::size_t tasks = ceil_divide(pool_.rows(), kQueriesPerTask);
  return writer.append(tasks, [&](std::size_t task, PairSink& sink) {
    const std::size_t begin = task * kQueriesPerTask;
    QueryBatch batch = box_batch(begin, std::min(pool_.rows(), begin + kQueriesPerTask));
    batch.mode = mode;
    return other.query_all(batch, sink);
  });
}

QueryBatch RowPartition::box_batch(std::size_t begin, std::size_t end) const noexcept {
  QueryBatch batch;
  std::copy_n(row_view().column, 6, batch.column);
  batch.filter = filters_.data();
  batch.id = pool_.ids();
  batch.begin = static_cast<std::uint32_t>(begin);
  batch.end = static_cast<std::uint32_t>(end);
  return batch;
}

void RowPartition::note_work(std::uint64_t tests, std::uint64_t queries,
                             std::atomic<std::uint64_t>& base) const noexcept {
  last_tests_.store(tests, std::memory_order_relaxed);
  // The first query after a build sets what a query costs on a fresh structure.
  const std::uint64_t each = tests / queries + 1;
  std::uint64_t expected = 0;
  if (base.compare_exchange_strong(expected, each, std::memory_order_relaxed)) return;
  if (each > expected) {
    excess_.fetch_add((each - expected) * queries, std::memory_order_relaxed);
  }
}

}  // namespace winnow
