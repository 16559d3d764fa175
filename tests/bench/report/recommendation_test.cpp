// Recommendations that a report makes from rows with an obvious answer.

#include "bench/report/recommendation.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace {

using winnow::bench::Format;
using winnow::bench::Json;
using winnow::bench::recommend;
using winnow::bench::Results;

Results empty_results() {
  Results results;
  for (const char* table : {"advice_ranking", "throughput"}) {
    std::vector<std::string> keys{"scene", "objects", "threads", "partition"};
    if (std::string(table) == "throughput") keys.emplace_back("isa");
    results.declare({table,
                     "advice",
                     "rows",
                     keys,
                     {{"frame_ms", "frame", "ms"},
                      {"first_ms", "first frame", "ms"},
                      {"bytes_per_object", "memory", "bytes/object"}}});
  }
  return results;
}

void add_race(Results& results, const std::string& scene,
              const std::vector<std::pair<std::string, double>>& frames) {
  for (const auto& [partition, ms] : frames) {
    results.add("advice_ranking", {{"scene", scene},
                                   {"objects", 1000},
                                   {"threads", 1},
                                   {"partition", partition},
                                   {"frame_ms", ms},
                                   {"first_ms", 3.0 * ms},
                                   {"bytes_per_object", 80.0}});
  }
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(ARecommendation, results_without_a_race_have_no_recommendation) {
  EXPECT_FALSE(recommend(empty_results()).has_value());
  EXPECT_FALSE(recommend(Results()).has_value());
}

TEST(ARecommendation, fastest_partition_of_one_race_is_recommended) {
  Results results = empty_results();
  add_race(results, "pile", {{"FlatGrid", 2.0}, {"LinearBvh", 1.0}, {"AutoPartition", 0.5}});
  const auto answer = recommend(results);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->take, "LinearBvh");
  EXPECT_TRUE(contains(answer->because, "no partition takes less time")) << answer->because;
  EXPECT_TRUE(contains(answer->price, "1.00 ms a frame and 3.00 ms")) << answer->price;
  EXPECT_TRUE(contains(answer->next, "FlatGrid, 2.00 times")) << answer->next;
  EXPECT_TRUE(contains(answer->varying, "0.500 times")) << answer->varying;
  EXPECT_EQ(answer->others, "");
}

TEST(ARecommendation, small_loss_everywhere_beats_frequent_wins) {
  Results results = empty_results();
  add_race(results, "pile", {{"FlatGrid", 1.0}, {"LinearBvh", 1.1}});
  add_race(results, "wall", {{"FlatGrid", 1.0}, {"LinearBvh", 1.1}});
  add_race(results, "mixed", {{"FlatGrid", 9.0}, {"LinearBvh", 1.0}});
  const auto answer = recommend(results);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->take, "LinearBvh");
  EXPECT_TRUE(contains(answer->because, "in 1 of 3 races and at most 1.10 times"))
      << answer->because;
}

TEST(ARecommendation, partition_with_missing_races_is_left_out) {
  Results results = empty_results();
  add_race(results, "pile", {{"FlatGrid", 2.0}, {"NSquared", 1.0}});
  add_race(results, "wall", {{"FlatGrid", 2.0}});
  EXPECT_EQ(recommend(results)->take, "FlatGrid");
}

TEST(ARecommendation, partitions_too_close_to_rank_are_named) {
  Results results = empty_results();
  add_race(results, "pile", {{"FlatGrid", 1.0}, {"LinearBvh", 1.01}});
  EXPECT_TRUE(contains(recommend(results)->next, "too close")) << recommend(results)->next;
}

TEST(ARecommendation, fastest_library_of_each_scene_is_named) {
  Results results = empty_results();
  const std::string isa = results.document()["machine"]["isa"];
  for (const char* scene : {"pile", "wall"}) {
    add_race(results, scene, {{"FlatGrid", 1.0}});
    const double embree = std::string(scene) == "pile" ? 4.0 : 20.0;
    for (const auto& [name, ms] : std::vector<std::pair<std::string, double>>{
             {"FlatGrid", 1.0}, {"Embree", embree}, {"FCL tree", 12.0}, {"yardstick", 2.0}}) {
      results.add("throughput", {{"scene", scene},
                                 {"objects", 1000},
                                 {"threads", 2},
                                 {"partition", name},
                                 {"isa", isa},
                                 {"frame_ms", ms}});
    }
  }
  const std::string others = recommend(results)->others;
  EXPECT_TRUE(contains(others, "4.00 to 12.0 times")) << others;
  EXPECT_TRUE(contains(others, "Embree") && contains(others, "FCL tree")) << others;
  EXPECT_FALSE(contains(others, "yardstick")) << others;
}

}  // namespace
