// Scenes distributed over many ranks of one process: the contacts equal the contacts of one scene
// bit for bit, and bad input is refused.

#include <gtest/gtest.h>
#include <winnow/pipeline/cluster_scene.h>
#include <winnow/pipeline/recording.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/pipeline/cluster_scene_world.h"
#include "tests/support/answers.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

void run_scene_frames(const WorldShapes& shapes, std::uint32_t ranks, ContactLevel level,
                      const ClusterSceneOptions& options = {}) {
  Random random(ranks);
  ClusterSceneWorld world(shapes, ranks, options);
  world.add_ground();
  world.add(scaled(150), 7.0, random);
  world.check(level);
  for (int frame = 0; frame < 4; ++frame) {
    world.move(frame == 2 ? 1.0 : 0.3, frame == 1 ? 3.0 : 0.1, random);
    world.remove(3, random);
    if (frame % 2 == 1) {
      world.move_ground(random);
      world.add(9, 7.0, random);
      world.remove(2, random);
    }
    world.check(level);
  }
}

TEST(ClusterContacts, contacts_match_one_scene_for_any_rank_count) {
  const WorldShapes shapes;
  for (const std::uint32_t ranks : {1U, 2U, 3U, 5U, 8U, 16U}) {
    for (const ContactLevel level : {ContactLevel::pairs, ContactLevel::boolean,
                                     ContactLevel::distance, ContactLevel::manifold}) {
      run_scene_frames(shapes, ranks, level);
    }
  }
}

TEST(ClusterContacts, margin_and_reduction_match_one_scene) {
  const WorldShapes shapes;
  for (const std::uint32_t ranks : {2U, 7U}) {
    run_scene_frames(shapes, ranks, ContactLevel::manifold, {.scene = {.contact_margin = 0.3}});
  }
}

TEST(ClusterContacts, thousands_of_ranks_match_one_scene) {
  const WorldShapes shapes;
  for (const std::uint32_t ranks : {64U, 512U, 4096U}) {
    Random random(ranks);
    ClusterSceneWorld world(shapes, ranks);
    if (ranks < 4096) world.add_ground();
    world.add(60, 5.0, random);
    world.check(ContactLevel::manifold);
    world.move(0.5, 0.3, random);
    world.check(ContactLevel::manifold);
  }
}

TEST(ClusterContacts, digest_matches_one_scene) {
  const WorldShapes shapes;
  ClusterDigest first;
  for (const std::uint32_t ranks : {1U, 4U, 9U}) {
    Random random(1);
    ClusterSceneWorld world(shapes, 1);
    world.add(scaled(120), 6.0, random);
    world.restart(ranks);
    world.check(ContactLevel::manifold);
    ClusterDigest digest = expect_ok(world.cluster().digest());
    if (ranks == 1) {
      first = digest;
      EXPECT_EQ(digest, digest_of(world.cluster().contacts(0)));
    }
    EXPECT_EQ(digest, first);
    world.move(1.0, 1e-6, random);
    world.check(ContactLevel::manifold);
    digest = expect_ok(world.cluster().digest());
    EXPECT_NE(digest, first);
  }
}

TEST(ClusterContacts, gathering_and_scattering_bodies_match_one_scene) {
  const WorldShapes shapes;
  Random random(7);
  ClusterSceneWorld world(shapes, 9);
  world.add(100, 6.0, random);
  for (const double step : {8.0, 0.1, 20.0}) {
    world.move(1.0, step, random);
    world.check(ContactLevel::distance);
  }
  EXPECT_GT(world.cluster().statistics().migrated, 0U);
  world.remove(100, random);
  world.check(ContactLevel::distance);
  world.add(20, 3.0, random);
  world.check(ContactLevel::distance);
}

TEST(ClusterContacts, extreme_positions_match_one_scene) {
  const WorldShapes shapes;
  for (const std::uint32_t ranks : {1U, 2U, 6U}) {
    Random random(8);
    ClusterSceneWorld world(shapes, ranks);
    world.add_ground();
    world.add(40, 4.0, random);
    for (const double far : {1e7, -1e18, 1e38, 1e300}) {
      world.add_at(Pose::at(far, 0, 1), random);
      world.add_at(Pose::at(far, 0, 1), random);
      world.add_at(Pose::at(0, -far, far), random);
    }
    world.check(ContactLevel::boolean);
    world.move(1.0, 1.0, random);
    world.check(ContactLevel::boolean);
  }
}

TEST(ClusterContacts, composites_edited_in_place_match_one_scene) {
  WorldShapes shapes;
  Random random(9);
  ClusterSceneWorld world(shapes, 5);
  world.add_ground();
  world.add(60, 6.0, random);
  world.check(ContactLevel::distance);
  for (const float height : {0.3F, 2.0F}) {
    const std::vector<float> heights(64, height);
    ASSERT_EQ(shapes.composites.update_height_field(shapes.ground[2], 0, 0, {heights, 8, 8}),
              Status::ok);
    world.check(ContactLevel::distance);
  }
}

TEST(ClusterContacts, resting_bodies_send_no_bytes) {
  const WorldShapes shapes;
  Random random(3);
  ClusterSceneWorld world(shapes, 8);
  world.add_ground();
  world.add(scaled(300), 8.0, random);
  std::uint64_t cuts = 0;
  do {
    cuts = world.cluster().statistics().cuts;
    world.check(ContactLevel::boolean);
  } while (world.cluster().statistics().cuts != cuts);
  EXPECT_GT(world.cluster().statistics().ghosts, 7U);
  EXPECT_EQ(world.cluster().statistics().bytes, 0U);
}

TEST(ClusterCheckpoints, restore_with_other_rank_count_continues) {
  const WorldShapes shapes;
  Random random(11);
  ClusterSceneWorld world(shapes, 3);
  world.add_ground();
  world.add(scaled(150), 6.0, random);
  for (const std::uint32_t ranks : {5U, 2U, 1U, 4U}) {
    world.check(ContactLevel::manifold);
    world.move(0.3, 0.2, random);
    if (ranks == 2) world.add(5, 6.0, random);
    if (ranks == 1) world.remove(5, random);
    world.restart(ranks);
    world.check(ContactLevel::manifold);
  }
}

TEST(ClusterCheckpoints, restore_of_damaged_bytes_changes_nothing) {
  const WorldShapes shapes;
  Random random(12);
  ClusterSceneWorld world(shapes, 2);
  world.add(30, 4.0, random);
  world.check(ContactLevel::boolean);
  const std::vector<std::vector<std::byte>> kept = world.saved();
  ClusterScene& cluster = world.cluster();
  Status answers[2];
  const auto answer_to = [&](std::span<const std::byte> bytes) {
    const std::span<const std::byte> given[] = {bytes, {}};
    EXPECT_EQ(cluster.restore(given, answers), Status::ok);
    EXPECT_EQ(answers[1], Status::ok);
    return answers[0];
  };
  // An undamaged checkpoint whose names already exist.
  EXPECT_EQ(answer_to(kept[0]), Status::invalid_key);
  EXPECT_EQ(answer_to(kept[1]), Status::invalid_key);
  for (std::size_t size = 1; size < kept[0].size(); size += 1 + size / 5) {
    EXPECT_EQ(answer_to(std::span(kept[0]).first(size)), Status::invalid_argument);
  }
  std::vector<std::byte> spoilt = kept[0];
  for (int i = 0; i < 200; ++i) {
    std::byte& byte = spoilt[random.below(spoilt.size())];
    const std::byte before = byte;
    byte ^= static_cast<std::byte>(1U << random.below(8));
    EXPECT_EQ(answer_to(spoilt), Status::invalid_argument);
    byte = before;
  }
  spoilt.push_back(std::byte{});
  EXPECT_EQ(answer_to(spoilt), Status::invalid_argument);
  EXPECT_EQ(cluster.restore({}, std::span(answers)), Status::size_mismatch);
  world.check(ContactLevel::boolean);
}

/// Adds a batch on one rank and empty batches on the others.
Status add_bodies_on(ClusterScene& cluster, std::uint32_t rank, std::span<const BodyName> names,
                     std::span<const BodyDefinition> bodies) {
  std::vector<ClusterSceneBatch> batches(cluster.hosted());
  std::vector<Status> answers(cluster.hosted());
  batches[rank] = {names, bodies};
  EXPECT_EQ(cluster.add(batches, answers), Status::ok);
  return answers[rank];
}

TEST(ClusterSceneInput, bad_input_fails_only_on_its_rank) {
  const WorldShapes shapes;
  Random random(6);
  ClusterSceneWorld world(shapes, 3);
  world.add_ground();
  world.add(50, 5.0, random);
  world.check(ContactLevel::manifold);
  ClusterScene& cluster = world.cluster();
  const BodyDefinition good{.shape = shapes.movable[0], .pose = Pose::at(1, 1, 1)};
  const BodyDefinition bad_pose{.shape = shapes.movable[0], .pose = Pose::at(NAN, 1, 1)};
  const BodyDefinition bad_shape{};
  const BodyDefinition asleep{.shape = shapes.movable[0], .state = BodyState::sleeping};
  const BodyName there = world.bodies().begin()->first;
  const std::uint32_t owner = world.rank_of(there);
  const BodyName fresh[] = {1, 2};
  const BodyName twice[] = {1, 1};
  const BodyName taken[] = {1, there};
  const BodyName replicated[] = {1, 0};
  const auto answer = [&](std::uint32_t rank, std::span<const BodyName> names,
                          const BodyDefinition& second) {
    const BodyDefinition bodies[] = {good, second};
    return add_bodies_on(cluster, rank, names, bodies);
  };
  for (std::uint32_t rank = 0; rank < 3; ++rank) {
    EXPECT_EQ(answer(rank, fresh, bad_pose), Status::invalid_pose);
    EXPECT_EQ(answer(rank, fresh, bad_shape), Status::invalid_key);
    EXPECT_EQ(answer(rank, fresh, asleep), Status::unsupported);
    EXPECT_EQ(answer(rank, std::span(fresh).first(1), good), Status::size_mismatch);
    EXPECT_EQ(answer(rank, twice, good), Status::invalid_key);
    EXPECT_EQ(answer(rank, taken, good), Status::invalid_key);
    EXPECT_EQ(answer(rank, replicated, good), Status::invalid_key);
    const Pose poses[] = {good.pose, good.pose};
    EXPECT_EQ(cluster.move(rank, std::span<const BodyName>(fresh), poses), Status::invalid_key);
    EXPECT_EQ(cluster.move(rank, std::span<const BodyName>(replicated).last(1),
                           std::span(poses).first(1)),
              Status::invalid_key);
    EXPECT_EQ(cluster.remove(rank, fresh), Status::invalid_key);
    if (rank == owner) continue;
    EXPECT_EQ(cluster.remove(rank, std::span(&there, 1)), Status::invalid_key);
    Key foreign = expect_ok(cluster.key_of(owner, there));
    EXPECT_EQ(cluster.move(rank, std::span(&foreign, 1), std::span(poses).first(1)),
              Status::invalid_key);
  }
  EXPECT_EQ(cluster.move(owner, std::span(&there, 1), std::span(&bad_pose.pose, 1)),
            Status::invalid_pose);
  EXPECT_EQ(cluster.move(3, std::span(&there, 1), std::span(&good.pose, 1)),
            Status::invalid_argument);
  EXPECT_EQ(cluster.replicate({std::span(&there, 1), std::span(&good, 1)}), Status::invalid_key);
  EXPECT_EQ(cluster.replicate({std::span(fresh).first(1), std::span(&good, 1)}),
            Status::unsupported);
  EXPECT_EQ(cluster.move_replicated(std::span(&there, 1), std::span(&good.pose, 1)),
            Status::invalid_key);
  EXPECT_EQ(cluster.collide(static_cast<ContactLevel>(9)), Status::invalid_argument);
  world.check(ContactLevel::manifold);
}

TEST(ClusterSceneInput, removed_name_can_be_used_again) {
  const WorldShapes shapes;
  LoopbackTransport transport(4);
  ClusterScene cluster(transport, shapes.shapes);
  const BodyName names[] = {7, 8};
  const BodyDefinition body{.shape = shapes.movable[0]};
  const BodyDefinition bodies[] = {body, body};
  ASSERT_EQ(add_bodies_on(cluster, 0, names, bodies), Status::ok);
  ASSERT_EQ(cluster.collide(ContactLevel::boolean), Status::ok);
  std::uint32_t owner = 0;
  while (cluster.size(owner) == 0) ++owner;
  ASSERT_EQ(cluster.remove(owner, std::span(names).first(1)), Status::ok);
  ASSERT_EQ(add_bodies_on(cluster, 3, std::span(names).first(1), std::span(bodies).first(1)),
            Status::ok);
  ASSERT_EQ(cluster.collide(ContactLevel::boolean), Status::ok);
  // One pair ended with the removed body, and a new pair began.
  std::size_t begun = 0;
  std::size_t ended = 0;
  for (std::uint32_t rank = 0; rank < 4; ++rank) {
    for (const ContactEvent event : cluster.contacts(rank).event()) {
      begun += event == ContactEvent::begun ? 1 : 0;
    }
    ended += cluster.contacts(rank).ended().size();
  }
  EXPECT_EQ(begun, 1U);
  EXPECT_EQ(ended, 1U);
}

TEST(ClusterSceneInput, options_out_of_range_fail_every_call) {
  const WorldShapes shapes;
  LoopbackTransport transport(2);
  Recorder recorder(RecordingSink{});
  for (const ClusterSceneOptions& options :
       {ClusterSceneOptions{.scene = {.contact_margin = -1.0}},
        ClusterSceneOptions{.imbalance = 0.5},
        ClusterSceneOptions{.scene = {.cache_tolerance = 1.0}},
        ClusterSceneOptions{.scene = {.warm_start = true}},
        ClusterSceneOptions{.scene = {.recorder = &recorder}}}) {
    ClusterScene cluster(transport, shapes.shapes, options);
    EXPECT_EQ(cluster.status(), Status::invalid_argument);
    EXPECT_EQ(cluster.collide(ContactLevel::pairs), Status::invalid_argument);
  }
}

}  // namespace
}  // namespace winnow::test
