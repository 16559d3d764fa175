// cast_ray on single shapes: exact hits on faces, edges and corners, degenerate shapes, and hits
// compared with distance functions (ray_probes.h).

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/shape_rays.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>

#include "core/numbers/rotation.h"
#include "tests/pipeline/ray_probes.h"
#include "tests/support/answers.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Eigen::Vector3d;

constexpr double kInf = std::numeric_limits<double>::infinity();

[[nodiscard]] Vector3d any_point(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

[[nodiscard]] Eigen::Quaterniond rotation_of(const Pose& pose) {
  return Eigen::Quaterniond(pose.orientation[0], pose.orientation[1], pose.orientation[2],
                            pose.orientation[3])
      .normalized();
}

[[nodiscard]] Pose any_pose(Random& random) {
  Pose pose;
  as_eigen(pose.position) = any_point(random, 5.0);
  for (double& q : pose.orientation) q = random.uniform(-1.0, 1.0);
  return pose;
}

/// Finds the least distance between a ray and a convex shape, and its parameter. The distance is
/// convex along the ray.
[[nodiscard]] double least(const std::function<double(double)>& distance, double low, double high,
                           double& at) {
  for (int i = 0; i < 200; ++i) {
    const double a = low + (high - low) * 0.382;
    const double b = low + (high - low) * 0.618;
    (distance(a) < distance(b) ? high : low) = distance(a) < distance(b) ? b : a;
  }
  at = 0.5 * (low + high);
  return distance(at);
}

struct Cast {
  Status status;
  ShapeHit hit;
};

[[nodiscard]] Cast cast(const ShapeTables& tables, ShapeId id, const Vector3d& origin,
                        const Vector3d& direction, double max_t = kInf, const Pose& pose = {}) {
  ShapeRay ray;
  as_eigen(ray.origin) = origin;
  as_eigen(ray.direction) = direction;
  ray.max_t = max_t;
  Cast result{Status::ok, {}};
  result.status = cast_ray(tables, id, pose, ray).get(result.hit);
  return result;
}

[[nodiscard]] Vector3d normal_of(const Cast& c) {
  return as_eigen(c.hit.normal);
}

TEST(ShapeRays, ray_without_max_t_is_unbounded) {
  ShapePool pool;
  const ShapeId ball = pool.add(SphereShape{1.0});
  const ShapeRay ray{.origin = {-1e6, 0.0, 0.0}, .direction = {1.0, 0.0, 0.0}};
  ShapeHit hit = expect_ok(cast_ray(pool.tables(), ball, {}, ray));
  EXPECT_DOUBLE_EQ(hit.t, 1e6 - 1.0);
}

TEST(ShapeRays, ray_in_face_edge_or_corner_hits) {
  ShapePool pool;
  ShapeId box;
  ShapeId rounded;
  box = expect_ok(pool.add(BoxShape{{1.0, 2.0, 3.0}, 0.0}));
  rounded = expect_ok(pool.add(BoxShape{{1.0, 2.0, 3.0}, 0.5}));
  const auto t = [&](ShapeId id, const Vector3d& origin, const Vector3d& direction) {
    const Cast c = cast(pool.tables(), id, origin, direction);
    return c.hit.hit ? c.hit.t : -1.0;
  };
  EXPECT_EQ(t(box, {-4.0, 2.0, 0.0}, {1.0, 0.0, 0.0}), 3.0);   // in a face
  EXPECT_EQ(t(box, {-4.0, 2.0, 3.0}, {1.0, 0.0, 0.0}), 3.0);   // along an edge
  EXPECT_EQ(t(box, {0.0, 3.0, 0.0}, {1.0, -1.0, 0.0}), 1.0);   // touches the box only at an edge
  EXPECT_EQ(t(box, {-3.0, -4.0, 1.0}, {1.0, 1.0, 1.0}), 2.0);  // through a corner
  EXPECT_EQ(t(box, {-4.0, 2.0 + 1e-12, 0.0}, {1.0, 0.0, 0.0}), -1.0);
  EXPECT_EQ(t(box, {-4.0, std::nextafter(2.0, 3.0), 0.0}, {1.0, 0.0, 0.0}), -1.0);
  EXPECT_EQ(t(box, {1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}), 0.0);  // starts on the surface
  EXPECT_EQ(t(box, {1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}), 0.0);
  EXPECT_EQ(t(rounded, {-4.0, 2.5, 0.0}, {1.0, 0.0, 0.0}),
            3.0);  // grazes, starting at the flat part
  EXPECT_EQ(t(rounded, {-4.0, 0.0, 0.0}, {1.0, 0.0, 0.0}), 2.5);
  EXPECT_EQ(t(rounded, {-4.0, 2.0, 3.0}, {1.0, 0.0, 0.0}), 2.5);
  EXPECT_NEAR(t(rounded, {-4.0, 2.3, 0.0}, {1.0, 0.0, 0.0}), 2.6, 1e-15);
  // With any orientation, rays aimed at corners and at the middle of edges hit.
  Random random(9);
  for (int i = 0; i < 500; ++i) {
    Pose pose = any_pose(random);
    const Vector3d corner((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 2.0 : -2.0,
                          (i & 4) != 0   ? 3.0
                          : (i & 8) != 0 ? -3.0
                                         : 0.0);
    const Vector3d target = rotation_of(pose) * corner + as_eigen(pose.position);
    const Vector3d middle = as_eigen(pose.position);
    const Vector3d origin = target + 3.0 * (target - middle);
    const Cast c = cast(pool.tables(), box, origin, middle - origin, kInf, pose);
    ASSERT_TRUE(c.hit.hit);
    ASSERT_NEAR(c.hit.t, 0.75, 1e-14);
  }
}

TEST(ShapeRays, flat_shapes_are_hit_from_both_sides) {
  ShapePool pool;
  ShapeId triangle;
  ShapeId segment;
  ShapeId point;
  triangle = expect_ok(pool.add(TriangleShape{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, 0.0}));
  segment = expect_ok(pool.add(TriangleShape{{{0, 0, 0}, {4, 0, 0}, {2, 0, 0}}, 0.0}));
  point = expect_ok(pool.add(TriangleShape{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, 0.0}));
  Cast c = cast(pool.tables(), triangle, {1, 1, 2}, {0, 0, -1});
  EXPECT_TRUE(c.hit.hit && c.hit.t == 2.0 && c.hit.normal[2] == 1.0);
  c = cast(pool.tables(), triangle, {1, 1, -2}, {0, 0, 1});
  EXPECT_TRUE(c.hit.hit && c.hit.t == 2.0 && c.hit.normal[2] == -1.0);
  c = cast(pool.tables(), triangle, {-1, 1, 0}, {2, 0, 0});
  EXPECT_TRUE(c.hit.hit && c.hit.t == 0.5 && c.hit.normal[0] == -1.0);
  EXPECT_TRUE(cast(pool.tables(), triangle, {2, 2, 2}, {0, 0, -1}).hit.hit);  // an edge
  EXPECT_TRUE(cast(pool.tables(), triangle, {4, 0, 2}, {0, 0, -1}).hit.hit);  // a corner
  EXPECT_FALSE(cast(pool.tables(), triangle, {2 + 1e-12, 2, 2}, {0, 0, -1}).hit.hit);
  EXPECT_FALSE(cast(pool.tables(), triangle, {1, 1, 1e-12}, {1, 0, 0}).hit.hit);
  EXPECT_EQ(cast(pool.tables(), segment, {3, 1, 1}, {0, -1, -1}).hit.t, 1.0);
  EXPECT_EQ(cast(pool.tables(), segment, {-2, 0, 0}, {1, 0, 0}).hit.t, 2.0);
  EXPECT_EQ(cast(pool.tables(), point, {1, 1, 3}, {0, 0, -1}).hit.t, 2.0);
  EXPECT_FALSE(cast(pool.tables(), point, {1, 1.0 + 1e-12, 3}, {0, 0, -1}).hit.hit);
}

TEST(ShapeRays, sliver_is_hit_only_within_its_edges) {
  ShapePool pool;
  ShapeId id;
  const double width = 1e-11;
  id = expect_ok(pool.add(TriangleShape{{{-1, 0, 0.3}, {1, 0, 0.3}, {0, width, 0.3}}, 0.0}));
  EXPECT_EQ(cast(pool.tables(), id, {0, 0.5 * width, 1.3}, {0, 0, -1}).hit.t, 1.0);
  EXPECT_FALSE(cast(pool.tables(), id, {0, 1.1 * width, 1.3}, {0, 0, -1}).hit.hit);
  EXPECT_FALSE(cast(pool.tables(), id, {0, -0.1 * width, 1.3}, {0, 0, -1}).hit.hit);
}

// The vertices are points of the ray, off only by rounding. No side bounds such a triangle along
// the ray, and the intersection with its plane is arbitrary.
TEST(ShapeRays, ray_along_sliver_hits_between_its_tips) {
  Random random(53);
  std::size_t hit_count = 0;
  for (std::size_t i = 0; i < scaled(2000); ++i) {
    const Vector3d along(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    TriangleShape sliver;
    double first = kInf;
    double last = 0.0;
    for (Vec3d& vertex : sliver.vertex) {
      const double t = random.uniform(0.001, 0.003);
      as_eigen(vertex) = t * along;
      first = std::min(first, t);
      last = std::max(last, t);
    }
    ShapePool pool;
    ShapeId id = expect_ok(pool.add(sliver));
    const Cast c = cast(pool.tables(), id, Vector3d::Zero(), along);
    if (!c.hit.hit) continue;
    ++hit_count;
    ASSERT_GE(c.hit.t, first - 1e-12) << i;
    ASSERT_LE(c.hit.t, last + 1e-12) << i;
  }
  EXPECT_GT(hit_count, scaled(1000));
}

TEST(ShapeRays, rays_along_cone_lines_hit_exactly) {
  ShapePool pool;
  ShapeId id = expect_ok(pool.add(ConeShape{1.0, 1.0, 0.0}));
  EXPECT_EQ(cast(pool.tables(), id, {0, 0, 3}, {0, 0, -1}).hit.t, 2.0);  // through the apex
  EXPECT_EQ(cast(pool.tables(), id, {-1, 0, 1}, {1, 0, 0}).hit.t, 1.0);  // grazes the apex
  EXPECT_EQ(cast(pool.tables(), id, {0.5, 0, 3}, {0, 0, -1}).hit.t, 3.0);
  EXPECT_EQ(cast(pool.tables(), id, {0.5, 0, -3}, {0, 0, 1}).hit.t, 2.0);
  EXPECT_EQ(cast(pool.tables(), id, {-3, 0, 0}, {1, 0, 0}).hit.t, 2.5);
  EXPECT_FALSE(cast(pool.tables(), id, {-3, 0, 1.5}, {1, 0, 0}).hit.hit);  // the other nappe
  // Along a line of the side, from (-1/2, 0, 2) through the apex.
  EXPECT_EQ(cast(pool.tables(), id, {-0.5, 0, 2}, {0.5, 0, -1}).hit.t, 1.0);
  // Parallel to a line of the side.
  EXPECT_EQ(cast(pool.tables(), id, {-2, 0, 0}, {0.5, 0, -1}).hit.hit, false);
  EXPECT_EQ(cast(pool.tables(), id, {-1, 0, 1.5}, {1, 0, -2}).hit.t, 0.625);
}

TEST(ShapeRays, needle_and_plate_cones_are_hit_correctly) {
  ShapePool pool;
  ShapeId needle;
  ShapeId plate;
  needle = expect_ok(pool.add(ConeShape{1e-5, 1e5, 0.0}));
  plate = expect_ok(pool.add(ConeShape{1e5, 1e-5, 0.0}));
  // At half of its height the needle has half of its radius. At half of its radius the plate has
  // half of its height.
  EXPECT_NEAR(cast(pool.tables(), needle, {-1, 0, 0}, {1, 0, 0}).hit.t, 1.0 - 0.5e-5, 1e-9);
  EXPECT_FALSE(cast(pool.tables(), needle, {-1, 1e-3, 0}, {1, 0, 0}).hit.hit);
  EXPECT_FALSE(cast(pool.tables(), needle, {1e-3, 0, 3e5}, {0, 0, -1}).hit.hit);
  EXPECT_FALSE(cast(pool.tables(), needle, {1e-3, 0, 0}, {0, 0, -1}).hit.hit);
  EXPECT_NEAR(cast(pool.tables(), needle, {0, 0, 3e5}, {0, 0, -1}).hit.t, 2e5, 1e-9);
  EXPECT_EQ(cast(pool.tables(), needle, {0, 0, 0}, {0, 0, -1}).hit.t, 0.0);
  EXPECT_NEAR(cast(pool.tables(), plate, {5e4, 0, 1}, {0, 0, -1}).hit.t, 1.0, 1e-9);
  EXPECT_NEAR(cast(pool.tables(), plate, {5e4, 0, -1}, {0, 0, 1}).hit.t, 1.0 - 1e-5, 1e-9);
  EXPECT_FALSE(cast(pool.tables(), plate, {5e4, 0, 1e-3}, {1, 0, 0}).hit.hit);
}

TEST(ShapeRays, bad_rays_poses_and_ids_are_refused) {
  const RayProbes shapes;
  for (const RayProbe& probe : shapes.probes()) {
    ShapeRay ray;
    ray.direction[0] = 0.0;
    expect_error(cast_ray(shapes.tables(), probe.id, {}, ray), Status::invalid_argument);
    for (const double bad : {std::nan(""), kInf}) {
      ray = {};
      ray.direction[1] = bad;
      expect_error(cast_ray(shapes.tables(), probe.id, {}, ray), Status::invalid_argument);
      ray = {};
      ray.origin[2] = bad;
      expect_error(cast_ray(shapes.tables(), probe.id, {}, ray), Status::invalid_argument);
      Pose pose;
      pose.position[0] = bad;
      expect_error(cast_ray(shapes.tables(), probe.id, pose, {}), Status::invalid_pose);
    }
    for (const double bad : {-1.0, std::nan("")}) {
      ray = {};
      ray.max_t = bad;
      expect_error(cast_ray(shapes.tables(), probe.id, {}, ray), Status::invalid_argument);
    }
  }
  expect_error(cast_ray(shapes.tables(), ShapeId{}, {}, {}), Status::invalid_key);
  expect_error(cast_ray(shapes.tables(), ShapeId::of(ShapeKind::sphere, 99), {}, {}),
               Status::invalid_key);
}

TEST(ShapeRays, ray_beyond_rounded_sliver_misses) {
  Random random(13);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d from = any_point(random, 1.0);
    const Vector3d along = any_point(random, 1.0);
    TriangleShape sliver;
    sliver.rounding = 0.15;
    as_eigen(sliver.vertex[0]) = from;
    as_eigen(sliver.vertex[1]) = from + along;
    as_eigen(sliver.vertex[2]) = from + random.uniform(-1.0, 2.0) * along;
    ShapePool pool;
    ShapeId id = expect_ok(pool.add(sliver));
    // Aimed beyond the ends of the segment.
    const double beyond = random.uniform(2.0, 20.0) + 0.2 / along.norm();
    const Vector3d target = from + (random.chance(0.5) ? beyond : 1.0 - beyond) * along;
    const Vector3d direction = any_point(random, 1.0).cross(along);
    if (direction.norm() < 1e-3) continue;
    EXPECT_FALSE(cast(pool.tables(), id, target - direction, direction).hit.hit) << i;
  }
}

TEST(ShapeRays, any_numbers_give_finite_results) {
  const RayProbes shapes;
  Random random(12);
  const double numbers[] = {0.0, 1.0, -1.0, 0.3, 1e-320, -1e-300, 1e308, -1e308, 1e20, -1e-20};
  const auto any = [&] { return numbers[random.below(std::size(numbers))]; };
  for (const RayProbe& probe : shapes.probes()) {
    for (int i = 0; i < 300; ++i) {
      Pose pose = Pose::at(any(), any(), any());
      for (double& q : pose.orientation) q = any();
      const Cast c =
          cast(shapes.tables(), probe.id, {any(), any(), any()}, {any(), any(), any()}, kInf, pose);
      if (!c.hit.hit) continue;
      ASSERT_TRUE(std::isfinite(c.hit.t) && c.hit.t >= 0.0) << probe.name;
      ASSERT_NEAR(normal_of(c).norm(), 1.0, 1e-14) << probe.name;
    }
  }
}

TEST(ShapeRays, hit_is_first_zero_of_distance) {
  const RayProbes shapes;
  Random random(5);
  for (const RayProbe& probe : shapes.probes()) {
    int hits = 0;
    for (std::size_t i = 0; i < scaled(400); ++i) {
      const Pose pose = any_pose(random);
      const Vector3d origin = as_eigen(pose.position) + any_point(random, 4.0);
      const Vector3d target = as_eigen(pose.position) + any_point(random, 1.2);
      const Vector3d direction = (target - origin) * random.log_uniform(0.1, 10.0);
      const Eigen::Quaterniond turn = rotation_of(pose);
      const auto distance = [&](double t) {
        return probe.distance(turn.conjugate() *
                              (origin + t * direction - as_eigen(pose.position)));
      };
      const Cast c = cast(shapes.tables(), probe.id, origin, direction, kInf, pose);
      ASSERT_EQ(c.status, Status::ok);
      double at = 0.0;
      const double nearest = least(distance, 0.0, 40.0 / direction.norm(), at);
      if (!c.hit.hit) {
        ASSERT_GT(nearest, -1e-12) << probe.name << i;
        continue;
      }
      ++hits;
      const double t = c.hit.t;
      if (distance(0.0) < 0.0) {
        ASSERT_EQ(t, 0.0) << probe.name << i;
        ASSERT_LT((normal_of(c) + direction.normalized()).norm(), 1e-14);
        continue;
      }
      ASSERT_NEAR(distance(t), 0.0, 1e-13 * (1.0 + t * direction.norm())) << probe.name << i;
      ASSERT_NEAR(normal_of(c).norm(), 1.0, 1e-14);
      ASSERT_LE(normal_of(c).dot(direction), 1e-12) << probe.name << i;
      // The hit is the first contact: just before it the ray is outside the shape.
      if (nearest < -1e-3) {
        ASSERT_GT(distance(t - 1e-6 / direction.norm()), 0.0) << probe.name << i;
        ASSERT_LT(t, at);
      }
      // With max_t just below t the ray misses, with max_t = t it hits.
      ASSERT_TRUE(cast(shapes.tables(), probe.id, origin, direction, t, pose).hit.hit);
      ASSERT_FALSE(
          cast(shapes.tables(), probe.id, origin, direction, std::nextafter(t, 0.0), pose).hit.hit);
    }
    EXPECT_GT(hits, 0) << probe.name;
  }
}

TEST(ShapeRays, hits_scale_with_shapes) {
  const RayProbes shapes;
  Random random(6);
  ShapePool pool;
  for (const double unit : {0x1p-70, 0x1p70, 0x1p-300, 0x1p300}) {
    ShapeId small;
    ShapeId box;
    small = expect_ok(pool.add(BoxShape{{unit, 0.5 * unit, 2.0 * unit}, 0.3 * unit}));
    box = expect_ok(pool.add(BoxShape{{1.0, 0.5, 2.0}, 0.3}));
    for (int i = 0; i < 50; ++i) {
      const Vector3d origin = any_point(random, 5.0);
      const Vector3d direction = any_point(random, 1.0) - origin;
      const Cast a = cast(pool.tables(), box, origin, direction);
      const Cast b = cast(pool.tables(), small, unit * origin, direction);
      ASSERT_EQ(a.hit.hit, b.hit.hit);
      ASSERT_EQ(a.hit.t * unit, b.hit.t);
      const Cast c = cast(pool.tables(), small, unit * origin, unit * direction);
      ASSERT_EQ(a.hit.t, c.hit.t);
    }
  }
}

TEST(ShapeRays, far_rays_match_near_rays) {
  ShapePool pool;
  ShapeId sphere;
  ShapeId box;
  sphere = expect_ok(pool.add(SphereShape{1.0}));
  box = expect_ok(pool.add(BoxShape{{1.0, 1.0, 1.0}, 0.0}));
  for (const double far : {1e3, 1e6, 1e9, 1e12}) {
    Cast c = cast(pool.tables(), sphere, {far, 0.6, 0.0}, {-1.0, 0.0, 0.0});
    ASSERT_TRUE(c.hit.hit);
    EXPECT_EQ(c.hit.t, far - 0.8);
    EXPECT_LT((normal_of(c) - Vector3d(0.8, 0.6, 0.0)).norm(), 1e-15);
    // A grazing ray hits. A ray slightly farther out misses.
    EXPECT_TRUE(cast(pool.tables(), sphere, {far, 1.0, 0.0}, {-1.0, 0.0, 0.0}).hit.hit);
    EXPECT_FALSE(cast(pool.tables(), sphere, {far, 1.0 + 1e-14, 0.0}, {-1.0, 0.0, 0.0}).hit.hit);
    EXPECT_TRUE(cast(pool.tables(), box, {far, 1.0, 0.5}, {-1.0, 0.0, 0.0}).hit.hit);
    EXPECT_FALSE(cast(pool.tables(), box, {far, 1.0 + 1e-14, 0.5}, {-1.0, 0.0, 0.0}).hit.hit);
    // A ray that points away.
    EXPECT_FALSE(cast(pool.tables(), sphere, {far, 0.0, 0.0}, {1.0, 0.0, 0.0}).hit.hit);
    // Ray and shape far from the origin.
    const Pose pose = Pose::at(far, far, -far);
    c = cast(pool.tables(), sphere, {far + 3.0, far, -far}, {-2.0, 0.0, 0.0}, kInf, pose);
    EXPECT_EQ(c.hit.t, 1.0);
  }
  // Along a diagonal without round numbers.
  const Vector3d direction = Vector3d(0.3, -0.7, 0.1).normalized();
  const Cast c = cast(pool.tables(), sphere, -1e9 * direction, direction);
  ASSERT_TRUE(c.hit.hit);
  EXPECT_NEAR(c.hit.t, 1e9 - 1.0, 1e-6);
  EXPECT_LT((normal_of(c) + direction).norm(), 1e-6);
}

}  // namespace
}  // namespace winnow::test
