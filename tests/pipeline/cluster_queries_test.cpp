// Collective queries of all ranks, which must give the answers of one scene bit for bit.

#include <gtest/gtest.h>
#include <winnow/pipeline/cluster_scene.h>
#include <winnow/pipeline/scene_queries.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "pipeline/cluster/regions.h"
#include "tests/pipeline/cluster_scene_world.h"
#include "tests/pipeline/cluster_world.h"
#include "tests/support/answers.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

/// An answer as numbers: names, parts, and the bits of all other values.
using FlatAnswer = std::vector<std::uint64_t>;

void add_bits(FlatAnswer& flat, std::initializer_list<double> values) {
  for (const double value : values) flat.push_back(std::bit_cast<std::uint64_t>(value));
}
void add_bits(FlatAnswer& flat, const Vec3d& vector) {
  add_bits(flat, {vector[0], vector[1], vector[2]});
}

FlatAnswer flat_hit(BodyName name, std::uint32_t part, double t, const Vec3d& normal,
                    const Vec3d& point) {
  FlatAnswer flat{name, part};
  add_bits(flat, {t});
  add_bits(flat, normal);
  add_bits(flat, point);
  return flat;
}
FlatAnswer flat_of(const ClusterHit& hit) {
  return flat_hit(hit.name, hit.part, hit.t, hit.normal, hit.point);
}
FlatAnswer flat_of(const SceneHit& hit) {
  return flat_hit(hit.data, hit.part, hit.t, hit.normal, hit.point);
}
FlatAnswer flat_of(const ClusterOverlap& body) {
  return {body.name, body.part};
}
FlatAnswer flat_of(const SceneOverlap& body) {
  return {body.data, body.part};
}
FlatAnswer flat_of(const ClusterDistance& body) {
  FlatAnswer flat = flat_hit(body.name, body.part, body.distance, body.normal, body.point);
  add_bits(flat, {body.error_bound});
  return flat;
}
FlatAnswer flat_of(const SceneDistance& body) {
  FlatAnswer flat = flat_hit(body.data, body.part, body.distance, body.normal, body.point_b);
  add_bits(flat, {body.error_bound});
  return flat;
}

/// Compares the answers of a cluster's rank with the answers of one scene.
template <typename Answer>
void expect_answers(const ClusterResults<Answer>& found, std::size_t query,
                    const std::vector<FlatAnswer>& expected) {
  ASSERT_GT(found.first.size(), query + 1);
  std::vector<FlatAnswer> flat;
  for (std::size_t i = found.first[query]; i < found.first[query + 1]; ++i) {
    flat.push_back(flat_of(found.answers[i]));
  }
  EXPECT_EQ(flat, expected) << "query " << query;
}

template <typename Answer>
std::vector<FlatAnswer> flat_of_all(std::span<const Answer> answers) {
  std::vector<FlatAnswer> flat;
  for (const Answer& answer : answers) flat.push_back(flat_of(answer));
  return flat;
}

ShapeRay random_ray(double size, Random& random) {
  ShapeRay ray;
  for (int axis = 0; axis < 3; ++axis) {
    ray.origin[axis] = random.uniform(-1, size);
    ray.direction[axis] = random.chance(0.3) ? 0.0 : random.uniform(-1, 1);
  }
  if (ray.direction[0] == 0.0 && ray.direction[1] == 0.0) ray.direction[2] = 1.0;
  ray.max_t = random.chance(0.5) ? std::numeric_limits<double>::infinity() : size;
  return ray;
}

/// Distributes new queries over the ranks. Some ranks may have none.
template <typename Query, typename Make>
std::vector<std::vector<Query>> queries_of(std::uint32_t ranks, Random& random, Make&& make) {
  std::vector<std::vector<Query>> all(ranks);
  for (std::size_t i = 0; i < scaled(60); ++i) all[random.below(ranks)].push_back(make());
  return all;
}

template <typename Query>
std::vector<ClusterQueryBatch<Query>> batches_of(const std::vector<std::vector<Query>>& all) {
  std::vector<ClusterQueryBatch<Query>> batches;
  for (const auto& queries : all) {
    batches.push_back({queries, {}});
    if (batches.size() % 2 == 0) batches.back().filter = {.layers = 1, .mask = 2};
  }
  return batches;
}

class ClusterQueryWorld {
 public:
  explicit ClusterQueryWorld(std::uint32_t ranks) : ranks_(ranks), world_(shapes_, ranks) {
    Random random(ranks);
    world_.add_ground();
    world_.add(scaled(120), kSize, random);
    world_.check(ContactLevel::boolean);
    world_.move(0.5, 1.0, random);  // after collide: queries use the current poses
    scene_ = world_.one_scene();
    EXPECT_EQ(scene_->refresh(), Status::ok);
  }

  static constexpr double kSize = 7.0;
  std::uint32_t ranks_;
  WorldShapes shapes_;
  ClusterSceneWorld world_;
  std::unique_ptr<Scene> scene_;
};

TEST(ClusterRays, hits_match_one_scene) {
  for (const std::uint32_t ranks : {1U, 2U, 5U, 16U}) {
    ClusterQueryWorld world(ranks);
    Random random(20 + ranks);
    const auto rays = queries_of<ShapeRay>(
        ranks, random, [&] { return random_ray(ClusterQueryWorld::kSize, random); });
    const auto batches = batches_of(rays);
    std::vector<Status> answers(ranks, Status::unsupported);
    ClusterQueries queries(world.world_.cluster());
    SceneQueries one(*world.scene_);
    ASSERT_EQ(queries.closest(batches, answers), Status::ok);
    world.world_.follow();
    for (std::uint32_t rank = 0; rank < ranks; ++rank) {
      EXPECT_EQ(answers[rank], Status::ok);
      for (std::size_t i = 0; i < rays[rank].size(); ++i) {
        SceneHit hit = expect_ok(one.closest(rays[rank][i], batches[rank].filter));
        const std::span<const SceneHit> hits(&hit, hit ? 1 : 0);
        expect_answers(queries.hits(rank), i, flat_of_all(hits));
      }
    }
    ASSERT_EQ(queries.all(batches, answers), Status::ok);
    ASSERT_EQ(queries.any(batches, answers), Status::ok);
    for (std::uint32_t rank = 0; rank < ranks; ++rank) {
      for (std::size_t i = 0; i < rays[rank].size(); ++i) {
        std::span<const SceneHit> hits = expect_ok(one.all(rays[rank][i], batches[rank].filter));
        expect_answers(queries.hits(rank), i, flat_of_all(hits));
        EXPECT_EQ(queries.blocked(rank)[i] != 0, !hits.empty());
      }
    }
    world.world_.check(ContactLevel::boolean);
  }
}

TEST(ClusterRays, tied_hits_return_least_name) {
  const WorldShapes shapes;
  LoopbackTransport transport(4);
  ClusterScene cluster(transport, shapes.shapes);
  const BodyName names[] = {9, 3, 7};
  std::vector<BodyDefinition> bodies;
  for (int i = 0; i < 3; ++i) {
    bodies.push_back({.shape = shapes.movable[3], .pose = Pose::at(5, 0.3 * i, 0)});
  }
  std::vector<ClusterSceneBatch> batches(4);
  batches[0] = {names, bodies};
  std::vector<Status> answers(4);
  ASSERT_EQ(cluster.add(batches, answers), Status::ok);
  ClusterQueries queries(cluster);
  const ShapeRay ray{.origin = {0, 0.3, 0}, .direction = {1, 0, 0}, .max_t = 10};
  std::vector<ClusterQueryBatch<ShapeRay>> rays(4);
  rays[2].queries = std::span(&ray, 1);
  ASSERT_EQ(queries.closest(rays, answers), Status::ok);
  ASSERT_EQ(queries.hits(2).answers.size(), 1U);
  EXPECT_EQ(queries.hits(2).answers[0].name, 3U);
  const NearestProbe probe{.point = {0, 0.3, 0}, .count = 2};
  std::vector<ClusterQueryBatch<NearestProbe>> probes(4);
  probes[1].queries = std::span(&probe, 1);
  ASSERT_EQ(queries.nearest(probes, answers), Status::ok);
  ASSERT_EQ(queries.neighbours(1).answers.size(), 2U);
  EXPECT_EQ(queries.neighbours(1).answers[0].name, 3U);
  EXPECT_EQ(queries.neighbours(1).answers[1].name, 7U);
}

TEST(ClusterOverlaps, overlaps_match_one_scene) {
  for (const std::uint32_t ranks : {1U, 3U, 16U}) {
    ClusterQueryWorld world(ranks);
    Random random(30 + ranks);
    const auto probes = queries_of<ShapeProbe>(ranks, random, [&] {
      const auto& from = random.chance(0.1) ? world.shapes_.ground : world.shapes_.movable;
      Pose pose;
      for (double& x : pose.position) x = random.uniform(0, ClusterQueryWorld::kSize);
      return ShapeProbe{from[random.below(from.size())], pose};
    });
    const auto batches = batches_of(probes);
    std::vector<Status> answers(ranks, Status::unsupported);
    ClusterQueries queries(world.world_.cluster());
    SceneQueries one(*world.scene_);
    ASSERT_EQ(queries.overlap(batches, answers), Status::ok);
    for (std::uint32_t rank = 0; rank < ranks; ++rank) {
      EXPECT_EQ(answers[rank], Status::ok);
      for (std::size_t i = 0; i < probes[rank].size(); ++i) {
        std::span<const SceneOverlap> bodies = expect_ok(
            one.overlap(probes[rank][i].shape, probes[rank][i].pose, batches[rank].filter));
        expect_answers(queries.overlaps(rank), i, flat_of_all(bodies));
      }
    }
  }
}

TEST(ClusterNeighbours, neighbours_match_one_scene) {
  for (const std::uint32_t ranks : {1U, 3U, 16U}) {
    ClusterQueryWorld world(ranks);
    Random random(40 + ranks);
    const auto probes = queries_of<NearestProbe>(ranks, random, [&] {
      NearestProbe probe{.count = random.below(6)};
      for (double& x : probe.point) x = random.uniform(-2, ClusterQueryWorld::kSize);
      if (random.chance(0.5)) probe.radius = random.uniform(0, 2);
      return probe;
    });
    const auto batches = batches_of(probes);
    std::vector<Status> answers(ranks, Status::unsupported);
    ClusterQueries queries(world.world_.cluster());
    SceneQueries one(*world.scene_);
    ASSERT_EQ(queries.nearest(batches, answers), Status::ok);
    for (std::uint32_t rank = 0; rank < ranks; ++rank) {
      EXPECT_EQ(answers[rank], Status::ok);
      for (std::size_t i = 0; i < probes[rank].size(); ++i) {
        const NearestProbe& probe = probes[rank][i];
        std::span<const SceneDistance> bodies =
            expect_ok(one.nearest(probe.point, probe.count, probe.radius, batches[rank].filter));
        expect_answers(queries.neighbours(rank), i, flat_of_all(bodies));
      }
    }
  }
}

TEST(ClusterQueryBatch, bad_queries_fail_only_on_their_rank) {
  ClusterQueryWorld world(3);
  ClusterQueries queries(world.world_.cluster());
  const ShapeRay bad{.direction = {0, 0, 0}};
  const ShapeRay good{.origin = {3, 3, 9}, .direction = {0, 0, -1}, .max_t = 20};
  std::vector<ClusterQueryBatch<ShapeRay>> rays(3);
  rays[0].queries = std::span(&bad, 1);
  rays[1].queries = rays[2].queries = std::span(&good, 1);
  rays[2].filter.predicate.accept = [](void*, Key, ClientData) { return true; };
  Status answers[3];
  ASSERT_EQ(queries.closest(rays, answers), Status::ok);
  world.world_.follow();
  EXPECT_EQ(answers[0], Status::invalid_argument);
  EXPECT_EQ(answers[1], Status::ok);
  EXPECT_EQ(answers[2], Status::unsupported);
  EXPECT_TRUE(queries.hits(0).answers.empty());
  EXPECT_EQ(queries.hits(1).answers.size(), 1U);
  EXPECT_EQ(queries.closest({}, std::span(answers)), Status::size_mismatch);
  const ShapeProbe no_shape{};
  const ShapeProbe no_pose{world.shapes_.movable[0], Pose::at(NAN, 0, 0)};
  std::vector<ClusterQueryBatch<ShapeProbe>> probes(3);
  probes[0].queries = std::span(&no_shape, 1);
  probes[1].queries = std::span(&no_pose, 1);
  ASSERT_EQ(queries.overlap(probes, answers), Status::ok);
  EXPECT_EQ(answers[0], Status::invalid_key);
  EXPECT_EQ(answers[1], Status::invalid_pose);
  const NearestProbe behind{.radius = -1.0};
  std::vector<ClusterQueryBatch<NearestProbe>> points(3);
  points[1].queries = std::span(&behind, 1);
  ASSERT_EQ(queries.nearest(points, answers), Status::ok);
  EXPECT_EQ(answers[1], Status::invalid_argument);
  world.world_.check(ContactLevel::boolean);
}

TEST(ClusterSceneFaults, transport_failure_fails_every_later_call) {
  const WorldShapes shapes;
  Random random(60);
  std::vector<BodyName> names;
  std::vector<BodyDefinition> bodies;
  for (BodyName name = 0; name < 30; ++name) {
    names.push_back(name);
    bodies.push_back({.shape = shapes.movable[name % 7],
                      .pose = Pose::at(random.uniform(0, 3), random.uniform(0, 3), 0)});
  }
  const BodyName ground_name = 99;
  const BodyDefinition ground{.shape = shapes.ground[0], .state = BodyState::fixed};
  const ShapeRay ray{};
  int fine = 0;
  for (int calls = 0; calls < 30; ++calls) {
    FailingTransport transport(3, calls);
    ClusterScene cluster(transport, shapes.shapes);
    ClusterQueries queries(cluster);
    std::vector<ClusterSceneBatch> batches(3);
    batches[1] = {names, bodies};
    std::vector<ClusterQueryBatch<ShapeRay>> rays(3);
    rays[2].queries = std::span(&ray, 1);
    Status answers[3];
    ClusterDigest digest;
    const std::span<const std::byte> nothing[3];
    Status status = cluster.replicate({std::span(&ground_name, 1), std::span(&ground, 1)});
    if (status == Status::ok) status = cluster.add(batches, answers);
    if (status == Status::ok) status = cluster.collide(ContactLevel::manifold);
    if (status == Status::ok) status = cluster.digest().get(digest);
    if (status == Status::ok) status = queries.closest(rays, answers);
    if (status == Status::ok) status = cluster.restore(nothing, answers);
    if (status == Status::ok) {
      ++fine;
      continue;
    }
    EXPECT_EQ(status, Status::communication_failed);
    EXPECT_EQ(cluster.collide(ContactLevel::manifold), Status::communication_failed);
    EXPECT_EQ(queries.any(rays, answers), Status::communication_failed);
    EXPECT_EQ(cluster.move(1, names, std::vector<Pose>(30)), Status::communication_failed);
    EXPECT_EQ(cluster.status(), Status::communication_failed);
  }
  EXPECT_GT(fine, 0);
  EXPECT_LT(fine, 30);
}

TEST(ClusterRegions, ray_reaches_regions_of_its_points) {
  Random random(50);
  for (int round = 0; round < 20; ++round) {
    std::vector<SplitPlane> cuts;
    for (std::int32_t i = 0; i < 15; ++i) {
      // A complete binary tree: cut i has the children 2i + 1 and 2i + 2, and the leaves are ranks.
      const auto side = [](std::int32_t k) { return k < 15 ? k : ~(k - 15); };
      cuts.push_back({static_cast<float>(random.uniform(-3, 3)),
                      static_cast<std::uint32_t>(random.below(3)),
                      {side(2 * i + 1), side(2 * i + 2)}});
    }
    const Regions regions(cuts);
    for (int k = 0; k < 50; ++k) {
      ShapeRay ray = random_ray(4.0, random);
      std::vector<std::uint32_t> ranks;
      regions.ranks_of(ray, ranks);
      for (int p = 0; p < 50; ++p) {
        const double t = random.uniform(0, std::min(ray.max_t, 20.0));
        const Vec3f point(static_cast<float>(ray.origin[0] + t * ray.direction[0]),
                          static_cast<float>(ray.origin[1] + t * ray.direction[1]),
                          static_cast<float>(ray.origin[2] + t * ray.direction[2]));
        // Skip points within float precision of a cut: either owner is correct.
        const std::uint32_t owner = regions.owner(point);
        const Aabb& region = regions.of(owner);
        const Vec3f inner = (point - region.min).min(region.max - point);
        if (std::min({inner.x(), inner.y(), inner.z()}) < 1e-4F) continue;
        EXPECT_TRUE(std::binary_search(ranks.begin(), ranks.end(), owner));
      }
    }
  }
}

}  // namespace
}  // namespace winnow::test
