// SpatialIndex: builds, which reorder the rows at once or by a plan that was made ahead over
// several refreshes, and exchanges of the structure. refresh() in spatial_index.cpp calls `build`;
// RebuildPlanner decides, OrderPlan computes the order.

#include "core/hooks/stage_scope.h"
#include "core/memory/columns.h"
#include "partitions/index/outliers.h"
#include "partitions/index/spatial_index.h"
#include "partitions/tree/environment_order.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace winnow {
namespace {

// Median, over a sample of blocks, of the mean edge of the box around a block.
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

// Rows that a build of `objects` objects reserves for the tail.
std::size_t spare_rows(const Structure& structure, std::size_t objects) noexcept {
  return (structure.prunes_rows() ? 2 : 1) * RebuildPlanner::max_in_tail(objects);
}

}  // namespace

// Starts a plan or continues it, runs it to the end and applies it.
Status SpatialIndex::build() {
  const StageScope stage(WorkStage::build);
  if (structure_->is_flat()) return build_flat();
  rows_.regions().built = false;
  const bool foreseen = plan_.underway();
  if ((!foreseen && !start_plan(*structure_)) || !plan_.advance(RebuildPlanner::kWholeBuild)) {
    drop_plan();
    return Status::out_of_memory;
  }
  const Status status = apply_plan(foreseen);
  return foreseen && status == Status::ok ? absorb_changes(true) : status;
}

// The rows are not changed before all steps that can fail have succeeded.
Status SpatialIndex::apply_plan(bool moved) {
  RowRegions& regions = rows_.regions();
  regions.built = false;
  const Structure& next = *plan_.structure();
  Column<std::uint32_t>& order = plan_.order();
  const std::size_t ordered = order.size();
  const std::size_t regular = plan_.regular();
  const std::size_t first_block = blocks_of(regular);
  const bool complete = !moved || plan_.complete();
  const std::size_t rows = order.size();
  const bool prunes = next.prunes_rows();
  if (!complete || !rows_.reserve_rows(rows + spare_rows(next, rows_.size())) ||
      !spare_.reserve(rows_.pool().capacity() + 2 * kBlockRows) ||
      !tree_.cover(first_block, blocks_of(rows) - first_block, node_content()) ||
      (prunes && !regular_tree_.cover(0, blocks_of(regular), node_content())) ||
      !departures_.reserve(regular)) {
    drop_plan();
    return Status::out_of_memory;
  }
  rows_.reorder({order.data(), rows}, spare_);
  install_planned_structure();
  regions = {.built = false, .regular = regular, .ordered = ordered, .sorted = ordered};
  const std::size_t holes = rows - rows_.size();
  structure_->finish_build(plan_.row_plan(), moved);
  plan_.drop();
  const Execution execution = rows_.execution_for(rows);
  tree_.refit_all(rows_.view(), execution);
  planner_.note_build(moved, holes, tree_.typical_edge());
  planner_.note_wide(count_wide_blocks(rows_, tree_, planner_.built_edge()));
  if (prunes) regular_tree_.refit_all(rows_.view(), execution);
  regions.built = true;
  rows_.note_build(edge_of_block(rows_.pool()));
  departures_.begin(rows_);
  return Status::ok;
}

Status SpatialIndex::build_flat() {
  drop_plan();
  rows_.compact();
  rows_.pad();
  RowRegions& regions = rows_.regions();
  const std::size_t rows = rows_.pool().rows();
  regions.regular = rows;
  regions.sorted = 0;
  if (rows_.filters().has_environments()) {
    Column<std::uint32_t>& order = plan_.order();
    if (!order.resize(rows) || !spare_.reserve(rows_.pool().capacity() + 2 * kBlockRows)) {
      return Status::out_of_memory;
    }
    std::iota(order.begin(), order.end(), 0U);
    if (!sort_by_environment(rows_.pool(), rows_.filters().data(), {order.data(), rows},
                             plan_.row_plan().items, rows_.execution_for(rows))) {
      return Status::out_of_memory;
    }
    rows_.reorder({order.data(), rows}, spare_);
    regions.sorted = rows;
  }
  order_changed_ = true;
  if (!refit_trees()) return Status::out_of_memory;
  regions.built = true;
  planner_.note_flat_build();
  rows_.note_build(0.0F);
  return Status::ok;
}

// Planning ahead.

bool SpatialIndex::start_plan(Structure& structure) noexcept {
  planner_.note_plan(numbers());
  return plan_.start(rows_, structure, spare_rows(structure, rows_.size()),
                     planner_.precision(structure.first_parts()));
}

// Starts a plan if a build is near, and runs the stages of this refresh.
void SpatialIndex::continue_planning() noexcept {
  if (planner_.is_paused()) return;
  if (!plan_.underway()) {
    const RowNumbers n = numbers();
    const RebuildPlanner::BuildForecast forecast = planner_.forecast_build(n);
    const bool near =
        forecast.may_leave
            ? RebuildPlanner::is_near_if_leaving(
                  n, departures_.share(rows_, *structure_, planner_.frames(), forecast.refreshes))
            : forecast.near;
    if (!near || !start_plan(*structure_)) return;
  }
  if (plan_.advance(planner_.planning_work(numbers()))) return;
  swap_refused_ = swap_is_planned();
  drop_plan();
}

void SpatialIndex::drop_plan() noexcept {
  plan_.drop();
  structures_.stash(std::exchange(next_, {}), reserved_);
}

// Exchange of the structure.

void SpatialIndex::install(Structure* structure, StructureKind kind) noexcept {
  drop_plan();
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
  planner_.note_new_structure();
  rows_.invalidate_order();
}

bool SpatialIndex::set_structure(StructureKind kind) noexcept {
  Structure* const made = structures_.make(kind);
  if (made == nullptr) return false;
  structures_.destroy_spares();
  structures_.destroy({kind_, structure_});
  install(made, kind);
  return true;
}

Status SpatialIndex::refresh_as(StructureKind kind, bool& refused) {
  Structure* const made = structures_.make(kind);
  refused = made == nullptr;
  if (refused) return refresh();
  const RowNumbers n = numbers();
  if (planner_.plans_ahead(n) && !n.flat && !made->is_flat() && !planner_.needs_build(n)) {
    drop_plan();
    // The scratch of the current structure's plan is of no use to the next structure.
    if (!reserved_) plan_.release();
    if (start_plan(*made)) {
      next_ = {kind, made};
      return refresh();
    }
  }
  const OwnedStructure before{kind_, structure_};
  install(made, kind);
  if (refresh() == Status::ok) {
    structures_.stash(before, reserved_);
    return Status::ok;
  }
  refused = true;
  structures_.stash({kind, made}, reserved_);
  install(before.structure, before.kind);
  return refresh();
}

void SpatialIndex::install_planned_structure() noexcept {
  if (!swap_is_planned()) return;
  structures_.stash({kind_, structure_}, reserved_);
  kind_ = next_.kind;
  structure_ = std::exchange(next_, {}).structure;
  if (!structure_->prunes_rows() && !reserved_) regular_tree_.release();
}

// Reservation of memory.

bool SpatialIndex::reserve(std::size_t objects, Pages pages,
                           std::span<const StructureKind> later) noexcept {
  drop_plan();
  if (!structures_.make_spares(later, kind_)) return false;
  std::size_t holes = 0;
  std::size_t behind = 0;
  bool flat = true;
  bool prunes = false;
  const auto count_in = [&](const Structure& structure) {
    flat = flat && structure.is_flat();
    prunes = prunes || structure.prunes_rows();
    holes = std::max(holes, structure.max_holes());
    behind = std::max(behind, spare_rows(structure, objects));
  };
  count_in(*structure_);
  for (const OwnedStructure& one : structures_.spares()) {
    if (one.structure != nullptr) count_in(*one.structure);
  }
  const std::size_t ordered = objects + holes + kBlockRows;
  reserved_ = flat || (reserve_order(ordered, behind, pages) &&
                       (!prunes || regular_tree_.reserve(blocks_of(ordered), pages)));
  const BuildRoom room = plan_.room_for(objects, pages);
  reserved_ = reserved_ && structure_->reserve(room);
  for (const OwnedStructure& one : structures_.spares()) {
    if (one.structure != nullptr) reserved_ = reserved_ && one.structure->reserve(room);
  }
  return reserved_;
}

// Makes room for `rows` rows in order and for `behind` rows in the tail.
bool SpatialIndex::reserve_order(std::size_t rows, std::size_t behind, Pages pages) noexcept {
  return rows_.reserve_rows(rows + behind) &&
         spare_.reserve(rows_.pool().capacity() + 2 * kBlockRows, pages) &&
         plan_.reserve(rows + behind, behind, pages) && tree_.reserve(blocks_of(rows), pages) &&
         departures_.reserve(rows);
}

void SpatialIndex::release_scratch() noexcept {
  drop_plan();
  release_columns(spare_, tail_order_);
  plan_.release();
}

void SpatialIndex::release_memory() noexcept {
  reserved_ = false;
  structures_.destroy_spares();
  release_scratch();
  structure_->release_scratch();
  if (rows_.size() != 0) return;
  tree_.release();
  regular_tree_.release();
  departures_.release();
  structure_->release_memory();
}

}  // namespace winnow
