// A cluster in one process: pairs compared with brute force for many numbers of ranks, and refused
// input.

#include <gtest/gtest.h>
#include <winnow/pipeline/cluster.h>

#include <cmath>
#include <limits>
#include <set>
#include <unordered_map>

#include "pipeline/cluster/name_table.h"
#include "pipeline/cluster/regions.h"
#include "tests/pipeline/cluster_world.h"
#include "tests/support/answers.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace winnow::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

/// Adds a batch on one rank and empty batches on the others.
Status add_on(Cluster& cluster, std::uint32_t rank, std::span<const BodyName> names,
              std::span<const Aabb> boxes) {
  std::vector<ClusterBatch> batches(cluster.hosted());
  std::vector<Status> answers(cluster.hosted());
  batches[rank] = {names, boxes};
  EXPECT_EQ(cluster.add(batches, answers), Status::ok);
  return answers[rank];
}

void run_frames(const std::vector<Aabb>& boxes, std::uint32_t ranks, double step) {
  Random random(ranks);
  ClusterWorld world(ranks);
  world.add(boxes, random);
  world.check();
  for (int frame = 0; frame < 5; ++frame) {
    world.move(frame == 2 ? 1.0 : 0.3, step, random);
    world.remove(3, random);
    if (frame % 2 == 1) {
      world.add(uniform_boxes(9, static_cast<std::uint64_t>(frame)), random);
      world.move(0.2, step, random);
      world.remove(9, random);
      world.add(uniform_boxes(3, static_cast<std::uint64_t>(frame)), random);
    }
    world.check();
  }
}

TEST(Cluster, exchange_calls_meanwhile_callback) {
  LoopbackTransport transport(3);
  const std::uint64_t number = 7;
  const RankMessage sent[] = {{2, 0, {std::as_bytes(std::span(&number, 1))}}};
  std::span<const RankMessage> received;
  int calls = 0;
  const OverlappedWork meanwhile{[](void* context) noexcept { ++*static_cast<int*>(context); },
                                 &calls};
  ASSERT_EQ(transport.exchange(sent, received, meanwhile), Status::ok);
  EXPECT_EQ(calls, 1);
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].from, 2U);
  ASSERT_EQ(transport.exchange({}, received, {}), Status::ok);
  EXPECT_EQ(received.size(), 0U);
}

TEST(ClusterPairs, pairs_match_brute_force_for_any_rank_count) {
  const std::size_t n = scaled(200);
  const std::vector<Aabb> scenes[] = {uniform_boxes(n), clustered_boxes(n), mixed_boxes(n),
                                      wall_boxes(n, 0), pile_boxes(n),      two_scale_boxes(n),
                                      outlier_boxes(n), rod_boxes(n)};
  for (const std::vector<Aabb>& boxes : scenes) {
    for (const std::uint32_t ranks : {1U, 2U, 3U, 4U, 8U, 16U}) run_frames(boxes, ranks, 1.0);
  }
}

TEST(ClusterPairs, thousands_of_ranks_match_brute_force) {
  for (const std::uint32_t ranks : {64U, 512U, 4096U}) run_frames(uniform_boxes(200), ranks, 0.5);
}

TEST(ClusterPairs, infinite_and_equal_boxes_match_brute_force) {
  std::vector<Aabb> boxes = uniform_boxes(60);
  for (int axis = 0; axis < 3; ++axis) {
    Aabb slab = boxes[static_cast<std::size_t>(axis)];
    slab.min[axis] = -kInf;
    boxes.push_back(slab);
    slab.max[axis] = kInf;
    boxes.push_back(slab);
  }
  boxes.push_back({Vec3f::constant(-kInf), Vec3f::constant(kInf)});
  for (int i = 0; i < 30; ++i) boxes.push_back({Vec3f(1, 1, 1), Vec3f(1, 1, 1)});
  for (const std::uint32_t ranks : {1U, 2U, 5U, 32U}) run_frames(boxes, ranks, 1.0);
}

TEST(ClusterPairs, gathering_and_scattering_boxes_match_brute_force) {
  Random random(7);
  ClusterWorld world(9);
  world.add(uniform_boxes(150), random);
  for (const double step : {20.0, 0.1, 50.0}) {
    world.move(1.0, step, random);
    world.check();
  }
  EXPECT_GT(world.cluster().statistics().migrated, 0U);
  world.remove(150, random);
  world.check();
  world.add(uniform_boxes(20), random);
  world.check();
}

TEST(ClusterMessages, resting_boxes_send_no_messages) {
  Random random(3);
  ClusterWorld world(8);
  std::vector<Aabb> boxes = uniform_boxes(400);
  boxes.push_back(
      {Vec3f(-100, -100, 0), Vec3f(100, 100, 1)});  // overlaps the regions of many ranks
  world.add(boxes, random);
  std::uint64_t cuts = 0;
  do {
    cuts = world.cluster().statistics().cuts;
    world.check();
  } while (world.cluster().statistics().cuts != cuts);
  EXPECT_GT(world.cluster().statistics().ghosts, 7U);
  EXPECT_EQ(world.cluster().statistics().bytes, 0U);
  EXPECT_EQ(world.cluster().statistics().messages, 0U);
}

TEST(ClusterMessages, few_moved_boxes_send_few_bytes) {
  Random random(4);
  ClusterWorld world(8, {.imbalance = 1e9});
  world.add(uniform_boxes(1000), random);
  world.check();
  const std::uint64_t first = world.cluster().statistics().bytes;
  world.move(0.02, 0.01, random);
  world.check();
  EXPECT_LT(world.cluster().statistics().bytes * 10, first);
}

TEST(ClusterCuts, cuts_balance_counted_work) {
  Random random(5);
  for (const auto& boxes : {uniform_boxes(3000), clustered_boxes(3000)}) {
    ClusterWorld world(4);
    world.add(boxes, random);
    for (int frame = 0; frame < 10; ++frame) {
      ASSERT_EQ(world.cluster().self_pairs(), Status::ok);
    }
    EXPECT_LE(world.cluster().statistics().imbalance, 1.15);
  }
}

TEST(ClusterInput, bad_input_fails_only_on_its_rank) {
  Random random(6);
  ClusterWorld world(3);
  world.add(uniform_boxes(50), random);
  world.check();
  Cluster& cluster = world.cluster();
  const Aabb good{Vec3f(0, 0, 0), Vec3f(9, 9, 9)};
  const Aabb bad{Vec3f(NAN, 0, 0), Vec3f(1, 1, 1)};
  const BodyName there = world.boxes().begin()->first;
  const std::uint32_t owner = world.rank_of(there);
  const BodyName fresh[] = {1, 2};
  const BodyName twice[] = {1, 1};
  const BodyName taken[] = {1, there};
  const Aabb boxes[] = {good, good};
  const Aabb spoilt[] = {good, bad};
  for (std::uint32_t rank = 0; rank < 3; ++rank) {
    EXPECT_EQ(add_on(cluster, rank, fresh, spoilt), Status::invalid_bounds);
    EXPECT_EQ(add_on(cluster, rank, fresh, std::span(boxes, 1)), Status::size_mismatch);
    EXPECT_EQ(add_on(cluster, rank, twice, boxes), Status::invalid_key);
    EXPECT_EQ(add_on(cluster, rank, taken, boxes), Status::invalid_key);
    EXPECT_EQ(cluster.move(rank, std::span<const BodyName>(fresh), std::span(boxes)),
              Status::invalid_key);
    EXPECT_EQ(cluster.remove(rank, fresh), Status::invalid_key);
    if (rank == owner) continue;
    EXPECT_EQ(cluster.remove(rank, std::span(&there, 1)), Status::invalid_key);
    const Key foreign = world.key_of(there);
    EXPECT_EQ(cluster.move(rank, std::span(&foreign, 1), std::span(&good, 1)), Status::invalid_key);
  }
  EXPECT_EQ(cluster.move(owner, std::span(&there, 1), std::span(&bad, 1)), Status::invalid_bounds);
  const BodyName same[] = {there, there};
  EXPECT_EQ(cluster.move(owner, std::span<const BodyName>(same), std::span(boxes)),
            Status::invalid_key);
  EXPECT_EQ(cluster.remove(owner, same), Status::invalid_key);
  EXPECT_EQ(cluster.move(3, std::span(&there, 1), std::span(&good, 1)), Status::invalid_argument);
  Status answer{};
  EXPECT_EQ(cluster.add({}, std::span(&answer, 1)), Status::size_mismatch);
  world.check();
}

TEST(ClusterInput, keys_wrapping_past_greatest_id_are_refused) {
  LoopbackTransport transport(2);
  Cluster cluster(transport);
  const BodyName names[] = {1, 2, 3};
  const std::vector<Aabb> boxes(4, Aabb{Vec3f(0, 0, 0), Vec3f(1, 1, 1)});
  ASSERT_EQ(add_on(cluster, 0, names, std::span(boxes).first(3)), Status::ok);
  std::vector<Key> keys(4);  // a null key, then the keys with ids 0, 1 and 2
  for (std::size_t i = 0; i < 3; ++i) {
    keys[1 + i] = expect_ok(cluster.key_of(0, names[i]));
    ASSERT_EQ(keys[1 + i].id, i);
  }
  EXPECT_EQ(cluster.move(0, std::span<const Key>(keys), BoxView(boxes)), Status::invalid_key);
}

TEST(ClusterInput, equal_names_on_two_ranks_fail_on_both) {
  LoopbackTransport transport(3);
  Cluster cluster(transport);
  const BodyName names[] = {1, 2, 3};
  const Aabb box{Vec3f(0, 0, 0), Vec3f(1, 1, 1)};
  const Aabb boxes[] = {box, box, box};
  const std::span all(boxes);
  const ClusterBatch batches[] = {{std::span(names).first(2), all.first(2)},
                                  {std::span(names).subspan(1, 1), all.first(1)},
                                  {std::span(names).subspan(2), all.first(1)}};
  Status answers[3];
  ASSERT_EQ(cluster.add(batches, answers), Status::ok);
  EXPECT_EQ(answers[0], Status::invalid_key);
  EXPECT_EQ(answers[1], Status::invalid_key);
  EXPECT_EQ(answers[2], Status::ok);
  EXPECT_EQ(add_on(cluster, 1, std::span(names).first(2), all.first(2)), Status::ok);
  ASSERT_EQ(cluster.self_pairs(), Status::ok);
  EXPECT_EQ(cluster.statistics().pairs, 3U);
}

TEST(ClusterPairs, reading_pairs_returns_names) {
  LoopbackTransport transport(1);
  Cluster cluster(transport);
  const BodyName names[] = {9, 4, 7};
  const Aabb box{Vec3f(0, 0, 0), Vec3f(1, 1, 1)};
  const Aabb boxes[] = {box, box, box};
  EXPECT_TRUE(cluster.pairs(0).empty());
  ASSERT_EQ(add_on(cluster, 0, names, boxes), Status::ok);
  for (const Order order : {Order::fast, Order::canonical}) {
    ASSERT_EQ(cluster.self_pairs(order), Status::ok);
    const NamePairs pairs = cluster.pairs(0);
    std::vector<NamePair> read(pairs.begin(), pairs.end());
    ASSERT_EQ(pairs.size(), read.size());
    for (std::size_t i = 0; i < read.size(); ++i) EXPECT_EQ(pairs[i], read[i]);
    if (order == Order::fast) std::sort(read.begin(), read.end());
    EXPECT_EQ(read, (std::vector<NamePair>{{4, 7}, {4, 9}, {7, 9}}));
  }
  const BodyName fresh = 5;
  ASSERT_EQ(add_on(cluster, 0, std::span(&fresh, 1), std::span(&box, 1)), Status::ok);
  EXPECT_TRUE(cluster.pairs(0).empty());
}

TEST(ClusterPairs, adding_bodies_clears_pairs_on_all_ranks) {
  for (const std::uint32_t ranks : {1U, 4U}) {
    Random random(10);
    ClusterWorld world(ranks);
    world.add(uniform_boxes(200), random);
    world.check();
    Cluster& cluster = world.cluster();
    const BodyName fresh = 1;
    const Aabb box{Vec3f(0, 0, 0), Vec3f(1, 1, 1)};
    ASSERT_EQ(add_on(cluster, 0, std::span(&fresh, 1), std::span(&box, 1)), Status::ok);
    for (std::uint32_t rank = 0; rank < ranks; ++rank) EXPECT_TRUE(cluster.pairs(rank).empty());
    ClusterDigest digest = expect_ok(cluster.digest());
    EXPECT_EQ(digest, ClusterDigest{});
  }
}

TEST(ClusterInput, name_removed_elsewhere_can_be_used_again) {
  Random random(8);
  ClusterWorld world(4);
  world.add(uniform_boxes(40), random);
  world.check();
  const auto [name, box] = *world.boxes().begin();
  const std::uint32_t owner = world.rank_of(name);
  Cluster& cluster = world.cluster();
  ASSERT_EQ(cluster.remove(owner, std::span(&name, 1)), Status::ok);
  EXPECT_EQ(cluster.remove(owner, std::span(&name, 1)), Status::invalid_key);
  EXPECT_EQ(add_on(cluster, (owner + 1) % 4, std::span(&name, 1), std::span(&box, 1)), Status::ok);
  ASSERT_EQ(cluster.self_pairs(Order::canonical), Status::ok);
  EXPECT_EQ(world.found_pairs(), world.true_pairs());
}

TEST(ClusterBodies, bodies_of_three_ranks_continue_on_five) {
  Random random(9);
  ClusterWorld world(3);
  world.add(mixed_boxes(150), random);
  world.move(1.0, 1.0, random);
  world.check();
  LoopbackTransport transport(5);
  Cluster restored(transport);
  for (std::uint32_t rank = 0; rank < 3; ++rank) {
    std::vector<ClusterBody> bodies(world.cluster().size(rank));
    std::vector<Aabb> boxes(bodies.size());
    ASSERT_EQ(world.cluster().bodies(rank, bodies, boxes), Status::ok);
    std::vector<BodyName> names;
    for (const ClusterBody& body : bodies) names.push_back(body.name);
    EXPECT_EQ(add_on(restored, rank + 1, names, boxes), Status::ok);
  }
  ASSERT_EQ(restored.self_pairs(), Status::ok);
  ClusterDigest digest = expect_ok(restored.digest());
  EXPECT_EQ(digest, digest_of(world.true_pairs()));
}

TEST(ClusterFaults, transport_failure_fails_every_later_call) {
  const std::vector<Aabb> boxes = uniform_boxes(30);
  std::vector<BodyName> names(boxes.size());
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = i;
  int fine = 0;
  for (int calls = 0; calls < 12; ++calls) {
    FailingTransport transport(3, calls);
    Cluster cluster(transport);
    std::vector<ClusterBatch> batches(3);
    batches[1] = {names, boxes};
    Status answers[3];
    Status status = cluster.add(batches, answers);
    if (status == Status::ok) status = cluster.self_pairs();
    ClusterDigest digest;
    if (status == Status::ok) status = cluster.digest().get(digest);
    if (status == Status::ok) {
      ++fine;
      continue;
    }
    EXPECT_EQ(status, Status::communication_failed);
    EXPECT_EQ(cluster.self_pairs(), Status::communication_failed);
    EXPECT_EQ(cluster.status(), Status::communication_failed);
    EXPECT_EQ(cluster.remove(1, std::span(names).first(1)), Status::communication_failed);
  }
  EXPECT_GT(fine, 0);
}

TEST(ClusterRegions, box_overlaps_regions_of_its_points) {
  Random random(10);
  const auto number = [&] {
    return random.chance(0.5) ? static_cast<float>(random.below(5))
                              : static_cast<float>(random.uniform(-1, 6));
  };
  for (int round = 0; round < 200; ++round) {
    LoopbackTransport transport(1 + static_cast<std::uint32_t>(random.below(12)));
    std::vector<Aabb> boxes(random.below(40));
    for (Aabb& box : boxes) {
      box.min = Vec3f(number(), number(), number());
      box.max = box.min.max(Vec3f(number(), number(), number()));
    }
    const std::vector<std::uint32_t> works(boxes.size(), 1);
    std::vector<SplitPlane> cuts(transport.ranks() - 1);
    const CutWork work{boxes, works};
    ASSERT_EQ(transport.cut(std::span(&work, 1), cuts), Status::ok);
    const Regions regions(cuts);
    for (const Aabb& box : boxes) {
      std::vector<std::uint32_t> ranks;
      regions.ranks_of(box, ranks);
      const std::set<std::uint32_t> overlapping(ranks.begin(), ranks.end());
      ASSERT_EQ(overlapping.size(), ranks.size());
      for (std::uint32_t rank = 0; rank < transport.ranks(); ++rank) {
        ASSERT_EQ(overlapping.contains(rank), regions.of(rank).overlaps(box));
      }
      for (const Vec3f& point : {box.min, box.max, centre_of(box)}) {
        const Aabb at{point, point};
        for (std::uint32_t rank = 0; rank < transport.ranks(); ++rank) {
          ASSERT_EQ(regions.owner(point) == rank, regions.of(rank).overlaps(at));
        }
      }
    }
  }
}

TEST(ClusterNames, name_table_matches_map) {
  Random random(11);
  NameTable table(std::pmr::get_default_resource());
  std::unordered_map<std::uint64_t, std::uint32_t> reference;
  for (int step = 0; step < 20'000; ++step) {
    const std::uint64_t name = random.below(300);
    if (random.chance(0.5)) {
      const auto number = static_cast<std::uint32_t>(random.below(1000));
      table.set(name, number);
      reference[name] = number;
    } else {
      table.erase(name);
      reference.erase(name);
    }
    const std::uint64_t queried = random.below(300);
    const auto found = reference.find(queried);
    ASSERT_EQ(table.find(queried), found == reference.end() ? NameTable::kNone : found->second);
    ASSERT_EQ(table.size(), reference.size());
  }
}

}  // namespace
}  // namespace winnow::test
