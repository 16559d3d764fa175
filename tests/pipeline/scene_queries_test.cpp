// Queries of the exact shapes of a scene, compared with tests of every primitive of every body.

#include <gtest/gtest.h>
#include <winnow/pipeline/scene_queries.h>
#include "pipeline/composites/shape_cast.h"

#include "tests/pipeline/query_world.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"

namespace winnow::test {
namespace {

TEST(SceneQueries, rays_hit_half_space_beyond_float_range) {
  Random random(23);
  QueryWorld world;
  ShapeId ground = expect_ok(world.shapes.pool.add(HalfSpaceShape{{0.0, 0.0, 1.0}, 0.0}));
  world.add(ground, Pose{}, random);
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  const ShapeRay rays[] = {{{0, 0, 1e39}, {0, 0, -1}, 0.0, 1e40},
                           {{1e39, -1e39, 5}, {0, 0, -1}, 0.0, 100.0},
                           {{-1e200, 0, 5}, {1, 0, -1e-200}},
                           {{0, 0, 1e300}, {0, 1, -1}}};
  for (const ShapeRay& ray : rays) {
    SceneHit hit;
    std::span<const SceneHit> all;
    hit = expect_ok(queries.closest(ray));
    all = expect_ok(queries.all(ray));
    ASSERT_EQ(all.size(), 1U) << ray.origin[2];
    EXPECT_EQ(hit.key, world.keys[0]);
    EXPECT_EQ(hit.t, all[0].t);
    EXPECT_DOUBLE_EQ(hit.t, ray.origin[2] / -ray.direction[2]);
  }
}

/// Returns zero, plus or minus one, or a number of any magnitude up to `most`.
double any_number(double most, Random& random) {
  const double sign = random.chance(0.5) ? 1.0 : -1.0;
  const std::size_t which = random.below(8);
  if (which < 2) return which == 0 ? 0.0 : sign;
  return sign * random.log_uniform(1.0 / most, most);
}

/// Adds a few bodies with random shapes and numbers of any magnitude.
void add_any_bodies(QueryWorld& world, double most, Random& random) {
  const auto size = [&] { return std::abs(any_number(most, random)); };
  std::vector<ShapeId> ids(7);
  ids[0] = expect_ok(world.shapes.pool.add(SphereShape{size()}));
  ids[1] = expect_ok(world.shapes.pool.add(BoxShape{{size(), size(), size()}}));
  ids[2] = expect_ok(world.shapes.pool.add(CylinderShape{size(), size()}));
  ids[3] = expect_ok(world.shapes.pool.add(ConeShape{size(), size()}));
  std::vector<Vec3d> points(8);
  std::vector<Vec3f> vertices(9);
  std::vector<std::uint32_t> corners(24);
  for (Vec3d& p : points) {
    for (int k = 0; k < 3; ++k) p[k] = any_number(most, random);
  }
  for (Vec3f& p : vertices) {
    for (int k = 0; k < 3; ++k) p[k] = static_cast<float>(any_number(most, random));
  }
  for (std::uint32_t& corner : corners) corner = static_cast<std::uint32_t>(random.below(9));
  ids[4] = expect_ok(world.shapes.pool.add_hull(points, 0.0));
  if (world.composites
          .add_mesh(std::span(std::as_const(vertices)), std::span(std::as_const(corners)))
          .get(ids[5]) != Status::ok) {
    ids[5] = ids[0];
  }
  ids[6] = ids[5];
  for (std::size_t i = 2 + random.below(8); i > 0; --i) {
    world.add(
        ids[random.below(ids.size())],
        Pose::at(any_number(most, random), any_number(most, random), any_number(most, random)),
        random);
  }
}

TEST(SceneQueries, closest_hit_of_any_sizes_matches_first) {
  Random random(19);
  for (const double most : {1e3, 1e6, 1e9}) {
    std::size_t hit_something = 0;
    for (std::size_t i = 0; i < scaled(2000); ++i) {
      QueryWorld world;
      add_any_bodies(world, most, random);
      world.add_to_scene({.execution = Execution::serial()});
      SceneQueries queries(*world.scene);
      for (int r = 0; r < 30; ++r) {
        ShapeRay ray;
        for (double& x : ray.origin) x = any_number(most, random);
        for (double& x : ray.direction) x = any_number(most, random);
        ray.max_t = 10.0 * std::abs(any_number(most, random));
        SceneHit closest;
        std::span<const SceneHit> all;
        const Status status = queries.closest(ray).get(closest);
        ASSERT_EQ(queries.all(ray).get(all), status);
        if (status != Status::ok) continue;
        ASSERT_EQ(static_cast<bool>(closest), !all.empty()) << i << ' ' << r << ' ' << most;
        if (!closest) continue;
        ++hit_something;
        ASSERT_EQ(closest.t, all[0].t) << i << ' ' << r << ' ' << most;
        ASSERT_EQ(closest.key, all[0].key) << i << ' ' << r << ' ' << most;
        ASSERT_EQ(closest.part, all[0].part) << i << ' ' << r << ' ' << most;
      }
    }
    EXPECT_GT(hit_something, scaled(1000));
  }
}

TEST(SceneQueries, two_balls_in_a_row_give_expected_results) {
  Random random(17);
  QueryWorld world;
  ShapeId ball = expect_ok(world.shapes.pool.add(SphereShape{1.0}));
  world.add(ball, Pose::at(10, 0, 0), random);
  world.add(ball, Pose::at(20, 0, 0), random);
  world.add_to_scene();
  SceneQueries queries(*world.scene);

  SceneHit hit;
  std::span<const SceneHit> hits;
  const ShapeRay ray{.direction = {1, 0, 0}};
  hit = expect_ok(queries.closest(ray));
  EXPECT_EQ(hit.key, world.keys[0]);
  EXPECT_DOUBLE_EQ(hit.t, 9.0);
  EXPECT_DOUBLE_EQ(hit.normal[0], -1.0);
  hits = expect_ok(queries.all(ray));
  ASSERT_EQ(hits.size(), 2U);
  EXPECT_DOUBLE_EQ(hits[1].t, 19.0);

  hit = expect_ok(queries.closest(ShapeCast{ball, {}, {1, 0, 0}, kInfinity}, {}, 1e-9));
  EXPECT_NEAR(hit.t, 8.0, 1e-8);

  std::span<const SceneOverlap> overlaps = expect_ok(queries.overlap(ball, Pose::at(18.5, 0, 0)));
  ASSERT_EQ(overlaps.size(), 1U);
  EXPECT_EQ(overlaps[0].key, world.keys[1]);

  SceneDistance apart =
      expect_ok(queries.distance(world.keys[0], world.keys[1], kInfinity, PairRules::none));
  EXPECT_DOUBLE_EQ(apart.distance, 8.0);

  const double origin[3] = {0, 0, 0};
  std::span<const SceneDistance> near = expect_ok(queries.nearest(origin, 1, kInfinity));
  ASSERT_EQ(near.size(), 1U);
  EXPECT_EQ(near[0].key, world.keys[0]);
  EXPECT_DOUBLE_EQ(near[0].distance, 9.0);
}

struct BodyTime {
  bool hit = false;
  double t = kInfinity;
};

void between(const double to[3], const double from[3], double result[3]) {
  for (int i = 0; i < 3; ++i) result[i] = to[i] - from[i];
}

/// Returns the time of the ray's hit for each body.
std::vector<BodyTime> ray_times(const QueryWorld& world, const ShapeRay& ray) {
  std::vector<BodyTime> times(world.bodies.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    ShapeRay local = ray;
    between(ray.origin.data(), world.bodies[i].pose.position.data(), local.origin.data());
    for (const FlatPart& part : world.parts(i)) {
      const PartTable table(world.shapes.pool, part);
      ShapeHit hit = expect_ok(cast_ray(table.tables, table.id, part.pose, local));
      if (hit.hit) times[i] = {true, std::min(times[i].t, hit.t)};
    }
  }
  return times;
}

/// Returns the time of impact of a moving and a stationary primitive. `from` is the position of the
/// cast relative to the stationary body.
double part_time(const ShapePool& pool, const ShapeCast& cast, const double from[3],
                 const FlatPart& moving, const FlatPart& stationary) {
  CastPair pair{moving.shape, moving.pose, {}, cast.max_t, stationary.shape, stationary.pose};
  for (int i = 0; i < 3; ++i) pair.from.position[i] += from[i];
  pair.direction = cast.direction;
  TriangleShape both[2];
  ShapeTables tables = pool.tables();
  tables.triangles = both;
  const auto put = [&](std::uint32_t slot, const FlatPart& part, ShapeId& id) {
    if (id.kind() != ShapeKind::triangle) return;
    both[slot] = part.part != kWholeShape ? part.triangle : pool.tables().triangles[id.index()];
    id = ShapeId::of(ShapeKind::triangle, slot);
  };
  put(0, moving, pair.moving);
  put(1, stationary, pair.stationary);
  CastTouch touch;
  return cast_shape(tables, pair, 1e-7, touch) ? touch.t : kInfinity;
}

/// Returns the time of impact of the cast for each body.
std::vector<BodyTime> cast_times(const QueryWorld& world, const ShapeCast& cast) {
  std::vector<BodyTime> times(world.bodies.size());
  const std::vector<FlatPart> own = world.parts(cast.shape, cast.pose);
  for (std::size_t i = 0; i < times.size(); ++i) {
    double from[3];
    between(cast.pose.position.data(), world.bodies[i].pose.position.data(), from);
    for (const FlatPart& stationary : world.parts(i)) {
      for (const FlatPart& moving : own) {
        const double t = part_time(world.shapes.pool, cast, from, moving, stationary);
        times[i].t = std::min(times[i].t, t);
      }
    }
    times[i].hit = times[i].t < kInfinity;
  }
  return times;
}

/// Checks that times agree to `slack`. Hits within `slack` of max_t may be found or missed.
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

TEST(SceneQueries, rays_match_brute_force) {
  for (const double center : kCenters) {
    Random random(1);
    QueryWorld world;
    fill(world, 250, center, random);
    ShapeId ground = expect_ok(world.shapes.pool.add(HalfSpaceShape{{0.1, 0.0, 1.0}, -8.0}));
    world.add(ground, {}, random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    for (std::size_t n = scaled(60); n-- != 0;) {
      ShapeRay ray;
      const double way = random.chance(0.2) ? 1e5 : 1.5 * world.size;
      draw_direction(random.log_uniform(1e-4, 1e4), random, ray.direction.data());
      const double back = random.chance(0.3) ? 0.0 : way / length_of(ray.direction.data());
      for (int i = 0; i < 3; ++i) {
        ray.origin[i] = center + random.uniform(-world.size, world.size) - back * ray.direction[i];
      }
      ray.max_t = random.chance(0.5) ? kInfinity : 1.5 * way / length_of(ray.direction.data());
      const std::vector<BodyTime> truth = ray_times(world, ray);
      SceneHit closest;
      SceneHit any;
      std::span<const SceneHit> hits;
      closest = expect_ok(queries.closest(ray));
      any = expect_ok(queries.any(ray));
      hits = expect_ok(queries.all(ray));
      // Positions are exact up to the rounding of their difference.
      const double slack =
          (1e-9 + 1e-15 * std::abs(center) + 1e-14 * way) / length_of(ray.direction.data());
      expect_hits(world, truth, hits, closest, ray.max_t, slack);
      ASSERT_EQ(static_cast<bool>(any), !hits.empty());
      if (any) {
        EXPECT_TRUE(truth[static_cast<std::size_t>(any.data - 1000)].hit);
      }
    }
  }
}

TEST(SceneQueries, ray_batch_matches_single_rays) {
  Random random(7);
  QueryWorld world;
  fill(world, 100, 0.0, random);
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  std::vector<ShapeRay> rays(scaled(100));
  for (ShapeRay& ray : rays) {
    draw_direction(1.0, random, ray.direction.data());
    for (double& x : ray.origin) x = random.uniform(-world.size, world.size);
    ray.max_t = world.size;
  }
  std::vector<Key> keys(rays.size());
  std::vector<ClientData> data(rays.size());
  std::vector<std::uint32_t> parts(rays.size());
  std::vector<double> times(rays.size());
  std::vector<double> heights(rays.size());
  const SceneHitColumns columns{.key = keys.data(),
                                .data = data.data(),
                                .part = parts.data(),
                                .t = times.data(),
                                .normal = {},
                                .point = {nullptr, nullptr, heights.data()}};
  ASSERT_EQ(queries.closest(std::span<const ShapeRay>(rays), columns), Status::ok);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    SceneHit hit = expect_ok(queries.closest(rays[i]));
    EXPECT_EQ(keys[i], hit.key);
    EXPECT_EQ(data[i], hit.data);
    EXPECT_EQ(parts[i], hit.part);
    EXPECT_EQ(times[i], hit ? hit.t : kInfinity);
    EXPECT_EQ(heights[i], hit.point[2]);
  }
  ASSERT_EQ(queries.any(std::span<const ShapeRay>(rays), {.key = keys.data()}), Status::ok);
  SceneHitLists lists = expect_ok(queries.all(std::span<const ShapeRay>(rays)));
  ASSERT_EQ(lists.first.size(), rays.size() + 1);
  const std::vector<SceneHit> hits(lists.hits.begin(), lists.hits.end());
  const std::vector<std::size_t> first(lists.first.begin(), lists.first.end());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(keys[i].id != kNoObject, times[i] < kInfinity);
    std::span<const SceneHit> single = expect_ok(queries.all(rays[i]));
    ASSERT_EQ(single.size(), first[i + 1] - first[i]);
    for (std::size_t k = 0; k < single.size(); ++k) {
      EXPECT_EQ(hits[first[i] + k].key, single[k].key);
      EXPECT_EQ(hits[first[i] + k].t, single[k].t);
    }
  }
  rays.back().direction[0] = std::nan("");
  keys[0] = Key{};
  EXPECT_EQ(queries.closest(std::span<const ShapeRay>(rays), {.key = keys.data()}),
            Status::invalid_argument);
  EXPECT_EQ(keys[0], Key{}) << "a refused batch writes nothing";
}

/// Returns the signed distance of two bodies: the least over all pairs of their primitives.
PairAnswer brute_distance(const QueryWorld& world, ShapeId a, const Pose& pose_a, std::size_t b) {
  double offset[3];
  between(world.bodies[b].pose.position.data(), pose_a.position.data(), offset);
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

/// Checks casts of convex or of composite shapes.
void expect_casts_hit(bool composite, std::size_t casts) {
  for (const double center : kCenters) {
    Random random(2);
    QueryWorld world;
    fill(world, 150, center, random);
    ShapeId point = expect_ok(world.shapes.pool.add(SphereShape{}));
    ShapeId ground = expect_ok(world.shapes.pool.add(HalfSpaceShape{{0.1, 0.0, 1.0}, -8.0}));
    if (composite) world.add(ground, {}, random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    for (std::size_t n = scaled(casts); n-- != 0;) {
      ShapeCast cast;
      cast.shape = composite ? world.bodies[150 + random.below(12)].shape
                             : world.shapes.shapes[random.below(150)];
      cast.pose = random_pose(world.size, random);
      for (double& x : cast.pose.position) x += center;
      draw_direction(random.log_uniform(1e-3, 1e3), random, cast.direction.data());
      cast.max_t = (random.chance(0.3) ? 1e4 : world.size) / length_of(cast.direction.data());
      SceneHit closest;
      std::span<const SceneHit> hits;
      closest = expect_ok(queries.closest(cast, {}, 1e-7));
      hits = expect_ok(queries.all(cast, {}, 1e-7));
      expect_hits(world, cast_times(world, cast), hits, hits.empty() ? closest : hits[0],
                  cast.max_t, 2e-7 / length_of(cast.direction.data()));
      ASSERT_EQ(static_cast<bool>(closest), !hits.empty());
      if (!closest) continue;
      EXPECT_NEAR(closest.t, hits[0].t, 1e-7 / length_of(cast.direction.data()));
      if (closest.t == 0.0) continue;
      // Normal and point belong to the body that was hit. On curved shapes that nearly touch, the
      // solver finds points to about 1e-8.
      double along = 0.0;
      for (int i = 0; i < 3; ++i) along += closest.normal[i] * cast.direction[i];
      EXPECT_LT(along, 1e-9 * length_of(cast.direction.data()));
      const Pose at = Pose::at(closest.point[0], closest.point[1], closest.point[2]);
      const auto body = static_cast<std::size_t>(closest.data - 1000);
      EXPECT_NEAR(brute_distance(world, point, at, body).distance, 0.0,
                  1e-7 + 1e-15 * std::abs(center));
    }
  }
}

TEST(SceneQueries, convex_casts_match_brute_force) {
  expect_casts_hit(false, 24);
}

TEST(SceneQueries, composite_casts_match_brute_force) {
  expect_casts_hit(true, 6);
}

TEST(SceneQueries, overlaps_match_brute_force) {
  for (const double center : kCenters) {
    Random random(3);
    QueryWorld world;
    fill(world, 60, center, random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    for (std::size_t n = 0; n < scaled(16); ++n) {
      // Every fourth shape is composite.
      const ShapeId shape =
          world.bodies[n % 4 == 0 ? 60 + random.below(12) : random.below(60)].shape;
      Pose pose = random_pose(world.size, random);
      for (double& x : pose.position) x += center;
      std::span<const SceneOverlap> found = expect_ok(queries.overlap(shape, pose));
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

TEST(SceneQueries, exact_touches_are_found) {
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
    } while (length_of(ray.direction.data()) == 0.0);
    ray.max_t = random.chance(0.5) ? kInfinity : static_cast<double>(random.below(20));
    std::span<const SceneHit> hits = expect_ok(queries.all(ray));
    std::vector<const SceneHit*> by_body(world.bodies.size(), nullptr);
    for (const SceneHit& hit : hits) by_body[static_cast<std::size_t>(hit.data - 1000)] = &hit;
    const BodyDefinition& queried = world.bodies[random.below(world.bodies.size())];
    Pose pose = queried.pose;
    for (double& x : pose.position) x = on_lattice(6.0);
    std::span<const SceneOverlap> overlaps = expect_ok(queries.overlap(queried.shape, pose));
    std::size_t k = 0;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const BodyDefinition& body = world.bodies[i];
      ShapeHit truth = expect_ok(cast_ray(tables, body.shape, body.pose, ray));
      ASSERT_EQ(by_body[i] != nullptr, truth.hit) << i;
      if (truth.hit) {
        EXPECT_EQ(by_body[i]->t, truth.t);
      }
      SolverCounts counts;
      const bool overlap = solve_pair(tables, queried.shape, pose, body.shape, body.pose,
                                      ContactLevel::boolean, 0.0, counts)
                               .overlap;
      const bool listed = k < overlaps.size() && overlaps[k].key == world.keys[i];
      ASSERT_EQ(listed, overlap) << i;
      k += listed ? 1 : 0;
    }
    EXPECT_EQ(k, overlaps.size());
  }
}

TEST(SceneQueries, distance_matches_closest_parts) {
  for (const double center : {0.0, 1e6}) {
    Random random(4);
    QueryWorld world;
    fill(world, 40, center, random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    for (std::size_t n = 0; n < scaled(40); ++n) {
      const std::size_t a = n % 2 == 0 ? 40 + random.below(12) : random.below(40);
      const std::size_t b = random.below(world.bodies.size());
      SceneDistance answer =
          expect_ok(queries.distance(world.keys[a], world.keys[b], kInfinity, PairRules::none));
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

TEST(SceneQueries, distance_beyond_limit_is_empty) {
  Random random(6);
  QueryWorld world;
  fill(world, 40, 0.0, random);
  world.add_to_scene();
  SceneQueries queries(*world.scene);
  for (std::size_t n = 0; n < scaled(40); ++n) {
    const std::size_t a = n % 2 == 0 ? 40 + random.below(12) : random.below(40);
    const std::size_t b = random.below(world.bodies.size());
    SceneDistance free;
    SceneDistance limited;
    free = expect_ok(queries.distance(world.keys[a], world.keys[b], kInfinity, PairRules::none));
    const double slack = 1e-9 + 0.01 * std::abs(free.distance);
    limited = expect_ok(
        queries.distance(world.keys[a], world.keys[b], free.distance + slack, PairRules::none));
    EXPECT_EQ(limited.key, world.keys[b]);
    EXPECT_NEAR(limited.distance, free.distance, 1e-12);
    limited = expect_ok(
        queries.distance(world.keys[a], world.keys[b], free.distance - slack, PairRules::none));
    EXPECT_FALSE(limited);
  }
  SceneDistance answer;
  expect_error(queries.distance(world.keys[0], world.keys[1], std::nan("")),
               Status::invalid_argument);
}

TEST(SceneQueries, set_queries_match_pairs_of_bodies) {
  for (const double center : {0.0, 1e6}) {
    Random random(7);
    QueryWorld world;
    fill(world, 60, center, random);
    world.add_to_scene();
    SceneQueries queries(*world.scene);
    for (std::size_t n = 0; n < scaled(30); ++n) {
      std::vector<Key> sets[2];
      for (std::vector<Key>& set : sets) {
        for (std::size_t i = random.below(8); i-- != 0;) {
          set.push_back(world.keys[random.below(world.keys.size())]);
        }
      }
      double least = kInfinity;
      std::vector<KeyPair> overlapping;
      for (const Key a : sets[0]) {
        for (const Key b : sets[1]) {
          if (a == b) continue;
          SceneDistance pair = expect_ok(queries.distance(a, b, kInfinity, PairRules::none));
          least = std::min(least, pair.distance);
          if (pair.distance <= 0.0) overlapping.push_back({a, b});
        }
      }
      std::span<const KeyPair> found =
          expect_ok(queries.overlaps(sets[0], sets[1], ~std::size_t{0}, PairRules::none));
      EXPECT_TRUE(std::ranges::equal(found, overlapping));
      found = expect_ok(queries.overlaps(sets[0], sets[1], 1, PairRules::none));
      EXPECT_EQ(found.size(), std::min<std::size_t>(overlapping.size(), 1));
      SetDistance answer =
          expect_ok(queries.least_distance(sets[0], sets[1], kInfinity, PairRules::none));
      ASSERT_EQ(static_cast<bool>(answer), least < kInfinity);
      if (!answer) continue;
      EXPECT_NEAR(answer.to.distance, least, 1e-9);
      SceneDistance own =
          expect_ok(queries.distance(answer.a, answer.to.key, kInfinity, PairRules::none));
      EXPECT_NEAR(own.distance, least, 1e-9);
      BodyDefinition body = expect_ok(world.scene->body(answer.a));
      EXPECT_EQ(answer.data_a, body.data);
      answer = expect_ok(queries.least_distance(sets[0], sets[1], least - 1e-6, PairRules::none));
      EXPECT_FALSE(answer);
    }
  }
}

TEST(SceneQueries, nearest_bodies_match_brute_force) {
  for (const double center : kCenters) {
    Random random(5);
    QueryWorld world;
    fill(world, 200, center, random);
    world.add_to_scene();
    ShapeId point = expect_ok(world.shapes.pool.add(SphereShape{}));
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
      std::span<const SceneDistance> found = expect_ok(queries.nearest(at.position, count, radius));
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

}  // namespace
}  // namespace winnow::test
