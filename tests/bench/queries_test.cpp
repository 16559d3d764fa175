// The races of `winnow dev queries`: all engines return equal answers, and a difference is noticed.

#include "bench/contenders/partition_queries.h"
#include "bench/contenders/partitions.h"
#include "bench/measure/query_race.h"
#include "bench/measure/ray_race.h"
#include "bench/peers/peers.h"
#include "bench/scenes/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace winnow::bench {
namespace {

std::vector<QueryRun> race_on(const std::string& scene, std::vector<QueryContender>& contenders,
                              int threads) {
  const auto source = make_scene(scene, 300, 5);
  for (const std::string& name : all_partitions()) {
    contenders.push_back({std::make_unique<PartitionQueries>(name, threads), false});
  }
  for (auto& peer : make_query_peers()) contenders.push_back({std::move(peer), true});
  const auto sets = make_query_sets(source->boxes(), 200, 9);
  return race_queries(source->boxes(), sets, contenders,
                      {.rounds = 1, .threads = threads, .judged = 200});
}

class Race : public testing::TestWithParam<const char*> {};

TEST_P(Race, every_engine_has_the_same_answers) {
  for (const int threads : {1, 2}) {
    std::vector<QueryContender> contenders;
    const std::vector<QueryRun> runs = race_on(GetParam(), contenders, threads);
    for (const QueryRun& run : runs) {
      EXPECT_TRUE(run.answered()) << run.engine << ": " << run.set << ": " << run.refusal;
      EXPECT_TRUE(run.comparison.agree())
          << run.engine << ": " << run.set << ": " << run.comparison.first;
    }
    // Every engine answers the queries of each set one by one. Partitions also answer rays and
    // boxes in batches.
    EXPECT_GE(runs.size(), all_partitions().size() * (query_set_names().size() + 7));
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Race, testing::Values("uniform", "mixed", "pile"));

TEST(Race, timed_round_has_the_hits_that_were_compared) {
  std::vector<QueryContender> contenders;
  const std::vector<QueryRun> runs = race_on("uniform", contenders, 1);
  for (const QueryRun& run : runs) {
    const auto first = std::find_if(runs.begin(), runs.end(), [&](const QueryRun& other) {
      return other.engine == "LinearBvh" && other.set == run.set;
    });
    ASSERT_NE(first, runs.end());
    if (run.comparison.undecided == 0) {
      EXPECT_EQ(run.found, first->found) << run.engine << ": " << run.set;
    }
    EXPECT_EQ(run.ms.size(), 1U);
  }
}

/// Two unit boxes in a row and one ray, which passes through both or misses both.
class Comparisons : public testing::Test {
 protected:
  static QueryResults answers(std::initializer_list<Found> found) {
    QueryResults result;
    for (const Found& one : found) result.add(one);
    result.next();
    return result;
  }
  Comparison exactly(std::initializer_list<Found> expected,
                     std::initializer_list<Found> got) const {
    return compare_exactly(judge_, set_, answers(expected), answers(got));
  }
  Comparison in_float(std::initializer_list<Found> expected,
                      std::initializer_list<Found> got) const {
    return compare_in_float(judge_, set_, answers(expected), answers(got));
  }
  Comparison by_force(std::initializer_list<Found> got) const {
    return compare_by_force(judge_, set_, boxes_.size(), answers(got), 1);
  }
  void set_ray(QueryType query_type, float height) {
    set_ = {};
    set_.query_type = query_type;
    set_.rays.push_back({.origin = {-1.0F, height, 0.5F}});
  }

  std::vector<Aabb> boxes_{{{0, 0, 0}, {1, 1, 1}}, {{2, 0, 0}, {3, 1, 1}}};
  ReferenceQueries judge_{boxes_};
  QuerySet set_;
};

TEST_F(Comparisons, missing_false_and_misplaced_hits_are_noticed) {
  set_ray(QueryType::all, 0.5F);
  EXPECT_TRUE(by_force({{0, 1.0F}, {1, 3.0F}}).agree());
  EXPECT_FALSE(by_force({{0, 1.0F}}).agree());
  EXPECT_FALSE(by_force({{1, 3.0F}, {0, 1.0F}}).agree());
  EXPECT_FALSE(by_force({{0, 1.0F}, {1, 3.1F}}).agree());
  EXPECT_FALSE(exactly({{0, 1.0F}, {1, 3.0F}}, {{0, 1.0F}}).agree());
  EXPECT_FALSE(exactly({{0, 1.0F}, {1, 3.0F}}, {{1, 3.0F}, {0, 1.0F}}).agree());
  EXPECT_FALSE(in_float({{0, 1.0F}, {1, 3.0F}}, {{0, 1.0F}}).agree());
  set_ray(QueryType::all, 2.0F);
  EXPECT_TRUE(by_force({}).agree());
  EXPECT_FALSE(by_force({{0, 1.0F}}).agree());
  EXPECT_FALSE(in_float({}, {{0, 1.0F}}).agree());
}

TEST_F(Comparisons, hit_that_is_not_the_closest_is_noticed) {
  set_ray(QueryType::closest, 0.5F);
  EXPECT_TRUE(by_force({{0, 1.0F}}).agree());
  EXPECT_FALSE(by_force({{1, 3.0F}}).agree());
  EXPECT_FALSE(by_force({}).agree());
  EXPECT_FALSE(exactly({{0, 1.0F}}, {{1, 3.0F}}).agree());
  EXPECT_FALSE(in_float({{0, 1.0F}}, {{1, 3.0F}}).agree());
  EXPECT_FALSE(in_float({{0, 1.0F}}, {}).agree());
}

TEST_F(Comparisons, rounding_is_allowed_to_float_engines_only) {
  set_ray(QueryType::closest, 0.5F);
  const float later = std::nextafter(1.0F, 2.0F);
  EXPECT_TRUE(in_float({{0, 1.0F}}, {{0, later}}).agree());
  EXPECT_FALSE(exactly({{0, 1.0F}}, {{0, later}}).agree());
  set_ray(QueryType::closest, 1.0F);  // along an edge: engines in float may miss it
  boxes_[0].max.y() = boxes_[1].max.y() = std::nextafter(1.0F, 2.0F);
  set_.rays[0].direction = {1.0F, 1e-9F, 0.0F};
  const Comparison grazing = in_float({{0, 1.0F}}, {});
  EXPECT_TRUE(grazing.agree());
  EXPECT_EQ(grazing.undecided, 1U);
}

TEST(RayRace, single_rays_and_batches_hit_the_same) {
  for (const char* const mesh : {"terrain", "soup"}) {
    SCOPED_TRACE(mesh);
    const RayMeasurement measured = measure_rays(
        {.mesh = mesh, .triangles = 800, .rays = 300, .rounds = 1, .machine_clock = false});
    ASSERT_FALSE(measured.timings.empty());
    const std::size_t hits = measured.timings.front().hits;
    EXPECT_GT(hits, 0U);
    for (const RayTiming& timing : measured.timings) {
      SCOPED_TRACE(timing.engine);
      if (timing.engine == "Embree fast") continue;  // this engine misses edges
      EXPECT_EQ(timing.hits, hits);
      EXPECT_EQ(timing.differ, 0U);
    }
  }
}

}  // namespace
}  // namespace winnow::bench
