// Scenes on virtual ranks: the fingerprints that a partition has, frame by frame.

#include "bench/measure/cluster_run.h"

#include "bench/measure/race.h"
#include "bench/scenes/scene.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/random.h"

namespace winnow::bench {
namespace {

constexpr std::size_t kFrames = 5;

Run run_partition(const std::string& scene, std::size_t objects) {
  const auto source = make_scene(scene, objects, 1);
  std::vector<Contender> contenders = make_contenders({"LinearBvh"}, 1);
  return race(*source, contenders, {.frames = kFrames}).front();
}

ClusterRun run_ranks(const std::string& scene, std::size_t objects, std::uint32_t ranks) {
  const auto source = make_scene(scene, objects, 1);
  LoopbackTransport transport(ranks);
  return run_cluster(*source, transport, kFrames, Execution::serial());
}

TEST(ClusterRuns, have_the_fingerprints_of_a_partition) {
  const std::size_t objects = test::scaled(1500);
  for (const SceneInfo& scene : scene_infos()) {
    const std::string name(scene.name);
    const auto partition = run_partition(name, objects);
    for (const std::uint32_t ranks : {1U, 2U, 3U, 4U, 8U, 16U, 128U}) {
      const ClusterRun run = run_ranks(name, objects, ranks);
      ASSERT_EQ(run.frames.size(), partition.pairs.size());
      for (std::size_t f = 0; f < run.frames.size(); ++f) {
        EXPECT_TRUE(run.frames[f].pairs.same_pairs(partition.pairs[f]))
            << name << ", " << ranks << " ranks, frame " << f;
      }
    }
  }
}

TEST(ClusterRuns, have_the_fingerprints_of_a_partition_on_thousands_of_ranks) {
  const auto partition = run_partition("mixed", 1000);
  const ClusterRun run = run_ranks("mixed", 1000, 4096);
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    EXPECT_TRUE(run.frames[f].pairs.same_pairs(partition.pairs[f])) << f;
  }
}

TEST(ClusterRuns, have_the_same_digest_on_any_number_of_ranks) {
  const ClusterRun one = run_ranks("clustered", 500, 1);
  const ClusterRun many = run_ranks("clustered", 500, 7);
  for (std::size_t f = 0; f < one.frames.size(); ++f) {
    EXPECT_EQ(one.frames[f].digest, many.frames[f].digest);
  }
}

}  // namespace
}  // namespace winnow::bench
