// Refresh, refit and views of SpatialIndex. refresh() is called once per frame that changed rows:
// it builds (rebuild.cpp), or moves rows that no longer fit to the tail and refits the trees.

#include "partitions/index/spatial_index.h"

#include <winnow/partitions/partition.h>
#include "core/memory/columns.h"
#include "partitions/index/outliers.h"
#include "partitions/tree/environment_order.h"

#include <algorithm>
#include <utility>

namespace winnow {
namespace {

/// Returns the number of rows behind the order of the last build.
std::size_t tail_rows(const Rows& rows) noexcept {
  const std::size_t ordered = rows.regions().ordered;
  return rows.pool().rows() > ordered ? rows.pool().rows() - ordered : 0;
}

/// Adds the regular rows that no longer fit the structure to the selection: tests all rows, with
/// `scratch`, or only the changed ones if it is null. Returns false if there are more than `most`
/// misfits, or if a sample predicts more.
bool collect_misfits(const Rows& rows, Structure& structure, std::uint32_t* scratch,
                     std::size_t most) noexcept {
  const std::size_t regular = rows.regions().regular;
  if (regular == 0) return true;
  Column<std::uint32_t>& misfits = rows.selection().list;
  if (scratch != nullptr) return structure.find_misfits(scratch, misfits, most);
  for (const ObjectId id : rows.changes().stale.ids()) {
    if (!rows.keys().is_live(id)) continue;
    const std::uint32_t row = rows.keys().row_of(id);
    if (row >= regular || structure.fits(row, structure.box_of_row(row))) continue;
    if (misfits.size() == most) return false;
    (void)misfits.push_back(row);
  }
  return true;
}

}  // namespace

SpatialIndex::SpatialIndex(std::pmr::memory_resource* memory, Rows& rows,
                           std::size_t build_budget) noexcept
    : rows_(rows),
      tree_(memory),
      regular_tree_(memory),
      planner_(build_budget),
      plan_(memory),
      departures_(memory),
      structures_(memory, rows, regular_tree_),
      spare_(memory),
      tail_order_(memory) {}

SpatialIndex::~SpatialIndex() {
  drop_plan();
  structures_.destroy({kind_, structure_});
}

RowNumbers SpatialIndex::numbers() const noexcept {
  const RowRegions& regions = rows_.regions();
  const ChangeList& stale = rows_.changes().stale;
  const bool flat = structure_->is_flat();
  RowNumbers n;
  n.objects = rows_.size();
  n.rows = rows_.pool().rows();
  n.regular = regions.regular;
  n.tail = tail_rows(rows_);
  n.changed = stale.all() ? n.objects : stale.ids().size();
  n.all_changed = stale.all();
  n.built = regions.built;
  n.flat = flat;
  n.environments = rows_.filters().has_environments();
  // With a flat structure, new rows are not in the group of their environment, either.
  n.ungrouped = rows_.filters().changed_environments() + (flat ? n.rows - regions.sorted : 0);
  n.build_price = structure_->build_price();
  n.plan_passes = (plan_.underway() ? plan_.structure() : structure_)->plan_passes();
  n.plan_rows = plan_.underway() ? plan_.rows() : 0;
  n.plan_ready = plan_.ready();
  return n;
}

Status SpatialIndex::refresh() {
  rows_.pad();
  swap_refused_ = false;
  // A plan is invalid once its rows were reordered.
  if (rows_.regions().planned == 0 || rows_.filters().has_environments()) drop_plan();
  Status status = Status::ok;
  switch (planner_.begin_refresh(numbers())) {
    case RebuildPlanner::OrderStep::build:
      status = build();
      break;
    case RebuildPlanner::OrderStep::apply_plan:
      status = apply_plan(true);
      if (status == Status::ok) status = absorb_changes(true);
      break;
    case RebuildPlanner::OrderStep::keep:
      status = absorb_changes(false);
      break;
  }
  query_trees_stale_.store(true, std::memory_order_relaxed);
  return status;
}

// Keeps the order: moves misfits to the tail, sorts the tail and refits the trees; then builds
// after all if the planner finds that the order is lost, or plans ahead. If `all` is true, any row
// may no longer fit its position in the order, even if it did not change now.
Status SpatialIndex::absorb_changes(bool all) {
  planner_.note_refit();
  if (structure_->is_flat()) {
    rows_.regions().regular = rows_.pool().rows();
    return refit_trees() ? Status::ok : Status::out_of_memory;
  }
  const std::size_t tail = tail_rows(rows_);
  const std::size_t limit = RebuildPlanner::tail_limit(rows_.size());
  const std::size_t room = limit - std::min(limit, tail);
  const bool any_row = all || rows_.changes().stale.all();
  RowSelection& misfits = rows_.selection();
  if (!misfits.start(limit) || (any_row && rows_.regions().regular != 0 &&
                                !spare_.reserve(rows_.pool().capacity() + 2 * kBlockRows))) {
    return Status::out_of_memory;
  }
  auto* const scratch = any_row ? reinterpret_cast<std::uint32_t*>(spare_.data()) : nullptr;
  if (tail > limit || !collect_misfits(rows_, *structure_, scratch, room)) {
    if (all) planner_.note_mistake();
    return build();
  }
  // A row that no longer fits a planned order may have moved before the last refresh, and is then
  // not in the list of stale objects.
  tail_changed_ = tail_changed_ || (all && !misfits.list.empty());
  if (!move_to_tail(misfits.entries()) || !sort_tail() || !refit_trees()) {
    return Status::out_of_memory;
  }
  const RowNumbers n = numbers();
  if (planner_.may_be_scattered(n, tree_.blocks()) &&
      planner_.is_scattered(n, tree_.typical_edge())) {
    return build();
  }
  const std::uint64_t builds = planner_.builds();
  const Status status = find_outliers(n);
  if (status != Status::ok || planner_.builds() != builds) return status;
  if (!planner_.begin_frame(n)) return Status::ok;
  planner_.note_frame(tail_rows(rows_));
  continue_planning();
  return Status::ok;
}

Status SpatialIndex::find_outliers(const RowNumbers& n) {
  if (!planner_.may_have_outliers(n)) return Status::ok;
  const std::size_t wide = count_wide_blocks(rows_, tree_, planner_.built_edge());
  switch (planner_.step_for_outliers(n, wide, ordered_blocks(rows_, tree_))) {
    case RebuildPlanner::OutlierStep::search:
      return move_outliers_to_tail(n.tail);
    case RebuildPlanner::OutlierStep::build:
      return build();
    case RebuildPlanner::OutlierStep::none:
      break;
  }
  return Status::ok;
}

// Moves the outliers to the tail, which is sorted by position. Builds instead if the tail would
// exceed its limit.
Status SpatialIndex::move_outliers_to_tail(std::size_t tail) {
  const std::size_t limit = RebuildPlanner::tail_limit(rows_.size());
  const std::size_t room = limit + 1 - std::min(limit, tail);
  if (!select_outliers(rows_, tree_, planner_.built_edge(), room)) return Status::out_of_memory;
  RowSelection& outliers = rows_.selection();
  if (outliers.list.size() >= room) return build();
  if (!outliers.list.empty()) {
    // The rows of a plan must stay in place, but outliers are moved.
    drop_plan();
    order_changed_ = true;
    if (!move_to_tail(outliers.entries()) || !sort_tail() || !refit_trees()) {
      return Status::out_of_memory;
    }
  }
  planner_.note_wide(count_wide_blocks(rows_, tree_, planner_.built_edge()));
  return Status::ok;
}

bool SpatialIndex::move_to_tail(std::span<const std::uint32_t> rows) noexcept {
  if (rows.empty()) return true;
  // Reserves the room of all moves until the next build, because growing copies every column.
  const std::size_t needed = rows_.pool().rows() + rows.size();
  const std::size_t room = rows_.regions().ordered + RebuildPlanner::max_in_tail(rows_.size());
  if (!rows_.reserve_rows(std::max(room, needed))) return false;
  if (plan_.underway()) {
    for (const std::uint32_t row : rows) plan_.note_move(row, rows_.pool().ids()[row]);
  }
  rows_.move_to_end(rows);
  return true;
}

bool SpatialIndex::sort_tail() noexcept {
  RowRegions& regions = rows_.regions();
  const BoundsPool& pool = rows_.pool();
  // The rows of a plan must stay in place; new rows behind them are sorted once the plan is applied
  // or dropped.
  if (plan_.underway() || pool.rows() < regions.sorted + kBlockRows) return true;
  const std::size_t begin = regions.ordered;
  RowSelection& live = rows_.selection();
  if (!live.start(pool.rows() - begin)) return false;
  for (std::size_t row = begin; row < pool.rows(); ++row) {
    if (pool.ids()[row] != kNoObject) live.add(row);
  }
  if (!tail_order_.grow(live.list.size()) || !spare_.grow(live.list.size() + 2 * kBlockRows)) {
    return false;
  }
  const bool sorted =
      rows_.filters().has_environments()
          ? sort_by_environment_and_place(pool, rows_.filters().data(), live.entries(),
                                          plan_.row_plan().items, tail_order_.data(),
                                          plan_.points(), Execution::serial())
          : sort_by_kd_cuts(pool, live.entries(), tail_order_.data(), plan_.points(),
                            Execution::serial());
  if (!sorted) return false;
  rows_.reorder_tail(begin, live.entries(), spare_);
  regions.sorted = pool.rows();
  tail_changed_ = true;
  return true;
}

BlockTree::NodeContent SpatialIndex::node_content() const noexcept {
  return rows_.filters().in_use() ? BlockTree::NodeContent::boxes_filters
                                  : BlockTree::NodeContent::boxes;
}

bool SpatialIndex::refit_trees() noexcept {
  const std::size_t blocks = rows_.pool().blocks();
  if (structure_->is_flat()) {
    return rows_.filters().in_use()
               ? refit(regular_tree_, 0, blocks, BlockTree::NodeContent::filters)
               : regular_tree_.cover(0, 0);
  }
  const std::size_t first = blocks_of(rows_.regions().regular);
  return refit(tree_, first, blocks - first, node_content()) &&
         (!structure_->prunes_rows() || refit(regular_tree_, 0, first, node_content()));
}

bool SpatialIndex::refit(BlockTree& tree, std::size_t first, std::size_t blocks,
                         BlockTree::NodeContent nodes) noexcept {
  const RowView rows = rows_.view();
  const bool filters = rows_.filters().in_use() && blocks != 0;
  const std::size_t blocks_before = tree.blocks();
  const bool reshape =
      tree.has_filters() != filters || (blocks != blocks_before && !tree.try_resize(blocks));
  if (reshape && !tree.cover(first, blocks, nodes)) {
    rows_.regions().built = false;
    return false;
  }
  const bool has_tail = &tree == &tree_ || structure_->is_flat();
  const bool tail_changed = has_tail && std::exchange(tail_changed_, false);
  const bool order_changed = has_tail && std::exchange(order_changed_, false);
  const auto refit_all = [&] {
    tree.refit_all(rows, rows_.execution_for(rows_.pool().rows()));
    return true;
  };
  if (reshape || order_changed || rows_.changes().stale.all()) return refit_all();
  // The sorted tail, and blocks that were added or removed at the end, have to be refitted.
  std::size_t changed_from = std::min(blocks, blocks_before) - (blocks < blocks_before ? 1 : 0);
  if (tail_changed) {
    const std::size_t tail_block = std::max(rows_.regions().ordered / kBlockRows, first);
    changed_from = std::min(changed_from, tail_block - first);
  }
  const std::size_t behind = blocks - changed_from;
  // If more than one block in four is behind `changed_from`, refitting all blocks takes less time.
  constexpr std::size_t kRefitShare = 4;
  if (kRefitShare * behind > blocks) return refit_all();
  RowSelection& leaves = rows_.selection();
  if (!leaves.start(rows_.changes().stale.ids().size() + behind) || !leaves.reserve_bits(blocks)) {
    rows_.regions().built = false;
    return false;
  }
  for (const ObjectId id : rows_.changes().stale.ids()) {
    if (!rows_.keys().is_live(id)) continue;
    const std::size_t block = rows_.keys().row_of(id) / kBlockRows;
    if (block >= first && block - first < blocks) leaves.add(block - first);
  }
  for (std::size_t block = changed_from; block < blocks; ++block) leaves.add(block);
  leaves.sort(blocks);
  tree.refit(rows, leaves.entries());
  return true;
}

Status SpatialIndex::refresh_query_trees() const {
  const std::size_t regular = rows_.regions().regular;
  const bool own_tree = !structure_->is_flat() && !structure_->prunes_rows();
  if (regular != 0 && own_tree) {
    const std::size_t blocks = blocks_of(regular);
    const bool reshape =
        regular_tree_.blocks() != blocks || regular_tree_.has_filters() != rows_.filters().in_use();
    if (reshape && !regular_tree_.cover(0, blocks, node_content())) return Status::out_of_memory;
    regular_tree_.refit_all(rows_.view(), rows_.execution_for(regular));
  }
  const bool mostly_regular = 2 * regular > rows_.pool().rows();
  leaf_edge_ = (mostly_regular ? regular_tree_ : tree_).typical_edge();
  query_trees_stale_.store(false, std::memory_order_release);
  return Status::ok;
}

void SpatialIndex::view(QueryView& view) const noexcept {
  const BoundsPool& pool = rows_.pool();
  for (std::size_t c = 0; c < 6; ++c) view.column[c] = pool.column(c);
  view.id = pool.ids();
  view.filter = pool.filters();
  view.span = rows_.filters().span();
  if (structure_->is_flat()) {
    view.flat_blocks = static_cast<std::uint32_t>(rows_.pool().blocks());
    return;
  }
  if (rows_.regions().regular != 0) view.tree[view.trees++] = &regular_tree_.shape();
  if (tree_.blocks() != 0) view.tree[view.trees++] = &tree_.shape();
  view.leaf_edge = leaf_edge_;
}

bool SpatialIndex::query(const QueryBatch& batch, PairSink& sink) const noexcept {
  if (rows_.regions().regular != 0 && !structure_->query(batch, sink)) return false;
  if (structure_->is_flat() || tree_.blocks() == 0) return true;
  return block_tree_kernels().query(tree_.view(rows_.view()), batch, sink);
}

void SpatialIndex::add_statistics(Statistics& s) const noexcept {
  const RowRegions& regions = rows_.regions();
  const std::size_t rows = rows_.pool().rows();
  const std::size_t regular_end =
      regions.regular == 0 ? regions.ordered : tree_.first_block() * kBlockRows;
  const std::size_t behind = rows > regular_end ? rows - regular_end : 0;
  s.objects = rows_.size();
  s.irregular = structure_->is_flat() ? 0 : std::min(rows_.size(), behind);
  s.regular = rows_.size() - s.irregular;
  s.cells = regions.regular == 0 ? tree_.blocks() : structure_->cells();
  s.depth = tree_.levels();
  s.levels = structure_->levels();
  s.builds = planner_.builds();
  s.planned_builds = planner_.planned_builds();
  s.refits = planner_.refits();
}

void SpatialIndex::add_bytes(Footprint& footprint) const noexcept {
  const std::size_t own = kind_.info()->bytes;
  footprint.structure += {own, own};
  footprint.structure += tree_.bytes();
  footprint.structure += regular_tree_.bytes();
  footprint.scratch += bytes_of(spare_, tail_order_);
  footprint.scratch += plan_.bytes();
  footprint.scratch += departures_.bytes();
  footprint.scratch += structures_.bytes();
  structure_->add_bytes(footprint);
  const auto add = [&](const OwnedStructure& one) {
    if (one.structure == nullptr) return;
    footprint.structure += {one.kind.info()->bytes, one.kind.info()->bytes};
    one.structure->add_bytes(footprint);
  };
  add(next_);
  for (const OwnedStructure& one : structures_.spares()) add(one);
}

}  // namespace winnow
