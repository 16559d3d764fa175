// Refresh, refit and views of SpatialIndex. refresh() is called once per frame that changed rows:
// it builds (rebuild.cpp), or moves rows that no longer fit to the tail and refits the trees.

#include "partitions/index/spatial_index.h"

#include <winnow/partitions/partition.h>
#include "core/memory/columns.h"
#include "partitions/tree/environment_order.h"

#include <algorithm>
#include <utility>

namespace winnow {
namespace {

// After a plan that was out of date when it was applied, this many builds are not planned ahead.
constexpr std::size_t kBuildsAfterMistake = 4;

}  // namespace

SpatialIndex::SpatialIndex(std::pmr::memory_resource* memory, Rows& rows,
                           std::size_t build_budget) noexcept
    : memory_(memory),
      rows_(rows),
      tree_(memory),
      regular_tree_(memory),
      spare_structures_(memory),
      spare_(memory),
      tail_order_(memory),
      build_budget_(build_budget),
      plan_(memory),
      departures_(memory) {}

SpatialIndex::~SpatialIndex() {
  drop_plan();
  destroy_spares();
  destroy({kind_, structure_});
}

Status SpatialIndex::refresh() {
  rows_.pad();
  swap_refused_ = false;
  // A plan is invalid once its rows were reordered.
  if (rows_.regions().planned == 0 || rows_.filters().has_environments()) drop_plan();
  note_quiet_refresh();
  Status status = Status::ok;
  if (needs_build()) {
    status = build();
  } else if (plan_.ready() && !plan_paused()) {
    status = apply_plan(true);
    if (status == Status::ok) status = absorb_changes(true);
  } else {
    status = absorb_changes(false);
  }
  queries_stale_.store(true, std::memory_order_relaxed);
  return status;
}

std::size_t SpatialIndex::tail() const noexcept {
  const std::size_t rows = rows_.pool().rows();
  const std::size_t ordered = rows_.regions().ordered;
  return rows > ordered ? rows - ordered : 0;
}

// If `all` is true, any row may no longer fit its position in the order, even if it did not change
// now.
Status SpatialIndex::absorb_changes(bool all) {
  ++refits_;
  if (structure_->is_flat()) {
    rows_.regions().regular = rows_.pool().rows();
    return refit_trees() ? Status::ok : Status::out_of_memory;
  }
  const std::size_t limit = tail_limit();
  const std::size_t room = limit - std::min(limit, tail());
  const bool any_row = all || rows_.stale().all();
  RowSelection& misfits = rows_.selection();
  if (!misfits.start(limit) || (any_row && !make_room_for_misfits())) return Status::out_of_memory;
  if (tail() > limit || !collect_misfits(any_row, room)) {
    if (all) builds_without_planning_ = kBuildsAfterMistake;
    return build();
  }
  // A row that no longer fits a planned order may have moved before the last refresh, and is then
  // not in the list of stale objects.
  tail_changed_ = tail_changed_ || (all && !misfits.list.empty());
  if (!move_to_tail(misfits.entries()) || !sort_tail() || !refit_trees()) {
    return Status::out_of_memory;
  }
  if (is_scattered()) return build();
  const std::uint64_t builds = builds_;
  const Status status = find_outliers();
  if (status != Status::ok || builds_ != builds) return status;
  if (!is_next_frame()) return Status::ok;
  tail_growth_.note(tail());
  wear_growth_.note(excess_tests());
  departures_.note_refresh();
  continue_planning();
  return Status::ok;
}

// A second refresh with few changes and no query in between does not count as a frame, because the
// forecasts of builds extrapolate growth per frame.
bool SpatialIndex::is_next_frame() const noexcept {
  const ChangeList& stale = rows_.stale();
  const bool queried = queried_.exchange(false, std::memory_order_relaxed);
  return queried || stale.all() || 4 * stale.ids().size() >= rows_.size();
}

// If most objects jumped, one query of a tree in the old order would cost as much as many builds.
// The sizes of the leaves show such jumps before the query. Slow wear is detected by counting
// tests.
bool SpatialIndex::is_scattered() const noexcept {
  constexpr float kScattered = 2.0F;
  constexpr float kScatterOfPrice = 0.1F;  // a lower limit if a build is cheap
  const float price = static_cast<float>(structure_->build_price());
  // A query of a tree with at most this many blocks tests nearly all of them in any order of the
  // rows.
  constexpr std::size_t kFewBlocks = 12;
  if (tree_.blocks() <= kFewBlocks) return false;
  // Cells and strips detect objects that leave them; the tree beside them contains rows of all
  // parts of the scene.
  if (rows_.regions().regular != 0 || !rows_.stale().all()) return false;
  const float scattered = std::min(kScattered, 1.0F + kScatterOfPrice * price);
  return built_edge_ > 0.0F && tree_.typical_edge() > scattered * built_edge_;
}

bool SpatialIndex::make_room_for_misfits() noexcept {
  return rows_.regions().regular == 0 || spare_.reserve(rows_.pool().capacity() + 2 * kBlockRows);
}

// Returns false if there are more than `most` misfits, or if a sample predicts more.
bool SpatialIndex::collect_misfits(bool any_row, std::size_t most) noexcept {
  const std::size_t regular = rows_.regions().regular;
  if (regular == 0) return true;
  Column<std::uint32_t>& misfits = rows_.selection().list;
  if (any_row) {
    return structure_->find_misfits(reinterpret_cast<std::uint32_t*>(spare_.data()), misfits, most);
  }
  for (const ObjectId id : rows_.stale().ids()) {
    if (!rows_.keys().is_live(id)) continue;
    const std::uint32_t row = rows_.keys().row_of(id);
    if (row >= regular || structure_->fits(row, structure_->box_of_row(row))) continue;
    if (misfits.size() == most) return false;
    (void)misfits.push_back(row);
  }
  return true;
}

bool SpatialIndex::move_to_tail(std::span<const std::uint32_t> rows) noexcept {
  if (rows.empty()) return true;
  // Reserves the room of all moves until the next build, because growing copies every column.
  const std::size_t needed = rows_.pool().rows() + rows.size();
  const std::size_t room = rows_.regions().ordered + max_in_tail(rows_.size());
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
  if (!tail_order_.grow(live.list.size()) || !spare_.grow(live.list.size() + 2 * kBlockRows) ||
      !sort_by_place(live.entries(), tail_order_.data())) {
    return false;
  }
  rows_.reorder_tail(begin, live.entries(), spare_);
  regions.sorted = pool.rows();
  tail_changed_ = true;
  return true;
}

// `room` has the length of `rows`.
bool SpatialIndex::sort_by_place(std::span<std::uint32_t> rows, std::uint32_t* room) noexcept {
  const Execution execution = Execution::serial();
  return rows_.filters().has_environments()
             ? sort_by_environment_and_place(rows_.pool(), rows_.filters().data(), rows,
                                             plan_.row_plan().items, room, plan_.points(),
                                             execution)
             : sort_by_kd_cuts(rows_.pool(), rows, room, plan_.points(), execution);
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
  if (reshape || order_changed || rows_.stale().all()) return refit_all();
  // The sorted tail, and blocks that were added or removed at the end, have to be refitted.
  std::size_t changed_from = std::min(blocks, blocks_before) - (blocks < blocks_before ? 1 : 0);
  if (tail_changed) {
    const std::size_t tail_block = std::max(rows_.regions().ordered / kBlockRows, first);
    changed_from = std::min(changed_from, tail_block - first);
  }
  const std::size_t behind = blocks - changed_from;
  // If more than one block in four changed, refitting all blocks takes less time.
  constexpr std::size_t kRefitShare = 4;
  if (kRefitShare * behind > blocks) return refit_all();
  RowSelection& leaves = rows_.selection();
  if (!leaves.start(rows_.stale().ids().size() + behind) || !leaves.reserve_bits(blocks)) {
    rows_.regions().built = false;
    return false;
  }
  for (const ObjectId id : rows_.stale().ids()) {
    if (!rows_.keys().is_live(id)) continue;
    const std::size_t block = rows_.keys().row_of(id) / kBlockRows;
    if (block >= first && block - first < blocks) leaves.add(block - first);
  }
  for (std::size_t block = changed_from; block < blocks; ++block) leaves.add(block);
  leaves.sort(blocks);
  tree.refit(rows, leaves.entries());
  return true;
}

Status SpatialIndex::refresh_queries() const {
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
  queries_stale_.store(false, std::memory_order_release);
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

void SpatialIndex::note_work(std::uint64_t tests, std::uint64_t queries,
                             PairQueryKind kind) const noexcept {
  queried_.store(true, std::memory_order_relaxed);
  // The first query after a build defines the cost on a fresh structure.
  std::atomic<std::uint64_t>& base = kind == PairQueryKind::all ? full_base_ : moved_base_;
  const std::uint64_t each = tests / queries + 1;
  std::uint64_t expected = 0;
  if (base.compare_exchange_strong(expected, each, std::memory_order_relaxed)) return;
  if (each > expected) {
    excess_.fetch_add((each - expected) * queries, std::memory_order_relaxed);
  }
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
  s.builds = builds_;
  s.planned_builds = planned_builds_;
  s.refits = refits_;
}

void SpatialIndex::add_bytes(Footprint& footprint) const noexcept {
  const std::size_t own = kind_.info()->bytes;
  footprint.structure += {own, own};
  footprint.structure += tree_.bytes();
  footprint.structure += regular_tree_.bytes();
  footprint.scratch += bytes_of(spare_, tail_order_);
  footprint.scratch += plan_.bytes();
  footprint.scratch += departures_.bytes();
  footprint.scratch += spare_structures_.bytes();
  structure_->add_bytes(footprint);
  const auto add = [&](const OwnedStructure& one) {
    if (one.structure == nullptr) return;
    footprint.structure += {one.kind.info()->bytes, one.kind.info()->bytes};
    one.structure->add_bytes(footprint);
  };
  add(next_);
  for (const OwnedStructure& one : spare_structures_) add(one);
}

void SpatialIndex::release_scratch() noexcept {
  drop_plan();
  release_columns(spare_, tail_order_);
  plan_.release();
}

void SpatialIndex::release_memory() noexcept {
  reserved_ = false;
  destroy_spares();
  release_scratch();
  structure_->release_scratch();
  if (rows_.size() != 0) return;
  tree_.release();
  regular_tree_.release();
  departures_.release();
  structure_->release_memory();
}

}  // namespace winnow
