// SceneQueries::crossings and ShapeRay::min_t. References: cast_ray for each part, signed distances
// of points on the ray, rays that start later, and the vertices of meshes.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/scene_queries.h>
#include "core/numbers/rotation.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <vector>

#include "tests/pipeline/composite_world.h"
#include "tests/pipeline/query_world.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"

namespace winnow::test {
namespace {

using Vec = Eigen::Vector3d;

[[nodiscard]] ShapeRay random_ray(const QueryWorld& world, Random& random) {
  ShapeRay ray;
  for (double& x : ray.origin) x = world.center + world.size * random.uniform(-1.5, 1.5);
  double direction[3];
  draw_direction(random.log_uniform(0.1, 10.0), random, direction);
  ray.direction = Vec3d(direction);
  if (random.chance(0.8)) {
    const BodyDefinition& target = world.bodies[random.below(world.bodies.size())];
    ray.direction += target.pose.position - ray.origin;
  }
  if (random.chance(0.5)) ray.max_t = random.log_uniform(0.1, 100.0);
  if (random.chance(0.3)) ray.min_t = std::min(ray.max_t, random.log_uniform(0.01, 10.0));
  return ray;
}

/// The crossings of each body.
[[nodiscard]] std::map<ObjectId, std::vector<SceneCrossing>> by_body(
    std::span<const SceneCrossing> crossings) {
  std::map<ObjectId, std::vector<SceneCrossing>> result;
  for (const SceneCrossing& crossing : crossings) result[crossing.key.id].push_back(crossing);
  return result;
}

/// The signed distance of a point of the ray, relative to a convex body, from the body.
[[nodiscard]] double distance_at(const ShapePool& pool, ShapeId point, const BodyDefinition& body,
                                 const ShapeRay& ray, double t) {
  Pose at;
  Pose own = body.pose;
  own.position = {};
  for (int i = 0; i < 3; ++i) {
    at.position[i] = ray.origin[i] - body.pose.position[i] + t * ray.direction[i];
  }
  PairAnswer answer;
  EXPECT_EQ(collide(pool, point, at, body.shape, own, {.level = ContactLevel::distance}, answer),
            Status::ok);
  return answer.distance;
}

TEST(RayCrossings, box_is_entered_and_left) {
  ShapePool shapes;
  Scene scene(shapes);
  const ShapeId box = expect_ok(shapes.add(BoxShape{{1, 2, 3}, 0.0}));
  const Key key = expect_ok(scene.add({.shape = box, .pose = Pose::at(5, 0, 0), .data = 7}));
  ASSERT_EQ(scene.refresh(), Status::ok);
  SceneQueries queries(scene);
  const auto found = expect_ok(queries.crossings({.direction = {2, 0, 0}}));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].key, key);
  EXPECT_EQ(found[0].data, 7U);
  EXPECT_EQ(found[0].t, 2.0);
  EXPECT_FALSE(found[0].exits);
  EXPECT_EQ(found[0].normal, Vec3d(-1, 0, 0));
  EXPECT_EQ(found[1].t, 3.0);
  EXPECT_TRUE(found[1].exits);
  EXPECT_EQ(found[1].normal, Vec3d(1, 0, 0));
  EXPECT_EQ(found[1].point, Vec3d(6, 0, 0));
  // From inside, and with ends between the two points.
  EXPECT_EQ(expect_ok(queries.crossings({.origin = {5, 0, 0}})).size(), 1U);
  EXPECT_EQ(expect_ok(queries.crossings({.min_t = 4.5, .max_t = 5.5})).size(), 0U);
  EXPECT_EQ(expect_ok(queries.crossings({.min_t = 4.5})).size(), 1U);
  EXPECT_EQ(expect_ok(queries.crossings({.max_t = 5.5})).size(), 1U);
}

TEST(RayCrossings, half_space_is_entered_or_left_once) {
  ShapePool shapes;
  Scene scene(shapes);
  const ShapeId below = expect_ok(shapes.add(HalfSpaceShape{}));
  expect_ok(scene.add({.shape = below, .pose = Pose::at(0, 0, 1)}));
  ASSERT_EQ(scene.refresh(), Status::ok);
  SceneQueries queries(scene);
  for (const double way : {-1.0, 1.0}) {
    const auto found =
        expect_ok(queries.crossings({.origin = {0, 0, 1 - 4 * way}, .direction = {1, 0, 2 * way}}));
    ASSERT_EQ(found.size(), 1U);
    EXPECT_DOUBLE_EQ(found[0].t, 2.0);
    EXPECT_EQ(found[0].exits, way > 0.0);
    EXPECT_EQ(found[0].normal, Vec3d(0, 0, 1));
  }
  EXPECT_EQ(expect_ok(queries.crossings({})).size(), 0U);
}

// A convex body is inside between the two points, and outside before and after them.
TEST(RayCrossings, convex_bodies_are_inside_between_crossings) {
  std::size_t crossed = 0;
  for (const double center : kCenters) {
    Random random(71);
    QueryWorld world;
    fill(world, 60, center, random);
    world.add_to_scene();
    const ShapeId point = expect_ok(world.shapes.pool.add(SphereShape{0.0}));
    SceneQueries queries(*world.scene);
    for (std::size_t r = 0; r < scaled(1000); ++r) {
      ShapeRay ray = random_ray(world, random);
      ray.min_t = 0.0;
      ray.max_t = kInfinity;
      const auto found = by_body(expect_ok(queries.crossings(ray)));
      for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        const BodyDefinition& body = world.bodies[i];
        if (body.shape.is_composite()) continue;
        const auto at = found.find(world.keys[i].id);
        const double start = distance_at(world.shapes.pool, point, body, ray, 0.0);
        const double slack = 1e-9 * std::max(1.0, std::abs(start));
        const ShapeHit hit =
            expect_ok(cast_ray(world.shapes.pool.tables(), body.shape, body.pose, ray));
        SCOPED_TRACE("kind " + std::to_string(body.shape.kind_index()));
        ASSERT_EQ(at != found.end(), hit.hit) << i << ' ' << r;
        if (at == found.end()) continue;
        const std::vector<SceneCrossing>& points = at->second;
        if (start > slack) {
          ASSERT_EQ(points.size(), 2U) << i << ' ' << r;
          EXPECT_FALSE(points[0].exits);
          EXPECT_EQ(points[0].t, hit.t);
        }
        if (start < -slack) {
          ASSERT_EQ(points.size(), 1U) << i << ' ' << r;
        }
        EXPECT_TRUE(points.back().exits);
        const double in = points.size() == 2 ? points[0].t : 0.0;
        const double out = points.back().t;
        const auto distance = [&](double t) {
          return distance_at(world.shapes.pool, point, body, ray, t);
        };
        EXPECT_LE(distance(0.5 * (in + out)), slack) << i << ' ' << r;
        EXPECT_NEAR(distance(out), 0.0, 1e-6 * std::max(1.0, std::abs(start))) << i << ' ' << r;
        EXPECT_GT(distance(out + 1e-3), -slack) << i << ' ' << r;
        EXPECT_GE(as_eigen(points.back().normal).dot(as_eigen(ray.direction)), -1e-6);
        ++crossed;
      }
    }
  }
  EXPECT_GT(crossed, scaled(1000));
}

// Each triangle is crossed where cast_ray hits it.
TEST(RayCrossings, triangles_are_crossed_where_rays_hit) {
  std::size_t crossed = 0;
  for (const double center : kCenters) {
    Random random(72);
    QueryWorld world;
    fill(world, 30, center, random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    for (std::size_t r = 0; r < scaled(1000); ++r) {
      const ShapeRay ray = random_ray(world, random);
      const auto found = by_body(expect_ok(queries.crossings(ray)));
      for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        if (!world.bodies[i].shape.is_composite()) continue;
        std::map<std::uint32_t, double> expected;
        ShapeRay local = ray;
        for (int k = 0; k < 3; ++k) local.origin[k] -= world.bodies[i].pose.position[k];
        for (const FlatPart& part : world.parts(i)) {
          if (part.shape.kind() != ShapeKind::triangle) continue;
          const PartTable table(world.shapes.pool, part);
          const ShapeHit hit = expect_ok(cast_ray(table.tables, table.id, part.pose, local));
          if (hit.hit) expected[part.part] = hit.t;
        }
        const auto at = found.find(world.keys[i].id);
        std::size_t matched = 0;
        for (const SceneCrossing& point :
             at != found.end() ? at->second : std::vector<SceneCrossing>{}) {
          const auto same = expected.find(point.part);
          if (same == expected.end()) continue;
          EXPECT_NEAR(point.t, same->second, 1e-9 * (1.0 + point.t) + 1e-15 * std::abs(center));
          ++matched;
        }
        EXPECT_EQ(matched, expected.size()) << i << ' ' << r;
        crossed += matched;
      }
    }
  }
  EXPECT_GT(crossed, scaled(1000));
}

/// The triangles of a cube with half extent 1, wound outward.
[[nodiscard]] Surface cube() {
  Surface surface;
  for (int i = 0; i < 8; ++i) {
    surface.vertices.emplace_back(i % 2 == 0 ? -1.0F : 1.0F, i / 2 % 2 == 0 ? -1.0F : 1.0F,
                                  i / 4 == 0 ? -1.0F : 1.0F);
  }
  surface.corners = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                     2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return surface;
}

// A mirrored mesh keeps its front; a one-sided mesh and a solid are crossed from both sides.
TEST(RayCrossings, closed_mesh_is_entered_then_left) {
  for (const Vec& scale : {Vec(1, 1, 1), Vec(-1, 1, 1), Vec(-2, -1, -0.5)}) {
    for (const int kind : {0, 1, 2}) {
      CompositeWorld world;
      const ShapeId mesh = add(world.composites, cube());
      const ShapeId scaled_mesh = expect_ok(world.composites.add_scaled(mesh, Vec3d(scale)));
      if (kind == 1) {
        ASSERT_EQ(world.composites.set_one_sided(scaled_mesh), Status::ok);
      }
      if (kind == 2) {
        ASSERT_EQ(world.composites.set_solid(scaled_mesh), Status::ok);
      }
      Scene scene(world.shapes, {.composites = &world.composites});
      expect_ok(scene.add({.shape = scaled_mesh}));
      ASSERT_EQ(scene.refresh(), Status::ok);
      SceneQueries queries(scene);
      const ShapeRay ray{.origin = {-5, 0.1, 0.2}, .direction = {1, 0.01, 0.02}};
      const auto found = expect_ok(queries.crossings(ray));
      ASSERT_EQ(found.size(), 2U) << scale.transpose() << " kind " << kind;
      EXPECT_FALSE(found[0].exits);
      EXPECT_TRUE(found[1].exits);
      EXPECT_LT((as_eigen(found[0].normal) - Vec(-1, 0, 0)).norm(), 1e-12);
      EXPECT_LT((as_eigen(found[1].normal) - Vec(1, 0, 0)).norm(), 1e-12);
      EXPECT_EQ(found[0].t, expect_ok(queries.closest(ray)).t);
    }
  }
}

TEST(RayCrossings, barycentric_weights_give_the_point) {
  Random random(73);
  std::size_t checked = 0;
  for (std::size_t round = 0; round < scaled(60); ++round) {
    CompositeWorld world;
    const Surface surface = soup(random, 40, 1.0, 0.7);
    const ShapeId mesh = add(world.composites, surface);
    const Vec scale(random.uniform(0.5, 2), random.uniform(-2, -0.5), random.uniform(0.5, 2));
    const ShapeId scaled_mesh = expect_ok(world.composites.add_scaled(mesh, Vec3d(scale)));
    const Pose pose = random_pose(random, 3.0);
    Scene scene(world.shapes, {.composites = &world.composites});
    expect_ok(scene.add({.shape = scaled_mesh, .pose = pose}));
    ASSERT_EQ(scene.refresh(), Status::ok);
    SceneQueries queries(scene);
    const Eigen::Matrix3d turn = rotation_of(scale_to_unit_max(pose.orientation));
    for (int r = 0; r < 30; ++r) {
      ShapeRay ray;
      for (double& x : ray.origin) x = random.uniform(-6, 6);
      for (int i = 0; i < 3; ++i) ray.direction[i] = pose.position[i] - ray.origin[i];
      for (const SceneCrossing& point : expect_ok(queries.crossings(ray))) {
        Vec sum = Vec::Zero();
        double total = 0.0;
        for (std::uint32_t k = 0; k < 3; ++k) {
          const Vec vertex = surface.vertices[surface.corners[3 * point.part + k]].cast<double>();
          EXPECT_GE(point.barycentric[k], 0.0);
          total += point.barycentric[k];
          sum +=
              point.barycentric[k] * (as_eigen(pose.position) + turn * scale.cwiseProduct(vertex));
        }
        EXPECT_NEAR(total, 1.0, 1e-15);
        EXPECT_LT((sum - as_eigen(point.point)).norm(), 1e-12);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, scaled(100));
}

// Rays with min_t find what rays that start there find.
TEST(RayCrossings, min_t_equals_a_later_start) {
  Random random(74);
  QueryWorld world;
  fill(world, 60, 0.0, random);
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  std::vector<ShapeRay> rays;
  std::vector<SceneHit> singles;
  for (std::size_t r = 0; r < scaled(2000); ++r) {
    ShapeRay ray = random_ray(world, random);
    ray.min_t = random.log_uniform(0.1, 3.0);
    ray.max_t = kInfinity;
    ShapeRay later = ray;
    later.min_t = 0.0;
    for (int i = 0; i < 3; ++i) later.origin[i] += ray.min_t * ray.direction[i];
    const SceneHit hit = expect_ok(queries.closest(ray));
    const SceneHit same = expect_ok(queries.closest(later));
    ASSERT_EQ(hit.key, same.key) << r;
    ASSERT_EQ(expect_ok(queries.any(ray)).key.id == kNoObject, hit.key.id == kNoObject) << r;
    const auto all = expect_ok(queries.all(ray));
    ASSERT_EQ(all.empty(), !hit) << r;
    if (hit) {
      EXPECT_EQ(all[0].t, hit.t);
      EXPECT_GE(hit.t, ray.min_t);
      EXPECT_NEAR(hit.t, ray.min_t + same.t, 1e-7 * (1.0 + hit.t)) << r;
    }
    rays.push_back(ray);
    singles.push_back(hit);
  }
  std::vector<Key> keys(rays.size());
  std::vector<double> times(rays.size());
  ASSERT_EQ(queries.closest(ShapeRayBatch(rays), {.key = keys.data(), .t = times.data()}),
            Status::ok);
  for (std::size_t r = 0; r < rays.size(); ++r) {
    EXPECT_EQ(keys[r], singles[r].key) << r;
    EXPECT_EQ(times[r], singles[r] ? singles[r].t : kInfinity) << r;
  }
}

// A ray that continues behind each hit passes every layer of a mesh once.
TEST(RayCrossings, ray_behind_each_hit_finds_next_layer) {
  CompositeWorld world;
  Surface layers;
  constexpr std::uint32_t kLayers = 40;
  for (std::uint32_t i = 0; i < kLayers; ++i) {
    const float z = static_cast<float>(i);
    for (const auto& [x, y] :
         {std::pair(-4.0F, -3.0F), std::pair(4.0F, -3.0F), std::pair(0.0F, 5.0F)}) {
      layers.vertices.emplace_back(x, y, z);
      layers.corners.push_back(static_cast<std::uint32_t>(layers.corners.size()));
    }
  }
  const ShapeId mesh = add(world.composites, layers);
  Scene scene(world.shapes, {.composites = &world.composites});
  expect_ok(scene.add({.shape = mesh}));
  ASSERT_EQ(scene.refresh(), Status::ok);
  SceneQueries queries(scene);
  ShapeRay ray{.origin = {0.1, 0.2, -1.5}, .direction = {0, 0, 3}};
  std::uint32_t layer = 0;
  for (SceneHit hit = queries.closest(ray); hit; hit = queries.closest(ray)) {
    EXPECT_EQ(hit.part, layer);
    EXPECT_NEAR(hit.t, (layer + 1.5) / 3.0, 1e-12);
    ++layer;
    ray.min_t = hit.t * (1.0 + 1e-12);
  }
  EXPECT_EQ(layer, kLayers);
}

// `distances` gives what `distance` gives for a body with the same shape and pose.
TEST(ShapeDistances, equal_those_of_a_body) {
  std::size_t found = 0;
  for (const double center : kCenters) {
    Random random(75);
    QueryWorld world;
    fill(world, 60, center, random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const BodyDefinition& own = world.bodies[i];
      for (const double limit : {-0.1, 0.0, 0.7}) {
        std::vector<SceneDistance> expected;
        for (const Key other : world.keys) {
          if (other == world.keys[i]) continue;
          const SceneDistance to =
              expect_ok(queries.distance(world.keys[i], other, limit, PairRules::none));
          if (to) expected.push_back(to);
        }
        std::sort(expected.begin(), expected.end(), [](const auto& a, const auto& b) {
          return a.distance != b.distance ? a.distance < b.distance : a.key.id < b.key.id;
        });
        const auto all = expect_ok(queries.distances(own.shape, own.pose, limit));
        std::vector<SceneDistance> near(all.begin(), all.end());
        std::erase_if(near, [&](const SceneDistance& to) { return to.key == world.keys[i]; });
        ASSERT_EQ(near.size(), expected.size()) << i << ' ' << limit;
        for (std::size_t k = 0; k < near.size(); ++k) {
          EXPECT_EQ(near[k].key, expected[k].key);
          EXPECT_EQ(near[k].distance, expected[k].distance);
          EXPECT_EQ(near[k].normal, expected[k].normal);
          EXPECT_EQ(near[k].point_a, expected[k].point_a);
        }
        found += near.size();
      }
    }
  }
  EXPECT_GT(found, 500U);
}

TEST(ShapeDistances, input_out_of_range_is_refused) {
  ShapePool shapes;
  Scene scene(shapes);
  const ShapeId ball = expect_ok(shapes.add(SphereShape{1.0}));
  const Key key = expect_ok(scene.add({.shape = ball}));
  SceneQueries queries(scene);
  ASSERT_EQ(scene.move(key, Pose::at(0, 0, 1)), Status::ok);
  expect_error(queries.distances(ball, {}), Status::invalid_argument);  // not refreshed
  ASSERT_EQ(scene.refresh(), Status::ok);
  EXPECT_EQ(expect_ok(queries.distances(ball, {})).size(), 1U);
  expect_error(queries.distances(ShapeId::of(ShapeKind::box, 3), {}), Status::invalid_key);
  expect_error(queries.distances(ball, Pose::at(kInfinity, 0, 0)), Status::invalid_pose);
  expect_error(queries.distances(ball, {}, kInfinity), Status::invalid_argument);
  expect_error(queries.distances(ball, {}, std::nan("")), Status::invalid_argument);
  EXPECT_EQ(expect_ok(queries.distances(ball, {}, 0.0, {.mask = 0})).size(), 0U);
}

}  // namespace
}  // namespace winnow::test
