// RowPartition: how the structure follows the rows.

#include "core/sort/bitmap_sort.h"
#include "partitions/rows/row_mutation.h"
#include "partitions/rows/row_partition.h"
#include "partitions/tree/environment_order.h"
#include "partitions/tree/kd_order.h"

#include <algorithm>
#include <numeric>

namespace winnow {
namespace {

constexpr std::size_t kBlock = BoundsPool::kBlock;

}  // namespace

Execution RowPartition::execution_for(std::size_t objects) const noexcept {
  // Below this a task costs more to hand over than to do.
  constexpr std::size_t kWorthSharing = 1536;
  return objects < kWorthSharing ? Execution::serial() : execution_;
}

Status RowPartition::refresh() const {
  if (!dirty_.load(std::memory_order_acquire)) return Status::ok;
  const std::lock_guard lock(refresh_mutex_);
  if (!dirty_.load(std::memory_order_relaxed)) return Status::ok;
  // The structure is a cache of the rows: bringing it up to date is no change that a caller of a
  // const query can see.
  const Status status = const_cast<RowPartition*>(this)->refresh_now();
  if (status == Status::ok) dirty_.store(false, std::memory_order_release);
  return status;
}

Status RowPartition::refresh_now() {
  pool_.pad();
  const Status status = needs_build() ? build() : absorb_changes();
  queries_stale_.store(true, std::memory_order_relaxed);
  if (status == Status::ok) forward_changes();
  return status;
}

bool RowPartition::needs_build() const noexcept {
  if (!built_) return true;
  const std::size_t live = keys_.size();
  const std::size_t tail = pool_.rows() > built_rows_ ? pool_.rows() - built_rows_ : 0;
  const std::size_t holes = pool_.rows() - live;
  if (holes > live / 4 + built_holes_ + 64) return true;
  if (filters_.has_environments() && wants_grouping()) return true;
  if (is_flat()) return false;
  return tail > tail_limit() ||
         excess_.load(std::memory_order_relaxed) > build_price() * (live + 64);
}

// Rows of many environments are in no order that keeps them apart: in cells, new, or moved from one
// environment to another.
bool RowPartition::wants_grouping() const noexcept {
  if (!is_flat()) return regular_rows_ != 0 || filters_.changed_environments() > tail_limit();
  return pool_.rows() - sorted_rows_ + filters_.changed_environments() > tail_limit();
}

bool RowPartition::plan(Column<std::uint32_t>&, Column<std::uint32_t>& rest) {
  for (std::size_t row = 0; row < pool_.rows(); ++row) {
    if (pool_.ids()[row] != kNoObject) (void)rest.push_back(static_cast<std::uint32_t>(row));
  }
  return true;
}

Status RowPartition::build() {
  if (is_flat()) return build_flat();
  // The rows are untouched until everything that can fail is done; the structure may be half
  // planned.
  built_ = false;
  const std::size_t spare = prunes_rows() ? 2 * tail_limit() : 0;
  const std::size_t room = pool_.rows() + spare + 4 * kBlock;
  order_.clear();
  list_.clear();
  if (!order_.grow(room) || !list_.grow(room)) return Status::out_of_memory;
  // Cells of many worlds would lie on top of each other, and a cell's objects be tested against
  // those of all of them: the tree, whose nodes know their environments, keeps them apart.
  const bool planned =
      filters_.has_environments() ? RowPartition::plan(order_, list_) : plan(order_, list_);
  if (!planned) return Status::out_of_memory;
  const std::size_t regular = order_.size();
  // The tree's blocks begin behind the regular ones: no block belongs to both.
  while (order_.size() % kBlock != 0) (void)order_.push_back(kNoObject);
  const std::size_t first_block = order_.size() / kBlock;
  if (!order_rest({list_.data(), list_.size()}, order_)) return Status::out_of_memory;
  const std::size_t rows = order_.size();
  if (!pool_.reserve_exact(rows + spare) || !spare_.reserve(pool_.capacity() + 2 * kBlock)) {
    return Status::out_of_memory;
  }
  if (!tree_.cover(first_block, (rows + kBlock - 1) / kBlock - first_block, node_content())) {
    return Status::out_of_memory;
  }
  if (prunes_rows() && !row_tree_.cover(0, (regular + kBlock - 1) / kBlock, node_content())) {
    return Status::out_of_memory;
  }

  const Execution execution = execution_for(rows);
  pool_.reorder({order_.data(), rows}, spare_, execution);
  for_ranges(execution, rows, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const ObjectId id = pool_.ids()[row];
      if (id != kNoObject) keys_.set_row(id, static_cast<std::uint32_t>(row));
    }
  });
  regular_rows_ = regular;
  built_rows_ = sorted_rows_ = rows;
  built_holes_ = rows - keys_.size();
  finish_build();
  tree_.refit_all(row_view(), execution);
  built_edge_ = tree_.typical_edge();
  if (prunes_rows()) row_tree_.refit_all(row_view(), execution);
  built_ = true;
  ++builds_;
  filters_.note_build();
  full_base_ = moved_base_ = excess_ = 0;
  return Status::ok;
}

bool RowPartition::order_rest(std::span<std::uint32_t> rest, Column<std::uint32_t>& order) {
  if (!sort_by_place(rest, execution_for(rest.size()))) return false;
  if (filters_.has_environments()) {
    return append_environments(pool_, filters_.data(), rest, order);
  }
  if (!order.resize(order.size() + rest.size())) return false;
  std::copy(rest.begin(), rest.end(), order.end() - rest.size());
  return true;
}

// Measured on both sides of the decision.
std::uint64_t RowPartition::build_price() const noexcept {
  return 12;
}

Status RowPartition::build_flat() {
  compact_rows();
  pool_.pad();
  const std::size_t rows = pool_.rows();
  regular_rows_ = rows;
  sorted_rows_ = 0;
  if (filters_.has_environments()) {
    if (!order_.resize(rows) || !spare_.reserve(pool_.capacity() + 2 * kBlock)) {
      return Status::out_of_memory;
    }
    std::iota(order_.begin(), order_.end(), 0U);
    const Execution execution = execution_for(rows);
    if (!sort_by_environment(pool_, filters_.data(), {order_.data(), rows}, sort_scratch_,
                             execution)) {
      return Status::out_of_memory;
    }
    pool_.reorder({order_.data(), rows}, spare_, execution);
    for (std::size_t row = 0; row < rows; ++row) {
      keys_.set_row(pool_.ids()[row], static_cast<std::uint32_t>(row));
    }
    sorted_rows_ = rows;
  }
  tail_changed_ = true;
  if (!refit_tree()) return Status::out_of_memory;
  built_ = true;
  ++builds_;
  filters_.note_build();
  return Status::ok;
}

bool RowPartition::sort_by_place(std::span<std::uint32_t> rows, const Execution& execution) {
  return filters_.has_environments()
             ? sort_by_environment_and_place(pool_, filters_.data(), rows, sort_scratch_,
                                             kd_scratch_, execution)
             : sort_by_kd_cuts(pool_, rows, kd_scratch_, execution);
}

Status RowPartition::absorb_changes() {
  ++refits_;
  if (is_flat()) {
    regular_rows_ = pool_.rows();
    return refit_tree() ? Status::ok : Status::out_of_memory;
  }
  const std::size_t limit = tail_limit();
  list_.clear();
  if (!list_.grow(limit + 1)) return Status::out_of_memory;
  collect_misfits(limit + 1);
  const std::size_t tail = pool_.rows() > built_rows_ ? pool_.rows() - built_rows_ : 0;
  if (tail + list_.size() > limit) return build();
  if (!move_to_tail({list_.data(), list_.size()}) || !sort_tail()) return Status::out_of_memory;
  if (!refit_tree()) return Status::out_of_memory;
  return is_torn() ? build() : Status::ok;
}

// Where everything jumped, one query of a tree in the old order would cost many builds: leaves tell
// before it is asked. Slow wear is left to the count of tests.
bool RowPartition::is_torn() const noexcept {
  constexpr float kTorn = 2.0F;
  // Cells and strips find what left them; beside them the tree holds what is of many kinds.
  if (regular_rows_ != 0 || !stale_.all()) return false;
  return built_edge_ > 0.0F && tree_.typical_edge() > kTorn * built_edge_;
}

void RowPartition::collect_misfits(std::size_t limit) noexcept {
  if (regular_rows_ == 0) return;
  if (stale_.all()) {
    find_misfits(list_, limit);
    return;
  }
  for (const ObjectId id : stale_.ids()) {
    if (!keys_.is_live(id) || list_.size() == limit) continue;
    const std::uint32_t row = keys_.row_of(id);
    if (row < regular_rows_ && !fits(row)) (void)list_.push_back(row);
  }
}

bool RowPartition::move_to_tail(std::span<const std::uint32_t> rows) noexcept {
  if (rows.empty()) return true;
  if (!pool_.reserve_exact(pool_.rows() + rows.size() + tail_limit())) return false;
  const PoolColumns columns(pool_);
  for (const std::uint32_t row : rows) {
    const std::size_t to = pool_.rows();
    const ObjectId id = pool_.ids()[row];
    pool_.append(1);
    for (std::size_t c = 0; c < pool_.columns(); ++c) {
      columns.pointers[c][to] = columns.pointers[c][row];
    }
    pool_.ids()[to] = id;
    keys_.set_row(id, static_cast<std::uint32_t>(to));
    pool_.blank(row);
  }
  pool_.pad();
  return true;
}

bool RowPartition::sort_tail() noexcept {
  if (pool_.rows() < sorted_rows_ + kBlock) return true;
  const std::size_t begin = built_rows_;
  list_.clear();
  if (!list_.grow(pool_.rows() - begin)) return false;
  for (std::size_t row = begin; row < pool_.rows(); ++row) {
    if (pool_.ids()[row] != kNoObject) (void)list_.push_back(static_cast<std::uint32_t>(row));
  }
  const std::span<std::uint32_t> rows(list_.data(), list_.size());
  if (!sort_by_place(rows, Execution::serial()) || !spare_.grow(rows.size() + 2 * kBlock)) {
    return false;
  }
  pool_.reorder_tail(begin, rows, spare_);
  for (std::size_t row = begin; row < pool_.rows(); ++row) {
    keys_.set_row(pool_.ids()[row], static_cast<std::uint32_t>(row));
  }
  sorted_rows_ = pool_.rows();
  tail_changed_ = true;
  return true;
}

BlockTree::Nodes RowPartition::node_content() const noexcept {
  return filters_.in_use() ? BlockTree::Nodes::boxes_filters : BlockTree::Nodes::boxes;
}

bool RowPartition::refit_tree() noexcept {
  const std::size_t blocks = pool_.blocks();
  if (is_flat()) {
    return filters_.in_use() ? refit(block_filters_, 0, blocks, BlockTree::Nodes::filters)
                             : block_filters_.cover(0, 0);
  }
  const std::size_t first = (regular_rows_ + kBlock - 1) / kBlock;
  return refit(tree_, first, blocks - first, node_content()) &&
         (!prunes_rows() || refit(row_tree_, 0, first, node_content()));
}

bool RowPartition::refit(BlockTree& tree, std::size_t first, std::size_t blocks,
                         BlockTree::Nodes nodes) noexcept {
  const RowView rows = row_view();
  const bool reshape =
      blocks != tree.blocks() || tree.has_filters() != (filters_.in_use() && blocks != 0);
  const bool tail_changed = tail_changed_ && &tree != &row_tree_;
  if (reshape || tail_changed || stale_.all()) {
    if (reshape && !tree.cover(first, blocks, nodes)) {
      built_ = false;
      return false;
    }
    tree.refit_all(rows, execution_for(pool_.rows()));
    if (tail_changed) tail_changed_ = false;
    return true;
  }
  list_.clear();
  if (!list_.grow(stale_.ids().size()) || !words_.grow(bitmap_words(blocks))) return false;
  for (const ObjectId id : stale_.ids()) {
    if (!keys_.is_live(id)) continue;
    const std::size_t block = keys_.row_of(id) / kBlock;
    if (block >= first && block - first < blocks) {
      (void)list_.push_back(static_cast<std::uint32_t>(block - first));
    }
  }
  const std::size_t leaves = sort_unique({list_.data(), list_.size()}, blocks, words_);
  tree.refit(rows, {list_.data(), leaves});
  return true;
}

void RowPartition::forward_changes() noexcept {
  if (tracked_serial_ != 0) {
    if (stale_.all()) {
      moved_.add_all();
    } else {
      for (const ObjectId id : stale_.ids()) moved_.add(id);
    }
  }
  stale_.clear();
}

}  // namespace winnow
