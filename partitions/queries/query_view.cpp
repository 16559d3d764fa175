// RowPartition: how it shows itself to queries.

#include "partitions/queries/query_view.h"

#include "partitions/rows/row_partition.h"

namespace winnow {

Status RowPartition::prepare(QueryView& view) const {
  if (const Status status = refresh(); status != Status::ok) return status;
  for (std::size_t c = 0; c < 6; ++c) view.column[c] = pool_.column(c);
  const RowView rows = row_view();
  view.id = rows.id;
  view.filter = rows.filter;
  if (is_flat()) {
    view.flat_blocks = static_cast<std::uint32_t>(pool_.blocks());
    return Status::ok;
  }
  if (const Status status = refresh_for_queries(); status != Status::ok) return status;
  if (regular_rows_ != 0) view.tree[view.trees++] = &row_tree_.shape();
  if (tree_.blocks() != 0) view.tree[view.trees++] = &tree_.shape();
  view.leaf_edge = leaf_edge_;
  return Status::ok;
}

Status RowPartition::refresh_for_queries() const {
  if (!queries_stale_.load(std::memory_order_acquire)) return Status::ok;
  const std::lock_guard lock(refresh_mutex_);
  if (!queries_stale_.load(std::memory_order_relaxed)) return Status::ok;
  if (regular_rows_ != 0 && !prunes_rows()) {
    const std::size_t blocks = (regular_rows_ + BoundsPool::kBlock - 1) / BoundsPool::kBlock;
    const bool reshape =
        row_tree_.blocks() != blocks || row_tree_.has_filters() != filters_.in_use();
    if (reshape && !row_tree_.cover(0, blocks, node_content())) return Status::out_of_memory;
    row_tree_.refit_all(row_view(), execution_for(regular_rows_));
  }
  const bool mostly_regular = 2 * regular_rows_ > pool_.rows();
  leaf_edge_ = (mostly_regular ? row_tree_ : tree_).typical_edge();
  queries_stale_.store(false, std::memory_order_release);
  return Status::ok;
}

}  // namespace winnow
