// Decisions of RebuildPlanner: builds that are due, outliers, and plans ahead; then the events that
// they depend on.

#include "partitions/index/rebuild_planner.h"

namespace winnow {
namespace {

// With fewer objects, and without a build budget, a build is short enough to be done at once.
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
// After a plan that was out of date when it was applied, this many builds are not planned ahead.
constexpr std::size_t kBuildsAfterMistake = 4;
// Searching a block for outliers costs this many tests for each of its rows.
constexpr std::uint64_t kSearchCost = 16;
// There is no search if fewer than one object in this many changed: then wear, which is counted in
// tests, leads to a build if it is necessary.
constexpr std::size_t kFewChanges = 256;
// There is no search either if few blocks became wide: at most one for this many tests of the price
// of a build.
constexpr std::size_t kPriceOfWideBlock = 512;

}  // namespace

// Builds that are due.

RebuildPlanner::OrderStep RebuildPlanner::begin_refresh(const RowNumbers& n) noexcept {
  // While few objects move, the plan pauses (`is_paused`): it would repair the wear of earlier
  // motion at the cost of quiet refreshes.
  const bool quiet =
      n.plan_rows != 0 && build_budget_ == 0 && kQuietFactor * n.changed < changed_at_plan_;
  quiet_refreshes_ = quiet ? quiet_refreshes_ + 1 : 0;
  if (needs_build(n)) return OrderStep::build;
  return n.plan_ready && !is_paused() ? OrderStep::apply_plan : OrderStep::keep;
}

bool RebuildPlanner::needs_build(const RowNumbers& n) const noexcept {
  if (!n.built) return true;
  const std::size_t holes = n.rows - n.objects;
  if (holes > n.objects / 4 + built_holes_ + 64) return true;
  // Rows in cells cannot be grouped by environment.
  const bool in_cells = !n.flat && n.regular != 0;
  if (n.environments && (in_cells || n.ungrouped > tail_limit(n.objects))) return true;
  if (n.flat) return false;
  return n.tail > tail_limit(n.objects) || excess_tests() > max_wear(n);
}

bool RebuildPlanner::may_be_scattered(const RowNumbers& n, std::size_t blocks) const noexcept {
  // A query of a tree with at most this many blocks tests nearly all of them in any order of the
  // rows.
  constexpr std::size_t kFewBlocks = 12;
  // Cells and strips detect objects that leave them; the tree beside them contains rows of all
  // parts of the scene.
  return blocks > kFewBlocks && n.regular == 0 && n.all_changed;
}

// If most objects jumped, one query of a tree in the old order would cost as much as many builds.
// The sizes of the leaves show such jumps before the query. Slow wear is detected by counting
// tests.
bool RebuildPlanner::is_scattered(const RowNumbers& n, float typical_edge) const noexcept {
  constexpr float kScattered = 2.0F;
  constexpr float kScatterOfPrice = 0.1F;  // a lower limit if a build is cheap
  const float price = static_cast<float>(n.build_price);
  const float scattered = std::min(kScattered, 1.0F + kScatterOfPrice * price);
  return built_edge_ > 0.0F && typical_edge > scattered * built_edge_;
}

bool RebuildPlanner::may_have_outliers(const RowNumbers& n) const noexcept {
  const bool few = !n.all_changed && n.changed * kFewChanges < n.objects;
  return !few && n.regular == 0 && built_edge_ > 0.0F;
}

// An outlier makes the box of its block overlap many others. Blocks that became wide since the last
// search may contain one.
RebuildPlanner::OutlierStep RebuildPlanner::step_for_outliers(const RowNumbers& n, std::size_t wide,
                                                              std::size_t blocks) noexcept {
  known_wide_ = std::min(known_wide_, wide);
  const std::uint64_t price = n.build_price * blocks;
  if (wide <= known_wide_ + price / kPriceOfWideBlock) return OutlierStep::none;
  // If the search would cost more than a build, build instead.
  return wide * kSearchCost > price ? OutlierStep::build : OutlierStep::search;
}

// Planning ahead.

bool RebuildPlanner::plans_ahead(const RowNumbers& n) const noexcept {
  const std::size_t fewest = build_budget_ == 0 ? kWorthPlanning : 1;
  return build_budget_ != kWholeBuild && n.objects >= fewest && !n.environments;
}

// The longer orders last, the more refreshes share a plan: two fifths of the life of an order, so
// that the planned order is not out of date when it is applied.
std::size_t RebuildPlanner::planning_work(const RowNumbers& n) const noexcept {
  if (build_budget_ != 0) return build_budget_;
  const std::size_t life = n.plan_rows != 0 ? frames_before_plan_ : frames_;
  const std::size_t refreshes = std::max<std::size_t>(1, 2 * life / 5);
  const std::size_t rows = n.plan_rows != 0 ? n.plan_rows : n.rows;
  return (n.plan_passes * rows + refreshes - 1) / refreshes;
}

bool RebuildPlanner::is_paused() const noexcept {
  return quiet_refreshes_ != 0 && quiet_refreshes_ <= kMaxQuietRefreshes;
}

RebuildPlanner::BuildForecast RebuildPlanner::forecast_build(const RowNumbers& n) const noexcept {
  if (!plans_ahead(n) || builds_without_planning_ != 0) return {};
  const std::size_t whole = n.plan_passes * n.rows;
  const std::size_t work = planning_work(n);
  const std::size_t ahead = 1 + (whole - 1) / work + kSpareRefreshes;
  // True if one refresh would plan the whole order. Without a build budget this means that builds
  // are frequent, and planning saves nothing: each order would be out of date when it is applied.
  const bool at_once = work >= whole;
  if (frames_ <= ahead || (at_once && build_budget_ == 0)) return {};
  const std::uint64_t grown = tail_growth_.in(ahead);
  if (grown > tail_limit(n.objects) || wear_growth_.in(ahead) > max_wear(n)) {
    return {.near = true, .refreshes = ahead};
  }
  if (!n.all_changed || n.regular == 0) return {};
  const float due = kNearlyDue * static_cast<float>(tail_limit(n.objects));
  const bool near = static_cast<float>(grown) > due;
  return {.near = near, .may_leave = !near, .refreshes = ahead};
}

bool RebuildPlanner::is_near_if_leaving(const RowNumbers& n, float leaving) noexcept {
  const float due = kNearlyDue * static_cast<float>(tail_limit(n.objects));
  const float behind = static_cast<float>(n.tail) + leaving * static_cast<float>(n.objects);
  return leaving > 0.0F && behind > due;
}

// More than kManyQueried refreshes for rays and regions since the last build, or any before the
// first build, justify an order that takes longer to compute. If the last order lasted at most
// kShortLife refreshes, a coarser order is computed.
KdPrecision RebuildPlanner::precision(KdPrecision first) const noexcept {
  constexpr std::size_t kManyQueried = 4;
  constexpr std::size_t kShortLife = 2;
  const std::size_t queried = queried_refreshes_.load(std::memory_order_relaxed);
  if (queried > (builds_ == 0 ? 0 : kManyQueried)) return KdPrecision::blocks;
  if (builds_ == 0) return first;
  return frames_ <= kShortLife ? KdPrecision::cells : KdPrecision::tiles;
}

// A second refresh with few changes and no query in between does not count as a frame, because the
// forecasts of builds extrapolate growth per frame.
bool RebuildPlanner::begin_frame(const RowNumbers& n) noexcept {
  const bool queried = queried_.exchange(false, std::memory_order_relaxed);
  return queried || n.all_changed || 4 * n.changed >= n.objects;
}

// Events.

void RebuildPlanner::note_query() const noexcept {
  queried_refreshes_.fetch_add(1, std::memory_order_relaxed);
  queried_.store(true, std::memory_order_relaxed);
}

void RebuildPlanner::note_work(std::uint64_t tests, std::uint64_t queries,
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

void RebuildPlanner::note_plan(const RowNumbers& n) noexcept {
  frames_before_plan_ = frames_;
  changed_at_plan_ = n.changed;
  quiet_refreshes_ = 0;
}

void RebuildPlanner::note_frame(std::size_t tail) noexcept {
  tail_growth_.note(tail);
  wear_growth_.note(excess_tests());
  ++frames_;
}

void RebuildPlanner::note_mistake() noexcept {
  builds_without_planning_ = kBuildsAfterMistake;
}

void RebuildPlanner::note_build(bool foreseen, std::size_t holes, float edge) noexcept {
  ++builds_;
  planned_builds_ += foreseen ? 1 : 0;
  if (builds_without_planning_ != 0) --builds_without_planning_;
  built_holes_ = holes;
  built_edge_ = edge;
  full_base_ = moved_base_ = excess_ = 0;
  queried_refreshes_ = 0;
  frames_ = 0;
  tail_growth_.begin();
  wear_growth_.begin();
}

void RebuildPlanner::note_new_structure() noexcept {
  built_edge_ = 0.0F;
  built_holes_ = 0;
  full_base_ = moved_base_ = excess_ = 0;
}

}  // namespace winnow
