// Scenes on virtual ranks have the same fingerprints, frame by frame, as one partition.

#include "bench/measure/cluster_run.h"

#include "bench/measure/race.h"
#include "bench/scenes/scene.h"

#include <gtest/gtest.h>
#include <winnow/pipeline/cluster_scene.h>
#include <winnow/pipeline/scene.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/random.h"

namespace winnow::bench {
namespace {

constexpr std::size_t kFrames = 5;

Run run_partition(const std::string& scene, std::size_t objects) {
  const auto source = make_scene(scene, objects, 1);
  std::vector<Contender> contenders = make_contenders({"LinearBvh"}, 1);
  return race(*source, contenders, {.frames = kFrames}).front();
}

ClusterRun run_on_ranks(const std::string& scene, std::size_t objects, std::uint32_t ranks,
                        std::optional<ContactLevel> level = {}) {
  const auto source = make_scene(scene, objects, 1);
  LoopbackTransport transport(ranks);
  return run_cluster(*source, transport, {kFrames, level}, Execution::serial());
}

/// Returns the digests of the contacts of one scene in every frame.
std::vector<ClusterDigest> digests_of_scene(const std::string& name, std::size_t objects,
                                            ContactLevel level) {
  const auto source = make_scene(name, objects, 1);
  ShapePool shapes;
  Scene scene(shapes);
  std::vector<Key> keys;
  Contacts contacts;
  std::vector<ClusterDigest> digests;
  do {
    const std::span<const Aabb> boxes = source->boxes();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Pose pose = middle_of(boxes[i]);
      if (i < keys.size()) {
        EXPECT_EQ(scene.move(keys[i], pose), Status::ok);
        continue;
      }
      const ShapeId shape = test::expect_ok(shapes.add(box_shape_of(boxes[i])));
      keys.push_back(test::expect_ok(scene.add({.shape = shape, .pose = pose, .data = i})));
    }
    EXPECT_EQ(scene.collide(level, contacts), Status::ok);
    digests.push_back(digest_of(contacts));
  } while (digests.size() < kFrames && source->advance());
  return digests;
}

TEST(ClusterRuns, ranks_have_the_fingerprints_of_a_partition) {
  const std::size_t objects = test::scaled(1500);
  for (const SceneInfo& scene : scene_infos()) {
    const std::string name(scene.name);
    const auto partition = run_partition(name, objects);
    for (const std::uint32_t ranks : {1U, 2U, 3U, 4U, 8U, 16U, 128U}) {
      const ClusterRun run = run_on_ranks(name, objects, ranks);
      ASSERT_EQ(run.pairs.size(), partition.pairs.size());
      for (std::size_t f = 0; f < run.pairs.size(); ++f) {
        EXPECT_TRUE(run.pairs[f].same_pairs(partition.pairs[f]))
            << name << ", " << ranks << " ranks, frame " << f;
      }
    }
  }
}

TEST(ClusterRuns, thousands_of_ranks_have_partition_fingerprints) {
  const auto partition = run_partition("mixed", 1000);
  const ClusterRun run = run_on_ranks("mixed", 1000, 4096);
  for (std::size_t f = 0; f < run.pairs.size(); ++f) {
    EXPECT_TRUE(run.pairs[f].same_pairs(partition.pairs[f])) << f;
  }
}

TEST(ClusterRuns, digest_does_not_depend_on_the_rank_count) {
  const ClusterRun one = run_on_ranks("clustered", 500, 1);
  const ClusterRun many = run_on_ranks("clustered", 500, 7);
  EXPECT_EQ(one.digests, many.digests);
}

TEST(ClusterRuns, bodies_on_ranks_have_the_scene_digests) {
  const std::size_t objects = test::scaled(400);
  for (const SceneInfo& info : scene_infos()) {
    const std::string name(info.name);
    const auto digests = digests_of_scene(name, objects, ContactLevel::manifold);
    for (const std::uint32_t ranks : {1U, 3U, 8U}) {
      const ClusterRun run = run_on_ranks(name, objects, ranks, ContactLevel::manifold);
      EXPECT_EQ(run.digests, digests) << name << ", " << ranks << " ranks";
    }
  }
}

}  // namespace
}  // namespace winnow::bench
