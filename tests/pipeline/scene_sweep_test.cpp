// SceneSweep and motion casts, compared with single-pair times of impact.

#include <gtest/gtest.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/scene_sweep.h>
#include <winnow/pipeline/time_of_impact.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory_resource>
#include <optional>
#include <vector>

#include "tests/pipeline/scene_world.h"
#include "tests/support/counting_memory.h"
#include "tests/support/meshes.h"

namespace winnow::test {
namespace {

/// A scene with some moving bodies, and the expected impact of each pair.
struct SweptWorld {
  /// `spread` multiplies the distances between the bodies of a SceneWorld.
  explicit SweptWorld(std::size_t count, const Execution& execution = Execution::serial(),
                      double spread = 1.0)
      : world(count, 91), composites(world.pool) {
    for (BodyDefinition& body : world.bodies) {
      for (double& x : body.pose.position) x *= spread;
    }
    const MeshData ring = torus(6, 5);
    EXPECT_EQ(composites.add_mesh(ring.points(), ring.indices(), mesh), Status::ok);
    for (std::size_t i = 0; i < count; i += 9) world.bodies[i].shape = mesh;
    for (std::size_t i = 0; i < count; i += 5) world.bodies[i].motion = Motion::fixed;
    for (std::size_t i = 3; i < count; i += 7) world.bodies[i].motion = Motion::sleeping;
    for (std::size_t i = 0; i < count; i += 11) world.bodies[i].filter.layers = 2;
    for (std::size_t i = 4; i < count; i += 13) world.bodies[i].filter.mask = ~2U;
    scene.emplace(world.pool, SceneOptions{.execution = execution, .composites = &composites});
    EXPECT_EQ(add_all(*scene, world), Status::ok);
    for (std::size_t i = 0; i < count; i += 2) {
      movers.push_back(i);
      keys.push_back(world.keys[i]);
      bullets.push_back(i % 3 == 0 ? 1 : 0);
      motions.push_back(RigidMotion::standing(world.bodies[i].pose));
      const double way = world.random.log_uniform(0.05, 20.0);
      const double turn = world.random.chance(0.1) ? 60.0 : 3.0;
      for (double& x : motions.back().travel) x = world.random.uniform(-way, way);
      for (double& x : motions.back().turn) x = world.random.uniform(-turn, turn);
    }
    EXPECT_EQ(scene->set_ignored(world.keys[0], world.keys[2]), Status::ok);
  }

  [[nodiscard]] bool filters_allow(std::size_t a, std::size_t b, SweepPairs which) const {
    const auto is_bullet = [&](std::size_t i) { return i % 2 == 0 && bullets[i / 2] != 0; };
    const BodyDefinition& of_a = world.bodies[a];
    const BodyDefinition& of_b = world.bodies[b];
    const bool fixed = of_a.motion == Motion::fixed || of_b.motion == Motion::fixed;
    const bool bullet = is_bullet(a) || is_bullet(b);
    const bool wanted = which == SweepPairs::all || (fixed && which == SweepPairs::fixed) ||
                        (bullet && which == SweepPairs::bullets) ||
                        ((fixed || bullet) && which == SweepPairs::bullets_and_fixed);
    return wanted && (a % 2 == 0 || b % 2 == 0) && !(a == 0 && b == 2) &&
           (of_a.motion == Motion::dynamic || of_b.motion == Motion::dynamic) &&
           winnow::filters_allow(of_a.filter, of_b.filter);
  }
  /// Returns for each pair its time of impact, computed separately.
  [[nodiscard]] std::map<Names, double> truth(SweepPairs which) const {
    std::vector<ShapeId> shapes;
    std::vector<RigidMotion> all;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      shapes.push_back(world.bodies[i].shape);
      all.push_back(i % 2 == 0 ? motions[i / 2] : RigidMotion::standing(world.bodies[i].pose));
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

TEST(SceneSweeps, impacts_match_single_pairs) {
  SweptWorld swept(scaled(160));
  SceneSweep sweep(*swept.scene);
  for (const SweepPairs which :
       {SweepPairs::all, SweepPairs::fixed, SweepPairs::bullets, SweepPairs::bullets_and_fixed}) {
    ASSERT_EQ(sweep.sweep(swept.keys, swept.motions, {.pairs = which, .bullets = swept.bullets}),
              Status::ok);
    const std::map<Names, double> truth = swept.truth(which);
    EXPECT_EQ(sweep.impacts().size(), truth.size());
    std::map<std::size_t, double> earliest;
    double last = 0.0;
    for (const SceneImpact& impact : sweep.impacts()) {
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
    ASSERT_EQ(sweep.first().size(), swept.movers.size());
    for (std::size_t i = 0; i < swept.movers.size(); ++i) {
      const std::uint32_t first = sweep.first()[i];
      const auto known = earliest.find(swept.movers[i]);
      ASSERT_EQ(first == kNoImpact, known == earliest.end());
      if (first == kNoImpact) continue;
      EXPECT_EQ(sweep.impacts()[first].time, known->second);
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

TEST(SceneSweeps, first_only_matches_first_of_all) {
  SweptWorld swept(400, Execution::serial(), 2.5);
  SceneSweep all(*swept.scene);
  SceneSweep firsts(*swept.scene);
  for (const double tolerance : {1e-6, 1e-2}) {
    ASSERT_EQ(all.sweep(swept.keys, swept.motions, {.tolerance = tolerance}), Status::ok);
    ASSERT_EQ(firsts.sweep(swept.keys, swept.motions, {.tolerance = tolerance, .first_only = true}),
              Status::ok);
    EXPECT_LE(firsts.impacts().size(), swept.movers.size());
    for (std::size_t i = 0; i < swept.movers.size(); ++i) {
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
    EXPECT_EQ(pool.add(BoxShape{{0.5, 0.5, 0.5}}, box), Status::ok);
    const double side = std::cbrt(2.0 * static_cast<double>(count));
    Random random(7);
    for (std::size_t i = 0; i < count; ++i) {
      const Pose start =
          Pose::at(random.uniform(0, side), random.uniform(0, side), random.uniform(0, side));
      keys.push_back(scene.add({.shape = box, .pose = start, .data = i}));
      motions.push_back(RigidMotion::standing(start));
      for (double& x : motions.back().travel) x = way + random.uniform(-0.1, 0.1);
    }
  }

  ShapePool pool;
  ShapeId box;
  Scene scene{pool};
  std::vector<Key> keys;
  std::vector<RigidMotion> motions;
};

TEST(SceneSweeps, common_motion_adds_no_candidate_pairs) {
  Convoy still(scaled(400), 0.0);
  Convoy fast(scaled(400), 1000.0);
  ShapeId wall;
  ASSERT_EQ(fast.pool.add(BoxShape{{1e-3, 1e4, 1e4}}, wall), Status::ok);
  ASSERT_NE(fast.scene.add({.shape = wall, .pose = Pose::at(500, 0, 0), .motion = Motion::fixed}),
            Key{});
  SceneSweep of_still(still.scene);
  SceneSweep of_fast(fast.scene);
  ASSERT_EQ(of_still.sweep(still.keys, still.motions), Status::ok);
  ASSERT_EQ(of_fast.sweep(fast.keys, fast.motions), Status::ok);
  const std::size_t count = fast.keys.size();
  EXPECT_LE(of_fast.statistics().body_pairs, 2 * of_still.statistics().body_pairs + count);
  // All boxes hit the wall. Impacts with each other do not change.
  EXPECT_EQ(of_fast.impacts().size(), of_still.impacts().size() + count);
}

TEST(SceneSweeps, impacts_match_on_any_thread_count) {
  SweptWorld one(scaled(160));
  SweptWorld many(scaled(160), Execution::parallel());
  for (const bool first_only : {false, true}) {
    SceneSweep serial(*one.scene);
    SceneSweep parallel(*many.scene);
    ASSERT_EQ(serial.sweep(one.keys, one.motions, {.first_only = first_only}), Status::ok);
    ASSERT_EQ(parallel.sweep(many.keys, many.motions, {.first_only = first_only}), Status::ok);
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
    EXPECT_EQ(pool.add(SphereShape{0.5}, ball), Status::ok);
    EXPECT_EQ(pool.add(BoxShape{{1e-3, 10, 10}}, wall), Status::ok);
    EXPECT_EQ(pool.add(HalfSpaceShape{{0, 0, 1}, 0}, floor), Status::ok);
    EXPECT_EQ(scene.add({.shape = floor, .motion = Motion::fixed}, keys[0]), Status::ok);
    EXPECT_EQ(scene.add({.shape = wall, .motion = Motion::fixed}, keys[1]), Status::ok);
    EXPECT_EQ(scene.add({.shape = ball, .pose = Pose::at(-50, 0, 0.5), .data = 7}, keys[2]),
              Status::ok);
  }

  ShapePool pool;
  ShapeId ball, wall, floor;
  Scene scene{pool};
  Key keys[3];
};

TEST(SceneSweeps, initial_touches_can_be_ignored) {
  Gallery gallery;
  SceneSweep sweep(gallery.scene);
  const Pose end[1] = {Pose::at(50, 0, 0.5)};
  const std::span<const Key> moving(&gallery.keys[2], 1);
  ASSERT_EQ(sweep.sweep(moving, PoseView(end)), Status::ok);
  ASSERT_EQ(sweep.impacts().size(), 2U);
  EXPECT_EQ(sweep.impacts()[0].a, gallery.keys[0]);
  EXPECT_EQ(sweep.impacts()[0].time, 0.0);
  for (const bool first_only : {false, true}) {
    ASSERT_EQ(sweep.sweep(moving, PoseView(end), {.touching = false, .first_only = first_only}),
              Status::ok);
    ASSERT_EQ(sweep.impacts().size(), 1U);
    const SceneImpact& impact = sweep.impacts()[sweep.first()[0]];
    EXPECT_EQ(impact.a, gallery.keys[1]);
    EXPECT_EQ(impact.b, gallery.keys[2]);
    EXPECT_EQ(impact.data_b, 7U);
    EXPECT_NEAR(impact.time, 0.5 - 0.00501, 1e-6);
    EXPECT_NEAR(impact.normal[0], -1.0, 1e-9);
    EXPECT_NEAR(impact.point[0], -1e-3, 1e-9);
  }
}

TEST(SceneSweeps, bad_input_is_refused_and_keeps_impacts) {
  Gallery gallery;
  SceneSweep sweep(gallery.scene);
  const Key ball = gallery.keys[2];
  const auto asked = [&](std::span<const Key> keys, std::span<const Pose> ends,
                         const SweepOptions& options = {}) {
    return sweep.sweep(keys, PoseView(ends), options);
  };
  const Pose good[2] = {Pose::at(50, 0, 0.5), Pose::at(1, 2, 3)};
  const std::span<const Key> moving(&ball, 1);
  const std::span<const Pose> end(good, 1);
  ASSERT_EQ(asked(moving, end), Status::ok);
  const Key twice[2] = {ball, ball};
  EXPECT_EQ(asked(twice, good), Status::invalid_key);
  EXPECT_EQ(asked(moving, good), Status::size_mismatch);
  const Key none[1] = {Key{}};
  EXPECT_EQ(asked(none, end), Status::invalid_key);
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kEndless, -kEndless}) {
    const Pose beyond[1] = {Pose::at(bad, 0, 0)};
    EXPECT_EQ(asked(moving, beyond), Status::invalid_pose);
  }
  Pose unturned[1] = {Pose::at(1, 2, 3)};
  unturned[0].orientation[0] = 0.0;
  EXPECT_EQ(asked(moving, unturned), Status::invalid_pose);
  for (const double tolerance : {0.0, -1.0, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(asked(moving, end, {.tolerance = tolerance}), Status::invalid_argument);
  }
  const std::uint8_t bullets[2] = {1, 1};
  EXPECT_EQ(asked(moving, end, {.bullets = bullets}), Status::size_mismatch);
  EXPECT_EQ(asked(moving, end, {.pairs = static_cast<SweepPairs>(9)}), Status::invalid_argument);
  EXPECT_EQ(sweep.impacts().size(), 2U);
  EXPECT_EQ(asked({}, {}), Status::ok);
  EXPECT_EQ(sweep.impacts().size(), 0U);
  // A motion near the end of the range of double that passes through the wall.
  const Pose far[1] = {Pose::at(1e300, 0, 0.5)};
  EXPECT_EQ(asked(moving, far, {.touching = false}), Status::ok);
  EXPECT_EQ(sweep.impacts().size(), 1U);
}

TEST(MotionCasts, hits_match_single_pairs) {
  SweptWorld swept(scaled(160));
  SceneQueries queries(*swept.scene);
  const SceneWorld& world = swept.world;
  ASSERT_EQ(swept.scene->refresh(), Status::ok);
  for (std::size_t i = 0; i < swept.movers.size(); ++i) {
    const ShapeId shape = world.bodies[swept.movers[i]].shape;
    if (!shape.is_composite() && shape.kind() == ShapeKind::half_space) continue;
    std::vector<ShapeId> shapes{shape};
    std::vector<RigidMotion> motions{swept.motions[i]};
    std::vector<BodyPair> pairs;
    for (const BodyDefinition& body : world.bodies) {
      pairs.push_back({0, static_cast<std::uint32_t>(shapes.size())});
      shapes.push_back(body.shape);
      motions.push_back(RigidMotion::standing(body.pose));
    }
    ImpactResult truth;
    ASSERT_EQ(time_of_impact(world.pool, {shapes, motions}, pairs,
                             {.composites = &swept.composites}, truth),
              Status::ok);
    std::span<const SceneHit> hits;
    const MotionCast cast{shape, swept.motions[i]};
    ASSERT_EQ(queries.all(cast, hits), Status::ok);
    EXPECT_EQ(hits.size(), static_cast<std::size_t>(std::ranges::count(truth.hit(), 1)));
    double last = 0.0;
    for (const SceneHit& hit : hits) {
      const auto body = static_cast<std::size_t>(hit.data);
      EXPECT_TRUE(truth.hits(body));
      EXPECT_NEAR(hit.t, truth.time()[body], 1e-5);
      EXPECT_LE(last, hit.t);
      last = hit.t;
    }
    SceneHit closest;
    ASSERT_EQ(queries.closest(cast, closest), Status::ok);
    EXPECT_EQ(static_cast<bool>(closest), !hits.empty());
  }
}

TEST(MotionCasts, closest_hit_matches_first_of_all) {
  SweptWorld swept(400, Execution::serial(), 2.5);
  SceneQueries queries(*swept.scene);
  ASSERT_EQ(swept.scene->refresh(), Status::ok);
  for (const RigidMotion& motion : swept.motions) {
    const MotionCast cast{swept.mesh, motion};
    std::span<const SceneHit> hits;
    ASSERT_EQ(queries.all(cast, hits), Status::ok);
    const SceneHit first = hits.empty() ? SceneHit{} : hits[0];
    SceneHit closest;
    ASSERT_EQ(queries.closest(cast, closest), Status::ok);
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
  ShapeId rod;
  ASSERT_EQ(gallery.pool.add(CapsuleShape{0.1, 3.9}, rod), Status::ok);
  // The rod stands upright beside the wall. A quarter turn about y drops it onto the wall.
  MotionCast cast{rod, {Pose::at(2, 0, 5), {0, 0, 0}, {0, -std::acos(0.0), 0}}};
  SceneHit hit;
  ASSERT_EQ(queries.closest(cast, hit), Status::ok);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit.key, gallery.keys[1]);
  const double angle = std::asin((2 - 1e-3 - 0.1) / 3.9);
  EXPECT_NEAR(hit.t, angle / std::acos(0.0), 1e-6);
  EXPECT_LE(hit.t, angle / std::acos(0.0));
  EXPECT_NEAR(hit.normal[0], 1.0, 1e-9);
  EXPECT_NEAR(hit.point[0], 1e-3, 1e-6);
  EXPECT_EQ(queries.closest(cast, hit, {}, 0.0), Status::invalid_argument);
  cast.motion.travel[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(queries.closest(cast, hit), Status::invalid_pose);
  cast.shape = gallery.floor;
  EXPECT_EQ(queries.closest(cast, hit), Status::unsupported);
  cast.shape = ShapeId::of(CompositeKind::mesh, 0);
  EXPECT_EQ(queries.closest(cast, hit), Status::invalid_key);
}

TEST(SceneSweeps, repeated_sweep_allocates_nothing_and_refusals_recover) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  SweptWorld swept(60);
  CountingMemory memory;
  {
    SceneSweep sweep(*swept.scene, &memory);
    for (int frame = 0; frame < 3; ++frame) {
      ASSERT_EQ(sweep.sweep(swept.keys, swept.motions), Status::ok);
    }
    EXPECT_EQ(sweep.footprint().total().reserved, memory.outstanding());
    const std::size_t before = memory.requests();
    ASSERT_EQ(sweep.sweep(swept.keys, swept.motions), Status::ok);
    EXPECT_EQ(memory.requests(), before);
  }
  EXPECT_EQ(memory.outstanding(), 0U);
  // A sweep whose memory request is refused has no impacts, and the next sweep is complete.
  SceneSweep whole(*swept.scene);
  ASSERT_EQ(whole.sweep(swept.keys, swept.motions), Status::ok);
  for (std::size_t granted = 1;; ++granted) {
    SceneSweep sweep(*swept.scene, &memory);
    memory.refuse_after(granted);
    const Status status = sweep.sweep(swept.keys, swept.motions);
    memory.grant_all();
    if (status == Status::ok) break;
    ASSERT_EQ(status, Status::out_of_memory);
    EXPECT_EQ(sweep.impacts().size(), 0U);
    ASSERT_EQ(sweep.sweep(swept.keys, swept.motions), Status::ok);
    EXPECT_EQ(sweep.impacts().size(), whole.impacts().size());
  }
  SceneSweep without(*swept.scene, std::pmr::null_memory_resource());
  EXPECT_EQ(without.sweep(swept.keys, swept.motions), Status::out_of_memory);
  EXPECT_EQ(without.impacts().size(), 0U);
}

}  // namespace
}  // namespace winnow::test
