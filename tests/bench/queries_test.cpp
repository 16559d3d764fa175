// Query engines return equal answers, and a difference is noticed.

#include "bench/contenders/partition_queries.h"
#include "bench/contenders/partitions.h"
#include "bench/measure/reference_queries.h"
#include "bench/peers/peers.h"
#include "bench/scenes/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

namespace winnow::bench {
namespace {

class Engines : public testing::TestWithParam<const char*> {};

TEST_P(Engines, every_engine_has_the_same_answers) {
  constexpr std::size_t kJudged = 200;
  const auto source = make_scene(GetParam(), 300, 5);
  const ReferenceQueries judge(source->boxes());
  for (const int threads : {1, 2}) {
    std::vector<std::unique_ptr<QueryEngine>> engines = make_query_peers();
    const std::size_t peers = engines.size();
    for (const std::string& name : all_partitions()) {
      engines.push_back(std::make_unique<PartitionQueries>(name, threads));
    }
    for (const auto& engine : engines) engine->start(source->boxes());
    for (const QuerySet& set : make_query_sets(source->boxes(), 200, 9)) {
      const QueryResults expected = engines.back()->answers(set, QueryMode::single, set.size());
      EXPECT_TRUE(compare_by_force(judge, set, source->boxes().size(), expected, kJudged).agree());
      for (std::size_t i = 0; i < engines.size(); ++i) {
        for (const QueryMode mode : {QueryMode::single, QueryMode::batch}) {
          if (!engines[i]->takes(set, mode)) continue;
          const QueryResults got = engines[i]->answers(set, mode, set.size());
          const Comparison found = i < peers ? compare_in_float(judge, set, expected, got)
                                             : compare_exactly(judge, set, expected, got);
          EXPECT_TRUE(found.agree()) << engines[i]->name() << ": " << set.name << found.first;
          std::size_t hits = 0;
          for (std::size_t q = 0; q < got.questions(); ++q) hits += got.of(q).size();
          EXPECT_EQ(engines[i]->run(set, mode, set.size()), hits) << engines[i]->name();
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Engines, testing::Values("uniform", "mixed", "pile"));

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

}  // namespace
}  // namespace winnow::bench
