// Questions to the exact shapes of a scene, against every part of every body one by one.

#include <gtest/gtest.h>
#include <winnow/pipeline/scene_queries.h>
#include "pipeline/scene/queries/shape_cast.h"

#include <cstring>
#include <limits>
#include <thread>

#include "tests/pipeline/query_world.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kCenters[] = {0.0, 1e6, -1e8};

struct BodyTime {
  bool hit = false;
  double t = kInfinity;
};

void between(const double to[3], const double from[3], double result[3]) {
  for (int i = 0; i < 3; ++i) result[i] = to[i] - from[i];
}

/// When the ray meets each body.
std::vector<BodyTime> ray_times(const QueryWorld& world, const ShapeRay& ray) {
  std::vector<BodyTime> times(world.bodies.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    ShapeRay local = ray;
    between(ray.origin, world.bodies[i].pose.position, local.origin);
    for (const FlatPart& part : world.parts(i)) {
      const PartTable table(world.shapes.pool, part);
      ShapeHit hit;
      EXPECT_EQ(cast_ray(table.tables, table.id, part.pose, local, hit), Status::ok);
      if (hit.hit) times[i] = {true, std::min(times[i].t, hit.t)};
    }
  }
  return times;
}

/// When the moving shape meets each body.
std::vector<BodyTime> cast_times(const QueryWorld& world, const ShapeCast& cast) {
  std::vector<BodyTime> times(world.bodies.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (const FlatPart& part : world.parts(i)) {
      CastPair pair{cast.shape, cast.pose, {}, cast.max_t, part.shape, part.pose};
      between(cast.pose.position, world.bodies[i].pose.position, pair.from.position);
      std::copy_n(cast.direction, 3, pair.direction);
      TriangleShape both[2] = {part.triangle, part.triangle};
      ShapeTables tables = world.shapes.pool.tables();
      if (part.part != kWholeShape && part.shape.kind() == ShapeKind::triangle) {
        if (cast.shape.kind() == ShapeKind::triangle) {
          both[1] = tables.triangles[cast.shape.index()];
          pair.moving = ShapeId::of(ShapeKind::triangle, 1);
        }
        tables.triangles = both;
        pair.standing = ShapeId::of(ShapeKind::triangle, 0);
      }
      CastTouch touch;
      if (cast_shape(tables, pair, 1e-7, touch)) times[i] = {true, std::min(times[i].t, touch.t)};
    }
  }
  return times;
}

/// Times agree to `slack`; what is met within `slack` of not being met at all may go either way.
void expect_hits(const QueryWorld& world, const std::vector<BodyTime>& truth,
                 std::span<const SceneHit> hits, const SceneHit& closest, double max_t,
                 double slack) {
  std::vector<bool> found(truth.size(), false);
  double first = kInfinity;
  for (const BodyTime& time : truth) first = std::min(first, time.t);
  for (std::size_t k = 0; k < hits.size(); ++k) {
    const SceneHit& hit = hits[k];
    if (k > 0) {
      EXPECT_LE(hits[k - 1].t, hit.t);
    }
    const auto i = static_cast<std::size_t>(hit.data - 1000);
    ASSERT_LT(i, truth.size());
    EXPECT_EQ(hit.key, world.keys[i]);
    EXPECT_FALSE(found[i]);
    found[i] = true;
    ASSERT_TRUE(truth[i].hit) << "body " << i << " at " << hit.t;
    EXPECT_NEAR(hit.t, truth[i].t, slack);
    EXPECT_EQ(hit.part == kWholeShape, !world.bodies[i].shape.is_composite());
    EXPECT_NEAR(std::hypot(hit.normal[0], hit.normal[1], hit.normal[2]), 1.0, 1e-12);
  }
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i].hit && truth[i].t < max_t - slack) {
      EXPECT_TRUE(found[i]) << "body " << i;
    }
  }
  ASSERT_EQ(static_cast<bool>(closest), !hits.empty());
  if (hits.empty()) return;
  EXPECT_EQ(closest.key, hits[0].key);
  EXPECT_EQ(closest.t, hits[0].t);
  EXPECT_EQ(closest.part, hits[0].part);
  EXPECT_NEAR(closest.t, first, slack);
}

/// Any direction, some along an axis or in a plane of two.
void draw_direction(double length, Random& random, double direction[3]) {
  for (int i = 0; i < 3; ++i) direction[i] = length * random.uniform(-1.0, 1.0);
  if (random.chance(0.3)) direction[random.below(3)] = 0.0;
  if (random.chance(0.2)) direction[0] = direction[1] = 0.0;
  if (direction[0] == 0.0 && direction[1] == 0.0 && direction[2] == 0.0) direction[0] = -length;
}

double length_of(const double v[3]) {
  return std::hypot(v[0], v[1], v[2]);
}

TEST(SceneQueries, rays_meet_what_bodies_asked_one_by_one_say) {
  for (const double center : kCenters) {
    Random random(1);
    QueryWorld world;
    fill(world, 250, center, random);
    ShapeId ground;
    ASSERT_EQ(world.shapes.pool.add(HalfSpaceShape{{0.1, 0.0, 1.0}, -8.0}, ground), Status::ok);
    world.add(ground, {}, random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    for (std::size_t n = scaled(60); n-- != 0;) {
      ShapeRay ray;
      const double way = random.chance(0.2) ? 1e5 : 1.5 * world.size;
      draw_direction(random.log_uniform(1e-4, 1e4), random, ray.direction);
      const double back = random.chance(0.3) ? 0.0 : way / length_of(ray.direction);
      for (int i = 0; i < 3; ++i) {
        ray.origin[i] = center + random.uniform(-world.size, world.size) - back * ray.direction[i];
      }
      ray.max_t = random.chance(0.5) ? kInfinity : 1.5 * way / length_of(ray.direction);
      const std::vector<BodyTime> truth = ray_times(world, ray);
      SceneHit closest;
      SceneHit any;
      std::span<const SceneHit> hits;
      ASSERT_EQ(queries.closest(ray, closest), Status::ok);
      ASSERT_EQ(queries.any(ray, any), Status::ok);
      ASSERT_EQ(queries.all(ray, hits), Status::ok);
      // Positions are known to a rounding of their difference.
      const double slack =
          (1e-9 + 1e-15 * std::abs(center) + 1e-14 * way) / length_of(ray.direction);
      expect_hits(world, truth, hits, closest, ray.max_t, slack);
      ASSERT_EQ(static_cast<bool>(any), !hits.empty());
      if (any) {
        EXPECT_TRUE(truth[static_cast<std::size_t>(any.data - 1000)].hit);
      }
    }
  }
}

/// The signed distance of two bodies: of all pairs of their parts the least.
PairAnswer brute_distance(const QueryWorld& world, ShapeId a, const Pose& pose_a, std::size_t b) {
  double offset[3];
  between(world.bodies[b].pose.position, pose_a.position, offset);
  PairAnswer best;
  best.distance = kInfinity;
  const std::vector<FlatPart> parts_b = world.parts(b);
  for (const FlatPart& part_a : world.parts(a, pose_a)) {
    for (const FlatPart& part_b : parts_b) {
      const PairAnswer answer =
          solve_parts(world.shapes.pool, part_a, part_b, offset, ContactLevel::distance);
      if (answer.distance < best.distance) best = answer;
    }
  }
  return best;
}

TEST(SceneQueries, moving_shapes_meet_what_bodies_asked_one_by_one_say) {
  for (const double center : kCenters) {
    Random random(2);
    QueryWorld world;
    fill(world, 150, center, random);
    ShapeId point;
    ASSERT_EQ(world.shapes.pool.add(SphereShape{}, point), Status::ok);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    for (std::size_t n = scaled(24); n-- != 0;) {
      ShapeCast cast;
      cast.shape = world.shapes.shapes[random.below(150)];
      cast.pose = random_pose(world.size, random);
      for (double& x : cast.pose.position) x += center;
      draw_direction(random.log_uniform(1e-3, 1e3), random, cast.direction);
      cast.max_t = (random.chance(0.3) ? 1e4 : world.size) / length_of(cast.direction);
      SceneHit closest;
      std::span<const SceneHit> hits;
      ASSERT_EQ(queries.closest(cast, closest, {}, 1e-7), Status::ok);
      ASSERT_EQ(queries.all(cast, hits, {}, 1e-7), Status::ok);
      expect_hits(world, cast_times(world, cast), hits, hits.empty() ? closest : hits[0],
                  cast.max_t, 2e-7 / length_of(cast.direction));
      ASSERT_EQ(static_cast<bool>(closest), !hits.empty());
      if (!closest) continue;
      EXPECT_NEAR(closest.t, hits[0].t, 1e-7 / length_of(cast.direction));
      if (closest.t == 0.0) continue;
      // Normal and point are those of the body where it is met. On curved shapes that all but touch
      // the solver finds points to about 1e-8.
      double along = 0.0;
      for (int i = 0; i < 3; ++i) along += closest.normal[i] * cast.direction[i];
      EXPECT_LT(along, 1e-9 * length_of(cast.direction));
      const Pose at = Pose::at(closest.point[0], closest.point[1], closest.point[2]);
      const auto body = static_cast<std::size_t>(closest.data - 1000);
      EXPECT_NEAR(brute_distance(world, point, at, body).distance, 0.0,
                  1e-7 + 1e-15 * std::abs(center));
    }
  }
}

TEST(SceneQueries, a_shape_overlaps_what_bodies_asked_one_by_one_say) {
  for (const double center : kCenters) {
    Random random(3);
    QueryWorld world;
    fill(world, 60, center, random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    for (std::size_t n = 0; n < scaled(16); ++n) {
      // Composite ones, too.
      const ShapeId shape =
          world.bodies[n % 4 == 0 ? 60 + random.below(12) : random.below(60)].shape;
      Pose pose = random_pose(world.size, random);
      for (double& x : pose.position) x += center;
      std::span<const SceneOverlap> found;
      ASSERT_EQ(queries.overlap(shape, pose, found), Status::ok);
      std::size_t k = 0;
      for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        const double distance = brute_distance(world, shape, pose, i).distance;
        const bool listed = k < found.size() && found[k].key == world.keys[i];
        if (std::abs(distance) > 1e-12) {
          EXPECT_EQ(listed, distance < 0.0) << i << ' ' << distance;
        }
        if (!listed) continue;
        EXPECT_EQ(found[k].data, world.bodies[i].data);
        EXPECT_EQ(found[k].part == kWholeShape, !world.bodies[i].shape.is_composite());
        ++k;
      }
      EXPECT_EQ(k, found.size());
    }
  }
}

TEST(SceneQueries, what_touches_or_grazes_to_the_bit_is_met) {
  Random random(16);
  QueryWorld world;
  const std::vector<ShapeKind> kinds = all_kinds();
  for (std::size_t i = 0; i < 60; ++i) {
    add_pairs(world.shapes, kinds[random.below(kinds.size() - 1)],
              kinds[random.below(kinds.size() - 1)], PairStyle::lattice, 1, random);
  }
  const auto on_lattice = [&](double spread) {
    return 0.5 * std::floor(random.uniform(-2.0 * spread, 2.0 * spread));
  };
  for (std::size_t i = 0; i < world.shapes.shapes.size(); ++i) {
    Pose pose = world.shapes.poses[i];
    for (double& x : pose.position) x = on_lattice(6.0);
    world.add(world.shapes.shapes[i], pose, random);
  }
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  const ShapeTables& tables = world.shapes.pool.tables();
  for (std::size_t n = scaled(150); n-- != 0;) {
    ShapeRay ray;
    do {
      for (int i = 0; i < 3; ++i) {
        ray.origin[i] = on_lattice(9.0);
        ray.direction[i] = static_cast<double>(random.below(3)) - 1.0;
      }
    } while (length_of(ray.direction) == 0.0);
    ray.max_t = random.chance(0.5) ? kInfinity : static_cast<double>(random.below(20));
    std::span<const SceneHit> hits;
    ASSERT_EQ(queries.all(ray, hits), Status::ok);
    std::vector<const SceneHit*> by_body(world.bodies.size(), nullptr);
    for (const SceneHit& hit : hits) by_body[static_cast<std::size_t>(hit.data - 1000)] = &hit;
    const BodyDefinition& asking = world.bodies[random.below(world.bodies.size())];
    Pose pose = asking.pose;
    for (double& x : pose.position) x = on_lattice(6.0);
    std::span<const SceneOverlap> overlaps;
    ASSERT_EQ(queries.overlap(asking.shape, pose, overlaps), Status::ok);
    std::size_t k = 0;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const BodyDefinition& body = world.bodies[i];
      ShapeHit truth;
      ASSERT_EQ(cast_ray(tables, body.shape, body.pose, ray, truth), Status::ok);
      ASSERT_EQ(by_body[i] != nullptr, truth.hit) << i;
      if (truth.hit) {
        EXPECT_EQ(by_body[i]->t, truth.t);
      }
      SolverCounts counts;
      const bool overlap = solve_pair(tables, asking.shape, pose, body.shape, body.pose,
                                      ContactLevel::boolean, 0.0, counts)
                               .overlap;
      const bool listed = k < overlaps.size() && overlaps[k].key == world.keys[i];
      ASSERT_EQ(listed, overlap) << i;
      k += listed ? 1 : 0;
    }
    EXPECT_EQ(k, overlaps.size());
  }
}

TEST(SceneQueries, two_bodies_are_as_far_apart_as_their_closest_parts) {
  for (const double center : {0.0, 1e6}) {
    Random random(4);
    QueryWorld world;
    fill(world, 40, center, random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    for (std::size_t n = 0; n < scaled(40); ++n) {
      const std::size_t a = n % 2 == 0 ? 40 + random.below(12) : random.below(40);
      const std::size_t b = random.below(world.bodies.size());
      SceneDistance answer;
      ASSERT_EQ(queries.distance(world.keys[a], world.keys[b], answer), Status::ok);
      EXPECT_EQ(answer.key, world.keys[b]);
      const PairAnswer truth =
          brute_distance(world, world.bodies[a].shape, world.bodies[a].pose, b);
      ASSERT_NEAR(answer.distance, truth.distance, 1e-9) << a << ' ' << b;
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(answer.point_b[i] - answer.point_a[i], answer.distance * answer.normal[i],
                    1e-9 + 1e-15 * std::abs(center));
      }
    }
  }
}

TEST(SceneQueries, the_bodies_nearest_to_a_point_are_those_of_all_bodies) {
  for (const double center : kCenters) {
    Random random(5);
    QueryWorld world;
    fill(world, 200, center, random);
    world.add_to_scene();
    ShapeId point;
    ASSERT_EQ(world.shapes.pool.add(SphereShape{}, point), Status::ok);
    SceneQueries queries(*world.scene);
    for (std::size_t n = 0; n < scaled(20); ++n) {
      Pose at = random_pose(2.0 * world.size, random);
      for (double& x : at.position) x += center;
      const std::size_t count = n % 4 == 0 ? 1000 : random.below(9);
      const double radius = random.chance(0.5) ? kInfinity : random.uniform(0.0, world.size);
      std::vector<double> truth;
      for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        const double distance = brute_distance(world, point, at, i).distance;
        if (distance <= radius) truth.push_back(distance);
      }
      std::sort(truth.begin(), truth.end());
      std::span<const SceneDistance> found;
      ASSERT_EQ(queries.nearest(at.position, count, radius, found), Status::ok);
      ASSERT_EQ(found.size(), std::min(count, truth.size()));
      for (std::size_t k = 0; k < found.size(); ++k) {
        EXPECT_NEAR(found[k].distance, truth[k], 1e-9);
        if (k > 0) {
          EXPECT_LE(found[k - 1].distance, found[k].distance);
        }
      }
    }
  }
}

TEST(SceneQueries, the_closest_hit_is_found_without_asking_all_bodies_on_the_way) {
  QueryWorld world;
  ShapeId ball;
  ASSERT_EQ(world.shapes.pool.add(SphereShape{0.4}, ball), Status::ok);
  Random random(6);
  for (int i = 0; i < 16; ++i) {
    for (int j = 0; j < 16; ++j) {
      for (int k = 0; k < 16; ++k) world.add(ball, Pose::at(i, j, k), random);
    }
  }
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  std::size_t asked = 0;
  Filter filter;
  filter.predicate = {[](void* count, Key, ClientData) {
                        ++*static_cast<std::size_t*>(count);
                        return true;
                      },
                      &asked};
  const std::size_t rays = 1000;
  for (std::size_t n = 0; n < rays; ++n) {
    ShapeRay ray;
    ray.max_t = kInfinity;
    for (int i = 0; i < 3; ++i) {
      ray.origin[i] = random.uniform(-4.0, 20.0);
      ray.direction[i] = random.uniform(0.0, 16.0) - ray.origin[i];
    }
    SceneHit hit;
    ASSERT_EQ(queries.closest(ray, hit, filter), Status::ok);
  }
  EXPECT_LT(asked, 12 * rays);
}

TEST(SceneQueries, a_long_way_ends_at_a_body_smaller_than_the_rounding_of_its_direction) {
  Random random(15);
  QueryWorld world;
  ShapeId grain;
  ASSERT_EQ(world.shapes.pool.add(SphereShape{1e-4}, grain), Status::ok);
  for (int i = 0; i < 100; ++i) world.add(grain, random_pose(100.0, random), random);
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  for (std::size_t n = scaled(500); n-- != 0;) {
    const std::size_t target = random.below(world.bodies.size());
    ShapeRay ray;
    draw_direction(1.0, random, ray.direction);
    const double way = random.log_uniform(1e3, 1e6) / length_of(ray.direction);
    for (int i = 0; i < 3; ++i) {
      ray.origin[i] = world.bodies[target].pose.position[i] - way * ray.direction[i];
    }
    ray.max_t = random.chance(0.5) ? kInfinity : 1.5 * way;
    SceneHit hit;
    ASSERT_EQ(queries.closest(ray, hit), Status::ok);
    ASSERT_TRUE(hit) << n;
    EXPECT_LE(hit.t, way);
    ShapeCast cast{grain, {}, {}, ray.max_t};
    std::copy_n(ray.origin, 3, cast.pose.position);
    std::copy_n(ray.direction, 3, cast.direction);
    ASSERT_EQ(queries.closest(cast, hit), Status::ok);
    ASSERT_TRUE(hit) << n;
    EXPECT_LE(hit.t, way);
  }
}

TEST(SceneQueries, ways_without_end_reach_what_lies_at_the_end_of_the_world) {
  for (const double far : {1e3, 1e9, 1e20, 1e30, 1e36, 1e200}) {
    QueryWorld world;
    ShapeId ball;
    ShapeId wall;
    ASSERT_EQ(world.shapes.pool.add(SphereShape{0.01 * far}, ball), Status::ok);
    ASSERT_EQ(world.shapes.pool.add(HalfSpaceShape{{-1.0, 0.0, 0.0}, -3.0 * far}, wall),
              Status::ok);
    Random random(7);
    world.add(wall, {}, random);
    world.add(ball, Pose::at(far, 0.5 * far, 0.25 * far), random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    ShapeRay ray{{0.0, 0.0, 0.0}, {4.0, 2.0, 1.0}, kInfinity};
    SceneHit hit;
    std::span<const SceneHit> hits;
    ASSERT_EQ(queries.closest(ray, hit), Status::ok);
    EXPECT_EQ(hit.key, world.keys[1]) << far;
    EXPECT_NEAR(hit.t / far, 0.25 - 0.01 / std::sqrt(21.0), 1e-12);
    ASSERT_EQ(queries.all(ray, hits), Status::ok);
    EXPECT_EQ(hits.size(), 2U) << far;
    const ShapeCast cast{ball, {}, {4.0, 2.0, 1.0}, kInfinity};
    ASSERT_EQ(queries.closest(cast, hit, {}, 1e-9 * far), Status::ok);
    EXPECT_EQ(hit.key, world.keys[1]) << far;
    EXPECT_NEAR(hit.t / far, 0.25 - 0.02 / std::sqrt(21.0), 1e-8);
  }
}

TEST(SceneQueries, a_bullet_never_tunnels_a_sheet_of_triangles) {
  Random random(8);
  for (const double center : kCenters) {
    QueryWorld world;
    world.center = center;
    ShapeId bullet;
    ASSERT_EQ(world.shapes.pool.add(SphereShape{1e-3}, bullet), Status::ok);
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
      SceneHit hit;
      ASSERT_EQ(queries.closest(cast, hit), Status::ok);
      ASSERT_TRUE(hit) << n;
      // The sheet is within 0.2 of its plane.
      EXPECT_NEAR(hit.t * speed, way, 0.21);
      EXPECT_GT(hit.normal[2], 0.0);
    }
  }
}

TEST(SceneQueries, a_turned_mesh_lets_no_ray_through_its_edges_and_corners) {
  Random random(14);
  QueryWorld world;
  constexpr std::uint32_t kCells = 40;
  const ShapeId sheet = add_sheet(world.composites, kCells);
  ShapeId large;
  ASSERT_EQ(world.composites.add_scaled(sheet, {100.0, 50.0, 30.0}, large), Status::ok);
  world.add(large, random_pose(10.0, random), random);
  ShapeId point;
  ASSERT_EQ(world.shapes.pool.add(SphereShape{}, point), Status::ok);
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  const std::vector<FlatPart> parts = world.parts(0);
  const double* const base = world.bodies[0].pose.position;
  for (std::size_t n = scaled(2000); n-- != 0;) {
    // Not those at the border.
    const std::size_t i = 1 + random.below(kCells - 2);
    const std::size_t cell = i * kCells + 1 + random.below(kCells - 2);
    const auto inner = std::find_if(parts.begin(), parts.end(),
                                    [&](const FlatPart& part) { return part.part == 2 * cell; });
    ASSERT_NE(inner, parts.end());
    const std::size_t corner = random.below(3);
    const double along = random.chance(0.5) ? 0.0 : random.unit();
    ShapeRay ray;
    draw_direction(1.0, random, ray.direction);
    for (int k = 0; k < 3; ++k) {
      const double from = inner->triangle.vertex[corner][k];
      const double to = inner->triangle.vertex[(corner + 1) % 3][k];
      ray.origin[k] =
          base[k] + inner->pose.position[k] + from + along * (to - from) - 4.0 * ray.direction[k];
    }
    ray.max_t = kInfinity;
    SceneHit hit;
    ASSERT_EQ(queries.closest(ray, hit), Status::ok);
    ASSERT_TRUE(hit) << n;
    EXPECT_LT(hit.t, 4.0 + 1e-6);
    ShapeCast cast{point, {}, {}, kInfinity};
    std::copy_n(ray.origin, 3, cast.pose.position);
    std::copy_n(ray.direction, 3, cast.direction);
    ASSERT_EQ(queries.closest(cast, hit), Status::ok);
    ASSERT_TRUE(hit) << n;
    EXPECT_LT(hit.t, 4.0 + 1e-6);
  }
}

TEST(SceneQueries, filters_and_predicates_choose_among_bodies) {
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
  Filter filter;
  filter.mask = 0b101;
  filter.predicate = {[](void* given, Key key, ClientData data) {
                        auto& c = *static_cast<Context*>(given);
                        c.right = c.right && c.world.keys[data - 1000] == key;
                        return data % 2 == 0;
                      },
                      &context};
  const auto wanted = [](ClientData data) { return (data - 1000) % 3 != 1 && data % 2 == 0; };
  const auto expect_chosen = [&](const auto& chosen, const auto& everything) {
    std::size_t k = 0;
    for (const auto& one : everything) {
      if (!wanted(one.data)) continue;
      ASSERT_LT(k, chosen.size());
      EXPECT_EQ(chosen[k++].key, one.key);
    }
    EXPECT_EQ(k, chosen.size());
  };
  const auto copy = [](const auto& span) { return std::vector(span.begin(), span.end()); };
  const double origin[3] = {0.0, 0.0, 0.0};
  for (int n = 0; n < 10; ++n) {
    ShapeRay ray;
    draw_direction(1.0, random, ray.direction);
    ray.max_t = kInfinity;
    std::span<const SceneHit> hits;
    ASSERT_EQ(queries.all(ray, hits), Status::ok);
    const auto every_hit = copy(hits);
    ASSERT_EQ(queries.all(ray, hits, filter), Status::ok);
    expect_chosen(hits, every_hit);
    std::span<const SceneOverlap> overlaps;
    const ShapeId sheet = world.bodies[120].shape;
    const Pose pose = random_pose(1.0, random);
    ASSERT_EQ(queries.overlap(sheet, pose, overlaps), Status::ok);
    const auto every_overlap = copy(overlaps);
    ASSERT_EQ(queries.overlap(sheet, pose, overlaps, filter), Status::ok);
    expect_chosen(overlaps, every_overlap);
    std::span<const SceneDistance> near;
    ASSERT_EQ(queries.nearest(origin, 1000, 4.0, near), Status::ok);
    const auto every_near = copy(near);
    ASSERT_EQ(queries.nearest(origin, 1000, 4.0, near, filter), Status::ok);
    expect_chosen(near, every_near);
  }
  EXPECT_TRUE(context.right);
}

TEST(SceneQueries, bad_questions_get_a_status_and_change_nothing) {
  Random random(10);
  QueryWorld world;
  fill(world, 30, 0.0, random);
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  SceneHit hit;
  hit.t = -7.0;
  const double nan = std::nan("");
  for (const ShapeRay& ray :
       {ShapeRay{{nan, 0, 0}, {1, 0, 0}, 1.0}, ShapeRay{{0, 0, 0}, {0, 0, 0}, 1.0},
        ShapeRay{{0, 0, 0}, {1, kInfinity, 0}, 1.0}, ShapeRay{{0, 0, 0}, {1, 0, 0}, -1.0},
        ShapeRay{{0, 0, 0}, {1, 0, 0}, nan}}) {
    EXPECT_EQ(queries.closest(ray, hit), Status::invalid_argument);
    EXPECT_EQ(queries.any(ray, hit), Status::invalid_argument);
  }
  const ShapeCast good{world.shapes.shapes[0], {}};
  ShapeCast cast = good;
  cast.shape = {};
  EXPECT_EQ(queries.closest(cast, hit), Status::invalid_key);
  cast.shape = world.bodies.back().shape;
  EXPECT_EQ(queries.closest(cast, hit), Status::unsupported);
  cast = good;
  cast.pose.orientation[0] = 0.0;
  EXPECT_EQ(queries.closest(cast, hit), Status::invalid_pose);
  cast = good;
  cast.direction[1] = nan;
  EXPECT_EQ(queries.closest(cast, hit), Status::invalid_argument);
  EXPECT_EQ(queries.closest(good, hit, {}, -1.0), Status::invalid_argument);
  EXPECT_EQ(queries.closest(good, hit, {}, nan), Status::invalid_argument);
  EXPECT_EQ(hit.t, -7.0);
  std::span<const SceneOverlap> overlaps;
  EXPECT_EQ(queries.overlap(ShapeId{}, {}, overlaps), Status::invalid_key);
  EXPECT_EQ(queries.overlap(good.shape, Pose::at(nan, 0, 0), overlaps), Status::invalid_pose);
  SceneDistance distance;
  EXPECT_EQ(queries.distance(world.keys[0], {}, distance), Status::invalid_key);
  std::span<const SceneDistance> near;
  const double nowhere[3] = {0.0, nan, 0.0};
  const double origin[3] = {0.0, 0.0, 0.0};
  EXPECT_EQ(queries.nearest(nowhere, 1, 1.0, near), Status::invalid_argument);
  EXPECT_EQ(queries.nearest(origin, 1, -1.0, near), Status::invalid_argument);
  ASSERT_EQ(world.scene->move(world.keys[0], Pose::at(1, 2, 3)), Status::ok);
  EXPECT_EQ(queries.closest(ShapeRay{}, hit), Status::invalid_argument);
  ASSERT_EQ(world.scene->refresh(), Status::ok);
  EXPECT_EQ(queries.closest(ShapeRay{}, hit), Status::ok);
  // As after a change of poses, so after one of composite shapes.
  ASSERT_EQ(world.composites.remove(add_sheet(world.composites, 2)), Status::ok);
  EXPECT_EQ(queries.closest(ShapeRay{}, hit), Status::invalid_argument);
  ASSERT_EQ(world.scene->refresh(), Status::ok);
  EXPECT_EQ(queries.closest(ShapeRay{}, hit), Status::ok);
}

/// A number for all answers to many questions.
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
    draw_direction(1.0, random, cast.direction);
    cast.max_t = kInfinity;
    ShapeRay ray;
    ray.max_t = kInfinity;
    std::copy_n(cast.pose.position, 3, ray.origin);
    std::copy_n(cast.direction, 3, ray.direction);
    SceneHit hit;
    std::span<const SceneHit> hits;
    EXPECT_EQ(queries.closest(ray, hit), Status::ok);
    mix_hit(hit);
    EXPECT_EQ(queries.closest(cast, hit), Status::ok);
    mix_hit(hit);
    EXPECT_EQ(queries.all(ray, hits), Status::ok);
    for (const SceneHit& one : hits) mix_hit(one);
    std::span<const SceneOverlap> overlaps;
    EXPECT_EQ(queries.overlap(world.bodies[100].shape, cast.pose, overlaps), Status::ok);
    for (const SceneOverlap& one : overlaps) mix(one.key.id), mix(one.part);
    std::span<const SceneDistance> near;
    EXPECT_EQ(queries.nearest(ray.origin, 7, 10.0, near), Status::ok);
    for (const SceneDistance& one : near) mix(one.key.id), mix(one.part), mix(one.distance);
  }
  return sum;
}

TEST(SceneQueries, answer_the_same_on_every_instruction_set_and_from_many_threads) {
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
}

TEST(SceneQueries, know_their_memory_to_the_byte_and_ask_for_none_twice) {
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
  SceneHit hit;
  EXPECT_EQ(refused.closest(ShapeRay{}, hit), Status::out_of_memory);
  memory.grant_all();
  SceneQueries poor(*world.scene, &memory);
  memory.refuse_after(0);
  const double origin[3] = {0.0, 0.0, 0.0};
  std::span<const SceneDistance> near;
  EXPECT_EQ(poor.nearest(origin, 7, kInfinity, near), Status::out_of_memory);
  memory.grant_all();
  EXPECT_EQ(poor.nearest(origin, 7, kInfinity, near), Status::ok);
  EXPECT_EQ(near.size(), 7U);
}

}  // namespace
}  // namespace winnow::test
