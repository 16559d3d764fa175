// Tests of `winnow advise`: the ranking, the reason for each rank, and the code for the winner.

#include "bench/measure/advice.h"
#include <winnow/partitions/structures.h>
#include "bench/scenes/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

const std::vector<std::string> kThree{"BoundsNSquared", "AutoPartition", "LinearBvh"};

TEST(Advice, ranking_lists_every_partition_with_a_reason) {
  const auto source = make_scene("sleepy", 400, 3);
  const Advice advice = advise(*source, kThree, 12, 1);
  EXPECT_TRUE(advice.same_pairs);
  EXPECT_EQ(advice.frames, 12U);
  EXPECT_EQ(advice.objects, 400U);
  EXPECT_NEAR(advice.moving, 0.05, 0.01);
  EXPECT_GT(advice.pairs, 0.0);
  ASSERT_EQ(advice.ranking.size(), kThree.size());
  EXPECT_TRUE(std::ranges::is_sorted(advice.ranking, {}, &Advised::median_ms));
  for (const Advised& one : advice.ranking) {
    EXPECT_FALSE(one.why.empty()) << one.partition;
    EXPECT_GT(one.bytes, 0U) << one.partition;
    EXPECT_GT(one.median_ms, 0.0) << one.partition;
    EXPECT_DOUBLE_EQ(one.times_best, one.median_ms / advice.best().median_ms);
  }
}

TEST(Advice, best_partition_is_never_the_automatic_one) {
  const auto source = make_scene("uniform", 300, 3);
  const Advice advice = advise(*source, kThree, 4, 1);
  EXPECT_NE(advice.best().partition, "AutoPartition");
  const bool is_tree = advice.best().partition == "LinearBvh";
  EXPECT_NE(advice.code().find(is_tree ? "winnow::linear_bvh()" : "winnow::bounds_n_squared()"),
            std::string::npos);
  EXPECT_FALSE(structure_named(advice.best().partition).name().empty());
  EXPECT_FALSE(structure_named(advice.chosen).name().empty());
  EXPECT_FALSE(advice.reason.empty());
}

TEST(Advice, advice_on_a_single_partition_is_refused) {
  const auto source = make_scene("uniform", 30, 3);
  EXPECT_THROW((void)advise(*source, {"AutoPartition"}, 3, 1), std::invalid_argument);
}

TEST(Advice, advice_ends_with_the_frames_of_the_source) {
  const auto source = make_scene("uniform", 30, 3);
  EXPECT_EQ(advise(*source, kThree, 1, 1).frames, 1U);
}

}  // namespace
}  // namespace winnow::bench
