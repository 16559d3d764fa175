// Result rows for median, worst and first frames, for first frames on touched and untouched memory,
// for other libraries and threads.

#include "bench/measure/cold_frames.h"
#include "bench/rows/machine.h"
#include "bench/rows/rows.h"
#include "bench/scenes/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

NamedScene scene_named(const char* name) {
  return named_scenes({name}).front();
}

TEST(FrameRows, worst_frame_is_present_only_after_settling) {
  for (const std::size_t frames : {6U, 12U}) {
    Results results;
    const Measurement raced =
        add_frame_race(results, scene_named("teleport"),
                       {.objects = 200, .partitions = {"FlatGrid"}, .frames = frames});
    const Json& row = *results.rows("throughput").front();
    EXPECT_EQ(row.contains("worst_ms"), frames > kSettlingFrames);
    if (!row.contains("worst_ms")) continue;
    const std::vector<double>& ms = raced.runs.front().frame_ms;
    EXPECT_EQ(row["worst_ms"], *std::max_element(ms.begin() + 6, ms.end()));
    EXPECT_EQ(row["first_ms"], ms.front());
  }
}

TEST(FrameRows, rows_compare_with_the_yardstick_if_present) {
  Results results;
  add_every_scene(results, scene_named("jumps"), {.objects = 300, .yardstick = true, .frames = 12});
  const auto rows = results.rows("every_scene");
  ASSERT_GT(rows.size(), 5U);
  for (const Json* row : rows) {
    EXPECT_GE(value_of(*row, "worst_ms"), value_of(*row, "median_ms")) << row->dump();
    EXPECT_GE(value_of(*row, "worst_ratio"), 1.0);
    EXPECT_GT(value_of(*row, "first_ms"), 0.0);
    EXPECT_EQ(row->contains("over_yardstick"), has_yardstick());
  }
  const Json* yardstick = results.row("every_scene", {{"partition", "yardstick"}});
  ASSERT_EQ(yardstick != nullptr, has_yardstick());
  if (yardstick == nullptr) return;
  EXPECT_EQ(value_of(*yardstick, "over_yardstick"), 1.0);
}

TEST(FrameRows, rows_without_the_yardstick_leave_it_out) {
  Results results;
  add_every_scene(results, scene_named("shear"), {.objects = 100, .frames = 3});
  add_cold(results, scene_named("shear"),
           {.objects = 100, .partitions = {"LinearBvh"}, .frames = 1});
  EXPECT_TRUE(results.rows("every_scene", {{"partition", "yardstick"}}).empty());
  EXPECT_FALSE(results.rows("cold").front()->contains("over_yardstick"));
}

TEST(FrameRows, library_with_one_thread_has_one_row) {
  Results results;
  add_frame_race(
      results, scene_named("uniform"),
      {.objects = 400, .partitions = {"LinearBvh"}, .threads = {1, 2}, .peers = true, .frames = 3},
      true);
  EXPECT_EQ(results.rows("throughput").empty(), !has_peers());
  for (const Json* row : results.rows("throughput")) {
    const std::string name = (*row)["partition"];
    EXPECT_TRUE(name == "Embree" || name == "CGAL boxes" || (*row)["threads"] == 1) << name;
  }
}

TEST(HostRows, each_partition_has_a_row_with_both_times) {
  Results results;
  add_hosts(results, scene_named("uniform"),
            {.objects = 300, .partitions = {"LinearBvh", "FlatGrid"}, .threads = {2}, .frames = 4});
  const auto rows = results.rows("hosts");
  ASSERT_EQ(rows.size(), 2U);
  for (const Json* row : rows) {
    EXPECT_GT(value_of(*row, "arena_ms"), 0.0);
    EXPECT_GT(value_of(*row, "over_arena"), 0.0);
  }
}

TEST(ColdFrames, cold_frames_are_measured_in_all_memories) {
  const auto scene = make_scene("mixed", 500, 1);
  for (const int threads : {1, 2}) {
    const ColdRace race =
        race_cold_frames(scene->boxes(), {"FlatGrid", "LinearBvh", "AutoPartition"}, threads, 3);
    ASSERT_EQ(race.frames.size(), 9U);
    EXPECT_EQ(race.yardstick_ms.size(), has_yardstick() ? 3U : 0U);
    for (ColdFrames one : race.frames) {
      auto& ms = one.times;
      ASSERT_EQ(ms["total_ms"].size(), 3U) << one.partition;
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(ms["insert_ms"][i] + ms["build_ms"][i] + ms["pairs_ms"][i], ms["total_ms"][i],
                    1e-9);
        EXPECT_GT(ms["pairs_ms"][i], 0.0);
      }
      for (const char* name : {"reserved_ms", "ready_ms", "reserve_ms"}) {
        EXPECT_EQ(ms[name].size(), one.memory == kTouched ? 0U : 3U) << name;
      }
    }
  }
}

}  // namespace
}  // namespace winnow::bench
