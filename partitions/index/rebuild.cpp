// SpatialIndex: builds, which reorder the rows at once or by a plan that was made ahead over
// several refreshes. refresh() in spatial_index.cpp calls `build`; RebuildPlanner decides,
// OrderPlan computes the order.

#include "core/hooks/stage_scope.h"
#include "partitions/index/outliers.h"
#include "partitions/index/spatial_index.h"
#include "partitions/tree/environment_order.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace winnow {
namespace {

// Median edge of the blocks of all rows, also of those in cells, which the tree does not contain.
float edge_of_block(const BoundsPool& pool) noexcept {
  return median_edge(pool.blocks(), [&](std::size_t block, std::size_t a) {
    const float* const low = pool.column(a) + block * kBlockRows;
    const float* const high = pool.column(3 + a) + block * kBlockRows;
    return *std::max_element(high, high + kBlockRows) - *std::min_element(low, low + kBlockRows);
  });
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
Status SpatialIndex::apply_plan(bool foreseen) {
  RowRegions& regions = rows_.regions();
  regions.built = false;
  const Structure& next = *plan_.structure();
  Column<std::uint32_t>& order = plan_.order();
  const std::size_t ordered = order.size();
  const std::size_t regular = plan_.regular();
  const std::size_t first_block = blocks_of(regular);
  // `complete` appends the rows added since the start of the plan: they are the tail.
  const bool completed = !foreseen || plan_.complete();
  const std::size_t rows = order.size();
  const bool prunes = next.prunes_rows();
  if (!completed || !rows_.reserve_rows(rows + RebuildPlanner::tail_room(prunes, rows_.size())) ||
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
  structure_->finish_build(plan_.row_plan(), foreseen);
  plan_.drop();
  const Execution execution = rows_.execution_for(rows);
  tree_.refit_all(rows_.view(), execution);
  planner_.note_build(foreseen, holes, tree_.typical_edge());
  if (regular == 0) planner_.note_wide(count_wide_blocks(rows_, tree_, planner_.built_edge()));
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
  return plan_.start(rows_, structure,
                     RebuildPlanner::tail_room(structure.prunes_rows(), rows_.size()),
                     planner_.precision(structure.first_precision()));
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

}  // namespace winnow
