// Pair queries of PairFinder: of all objects, of moved objects, and of the objects of one partition
// with another. Each runs tasks that call kernels, and PairWriter joins their pairs.

#include "core/memory/volume_columns.h"
#include "partitions/pairs/pair_finder.h"
#include "partitions/pairs/pair_writer.h"
#include "partitions/structures/tasks.h"

#include <algorithm>

namespace winnow {
namespace {

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
struct PairFinder::FullTasks {
  std::size_t regular_tasks = 0;
  std::size_t tree_tasks = 0;
  std::size_t cross_tasks = 0;
  std::size_t groups_per_task = 1;
  std::size_t queries_per_task = kQueriesPerTask;
  std::size_t first_tree_row = 0;

  FullTasks(const Rows& rows, const SpatialIndex& index) noexcept
      : regular_tasks(index.structure().pair_tasks()),
        groups_per_task(std::max<std::size_t>(1, index.tree().groups() / kTreeTasks)),
        first_tree_row(index.tree().first_block() * kBlockRows) {
    if (index.structure().is_flat() || index.tree().blocks() == 0) return;
    tree_tasks = ceil_divide(index.tree().groups(), groups_per_task);
    if (rows.regions().regular != 0) {
      const std::size_t query_rows = rows.pool().rows() - first_tree_row;
      // Each task gets whole blocks.
      queries_per_task *= ceil_divide(query_rows, kTreeTasks * kQueriesPerTask);
      cross_tasks = ceil_divide(query_rows, queries_per_task);
    }
  }
  /// Returns the largest number of tasks for that many rows.
  [[nodiscard]] static std::size_t max_count(std::size_t most_rows) noexcept {
    const std::size_t groups = most_rows / (16 * kBlockRows) + 2;
    return std::min(kMaxTasks, most_rows) + std::min(2 * kTreeTasks, groups) +
           std::min(kTreeTasks, most_rows / kQueriesPerTask + 1);
  }
  [[nodiscard]] std::size_t count() const noexcept {
    return regular_tasks + tree_tasks + cross_tasks;
  }
};

Status PairFinder::query_all(PairBuffer& out, const PairPredicate& predicate) {
  const FullTasks tasks(rows_, index_);
  const Execution execution = rows_.execution_for(kPairWork * rows_.pool().rows());
  PairWriter writer(out, execution, predicate);
  const Status status = writer.append(
      tasks.count(), [&](std::size_t task, PairSink& sink) { return run_task(tasks, task, sink); });
  if (status != Status::ok) return status;
  full_queries_.fetch_add(1, std::memory_order_relaxed);
  note_work(writer.tests(), 1, RebuildPlanner::PairQueryKind::all);
  return Status::ok;
}

bool PairFinder::run_task(const FullTasks& tasks, std::size_t task, PairSink& sink) const noexcept {
  if (task < tasks.regular_tasks) return index_.structure().run_pair_task(task, sink);
  task -= tasks.regular_tasks;
  if (task < tasks.tree_tasks) {
    const BlockTree& tree = index_.tree();
    const std::size_t begin = task * tasks.groups_per_task;
    const std::size_t end = std::min(tree.groups(), begin + tasks.groups_per_task);
    return block_tree_kernels().self_pairs(tree.view(rows_.view()),
                                           static_cast<std::uint32_t>(begin),
                                           static_cast<std::uint32_t>(end), sink);
  }
  task -= tasks.tree_tasks;
  const std::size_t begin = tasks.first_tree_row + task * tasks.queries_per_task;
  const std::size_t end = std::min(rows_.pool().rows(), begin + tasks.queries_per_task);
  return index_.structure().query(volume_batch(rows_, begin, end), sink);
}

// Selects the rows of the live objects that moved. False if memory is refused.
bool PairFinder::select_moved_rows() const noexcept {
  const std::span<const ObjectId> moved = rows_.changes().moved.ids();
  const std::size_t limit = rows_.pool().rows();
  RowSelection& query_rows = rows_.selection();
  if (!query_rows.start(moved.size()) || !query_rows.reserve_bits(limit)) return false;
  for (const ObjectId id : moved) {
    if (rows_.keys().is_live(id)) query_rows.add(rows_.keys().row_of(id));
  }
  // Neighbours in the pool are neighbours in space: queries in row order share cache lines.
  query_rows.sort(limit);
  return true;
}

// Appends all pairs of the objects that moved.
Status PairFinder::query_moved(PairBuffer& out, const PairPredicate& predicate) {
  if (!select_moved_rows()) return Status::out_of_memory;
  RowSelection& query_rows = rows_.selection();
  const std::size_t count = query_rows.list.size();
  const Execution execution = rows_.execution_for(count);
  PairWriter writer(out, execution, predicate);
  query_rows.mark();
  const std::size_t tasks = ceil_divide(count, kQueriesPerTask);
  const Status status = writer.append(tasks, [&](std::size_t task, PairSink& sink) {
    const std::size_t begin = task * kQueriesPerTask;
    QueryBatch batch = volume_batch(rows_, begin, std::min(count, begin + kQueriesPerTask));
    batch.rows = query_rows.list.data();
    batch.mode = HitMode::moved;
    batch.moved = query_rows.bits.data();
    return index_.query(batch, sink);
  });
  query_rows.unmark();
  if (status != Status::ok) return status;
  note_work(writer.tests(), std::max<std::size_t>(1, count), RebuildPlanner::PairQueryKind::moved);
  return Status::ok;
}

void PairFinder::note_work(std::uint64_t tests, std::uint64_t queries,
                           RebuildPlanner::PairQueryKind kind) noexcept {
  last_tests_.store(tests, std::memory_order_relaxed);
  index_.planner().note_work(tests, queries, kind);
}

Status PairFinder::find_with(const PairFinder& other, HitMode mode, const PairPredicate& predicate,
                             PairBuffer& out) const {
  const Execution execution = rows_.execution_for(rows_.pool().rows());
  PairWriter writer(out, execution, predicate);
  const std::size_t tasks = ceil_divide(rows_.pool().rows(), kQueriesPerTask);
  const RowView view = rows_.view();
  const bool matches_all = surely_match(view.span, other.rows_.view().span);
  return writer.append(tasks, [&](std::size_t task, PairSink& sink) {
    const std::size_t begin = task * kQueriesPerTask;
    QueryBatch batch;
    std::copy_n(view.column, 6, batch.column);
    batch.filter = view.filter;
    batch.environments = view.environments;
    batch.matches_all = matches_all;
    batch.id = view.id;
    batch.begin = static_cast<std::uint32_t>(begin);
    batch.end = static_cast<std::uint32_t>(std::min(rows_.pool().rows(), begin + kQueriesPerTask));
    batch.mode = mode;
    return other.index_.query(batch, sink);
  });
}

bool PairFinder::reserve(PairBuffer& out, std::size_t pairs, std::size_t rows,
                         Pages pages) const noexcept {
  return PairWriter::reserve(out, pairs, FullTasks::max_count(rows), rows_.execution(), pages);
}

}  // namespace winnow
