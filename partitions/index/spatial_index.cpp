#include "partitions/index/spatial_index.h"

#include <winnow/partitions/partition.h>
#include "core/memory/columns.h"
#include "partitions/tree/environment_order.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace winnow {
namespace {

// Entries that a plan may have beyond the rows.
constexpr std::size_t kPlanSlack = 4 * kBlockRows;

constexpr std::size_t blocks_of(std::size_t rows) noexcept {
  return (rows + kBlockRows - 1) / kBlockRows;
}

// The mean edge of the box around 16 rows that follow each other: that in the middle of a sample.
float edge_of_block(const BoundsPool& pool) noexcept {
  constexpr std::size_t kSample = 31;
  std::array<float, kSample> edge;
  const std::size_t count = std::min(kSample, pool.blocks());
  if (count == 0) return 0.0F;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = pool.blocks() * i / count * kBlockRows;
    edge[i] = 0.0F;
    for (std::size_t a = 0; a < 3; ++a) {
      const float* const low = pool.column(a) + row;
      const float* const high = pool.column(3 + a) + row;
      const float from = *std::min_element(low, low + kBlockRows);
      edge[i] += (*std::max_element(high, high + kBlockRows) - from) / 3.0F;
    }
  }
  std::nth_element(edge.begin(), edge.begin() + count / 2, edge.begin() + count);
  return edge[count / 2];
}

}  // namespace

SpatialIndex::SpatialIndex(std::pmr::memory_resource* memory, Rows& rows) noexcept
    : memory_(memory),
      rows_(rows),
      tree_(memory),
      regular_tree_(memory),
      spare_(memory),
      order_(memory),
      items_(memory),
      points_(memory) {}

SpatialIndex::~SpatialIndex() {
  end_waiting();
  end({kind_, structure_});
}

Structure* SpatialIndex::make(StructureKind kind) noexcept {
  const auto waiting = std::ranges::find(waiting_, kind, &Waiting::kind);
  if (waiting != waiting_.end()) return std::exchange(*waiting, {}).structure;
  return kind.info()->make({memory_, rows_, regular_tree_, kind.parameter()});
}

void SpatialIndex::end(const Waiting& one) noexcept {
  if (one.structure != nullptr) one.kind.info()->end(one.structure, memory_);
}

// With what was reserved for it, it may be taken again.
void SpatialIndex::put_by(const Waiting& one) noexcept {
  const auto place = std::ranges::find(waiting_, nullptr, &Waiting::structure);
  if (reserved_ && place != waiting_.end()) {
    *place = one;
  } else {
    end(one);
  }
}

void SpatialIndex::install(Structure* structure, StructureKind kind) noexcept {
  structure_ = structure;
  kind_ = kind;
  if (reserved_) {
    (void)tree_.cover(0, 0);
    (void)regular_tree_.cover(0, 0);
  } else {
    tree_.release();
    regular_tree_.release();
    release_scratch();
    rows_.selection().release();
  }
  built_edge_ = 0.0F;
  built_holes_ = 0;
  full_base_ = moved_base_ = excess_ = 0;
  rows_.disorder();
}

bool SpatialIndex::reserve(std::size_t objects, Pages pages,
                           std::span<const StructureKind> later) noexcept {
  if (!have_wait(later)) return false;
  std::size_t holes = 0;
  std::size_t behind = 0;
  bool flat = true;
  const auto count_in = [&](const Structure& structure) {
    flat = flat && structure.is_flat();
    holes = std::max(holes, structure.most_holes());
    if (structure.prunes_rows()) behind = 2 * tail_limit(objects);
  };
  count_in(*structure_);
  for (const Waiting& one : waiting_) {
    if (one.structure != nullptr) count_in(*one.structure);
  }
  reserved_ = flat || reserve_order(objects + holes + kBlockRows, behind, pages);
  const BuildRoom room{objects, pages, items_, points_};
  reserved_ = reserved_ && structure_->reserve(room);
  for (const Waiting& one : waiting_) {
    if (one.structure != nullptr) reserved_ = reserved_ && one.structure->reserve(room);
  }
  return reserved_;
}

// Room for so many rows in order, and for those that are to be left behind them.
bool SpatialIndex::reserve_order(std::size_t rows, std::size_t behind, Pages pages) noexcept {
  const std::size_t planned = rows + behind + kPlanSlack;
  const std::size_t blocks = blocks_of(rows);
  return rows_.reserve_rows(rows + behind) &&
         spare_.reserve(rows_.pool().capacity() + 2 * kBlockRows, pages) &&
         order_.reserve(planned, pages) && rows_.selection().list.reserve(planned, pages) &&
         tree_.reserve(blocks, pages) && (behind == 0 || regular_tree_.reserve(blocks, pages));
}

bool SpatialIndex::have_wait(std::span<const StructureKind> kinds) noexcept {
  auto place = waiting_.begin();
  for (const StructureKind kind : kinds) {
    if (kind == kind_ || std::ranges::find(waiting_, kind, &Waiting::kind) != waiting_.end()) {
      continue;
    }
    place = std::find_if(place, waiting_.end(), [](const Waiting& w) { return !w.structure; });
    if (place == waiting_.end()) return true;
    Structure* const made = make(kind);
    if (made == nullptr) return false;
    *place = {kind, made};
  }
  return true;
}

void SpatialIndex::end_waiting() noexcept {
  for (Waiting& one : waiting_) end(std::exchange(one, {}));
}

bool SpatialIndex::set_structure(StructureKind kind) noexcept {
  Structure* const made = make(kind);
  if (made == nullptr) return false;
  end_waiting();
  end({kind_, structure_});
  install(made, kind);
  return true;
}

Status SpatialIndex::refresh_as(StructureKind kind, bool& taken) {
  taken = false;
  Structure* const made = make(kind);
  if (made == nullptr) return refresh();
  Structure* const structure_before = structure_;
  const StructureKind kind_before = kind_;
  install(made, kind);
  taken = refresh() == Status::ok;
  if (taken) {
    put_by({kind_before, structure_before});
    return Status::ok;
  }
  put_by({kind, made});
  install(structure_before, kind_before);
  return refresh();
}

Status SpatialIndex::refresh() {
  rows_.pad();
  const Status status = needs_build() ? build() : absorb_changes();
  queries_stale_.store(true, std::memory_order_relaxed);
  return status;
}

std::size_t SpatialIndex::tail() const noexcept {
  const std::size_t rows = rows_.pool().rows();
  const std::size_t ordered = rows_.regions().ordered;
  return rows > ordered ? rows - ordered : 0;
}

bool SpatialIndex::needs_build() const noexcept {
  if (!rows_.regions().built) return true;
  const std::size_t live = rows_.size();
  const std::size_t holes = rows_.pool().rows() - live;
  if (holes > live / 4 + built_holes_ + 64) return true;
  if (rows_.filters().has_environments() && wants_grouping()) return true;
  if (structure_->is_flat()) return false;
  return tail() > tail_limit() ||
         excess_.load(std::memory_order_relaxed) > structure_->build_price() * (live + 64);
}

// Rows of many environments are in no order that keeps them apart: in cells, new, or moved from one
// environment to another.
bool SpatialIndex::wants_grouping() const noexcept {
  const RowRegions& regions = rows_.regions();
  const std::size_t changed = rows_.filters().changed_environments();
  if (!structure_->is_flat()) return regions.regular != 0 || changed > tail_limit();
  return rows_.pool().rows() - regions.sorted + changed > tail_limit();
}

// The rows are untouched until everything that can fail is done; the structure may be half planned.
Status SpatialIndex::build() {
  if (structure_->is_flat()) return build_flat();
  RowRegions& regions = rows_.regions();
  regions.built = false;
  if (!plan_order()) return Status::out_of_memory;
  const std::size_t regular = order_.size();
  // The tree's blocks begin behind the regular ones: no block belongs to both.
  while (order_.size() % kBlockRows != 0) (void)order_.push_back(kNoObject);
  const std::size_t first_block = order_.size() / kBlockRows;
  if (!order_rest()) return Status::out_of_memory;
  const std::size_t rows = order_.size();
  const bool prunes = structure_->prunes_rows();
  if (!rows_.reserve_rows(rows + spare_rows()) ||
      !spare_.reserve(rows_.pool().capacity() + 2 * kBlockRows) ||
      !tree_.cover(first_block, blocks_of(rows) - first_block, node_content()) ||
      (prunes && !regular_tree_.cover(0, blocks_of(regular), node_content()))) {
    return Status::out_of_memory;
  }

  rows_.reorder({order_.data(), rows}, spare_);
  regions = {.built = false, .regular = regular, .ordered = rows, .sorted = rows};
  built_holes_ = rows - rows_.size();
  structure_->finish_build();
  const Execution execution = rows_.execution_for(rows);
  tree_.refit_all(rows_.view(), execution);
  built_edge_ = tree_.typical_edge();
  if (prunes) regular_tree_.refit_all(rows_.view(), execution);
  regions.built = true;
  ++builds_;
  rows_.note_build(edge_of_block(rows_.pool()));
  full_base_ = moved_base_ = excess_ = 0;
  return Status::ok;
}

// Leaves the regular rows in order_ and all others in the selection.
bool SpatialIndex::plan_order() {
  const std::size_t room = rows_.pool().rows() + spare_rows() + kPlanSlack;
  RowSelection& rest = rows_.selection();
  order_.clear();
  if (!order_.grow(room) || !rest.start(room)) return false;
  const RowPlan plan{order_, rest.list, items_};
  // Cells of many worlds would lie on top of each other, and a cell's objects be tested against
  // those of all of them: the tree, whose nodes know their environments, keeps them apart.
  if (!rows_.filters().has_environments()) return structure_->plan(plan);
  structure_->leave_all(plan);
  return true;
}

bool SpatialIndex::order_rest() {
  const std::span<std::uint32_t> rest = rows_.selection().entries();
  const bool environments = rows_.filters().has_environments();
  if (!environments) {
    const Structure::Ordered ordered = structure_->order_rest(rest, order_);
    if (ordered != Structure::Ordered::none) return ordered == Structure::Ordered::done;
  }
  if (!order_.grow(order_.size() + rest.size())) return false;
  if (!sort_by_place(rest, order_.end(), rows_.execution_for(rest.size()))) return false;
  if (environments) return append_environments(rows_.pool(), rows_.filters().data(), rest, order_);
  std::copy(rest.begin(), rest.end(), order_.end());
  order_.set_size(order_.size() + rest.size());
  return true;
}

Status SpatialIndex::build_flat() {
  rows_.compact();
  rows_.pad();
  RowRegions& regions = rows_.regions();
  const std::size_t rows = rows_.pool().rows();
  regions.regular = rows;
  regions.sorted = 0;
  if (rows_.filters().has_environments()) {
    if (!order_.resize(rows) || !spare_.reserve(rows_.pool().capacity() + 2 * kBlockRows)) {
      return Status::out_of_memory;
    }
    std::iota(order_.begin(), order_.end(), 0U);
    if (!sort_by_environment(rows_.pool(), rows_.filters().data(), {order_.data(), rows}, items_,
                             rows_.execution_for(rows))) {
      return Status::out_of_memory;
    }
    rows_.reorder({order_.data(), rows}, spare_);
    regions.sorted = rows;
  }
  tail_changed_ = true;
  if (!refit_trees()) return Status::out_of_memory;
  regions.built = true;
  ++builds_;
  rows_.note_build(0.0F);
  return Status::ok;
}

// `room` is for as many rows.
bool SpatialIndex::sort_by_place(std::span<std::uint32_t> rows, std::uint32_t* room,
                                 const Execution& execution) {
  return rows_.filters().has_environments()
             ? sort_by_environment_and_place(rows_.pool(), rows_.filters().data(), rows, items_,
                                             room, points_, execution)
             : sort_by_kd_cuts(rows_.pool(), rows, room, points_, execution);
}

Status SpatialIndex::absorb_changes() {
  ++refits_;
  if (structure_->is_flat()) {
    rows_.regions().regular = rows_.pool().rows();
    return refit_trees() ? Status::ok : Status::out_of_memory;
  }
  const std::size_t limit = tail_limit();
  RowSelection& misfits = rows_.selection();
  if (!misfits.start(limit + 1)) return Status::out_of_memory;
  collect_misfits(limit + 1);
  if (tail() + misfits.list.size() > limit) return build();
  if (!move_to_tail(misfits.entries()) || !sort_tail() || !refit_trees()) {
    return Status::out_of_memory;
  }
  return is_torn() ? build() : Status::ok;
}

// Where everything jumped, one query of a tree in the old order would cost many builds: leaves tell
// before it is asked. Slow wear is left to the count of tests.
bool SpatialIndex::is_torn() const noexcept {
  constexpr float kTorn = 2.0F;
  // Cells and strips find what left them; beside them the tree holds what is of many kinds.
  if (rows_.regions().regular != 0 || !rows_.stale().all()) return false;
  return built_edge_ > 0.0F && tree_.typical_edge() > kTorn * built_edge_;
}

void SpatialIndex::collect_misfits(std::size_t limit) noexcept {
  const std::size_t regular = rows_.regions().regular;
  if (regular == 0) return;
  Column<std::uint32_t>& misfits = rows_.selection().list;
  if (rows_.stale().all()) {
    structure_->find_misfits(misfits, limit);
    return;
  }
  for (const ObjectId id : rows_.stale().ids()) {
    if (!rows_.keys().is_live(id) || misfits.size() == limit) continue;
    const std::uint32_t row = rows_.keys().row_of(id);
    if (row < regular && !structure_->fits(row)) (void)misfits.push_back(row);
  }
}

bool SpatialIndex::move_to_tail(std::span<const std::uint32_t> rows) noexcept {
  if (rows.empty()) return true;
  if (!rows_.reserve_rows(rows_.pool().rows() + rows.size() + tail_limit())) return false;
  rows_.move_to_end(rows);
  return true;
}

bool SpatialIndex::sort_tail() noexcept {
  RowRegions& regions = rows_.regions();
  const BoundsPool& pool = rows_.pool();
  if (pool.rows() < regions.sorted + kBlockRows) return true;
  const std::size_t begin = regions.ordered;
  RowSelection& live = rows_.selection();
  if (!live.start(pool.rows() - begin)) return false;
  for (std::size_t row = begin; row < pool.rows(); ++row) {
    if (pool.ids()[row] != kNoObject) live.add(row);
  }
  if (!order_.grow(live.list.size()) || !spare_.grow(live.list.size() + 2 * kBlockRows) ||
      !sort_by_place(live.entries(), order_.data(), Execution::serial())) {
    return false;
  }
  rows_.reorder_tail(begin, live.entries(), spare_);
  regions.sorted = pool.rows();
  tail_changed_ = true;
  return true;
}

BlockTree::Nodes SpatialIndex::node_content() const noexcept {
  return rows_.filters().in_use() ? BlockTree::Nodes::boxes_filters : BlockTree::Nodes::boxes;
}

bool SpatialIndex::refit_trees() noexcept {
  const std::size_t blocks = rows_.pool().blocks();
  if (structure_->is_flat()) {
    return rows_.filters().in_use() ? refit(regular_tree_, 0, blocks, BlockTree::Nodes::filters)
                                    : regular_tree_.cover(0, 0);
  }
  const std::size_t first = blocks_of(rows_.regions().regular);
  return refit(tree_, first, blocks - first, node_content()) &&
         (!structure_->prunes_rows() || refit(regular_tree_, 0, first, node_content()));
}

bool SpatialIndex::refit(BlockTree& tree, std::size_t first, std::size_t blocks,
                         BlockTree::Nodes nodes) noexcept {
  const RowView rows = rows_.view();
  const bool reshape =
      blocks != tree.blocks() || tree.has_filters() != (rows_.filters().in_use() && blocks != 0);
  const bool of_tail = &tree == &tree_ || structure_->is_flat();
  const bool tail_changed = tail_changed_ && of_tail;
  if (reshape || tail_changed || rows_.stale().all()) {
    if (reshape && !tree.cover(first, blocks, nodes)) {
      rows_.regions().built = false;
      return false;
    }
    tree.refit_all(rows, rows_.execution_for(rows_.pool().rows()));
    if (tail_changed) tail_changed_ = false;
    return true;
  }
  RowSelection& leaves = rows_.selection();
  if (!leaves.start(rows_.stale().ids().size()) || !leaves.reserve_bits(blocks)) return false;
  for (const ObjectId id : rows_.stale().ids()) {
    if (!rows_.keys().is_live(id)) continue;
    const std::size_t block = rows_.keys().row_of(id) / kBlockRows;
    if (block >= first && block - first < blocks) leaves.add(block - first);
  }
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
  const RowView rows = rows_.view();
  std::copy_n(rows.column, 6, view.column);
  view.id = rows.id;
  view.filter = rows.filter;
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
                             Asked asked) const noexcept {
  // The first query after a build sets what a query costs on a fresh structure.
  std::atomic<std::uint64_t>& base = asked == Asked::all ? full_base_ : moved_base_;
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
  s.refits = refits_;
}

void SpatialIndex::add_bytes(Footprint& footprint) const noexcept {
  const std::size_t own = kind_.info()->bytes;
  footprint.structure += {own, own};
  footprint.structure += tree_.bytes();
  footprint.structure += regular_tree_.bytes();
  footprint.scratch += bytes_of(spare_, order_, items_, points_);
  structure_->add_bytes(footprint);
  for (const Waiting& one : waiting_) {
    if (one.structure == nullptr) continue;
    footprint.structure += {one.kind.info()->bytes, one.kind.info()->bytes};
    one.structure->add_bytes(footprint);
  }
}

void SpatialIndex::release_scratch() noexcept {
  release_columns(spare_, order_, items_, points_);
}

void SpatialIndex::release_memory() noexcept {
  reserved_ = false;
  end_waiting();
  release_scratch();
  structure_->release_scratch();
  if (rows_.size() != 0) return;
  tree_.release();
  regular_tree_.release();
  structure_->release_memory();
}

}  // namespace winnow
