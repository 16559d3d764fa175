// Common behaviour of all scene queries: filters, refused input, determinism, memory.

#include <gtest/gtest.h>
#include <winnow/pipeline/scene_queries.h>

#include <Eigen/Core>
#include <cstring>

#include "tests/pipeline/query_world.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"
#include "tests/support/platform.h"

#if WINNOW_TEST_THREADS
#include <thread>
#endif

namespace winnow::test {
namespace {

TEST(SceneQueryCalls, filters_and_predicates_select_bodies) {
  Random random(9);
  QueryWorld world;
  fill(world, 120, 0.0, random);
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    world.bodies[i].filter.layers = 1U << (i % 3);
  }
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  struct Context {
    const QueryWorld& world;
    bool right = true;
  } context{world};
  SceneFilter filter;
  filter.mask = 0b101;
  filter.predicate = {[](void* given, Key key, ClientData data) {
                        auto& c = *static_cast<Context*>(given);
                        c.right =
                            c.right && c.world.keys[static_cast<std::size_t>(data) - 1000] == key;
                        return data % 2 == 0;
                      },
                      &context};
  const auto is_selected = [](ClientData data) { return (data - 1000) % 3 != 1 && data % 2 == 0; };
  const auto expect_chosen = [&](const auto& chosen, const auto& everything) {
    std::size_t k = 0;
    for (const auto& one : everything) {
      if (!is_selected(one.data)) continue;
      ASSERT_LT(k, chosen.size());
      EXPECT_EQ(chosen[k++].key, one.key);
    }
    EXPECT_EQ(k, chosen.size());
  };
  const auto copy = [](const auto& span) { return std::vector(span.begin(), span.end()); };
  const double origin[3] = {0.0, 0.0, 0.0};
  for (int n = 0; n < 10; ++n) {
    ShapeRay ray;
    draw_direction(1.0, random, ray.direction.data());
    ray.max_t = kInfinity;
    std::span<const SceneHit> hits = expect_ok(queries.all(ray));
    const auto every_hit = copy(hits);
    hits = expect_ok(queries.all(ray, filter));
    expect_chosen(hits, every_hit);
    std::span<const SceneOverlap> overlaps;
    const ShapeId sheet = world.bodies[120].shape;
    const Pose pose = random_pose(1.0, random);
    overlaps = expect_ok(queries.overlap(sheet, pose));
    const auto every_overlap = copy(overlaps);
    overlaps = expect_ok(queries.overlap(sheet, pose, filter));
    expect_chosen(overlaps, every_overlap);
    std::span<const SceneDistance> near = expect_ok(queries.nearest(origin, 1000, 4.0));
    const auto every_near = copy(near);
    near = expect_ok(queries.nearest(origin, 1000, 4.0, filter));
    expect_chosen(near, every_near);
  }
  EXPECT_TRUE(context.right);
}

TEST(SceneQueryCalls, bad_queries_are_refused_and_change_nothing) {
  Random random(10);
  QueryWorld world;
  fill(world, 30, 0.0, random);
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  const double nan = std::nan("");
  for (const ShapeRay& ray :
       {ShapeRay{.origin = {nan, 0, 0}}, ShapeRay{.direction = {0, 0, 0}},
        ShapeRay{.direction = {1, kInfinity, 0}}, ShapeRay{.max_t = -1.0}, ShapeRay{.max_t = nan},
        ShapeRay{.min_t = -1.0}, ShapeRay{.min_t = nan}, ShapeRay{.min_t = kInfinity},
        ShapeRay{.min_t = 2.0, .max_t = 1.0}}) {
    expect_error(queries.closest(ray), Status::invalid_argument);
    expect_error(queries.any(ray), Status::invalid_argument);
    expect_error(queries.all(ray), Status::invalid_argument);
    expect_error(queries.crossings(ray), Status::invalid_argument);
  }
  const ShapeCast good{world.shapes.shapes[0], {}};
  ShapeCast cast = good;
  cast.shape = {};
  expect_error(queries.closest(cast), Status::invalid_key);
  cast.shape = expect_ok(world.shapes.pool.add(HalfSpaceShape{}));
  expect_error(queries.closest(cast), Status::unsupported);
  cast = good;
  cast.pose.orientation[0] = 0.0;
  expect_error(queries.closest(cast), Status::invalid_pose);
  cast = good;
  cast.direction[1] = nan;
  expect_error(queries.closest(cast), Status::invalid_argument);
  expect_error(queries.closest(good, {}, -1.0), Status::invalid_argument);
  expect_error(queries.closest(good, {}, nan), Status::invalid_argument);
  expect_error(queries.overlap(ShapeId{}, {}), Status::invalid_key);
  expect_error(queries.overlap(good.shape, Pose::at(nan, 0, 0)), Status::invalid_pose);
  expect_error(queries.distance(world.keys[0], {}), Status::invalid_key);
  const auto no_rules = static_cast<PairRules>(7);
  expect_error(queries.distance(world.keys[0], world.keys[1], 1.0, no_rules),
               Status::invalid_argument);
  const Key gone[] = {world.keys[0], Key{}};
  expect_error(queries.any_contact(gone, world.keys), Status::invalid_key);
  for (const double margin : {-1.0, nan, kInfinity}) {
    expect_error(queries.any_contact(world.keys, world.keys, margin), Status::invalid_argument);
    expect_error(queries.any_contact(margin), Status::invalid_argument);
  }
  expect_error(queries.any_contact(world.keys, world.keys, 0.0, no_rules),
               Status::invalid_argument);
  expect_error(queries.any_contact(0.0, no_rules), Status::invalid_argument);
  const double nowhere[3] = {0.0, nan, 0.0};
  const double origin[3] = {0.0, 0.0, 0.0};
  expect_error(queries.nearest(nowhere, 1, 1.0), Status::invalid_argument);
  expect_error(queries.nearest(origin, 1, -1.0), Status::invalid_argument);
  ASSERT_EQ(world.scene->move(world.keys[0], Pose::at(1, 2, 3)), Status::ok);
  expect_error(queries.closest(ShapeRay{}), Status::invalid_argument);
  ASSERT_EQ(world.scene->refresh(), Status::ok);
  expect_ok(queries.closest(ShapeRay{}));
  // After a change of poses or of composite shapes, queries need a refresh.
  ASSERT_EQ(world.composites.remove(add_sheet(world.composites, 2)), Status::ok);
  expect_error(queries.closest(ShapeRay{}), Status::invalid_argument);
  ASSERT_EQ(world.scene->refresh(), Status::ok);
  expect_ok(queries.closest(ShapeRay{}));
}

/// Returns a hash of the results of many queries.
std::uint64_t fingerprint(const QueryWorld& world, SceneQueries& queries) {
  Random random(11);
  std::uint64_t sum = 0;
  const auto mix = [&](const auto& value) {
    std::uint64_t bits[2] = {0, 0};
    static_assert(sizeof(value) <= sizeof(bits));
    std::memcpy(bits, &value, sizeof(value));
    sum = (sum ^ bits[0]) * 0x9E3779B97F4A7C15ULL + bits[1];
  };
  const auto mix_hit = [&](const SceneHit& hit) {
    mix(hit.key.id);
    mix(hit.part);
    mix(hit.t);
    for (int i = 0; i < 3; ++i) mix(hit.normal[i]), mix(hit.point[i]);
  };
  for (int n = 0; n < 12; ++n) {
    ShapeCast cast;
    cast.shape = world.shapes.shapes[random.below(100)];
    cast.pose = random_pose(world.size, random);
    draw_direction(1.0, random, cast.direction.data());
    cast.max_t = kInfinity;
    ShapeRay ray;
    ray.max_t = kInfinity;
    ray.origin = cast.pose.position;
    ray.direction = cast.direction;
    SceneHit hit;
    std::span<const SceneHit> hits;
    hit = expect_ok(queries.closest(ray));
    mix_hit(hit);
    hit = expect_ok(queries.closest(cast));
    mix_hit(hit);
    hits = expect_ok(queries.all(ray));
    for (const SceneHit& one : hits) mix_hit(one);
    std::span<const SceneOverlap> overlaps =
        expect_ok(queries.overlap(world.bodies[100].shape, cast.pose));
    for (const SceneOverlap& one : overlaps) mix(one.key.id), mix(one.part);
    std::span<const SceneDistance> near = expect_ok(queries.nearest(ray.origin, 7, 10.0));
    for (const SceneDistance& one : near) mix(one.key.id), mix(one.part), mix(one.distance);
  }
  return sum;
}

TEST(SceneQueryCalls, rays_hit_mesh_in_its_current_state) {
  ShapePool shapes;
  CompositePool composites(shapes);
  const std::vector<Eigen::Vector3d> square = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  const std::vector<std::uint32_t> corners = {0, 1, 2, 0, 2, 3};
  ShapeId floor;
  ShapeId high;
  const auto add = [&](std::span<const Eigen::Vector3d> at, ShapeId& shape) {
    shape = expect_ok(composites.add_mesh(at, std::span<const std::uint32_t>(corners)));
  };
  add(square, floor);
  std::vector<Eigen::Vector3d> raised = square;
  for (Eigen::Vector3d& corner : raised) corner.z() = 0.5;
  add(raised, high);
  Scene scene(shapes, {.composites = &composites});
  Key key = expect_ok(scene.add({.shape = floor, .data = 7}));
  SceneQueries queries(scene);
  ShapeRay ray;
  ray.origin[0] = 0.25;
  ray.origin[2] = 10.0;
  ray.direction[0] = 0.0;
  ray.direction[2] = -1.0;
  ray.max_t = kInfinity;
  const auto expect_at = [&](double t) {
    ASSERT_EQ(scene.refresh(), Status::ok);
    for (int again = 0; again < 2; ++again) {
      SceneHit hit = expect_ok(queries.closest(ray));
      EXPECT_EQ(hit.key != Key{}, std::isfinite(t));
      if (!std::isfinite(t)) continue;
      EXPECT_EQ(hit.data, 7U);
      EXPECT_NEAR(hit.t, t, 1e-12);
      EXPECT_NEAR(hit.point[2], 10.0 - t, 1e-12);
      SceneHit any = expect_ok(queries.any(ray));
      EXPECT_EQ(any.t, hit.t);
    }
  };
  expect_at(10.0);
  ASSERT_EQ(scene.move(key, Pose::at(0.0, 0.0, 2.0)), Status::ok);
  expect_at(8.0);
  ASSERT_EQ(scene.set_shape(key, high), Status::ok);
  expect_at(7.5);
  const double half = std::sqrt(0.5);
  ASSERT_EQ(scene.move(key, {{0.0, 0.0, 2.0}, {half, half, 0.0, 0.0}}), Status::ok);
  expect_at(kInfinity);
  ASSERT_EQ(scene.move(key, {{0.0, 0.0, 2.0}, {0.0, 1.0, 0.0, 0.0}}), Status::ok);
  expect_at(8.5);
  ASSERT_EQ(scene.set_shape(key, floor), Status::ok);
  expect_at(8.0);
  ASSERT_EQ(composites.refit_mesh(floor, std::span<const Eigen::Vector3d>(raised)), Status::ok);
  expect_at(8.5);
  ASSERT_EQ(composites.set_one_sided(floor, true), Status::ok);
  expect_at(kInfinity);
}

TEST(SceneQueryCalls, results_match_on_every_isa_and_thread) {
  Random random(12);
  QueryWorld world;
  fill(world, 100, 0.0, random);
  world.add_to_scene();
  SceneQueries first(*world.scene);
  const std::uint64_t truth = fingerprint(world, first);
  for (const Isa isa : available_isas()) {
    const IsaScope scope(isa);
    SceneQueries queries(*world.scene);
    EXPECT_EQ(fingerprint(world, queries), truth) << to_string(isa);
  }
#if WINNOW_TEST_THREADS
  std::uint64_t sums[4] = {};
  std::vector<std::thread> threads;
  for (std::uint64_t& sum : sums) {
    threads.emplace_back([&world, &sum] {
      SceneQueries queries(*world.scene);
      sum = fingerprint(world, queries);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::uint64_t sum : sums) EXPECT_EQ(sum, truth);
#endif
}

TEST(SceneQueryCalls, footprint_is_exact_and_repeated_queries_allocate_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  Random random(13);
  QueryWorld world;
  fill(world, 100, 0.0, random);
  world.add_to_scene();
  CountingMemory memory;
  {
    SceneQueries queries(*world.scene, &memory);
    EXPECT_EQ(queries.footprint().total().reserved, memory.outstanding());
    const std::uint64_t truth = fingerprint(world, queries);
    EXPECT_EQ(queries.footprint().total().reserved, memory.outstanding());
    const std::size_t requests = memory.requests();
    EXPECT_EQ(fingerprint(world, queries), truth);
    EXPECT_EQ(memory.requests(), requests);
  }
  EXPECT_EQ(memory.outstanding(), 0U);
  memory.refuse_after(0);
  SceneQueries refused(*world.scene, &memory);
  expect_error(refused.closest(ShapeRay{}), Status::out_of_memory);
  memory.grant_all();
  SceneQueries poor(*world.scene, &memory);
  memory.refuse_after(0);
  const double origin[3] = {0.0, 0.0, 0.0};
  expect_error(poor.nearest(origin, 7, kInfinity), Status::out_of_memory);
  memory.grant_all();
  EXPECT_EQ(expect_ok(poor.nearest(origin, 7, kInfinity)).size(), 7U);
}

}  // namespace
}  // namespace winnow::test
