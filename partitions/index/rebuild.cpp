// SpatialIndex: decides when the rows are reordered, and reorders them at once or by a plan that
// was made ahead over several refreshes. refresh() in spatial_index.cpp calls it; OrderPlan
// computes the order.

#include "partitions/index/spatial_index.h"

#include "core/hooks/stage_scope.h"
#include "partitions/tree/environment_order.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

namespace winnow {
namespace {

// Work for a build that is completed at once.
constexpr std::size_t kWholeBuild = std::numeric_limits<std::size_t>::max();
// With fewer rows a build is short enough to be done at once.
constexpr std::size_t kWorthPlanning = 1024;
// A plan starts this many refreshes early: one refresh applies the order, and the forecast is late
// if objects accelerate.
constexpr std::size_t kSpareRefreshes = 2;
// A plan pauses while refreshes have kQuietFactor times fewer changes than the refresh that started
// it, for at most kMaxQuietRefreshes refreshes in a row: if the motion has ended for good, the plan
// must continue.
constexpr std::size_t kQuietFactor = 4;
constexpr std::size_t kMaxQuietRefreshes = 8;
// A build is expected if the tail will have grown to this share of its limit.
constexpr float kNearlyDue = 0.35F;

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

}  // namespace

bool SpatialIndex::needs_build() const noexcept {
  if (!rows_.regions().built) return true;
  const std::size_t live = rows_.size();
  const std::size_t holes = rows_.pool().rows() - live;
  if (holes > live / 4 + built_holes_ + 64) return true;
  if (rows_.filters().has_environments() && needs_grouping()) return true;
  if (structure_->is_flat()) return false;
  return tail() > tail_limit() || excess_tests() > max_wear();
}

std::uint64_t SpatialIndex::max_wear() const noexcept {
  return structure_->build_price() * (rows_.size() + 64);
}

// True if the rows have to be grouped by environment again: rows are in cells, or more than
// tail_limit() objects changed their environment. With a flat structure, new rows count, too.
bool SpatialIndex::needs_grouping() const noexcept {
  const RowRegions& regions = rows_.regions();
  const std::size_t changed = rows_.filters().changed_environments();
  if (!structure_->is_flat()) return regions.regular != 0 || changed > tail_limit();
  return rows_.pool().rows() - regions.sorted + changed > tail_limit();
}

// Starts a plan or continues it, runs it to the end and applies it.
Status SpatialIndex::build() {
  const StageScope stage(WorkStage::build);
  if (structure_->is_flat()) return build_flat();
  rows_.regions().built = false;
  const bool foreseen = plan_.underway();
  if ((!foreseen && !start_plan(*structure_)) || !plan_.advance(kWholeBuild)) {
    drop_plan();
    return Status::out_of_memory;
  }
  const Status status = apply_plan(foreseen);
  return foreseen && status == Status::ok ? absorb_changes(true) : status;
}

bool SpatialIndex::start_plan(Structure& structure) noexcept {
  refreshes_before_plan_ = departures_.refreshes();
  changed_at_plan_ = changed();
  quiet_refreshes_ = 0;
  return plan_.start(rows_, structure, spare_rows(structure), needed_parts(structure));
}

// More than kOften refreshes for rays and regions since the last build, or any before the first
// build, justify an order that takes longer to compute. If the last order lasted at most kTorn
// refreshes, a coarser order is computed.
KdParts SpatialIndex::needed_parts(const Structure& structure) const noexcept {
  constexpr std::size_t kOften = 4;
  constexpr std::size_t kTorn = 2;
  const std::size_t queried = queried_refreshes_.load(std::memory_order_relaxed);
  if (queried > (builds_ == 0 ? 0 : kOften)) return KdParts::blocks;
  if (builds_ == 0) return structure.first_parts();
  return departures_.refreshes() <= kTorn ? KdParts::cells : KdParts::tiles;
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
  if (!complete || !rows_.reserve_rows(rows + spare_rows(next)) ||
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
  built_holes_ = rows - rows_.size();
  structure_->finish_build(plan_.row_plan(), moved);
  plan_.drop();
  const Execution execution = rows_.execution_for(rows);
  tree_.refit_all(rows_.view(), execution);
  built_edge_ = tree_.typical_edge();
  known_wide_ = wide_blocks();
  if (prunes) regular_tree_.refit_all(rows_.view(), execution);
  regions.built = true;
  ++builds_;
  planned_builds_ += moved ? 1 : 0;
  if (builds_without_planning_ != 0) --builds_without_planning_;
  rows_.note_build(edge_of_block(rows_.pool()));
  full_base_ = moved_base_ = excess_ = 0;
  queried_refreshes_ = 0;
  departures_.begin(rows_);
  tail_growth_.begin();
  wear_growth_.begin();
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
  ++builds_;
  rows_.note_build(0.0F);
  return Status::ok;
}

// Planning ahead.

bool SpatialIndex::plans_ahead() const noexcept {
  const std::size_t fewest = build_budget_ == 0 ? kWorthPlanning : 1;
  return build_budget_ != kWholeBuild && rows_.size() >= fewest &&
         !rows_.filters().has_environments();
}

// Returns the number of rows that a refresh plans. The longer orders last, the more refreshes share
// a plan: two fifths of the life of an order, so that the planned order is not out of date when it
// is applied.
std::size_t SpatialIndex::planning_work(const Structure& structure) const noexcept {
  if (build_budget_ != 0) return build_budget_;
  const std::size_t life = plan_.underway() ? refreshes_before_plan_ : departures_.refreshes();
  const std::size_t refreshes = std::max<std::size_t>(1, 2 * life / 5);
  const std::size_t rows = plan_.underway() ? plan_.rows() : rows_.pool().rows();
  return (structure.plan_passes() * rows + refreshes - 1) / refreshes;
}

std::size_t SpatialIndex::changed() const noexcept {
  return rows_.stale().all() ? rows_.size() : rows_.stale().ids().size();
}

// If few objects move now, their refreshes should not pay for the wear of earlier motion.
void SpatialIndex::note_quiet_refresh() noexcept {
  const bool quiet =
      plan_.underway() && build_budget_ == 0 && kQuietFactor * changed() < changed_at_plan_;
  quiet_refreshes_ = quiet ? quiet_refreshes_ + 1 : 0;
}

bool SpatialIndex::plan_paused() const noexcept {
  return quiet_refreshes_ != 0 && quiet_refreshes_ <= kMaxQuietRefreshes;
}

void SpatialIndex::continue_planning() noexcept {
  if (plan_paused()) return;
  if (!plan_.underway() && (!build_is_near() || !start_plan(*structure_))) return;
  if (plan_.advance(planning_work(*plan_.structure()))) return;
  swap_refused_ = swap_is_planned();
  drop_plan();
}

// True if a build is expected within as many refreshes as a plan takes.
bool SpatialIndex::build_is_near() const noexcept {
  if (!plans_ahead() || builds_without_planning_ != 0) return false;
  const std::size_t whole = structure_->plan_passes() * rows_.pool().rows();
  const std::size_t ahead = 1 + (whole - 1) / planning_work(*structure_) + kSpareRefreshes;
  // True if one refresh would plan the whole order. Without a build budget this means that builds
  // are frequent, and planning saves nothing: each order would be out of date when it is applied.
  const bool at_once = planning_work(*structure_) >= whole;
  if (departures_.refreshes() <= ahead || (at_once && build_budget_ == 0)) return false;
  const std::uint64_t grown = tail_growth_.in(ahead);
  if (grown > tail_limit() || wear_growth_.in(ahead) > max_wear()) return true;
  if (!rows_.stale().all() || rows_.regions().regular == 0) return false;
  const float due = kNearlyDue * static_cast<float>(tail_limit());
  if (static_cast<float>(grown) > due) return true;
  const float leaving = departures_.share(rows_, *structure_, ahead);
  const float behind = static_cast<float>(tail()) + leaving * static_cast<float>(rows_.size());
  return leaving > 0.0F && behind > due;
}

void SpatialIndex::drop_plan() noexcept {
  plan_.drop();
  stash(std::exchange(next_, {}));
}

}  // namespace winnow
