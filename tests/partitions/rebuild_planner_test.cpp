// Decisions of RebuildPlanner on synthetic numbers: no rows, no structure.

#include "partitions/index/rebuild_planner.h"

#include <gtest/gtest.h>

namespace winnow::test {
namespace {

using OrderStep = RebuildPlanner::OrderStep;
using OutlierStep = RebuildPlanner::OutlierStep;
using PairQueryKind = RebuildPlanner::PairQueryKind;

constexpr std::size_t kOrdered = 16000;
constexpr std::size_t kFullTail = 1064;  // a sixteenth of the objects, plus 64

// An ordered tree over kOrdered rows without holes, in which all objects moved.
RowNumbers ordered_tree() {
  RowNumbers n;
  n.objects = n.rows = n.changed = kOrdered;
  n.all_changed = n.built = true;
  n.build_price = 4;
  n.plan_passes = 4;
  return n;
}

// A planner that made one build and then saw `frames` frames, each with `growth` more rows in the
// tail.
struct PlannerAfter : RebuildPlanner {
  explicit PlannerAfter(std::size_t frames, std::size_t growth = 0, std::size_t budget = 0)
      : RebuildPlanner(budget) {
    note_build(false, 0, 1.0F);
    for (std::size_t i = 1; i <= frames; ++i) note_frame(i * growth);
  }
};

TEST(RebuildPlanner, rows_without_an_order_are_built) {
  RebuildPlanner planner(0);
  RowNumbers n = ordered_tree();
  n.built = false;
  EXPECT_EQ(planner.begin_refresh(n), OrderStep::build);
  n.built = true;
  EXPECT_EQ(planner.begin_refresh(n), OrderStep::keep);
}

TEST(RebuildPlanner, long_tail_is_built_unless_structure_is_flat) {
  const PlannerAfter planner(1);
  RowNumbers n = ordered_tree();
  n.tail = kFullTail;
  EXPECT_FALSE(planner.needs_build(n));
  ++n.tail;
  EXPECT_TRUE(planner.needs_build(n));
  n.flat = true;
  EXPECT_FALSE(planner.needs_build(n));
}

TEST(RebuildPlanner, holes_beyond_padding_of_build_are_built) {
  RebuildPlanner planner(0);
  planner.note_build(false, 100, 1.0F);
  RowNumbers n = ordered_tree();
  n.rows = n.objects + n.objects / 4 + 100 + 64;
  EXPECT_FALSE(planner.needs_build(n));
  ++n.rows;
  EXPECT_TRUE(planner.needs_build(n));
}

TEST(RebuildPlanner, environments_in_cells_are_built) {
  const PlannerAfter planner(1);
  RowNumbers n = ordered_tree();
  n.environments = true;
  n.ungrouped = kFullTail;
  EXPECT_FALSE(planner.needs_build(n));
  n.regular = 1;
  EXPECT_TRUE(planner.needs_build(n));
  n.regular = 0;
  ++n.ungrouped;
  EXPECT_TRUE(planner.needs_build(n));
}

TEST(RebuildPlanner, wear_above_price_of_build_is_built) {
  const PlannerAfter planner(1);
  const RowNumbers n = ordered_tree();
  const std::uint64_t price = n.build_price * (n.objects + 64);
  planner.note_work(1000, 1, PairQueryKind::all);  // the cost on a fresh structure
  planner.note_work(1000 + price, 1, PairQueryKind::all);
  EXPECT_EQ(planner.excess_tests(), price);
  EXPECT_FALSE(planner.needs_build(n));
  planner.note_work(1001, 1, PairQueryKind::all);
  EXPECT_TRUE(planner.needs_build(n));
}

TEST(RebuildPlanner, build_resets_wear) {
  PlannerAfter planner(1);
  planner.note_work(1, 1, PairQueryKind::moved);
  planner.note_work(1'000'000, 1, PairQueryKind::moved);
  ASSERT_TRUE(planner.needs_build(ordered_tree()));
  planner.note_build(false, 0, 1.0F);
  EXPECT_FALSE(planner.needs_build(ordered_tree()));
  EXPECT_EQ(planner.excess_tests(), 0U);
  EXPECT_EQ(planner.frames(), 0U);
}

TEST(RebuildPlanner, growing_tail_is_foreseen) {
  const RowNumbers n = ordered_tree();
  // A plan takes at most a few refreshes: after 20 frames, an eighth of the rows per refresh.
  EXPECT_TRUE(PlannerAfter(20, 50).forecast_build(n).near);
  EXPECT_FALSE(PlannerAfter(20, 1).forecast_build(n).near);
}

TEST(RebuildPlanner, builds_after_few_frames_are_not_planned) {
  EXPECT_FALSE(PlannerAfter(2, 500).forecast_build(ordered_tree()).near);
}

TEST(RebuildPlanner, largest_budget_or_few_objects_plan_nothing) {
  RowNumbers n = ordered_tree();
  EXPECT_FALSE(PlannerAfter(20, 50, RebuildPlanner::kWholeBuild).forecast_build(n).near);
  n.objects = n.rows = 1023;
  EXPECT_FALSE(PlannerAfter(20, 50).plans_ahead(n));
  EXPECT_TRUE(PlannerAfter(20, 50, 100).plans_ahead(n));
}

TEST(RebuildPlanner, outdated_plan_stops_planning_for_four_builds) {
  PlannerAfter planner(20, 50);
  ASSERT_TRUE(planner.forecast_build(ordered_tree()).near);
  planner.note_mistake();
  for (int build = 0; build < 4; ++build) {
    EXPECT_FALSE(planner.forecast_build(ordered_tree()).near) << build;
    planner.note_build(false, 0, 1.0F);
    for (std::size_t i = 1; i <= 20; ++i) planner.note_frame(50 * i);
  }
  EXPECT_TRUE(planner.forecast_build(ordered_tree()).near);
}

TEST(RebuildPlanner, objects_in_cells_are_foreseen_to_leave) {
  RowNumbers n = ordered_tree();
  n.regular = kOrdered;
  const RebuildPlanner::BuildForecast forecast = PlannerAfter(20).forecast_build(n);
  EXPECT_FALSE(forecast.near);
  ASSERT_TRUE(forecast.may_leave);
  EXPECT_FALSE(RebuildPlanner::is_near_if_leaving(n, 0.0F));
  EXPECT_FALSE(RebuildPlanner::is_near_if_leaving(n, 0.01F));
  EXPECT_TRUE(RebuildPlanner::is_near_if_leaving(n, 0.1F));
}

TEST(RebuildPlanner, plan_takes_two_fifths_of_life_of_order) {
  RowNumbers n = ordered_tree();
  EXPECT_EQ(PlannerAfter(25).planning_work(n), 4 * kOrdered / 10);
  EXPECT_EQ(PlannerAfter(25, 0, 77).planning_work(n), 77U);
}

TEST(RebuildPlanner, ready_plan_is_applied_except_in_pause) {
  PlannerAfter planner(20);
  RowNumbers n = ordered_tree();
  planner.note_plan(n);
  n.plan_rows = kOrdered;
  n.plan_ready = true;
  EXPECT_EQ(planner.begin_refresh(n), OrderStep::apply_plan);
  n.all_changed = false;
  n.changed = kOrdered / 8;
  for (int quiet = 0; quiet < 8; ++quiet) {
    EXPECT_EQ(planner.begin_refresh(n), OrderStep::keep) << quiet;
    EXPECT_TRUE(planner.is_paused());
  }
  EXPECT_EQ(planner.begin_refresh(n), OrderStep::apply_plan);
}

TEST(RebuildPlanner, wide_blocks_are_searched_or_built) {
  PlannerAfter planner(1);
  const RowNumbers n = ordered_tree();
  ASSERT_TRUE(planner.may_have_outliers(n));
  // The price of a build of 1000 blocks is 4000 tests.
  EXPECT_EQ(planner.step_for_outliers(n, 7, 1000), OutlierStep::none);
  EXPECT_EQ(planner.step_for_outliers(n, 8, 1000), OutlierStep::search);
  EXPECT_EQ(planner.step_for_outliers(n, 250, 1000), OutlierStep::search);
  EXPECT_EQ(planner.step_for_outliers(n, 251, 1000), OutlierStep::build);
  planner.note_wide(251);
  EXPECT_EQ(planner.step_for_outliers(n, 251, 1000), OutlierStep::none);
}

TEST(RebuildPlanner, few_changes_are_not_searched_for_outliers) {
  const PlannerAfter planner(1);
  RowNumbers n = ordered_tree();
  n.all_changed = false;
  n.changed = 10;
  EXPECT_FALSE(planner.may_have_outliers(n));
}

TEST(RebuildPlanner, blocks_far_wider_than_after_build_are_scattered) {
  const PlannerAfter planner(1);
  RowNumbers n = ordered_tree();
  EXPECT_FALSE(planner.may_be_scattered(n, 12));
  EXPECT_TRUE(planner.may_be_scattered(n, 13));
  // At a price of 4 tests, blocks may become 1.4 times as wide; at a high price, twice.
  EXPECT_FALSE(planner.is_scattered(n, 1.3F));
  EXPECT_TRUE(planner.is_scattered(n, 1.5F));
  n.build_price = 240;
  EXPECT_FALSE(planner.is_scattered(n, 1.9F));
  EXPECT_TRUE(planner.is_scattered(n, 2.1F));
}

TEST(RebuildPlanner, queries_before_first_build_get_precise_order) {
  RebuildPlanner planner(0);
  EXPECT_EQ(planner.precision(KdPrecision::cells), KdPrecision::cells);
  planner.note_query();
  EXPECT_EQ(planner.precision(KdPrecision::cells), KdPrecision::blocks);
  planner.note_build(false, 0, 1.0F);
  EXPECT_EQ(planner.precision(KdPrecision::cells), KdPrecision::cells);  // a second build at once
  for (int frame = 0; frame < 3; ++frame) planner.note_frame(0);
  EXPECT_EQ(planner.precision(KdPrecision::cells), KdPrecision::tiles);
}

TEST(RebuildPlanner, repeated_refresh_with_few_changes_is_no_frame) {
  PlannerAfter planner(1);
  RowNumbers n = ordered_tree();
  n.all_changed = false;
  n.changed = 1;
  EXPECT_FALSE(planner.begin_frame(n));
  planner.note_query();
  EXPECT_TRUE(planner.begin_frame(n));
  EXPECT_FALSE(planner.begin_frame(n));
}

}  // namespace
}  // namespace winnow::test
