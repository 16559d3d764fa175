// Query engines return equal answers, and a difference is noticed.

#include "bench/contenders/partition_queries.h"
#include "bench/contenders/partitions.h"
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
  const auto source = make_scene(GetParam(), 300, 5);
  for (const int threads : {1, 2}) {
    PartitionQueries reference("BoundsNSquared", threads);
    reference.start(source->boxes());
    std::vector<std::unique_ptr<QueryEngine>> engines = make_peers<QueryEngine>();
    const std::size_t peers = engines.size();
    for (const std::string& name : all_partitions()) {
      engines.push_back(std::make_unique<PartitionQueries>(name, threads));
    }
    for (const auto& engine : engines) engine->start(source->boxes());
    for (const QuerySet& set : make_query_sets(source->boxes(), 200, 9)) {
      const QueryResults expected = reference.answers(set, QueryMode::single, set.size());
      for (std::size_t i = 0; i < engines.size(); ++i) {
        for (const QueryMode mode : {QueryMode::single, QueryMode::batch}) {
          if (!engines[i]->takes(set, mode)) continue;
          const QueryResults got = engines[i]->answers(set, mode, set.size());
          // A library in float may miss an object that a query only touches.
          const std::size_t differing =
              count_differing(set.query_type, expected, got, i < peers ? 1e-6F : 0.0F);
          EXPECT_LE(differing, i < peers ? set.size() / 50 : 0) << engines[i]->name() << set.name;
          std::size_t hits = 0;
          for (std::size_t q = 0; q < got.questions(); ++q) hits += got.of(q).size();
          EXPECT_EQ(engines[i]->run(set, mode, set.size()), hits) << engines[i]->name();
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Engines, testing::Values("uniform", "mixed", "pile"));

QueryResults found(std::initializer_list<Found> objects) {
  QueryResults result;
  for (const Found& one : objects) result.add(one);
  result.next();
  return result;
}

TEST(Differences, missing_false_and_misplaced_hits_are_noticed) {
  const QueryResults both = found({{0, 1.0F}, {1, 3.0F}});
  const QueryResults turned = found({{1, 3.0F}, {0, 1.0F}});
  for (const float rounding : {0.0F, 1e-6F}) {
    EXPECT_EQ(count_differing(QueryType::all, both, both, rounding), 0U);
    EXPECT_EQ(count_differing(QueryType::all, both, found({{0, 1.0F}}), rounding), 1U);
    EXPECT_EQ(count_differing(QueryType::all, found({{0, 1.0F}}), both, rounding), 1U);
    EXPECT_EQ(count_differing(QueryType::all, both, found({{0, 1.0F}, {1, 3.1F}}), rounding), 1U);
    EXPECT_EQ(count_differing(QueryType::closest, both, turned, rounding), 1U);
    EXPECT_EQ(count_differing(QueryType::any, both, found({}), rounding), 1U);
    EXPECT_EQ(count_differing(QueryType::overlap, both, turned, rounding), 0U);
  }
  EXPECT_EQ(count_differing(QueryType::all, both, turned), 1U);
}

TEST(Differences, rounding_is_allowed_to_float_engines_only) {
  const QueryResults hit = found({{0, 1.0F}});
  const QueryResults later = found({{0, std::nextafter(1.0F, 2.0F)}});
  EXPECT_EQ(count_differing(QueryType::closest, hit, later, 1e-6F), 0U);
  EXPECT_EQ(count_differing(QueryType::closest, hit, later), 1U);
}

}  // namespace
}  // namespace winnow::bench
