// ContinuousCollision and motion casts, compared with single-pair times of impact.

#include <gtest/gtest.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/impacts.h>
#include <winnow/pipeline/scene_queries.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory_resource>
#include <optional>
#include <vector>

#include "tests/pipeline/scene_world.h"
#include "tests/support/answers.h"
#include "tests/support/counting_memory.h"
#include "tests/support/meshes.h"

namespace winnow::test {
namespace {

/// A scene with some moving bodies, and the expected impact of each pair.
struct ImpactWorld {
  /// `spread` multiplies the distances between the bodies of a SceneWorld.
  explicit ImpactWorld(std::size_t count, const Execution& execution = Execution::serial(),
                       double spread = 1.0)
      : world(count, 91), composites(world.pool) {
    for (BodyDefinition& body : world.bodies) {
      for (double& x : body.pose.position) x *= spread;
    }
    const MeshData ring = torus(6, 5);
    mesh = expect_ok(composites.add_mesh(ring.points(), ring.indices()));
    for (std::size_t i = 0; i < count; i += 9) world.bodies[i].shape = mesh;
    for (std::size_t i = 0; i < count; i += 5) world.bodies[i].state = BodyState::fixed;
    for (std::size_t i = 3; i < count; i += 7) world.bodies[i].state = BodyState::sleeping;
    for (std::size_t i = 0; i < count; i += 11) world.bodies[i].filter.layers = 2;
    for (std::size_t i = 4; i < count; i += 13) world.bodies[i].filter.mask = ~2U;
    scene.emplace(world.pool, SceneOptions{.execution = execution, .composites = &composites});
    EXPECT_EQ(add_all(*scene, world), Status::ok);
    for (std::size_t i = 0; i < count; i += 2) {
      movers.push_back(i);
      keys.push_back(world.keys[i]);
      bullets.push_back(i % 3 == 0 ? 1 : 0);
      motions.push_back(RigidMotion::stationary(world.bodies[i].pose));
      const double way = world.random.log_uniform(0.05, 20.0);
      const double turn = world.random.chance(0.1) ? 60.0 : 3.0;
      for (double& x : motions.back().travel) x = world.random.uniform(-way, way);
      for (double& x : motions.back().turn) x = world.random.uniform(-turn, turn);
    }
    EXPECT_EQ(scene->set_ignored(world.keys[0], world.keys[2]), Status::ok);
  }

  [[nodiscard]] bool filters_allow(std::size_t a, std::size_t b, ContinuousPairs which) const {
    const auto is_bullet = [&](std::size_t i) { return i % 2 == 0 && bullets[i / 2] != 0; };
    const BodyDefinition& of_a = world.bodies[a];
    const BodyDefinition& of_b = world.bodies[b];
    const bool fixed = of_a.state == BodyState::fixed || of_b.state == BodyState::fixed;
    const bool bullet = is_bullet(a) || is_bullet(b);
    const bool is_selected = which == ContinuousPairs::all ||
                             (fixed && which == ContinuousPairs::fixed) ||
                             (bullet && which == ContinuousPairs::bullets) ||
                             ((fixed || bullet) && which == ContinuousPairs::bullets_and_fixed);
    return is_selected && (a % 2 == 0 || b % 2 == 0) && !(a == 0 && b == 2) &&
           (of_a.state == BodyState::dynamic || of_b.state == BodyState::dynamic) &&
           winnow::filters_allow(of_a.filter, of_b.filter);
  }
  /// Returns for each pair its time of impact, computed separately.
  [[nodiscard]] std::map<Names, double> truth(ContinuousPairs which) const {
    std::vector<ShapeId> shapes;
    std::vector<RigidMotion> all;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      shapes.push_back(world.bodies[i].shape);
      all.push_back(i % 2 == 0 ? motions[i / 2] : RigidMotion::stationary(world.bodies[i].pose));
    }
    std::vector<BodyPair> pairs;
    for (std::uint32_t a = 0; a < shapes.size(); ++a) {
      for (std::uint32_t b = a + 1; b < shapes.size(); ++b) {
        if (filters_allow(a, b, which)) pairs.push_back({a, b});
      }
    }
    ImpactResult result;
    EXPECT_EQ(time_of_impact(world.pool, {shapes, all}, pairs, {.composites = &composites}, result),
              Status::ok);
    std::map<Names, double> times;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (result.hits(i)) times[names(pairs[i].a, pairs[i].b)] = result.time()[i];
    }
    return times;
  }

  SceneWorld world;
  CompositePool composites;
  ShapeId mesh;
  std::optional<Scene> scene;
  /// Every second body.
  std::vector<std::size_t> movers;
  std::vector<Key> keys;
  std::vector<RigidMotion> motions;
  std::vector<std::uint8_t> bullets;
};

TEST(ContinuousCollisions, impacts_match_single_pairs) {
  ImpactWorld impact_world(scaled(160));
  ContinuousCollision ccd(*impact_world.scene);
  for (const ContinuousPairs which :
       {ContinuousPairs::all, ContinuousPairs::fixed, ContinuousPairs::bullets,
        ContinuousPairs::bullets_and_fixed}) {
    ASSERT_EQ(ccd.find_impacts(impact_world.keys, impact_world.motions,
                               {.pairs = which, .bullets = impact_world.bullets}),
              Status::ok);
    const std::map<Names, double> truth = impact_world.truth(which);
    EXPECT_EQ(ccd.impacts().size(), truth.size());
    std::map<std::size_t, double> earliest;
    double last = 0.0;
    for (const SceneImpact& impact : ccd.impacts()) {
      const auto found = truth.find(names(impact.data_a, impact.data_b));
      ASSERT_NE(found, truth.end());
      EXPECT_EQ(found->second, impact.time);
      EXPECT_LT(impact.a.id, impact.b.id);
      EXPECT_LE(last, impact.time);
      last = impact.time;
      for (const ClientData body : {impact.data_a, impact.data_b}) {
        earliest.emplace(static_cast<std::size_t>(body), impact.time);
      }
    }
    ASSERT_EQ(ccd.first().size(), impact_world.movers.size());
    for (std::size_t i = 0; i < impact_world.movers.size(); ++i) {
      const std::uint32_t first = ccd.first()[i];
      const auto known = earliest.find(impact_world.movers[i]);
      ASSERT_EQ(first == kNoImpact, known == earliest.end());
      if (first == kNoImpact) continue;
      EXPECT_EQ(ccd.impacts()[first].time, known->second);
    }
  }
}

void expect_same(const SceneImpact& a, const SceneImpact& b) {
  EXPECT_EQ(a.data_a, b.data_a);
  EXPECT_EQ(a.data_b, b.data_b);
  EXPECT_EQ(a.part_a, b.part_a);
  EXPECT_EQ(a.part_b, b.part_b);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.gap, b.gap);
  EXPECT_EQ(a.error_bound, b.error_bound);
  EXPECT_TRUE(std::ranges::equal(a.point, b.point));
  EXPECT_TRUE(std::ranges::equal(a.normal, b.normal));
}

TEST(ContinuousCollisions, first_only_matches_first_of_all) {
  ImpactWorld impact_world(400, Execution::serial(), 2.5);
  ContinuousCollision all(*impact_world.scene);
  ContinuousCollision firsts(*impact_world.scene);
  for (const double tolerance : {1e-6, 1e-2}) {
    ASSERT_EQ(all.find_impacts(impact_world.keys, impact_world.motions, {.tolerance = tolerance}),
              Status::ok);
    ASSERT_EQ(firsts.find_impacts(impact_world.keys, impact_world.motions,
                                  {.tolerance = tolerance, .first_only = true}),
              Status::ok);
    EXPECT_LE(firsts.impacts().size(), impact_world.movers.size());
    for (std::size_t i = 0; i < impact_world.movers.size(); ++i) {
      const std::uint32_t expected = all.first()[i];
      const std::uint32_t first = firsts.first()[i];
      ASSERT_EQ(first == kNoImpact, expected == kNoImpact);
      if (first != kNoImpact) expect_same(firsts.impacts()[first], all.impacts()[expected]);
    }
  }
}

/// Boxes in a cube that all move by nearly the same long vector.
struct Convoy {
  Convoy(std::size_t count, double way) {
    box = expect_ok(pool.add(BoxShape{{0.5, 0.5, 0.5}}));
    const double side = std::cbrt(2.0 * static_cast<double>(count));
    Random random(7);
    for (std::size_t i = 0; i < count; ++i) {
      const Pose start =
          Pose::at(random.uniform(0, side), random.uniform(0, side), random.uniform(0, side));
      keys.push_back(scene.add({.shape = box, .pose = start, .data = i}));
      motions.push_back(RigidMotion::stationary(start));
      for (double& x : motions.back().travel) x = way + random.uniform(-0.1, 0.1);
    }
  }

  ShapePool pool;
  ShapeId box;
  Scene scene{pool};
  std::vector<Key> keys;
  std::vector<RigidMotion> motions;
};

TEST(ContinuousCollisions, common_motion_adds_no_candidate_pairs) {
  Convoy still(scaled(400), 0.0);
  Convoy fast(scaled(400), 1000.0);
  ShapeId wall = expect_ok(fast.pool.add(BoxShape{{1e-3, 1e4, 1e4}}));
  ASSERT_NE(fast.scene.add({.shape = wall, .pose = Pose::at(500, 0, 0), .state = BodyState::fixed}),
            Key{});
  ContinuousCollision of_still(still.scene);
  ContinuousCollision of_fast(fast.scene);
  ASSERT_EQ(of_still.find_impacts(still.keys, still.motions), Status::ok);
  ASSERT_EQ(of_fast.find_impacts(fast.keys, fast.motions), Status::ok);
  const std::size_t count = fast.keys.size();
  EXPECT_LE(of_fast.statistics().body_pairs, 2 * of_still.statistics().body_pairs + count);
  // All boxes hit the wall. Impacts with each other do not change.
  EXPECT_EQ(of_fast.impacts().size(), of_still.impacts().size() + count);
}

TEST(ContinuousCollisions, impacts_match_on_any_thread_count) {
  ImpactWorld one(scaled(160));
  ImpactWorld many(scaled(160), Execution::parallel());
  for (const bool first_only : {false, true}) {
    ContinuousCollision serial(*one.scene);
    ContinuousCollision parallel(*many.scene);
    ASSERT_EQ(serial.find_impacts(one.keys, one.motions, {.first_only = first_only}), Status::ok);
    ASSERT_EQ(parallel.find_impacts(many.keys, many.motions, {.first_only = first_only}),
              Status::ok);
    ASSERT_EQ(serial.impacts().size(), parallel.impacts().size());
    EXPECT_TRUE(std::ranges::equal(serial.first(), parallel.first()));
    for (std::size_t i = 0; i < serial.impacts().size(); ++i) {
      expect_same(serial.impacts()[i], parallel.impacts()[i]);
    }
  }
}

/// A ball that rests on a floor and flies through a thin wall at x = 0.
struct Gallery {
  Gallery() {
    ball = expect_ok(pool.add(SphereShape{0.5}));
    wall = expect_ok(pool.add(BoxShape{{1e-3, 10, 10}}));
    floor = expect_ok(pool.add(HalfSpaceShape{{0, 0, 1}, 0}));
    keys[0] = expect_ok(scene.add({.shape = floor, .state = BodyState::fixed}));
    keys[1] = expect_ok(scene.add({.shape = wall, .state = BodyState::fixed}));
    keys[2] = expect_ok(scene.add({.shape = ball, .pose = Pose::at(-50, 0, 0.5), .data = 7}));
  }

  ShapePool pool;
  ShapeId ball, wall, floor;
  Scene scene{pool};
  Key keys[3];
};

TEST(ContinuousCollisions, initial_touches_can_be_ignored) {
  Gallery gallery;
  ContinuousCollision ccd(gallery.scene);
  const Pose end[1] = {Pose::at(50, 0, 0.5)};
  const std::span<const Key> moving(&gallery.keys[2], 1);
  ASSERT_EQ(ccd.find_impacts(moving, PoseView(end)), Status::ok);
  ASSERT_EQ(ccd.impacts().size(), 2U);
  EXPECT_EQ(ccd.impacts()[0].a, gallery.keys[0]);
  EXPECT_EQ(ccd.impacts()[0].time, 0.0);
  for (const bool first_only : {false, true}) {
    ASSERT_EQ(
        ccd.find_impacts(moving, PoseView(end), {.touching = false, .first_only = first_only}),
        Status::ok);
    ASSERT_EQ(ccd.impacts().size(), 1U);
    const SceneImpact& impact = ccd.impacts()[ccd.first()[0]];
    EXPECT_EQ(impact.a, gallery.keys[1]);
    EXPECT_EQ(impact.b, gallery.keys[2]);
    EXPECT_EQ(impact.data_b, 7U);
    EXPECT_NEAR(impact.time, 0.5 - 0.00501, 1e-6);
    EXPECT_NEAR(impact.normal[0], -1.0, 1e-9);
    EXPECT_NEAR(impact.point[0], -1e-3, 1e-9);
  }
}

TEST(ContinuousCollisions, bad_input_is_refused_and_keeps_impacts) {
  Gallery gallery;
  ContinuousCollision ccd(gallery.scene);
  const Key ball = gallery.keys[2];
  const auto status_of = [&](std::span<const Key> keys, std::span<const Pose> ends,
                             const ContinuousOptions& options = {}) {
    return ccd.find_impacts(keys, PoseView(ends), options);
  };
  const Pose good[2] = {Pose::at(50, 0, 0.5), Pose::at(1, 2, 3)};
  const std::span<const Key> moving(&ball, 1);
  const std::span<const Pose> end(good, 1);
  ASSERT_EQ(status_of(moving, end), Status::ok);
  const Key twice[2] = {ball, ball};
  EXPECT_EQ(status_of(twice, good), Status::invalid_key);
  EXPECT_EQ(status_of(moving, good), Status::size_mismatch);
  const Key none[1] = {Key{}};
  EXPECT_EQ(status_of(none, end), Status::invalid_key);
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kEndless, -kEndless}) {
    const Pose beyond[1] = {Pose::at(bad, 0, 0)};
    EXPECT_EQ(status_of(moving, beyond), Status::invalid_pose);
  }
  Pose unturned[1] = {Pose::at(1, 2, 3)};
  unturned[0].orientation[0] = 0.0;
  EXPECT_EQ(status_of(moving, unturned), Status::invalid_pose);
  for (const double tolerance : {0.0, -1.0, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(status_of(moving, end, {.tolerance = tolerance}), Status::invalid_argument);
  }
  const std::uint8_t bullets[2] = {1, 1};
  EXPECT_EQ(status_of(moving, end, {.bullets = bullets}), Status::size_mismatch);
  EXPECT_EQ(status_of(moving, end, {.pairs = static_cast<ContinuousPairs>(9)}),
            Status::invalid_argument);
  EXPECT_EQ(ccd.impacts().size(), 2U);
  EXPECT_EQ(status_of({}, {}), Status::ok);
  EXPECT_EQ(ccd.impacts().size(), 0U);
  // A motion near the end of the range of double that passes through the wall.
  const Pose far[1] = {Pose::at(1e300, 0, 0.5)};
  EXPECT_EQ(status_of(moving, far, {.touching = false}), Status::ok);
  EXPECT_EQ(ccd.impacts().size(), 1U);
}

TEST(MotionCasts, hits_match_single_pairs) {
  ImpactWorld impact_world(scaled(160));
  SceneQueries queries(*impact_world.scene);
  const SceneWorld& world = impact_world.world;
  ASSERT_EQ(impact_world.scene->refresh(), Status::ok);
  for (std::size_t i = 0; i < impact_world.movers.size(); ++i) {
    const ShapeId shape = world.bodies[impact_world.movers[i]].shape;
    if (!shape.is_composite() && shape.kind() == ShapeKind::half_space) continue;
    std::vector<ShapeId> shapes{shape};
    std::vector<RigidMotion> motions{impact_world.motions[i]};
    std::vector<BodyPair> pairs;
    for (const BodyDefinition& body : world.bodies) {
      pairs.push_back({0, static_cast<std::uint32_t>(shapes.size())});
      shapes.push_back(body.shape);
      motions.push_back(RigidMotion::stationary(body.pose));
    }
    ImpactResult truth;
    ASSERT_EQ(time_of_impact(world.pool, {shapes, motions}, pairs,
                             {.composites = &impact_world.composites}, truth),
              Status::ok);
    std::span<const SceneHit> hits;
    const MotionCast cast{shape, impact_world.motions[i]};
    hits = expect_ok(queries.all(cast));
    EXPECT_EQ(hits.size(), static_cast<std::size_t>(std::ranges::count(truth.hit(), 1)));
    double last = 0.0;
    for (const SceneHit& hit : hits) {
      const auto body = static_cast<std::size_t>(hit.data);
      EXPECT_TRUE(truth.hits(body));
      EXPECT_NEAR(hit.t, truth.time()[body], 1e-5);
      EXPECT_LE(last, hit.t);
      last = hit.t;
    }
    SceneHit closest = expect_ok(queries.closest(cast));
    EXPECT_EQ(static_cast<bool>(closest), !hits.empty());
  }
}

TEST(MotionCasts, closest_hit_matches_first_of_all) {
  ImpactWorld impact_world(400, Execution::serial(), 2.5);
  SceneQueries queries(*impact_world.scene);
  ASSERT_EQ(impact_world.scene->refresh(), Status::ok);
  for (const RigidMotion& motion : impact_world.motions) {
    const MotionCast cast{impact_world.mesh, motion};
    std::span<const SceneHit> hits = expect_ok(queries.all(cast));
    const SceneHit first = hits.empty() ? SceneHit{} : hits[0];
    SceneHit closest = expect_ok(queries.closest(cast));
    EXPECT_EQ(closest.key, first.key);
    EXPECT_EQ(closest.part, first.part);
    EXPECT_EQ(closest.t, first.t);
    EXPECT_TRUE(std::ranges::equal(closest.normal, first.normal));
    EXPECT_TRUE(std::ranges::equal(closest.point, first.point));
  }
}

TEST(MotionCasts, rotation_hits_and_bad_motion_is_refused) {
  Gallery gallery;
  SceneQueries queries(gallery.scene);
  ASSERT_EQ(gallery.scene.refresh(), Status::ok);
  ShapeId rod = expect_ok(gallery.pool.add(CapsuleShape{0.1, 3.9}));
  // The rod stands upright beside the wall. A quarter turn about y drops it onto the wall.
  MotionCast cast{rod, {Pose::at(2, 0, 5), {0, 0, 0}, {0, -std::acos(0.0), 0}}};
  SceneHit hit = expect_ok(queries.closest(cast));
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit.key, gallery.keys[1]);
  const double angle = std::asin((2 - 1e-3 - 0.1) / 3.9);
  EXPECT_NEAR(hit.t, angle / std::acos(0.0), 1e-6);
  EXPECT_LE(hit.t, angle / std::acos(0.0));
  EXPECT_NEAR(hit.normal[0], 1.0, 1e-9);
  EXPECT_NEAR(hit.point[0], 1e-3, 1e-6);
  expect_error(queries.closest(cast, {}, 0.0), Status::invalid_argument);
  cast.motion.travel[1] = std::numeric_limits<double>::quiet_NaN();
  expect_error(queries.closest(cast), Status::invalid_pose);
  cast.shape = gallery.floor;
  expect_error(queries.closest(cast), Status::unsupported);
  cast.shape = ShapeId::of(CompositeKind::mesh, 0);
  expect_error(queries.closest(cast), Status::invalid_key);
}

TEST(ContinuousCollisions, repeated_call_allocates_nothing_and_refusals_recover) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  ImpactWorld impact_world(60);
  CountingMemory memory;
  {
    ContinuousCollision ccd(*impact_world.scene, &memory);
    for (int frame = 0; frame < 3; ++frame) {
      ASSERT_EQ(ccd.find_impacts(impact_world.keys, impact_world.motions), Status::ok);
    }
    EXPECT_EQ(ccd.footprint().total().reserved, memory.outstanding());
    const std::size_t before = memory.requests();
    ASSERT_EQ(ccd.find_impacts(impact_world.keys, impact_world.motions), Status::ok);
    EXPECT_EQ(memory.requests(), before);
  }
  EXPECT_EQ(memory.outstanding(), 0U);
  // A call whose memory request is refused has no impacts, and the next call is complete.
  ContinuousCollision whole(*impact_world.scene);
  ASSERT_EQ(whole.find_impacts(impact_world.keys, impact_world.motions), Status::ok);
  for (std::size_t granted = 1;; ++granted) {
    ContinuousCollision ccd(*impact_world.scene, &memory);
    memory.refuse_after(granted);
    const Status status = ccd.find_impacts(impact_world.keys, impact_world.motions);
    memory.grant_all();
    if (status == Status::ok) break;
    ASSERT_EQ(status, Status::out_of_memory);
    EXPECT_EQ(ccd.impacts().size(), 0U);
    ASSERT_EQ(ccd.find_impacts(impact_world.keys, impact_world.motions), Status::ok);
    EXPECT_EQ(ccd.impacts().size(), whole.impacts().size());
  }
  ContinuousCollision without(*impact_world.scene, std::pmr::null_memory_resource());
  EXPECT_EQ(without.find_impacts(impact_world.keys, impact_world.motions), Status::out_of_memory);
  EXPECT_EQ(without.impacts().size(), 0U);
}

}  // namespace
}  // namespace winnow::test
