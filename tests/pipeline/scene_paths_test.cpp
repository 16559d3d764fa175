// Rays and casts in scenes: the number of tested bodies, ranges from tiny to infinite, and no leaks
// between triangles.

#include <gtest/gtest.h>
#include <winnow/pipeline/scene_queries.h>

#include "tests/pipeline/query_world.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"

namespace winnow::test {
namespace {

TEST(ScenePaths, closest_hit_tests_few_bodies) {
  QueryWorld world;
  ShapeId ball = expect_ok(world.shapes.pool.add(SphereShape{0.4}));
  Random random(6);
  for (int i = 0; i < 16; ++i) {
    for (int j = 0; j < 16; ++j) {
      for (int k = 0; k < 16; ++k) world.add(ball, Pose::at(i, j, k), random);
    }
  }
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  std::size_t calls = 0;
  SceneFilter filter;
  filter.predicate = {[](void* count, Key, ClientData) {
                        ++*static_cast<std::size_t*>(count);
                        return true;
                      },
                      &calls};
  const std::size_t rays = 1000;
  for (std::size_t n = 0; n < rays; ++n) {
    ShapeRay ray;
    ray.max_t = kInfinity;
    for (int i = 0; i < 3; ++i) {
      ray.origin[i] = random.uniform(-4.0, 20.0);
      ray.direction[i] = random.uniform(0.0, 16.0) - ray.origin[i];
    }
    expect_ok(queries.closest(ray, filter));
  }
  EXPECT_LT(calls, 12 * rays);
}

TEST(ScenePaths, long_ray_hits_tiny_body) {
  Random random(15);
  QueryWorld world;
  ShapeId grain = expect_ok(world.shapes.pool.add(SphereShape{1e-4}));
  for (int i = 0; i < 100; ++i) world.add(grain, random_pose(100.0, random), random);
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  for (std::size_t n = scaled(500); n-- != 0;) {
    const std::size_t target = random.below(world.bodies.size());
    ShapeRay ray;
    draw_direction(1.0, random, ray.direction.data());
    const double way = random.log_uniform(1e3, 1e6) / length_of(ray.direction.data());
    for (int i = 0; i < 3; ++i) {
      ray.origin[i] = world.bodies[target].pose.position[i] - way * ray.direction[i];
    }
    ray.max_t = random.chance(0.5) ? kInfinity : 1.5 * way;
    SceneHit hit = expect_ok(queries.closest(ray));
    ASSERT_TRUE(hit) << n;
    EXPECT_LE(hit.t, way);
    ShapeCast cast{grain, {}, {}, ray.max_t};
    cast.pose.position = ray.origin;
    cast.direction = ray.direction;
    hit = expect_ok(queries.closest(cast));
    ASSERT_TRUE(hit) << n;
    EXPECT_LE(hit.t, way);
  }
}

TEST(ScenePaths, unbounded_rays_reach_distant_bodies) {
  for (const double far : {1e3, 1e9, 1e20, 1e30, 1e36, 1e200}) {
    QueryWorld world;
    ShapeId ball;
    ShapeId wall;
    ball = expect_ok(world.shapes.pool.add(SphereShape{0.01 * far}));
    wall = expect_ok(world.shapes.pool.add(HalfSpaceShape{{-1.0, 0.0, 0.0}, -3.0 * far}));
    Random random(7);
    world.add(wall, {}, random);
    world.add(ball, Pose::at(far, 0.5 * far, 0.25 * far), random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    ShapeRay ray{.direction = {4.0, 2.0, 1.0}};
    SceneHit hit;
    std::span<const SceneHit> hits;
    hit = expect_ok(queries.closest(ray));
    EXPECT_EQ(hit.key, world.keys[1]) << far;
    EXPECT_NEAR(hit.t / far, 0.25 - 0.01 / std::sqrt(21.0), 1e-12);
    hits = expect_ok(queries.all(ray));
    EXPECT_EQ(hits.size(), 2U) << far;
    const ShapeCast cast{ball, {}, {4.0, 2.0, 1.0}, kInfinity};
    hit = expect_ok(queries.closest(cast, {}, 1e-9 * far));
    EXPECT_EQ(hit.key, world.keys[1]) << far;
    EXPECT_NEAR(hit.t / far, 0.25 - 0.02 / std::sqrt(21.0), 1e-8);
  }
}

TEST(ScenePaths, bullet_never_tunnels_through_sheet) {
  Random random(8);
  for (const double center : kCenters) {
    QueryWorld world;
    world.center = center;
    ShapeId bullet = expect_ok(world.shapes.pool.add(SphereShape{1e-3}));
    world.add(add_sheet(world.composites, 40), {}, random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    for (std::size_t n = scaled(400); n-- != 0;) {
      ShapeCast cast{bullet, {}, {}, kInfinity};
      const double speed = random.log_uniform(1e-3, 1e9);
      const double way = random.log_uniform(1.0, 1e4);
      const double slope[3] = {random.uniform(-2, 2), random.uniform(-2, 2), -1.0};
      for (int i = 0; i < 3; ++i) {
        cast.pose.position[i] = center + (i < 2 ? random.uniform(-0.4, 0.4) : 0.0) - way * slope[i];
        cast.direction[i] = speed * slope[i];
      }
      SceneHit hit = expect_ok(queries.closest(cast));
      ASSERT_TRUE(hit) << n;
      // The sheet is within 0.2 of its plane.
      EXPECT_NEAR(hit.t * speed, way, 0.21);
      EXPECT_GT(hit.normal[2], 0.0);
    }
  }
}

TEST(ScenePaths, rays_at_edges_and_corners_hit_mesh) {
  Random random(14);
  QueryWorld world;
  constexpr std::uint32_t kCells = 40;
  const ShapeId sheet = add_sheet(world.composites, kCells);
  ShapeId large = expect_ok(world.composites.add_scaled(sheet, {100.0, 50.0, 30.0}));
  world.add(large, random_pose(10.0, random), random);
  ShapeId point = expect_ok(world.shapes.pool.add(SphereShape{}));
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  const std::vector<FlatPart> parts = world.parts(0);
  const Vec3d& base = world.bodies[0].pose.position;
  for (std::size_t n = scaled(2000); n-- != 0;) {
    // Leave out the triangles at the border.
    const std::size_t i = 1 + random.below(kCells - 2);
    const std::size_t cell = i * kCells + 1 + random.below(kCells - 2);
    const auto inner = std::find_if(parts.begin(), parts.end(),
                                    [&](const FlatPart& part) { return part.part == 2 * cell; });
    ASSERT_NE(inner, parts.end());
    const std::size_t corner = random.below(3);
    const double along = random.chance(0.5) ? 0.0 : random.unit();
    ShapeRay ray;
    draw_direction(1.0, random, ray.direction.data());
    for (int k = 0; k < 3; ++k) {
      const double from = inner->triangle.vertex[corner][k];
      const double to = inner->triangle.vertex[(corner + 1) % 3][k];
      ray.origin[k] =
          base[k] + inner->pose.position[k] + from + along * (to - from) - 4.0 * ray.direction[k];
    }
    ray.max_t = kInfinity;
    SceneHit hit = expect_ok(queries.closest(ray));
    ASSERT_TRUE(hit) << n;
    EXPECT_LT(hit.t, 4.0 + 1e-6);
    ShapeCast cast{point, {}, {}, kInfinity};
    cast.pose.position = ray.origin;
    cast.direction = ray.direction;
    hit = expect_ok(queries.closest(cast));
    ASSERT_TRUE(hit) << n;
    EXPECT_LT(hit.t, 4.0 + 1e-6);
  }
}

}  // namespace
}  // namespace winnow::test
