// Runs the stages of a plan: the structure orders its regular rows (Structure::plan), then the
// remaining rows are ordered for the tree, by the structure (order_rest), by environment
// (tree/environment_order.h) or by k-d cuts (tree/kd_order.h). SpatialIndex calls these functions
// (rebuild.cpp).

#include "partitions/index/order_plan.h"

#include "partitions/tree/environment_order.h"

#include <algorithm>
#include <limits>

namespace winnow {
namespace {

// Entries of an order beyond the number of rows.
constexpr std::size_t kSlack = 4 * kBlockRows;
// This many cuts of a row take as long as one visit of the row.
constexpr std::size_t kCutsPerRow = 2;
// More work than this overflows when it is counted in cuts.
constexpr std::size_t kMaxCutWork = std::numeric_limits<std::size_t>::max() / kCutsPerRow;

}  // namespace

bool OrderPlan::reserve(std::size_t rows, std::size_t moved, Pages pages) noexcept {
  return order_.reserve(rows + kSlack, pages) && rest_.reserve(rows + kSlack, pages) &&
         moves_.reserve(moved, pages) && placed_.reserve(moved, pages);
}

bool OrderPlan::start(Rows& rows, Structure& structure, std::size_t room,
                      KdPrecision precision) noexcept {
  drop();
  const std::size_t most = rows.pool().rows() + room + kSlack;
  order_.clear();
  rest_.clear();
  moves_.clear();
  placed_.clear();
  if (!order_.grow(most) || !rest_.grow(most)) return false;
  rows_ = &rows;
  structure_ = &structure;
  planned_rows_ = rows.pool().rows();
  planned_objects_ = rows.size();
  phase_ = PlanPhase::structure;
  structure_stage_ = 0;
  resumed_ = false;
  precision_ = precision;
  rows.regions().planned = planned_rows_;
  // Cells would mix the environments, and each object would be tested against objects of all
  // environments. In the tree, rows are sorted by environment, and queries skip nodes of other
  // environments.
  if (rows.filters().has_environments()) {
    structure.append_all_to_rest(row_plan());
    phase_ = PlanPhase::rest;
  }
  return true;
}

bool OrderPlan::advance(std::size_t work) noexcept {
  sort_moves();  // Structure::plan searches the moves by row
  // If no rows remain for the tree, the stage `rest` takes no work, so the plan becomes ready in
  // this refresh.
  const auto is_as_good_as_ready = [&] { return phase_ == PlanPhase::rest && rest_.empty(); };
  while ((work != 0 && !ready()) || is_as_good_as_ready()) {
    if (!run_stage(work)) return false;
  }
  resumed_ = true;
  return true;
}

// Returns false if an allocation fails.
bool OrderPlan::run_stage(std::size_t& work) noexcept {
  switch (phase_) {
    case PlanPhase::structure: {
      const PlanStatus planned = structure_->plan(row_plan(), structure_stage_++);
      if (planned == PlanStatus::done) phase_ = PlanPhase::rest;
      // A structure that leaves all rows to the tree takes no work.
      if (planned == PlanStatus::unfinished || !order_.empty())
        work -= std::min(work, planned_rows_);
      return planned != PlanStatus::out_of_memory;
    }
    case PlanPhase::rest:
      return begin_rest(work);
    case PlanPhase::cuts: {
      const bool done = cuts_.advance(work > kMaxCutWork ? work : kCutsPerRow * work,
                                      rows_->execution_for(rest_.size()));
      work = 0;
      if (done) append_rest();
      return true;
    }
    case PlanPhase::ready:
      return true;
  }
  return false;
}

bool OrderPlan::begin_rest(std::size_t& work) noexcept {
  work -= std::min(work, rest_.size());
  const BoundsPool& pool = rows_->pool();
  if (resumed_) {
    const auto is_hole = [&](std::uint32_t row) { return pool.ids()[row] == kNoObject; };
    rest_.set_size(static_cast<std::size_t>(std::remove_if(rest_.begin(), rest_.end(), is_hole) -
                                            rest_.begin()));
  }
  const std::span<std::uint32_t> rest(rest_.data(), rest_.size());
  regular_ = order_.size();
  // The tree's blocks begin behind the regular rows, so that no block has both regular rows and
  // rows of the tree.
  while (order_.size() % kBlockRows != 0) (void)order_.push_back(kNoObject);
  const Execution execution = rows_->execution_for(rest.size());
  if (rows_->filters().has_environments()) {
    phase_ = PlanPhase::ready;
    const ObjectFilter* const filters = rows_->filters().data();
    return order_.grow(order_.size() + rest.size()) &&
           sort_by_environment_and_place(pool, filters, rest, items_, order_.end(), points_,
                                         execution) &&
           append_environments(pool, filters, rest, order_);
  }
  const Structure::RestOrder ordered = structure_->order_rest(rest, order_);
  if (ordered != Structure::RestOrder::none) {
    phase_ = PlanPhase::ready;
    return ordered == Structure::RestOrder::done;
  }
  if (!order_.grow(order_.size() + rest.size()) ||
      !cuts_.start(pool, rest, order_.end(), points_, execution, precision_)) {
    return false;
  }
  phase_ = PlanPhase::cuts;
  // One block needs no cuts, so the plan is ready without another refresh.
  if (rest.size() <= kBlockRows) append_rest();
  return true;
}

void OrderPlan::append_rest() noexcept {
  std::copy(rest_.begin(), rest_.end(), order_.end());
  order_.set_size(order_.size() + rest_.size());
  phase_ = PlanPhase::ready;
}

bool OrderPlan::complete() noexcept {
  const ObjectId* const ids = rows_->pool().ids();
  const std::size_t rows = rows_->pool().rows();
  const std::size_t added = rows - planned_rows_;
  if (!order_.grow(order_.size() + added) || !placed_.grow(moves_.size())) return false;
  if (!moves_.empty()) place_moved();
  const std::uint32_t* placed = placed_.begin();
  for (std::size_t row = planned_rows_; row < rows; ++row) {
    if (placed != placed_.end() && *placed == row) {
      ++placed;
    } else if (ids[row] != kNoObject) {
      (void)order_.push_back(static_cast<std::uint32_t>(row));
    }
  }
  return true;
}

void OrderPlan::sort_moves() noexcept {
  std::ranges::sort(moves_, {}, &RowMove::row);
}

void OrderPlan::place_moved() noexcept {
  sort_moves();  // moves were noted since the last stage
  const ObjectId* const ids = rows_->pool().ids();
  const KeyTable& keys = rows_->keys();
  for (std::uint32_t& row : order_) {
    if (row == kNoObject || ids[row] != kNoObject) continue;
    const RowMove* const move = std::ranges::lower_bound(moves_, row, {}, &RowMove::row);
    if (move == moves_.end() || move->row != row || !keys.is_live(move->id)) continue;
    row = keys.row_of(move->id);
    (void)placed_.push_back(row);
  }
  std::sort(placed_.begin(), placed_.end());
}

void OrderPlan::drop() noexcept {
  if (rows_ != nullptr) rows_->regions().planned = 0;
  rows_ = nullptr;
  structure_ = nullptr;
  phase_ = PlanPhase::structure;
}

void OrderPlan::release() noexcept {
  drop();
  release_columns(order_, rest_, moves_, placed_, items_, list_, points_);
}

}  // namespace winnow
