// Shape casts against a stationary shape: times of impact compared with closed forms, and with
// distances of the solver just before and after the impact.

#include "pipeline/composites/shape_cast.h"
#include <gtest/gtest.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/shape_rays.h>
#include "pipeline/solver/solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/pipeline/pair_scenes.h"
#include "tests/support/answers.h"

namespace winnow::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Direction {
  double v[3];
};

Direction unit(Random& random) {
  for (;;) {
    Direction d{{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}};
    const double length = std::hypot(d.v[0], d.v[1], d.v[2]);
    if (length < 0.1 || length > 1.0) continue;
    for (double& x : d.v) x /= length;
    return d;
  }
}

/// Moves the start back by `distance` so that the cast passes through the old start at `speed`.
void back_off(CastPair& pair, const Direction& way, double distance, double speed) {
  for (int i = 0; i < 3; ++i) {
    pair.from.position[i] -= way.v[i] * distance;
    pair.direction[i] = way.v[i] * speed;
  }
}

Pose moved(const CastPair& pair, double t) {
  Pose pose = pair.from;
  for (int i = 0; i < 3; ++i) pose.position[i] += t * pair.direction[i];
  return pose;
}

double distance_at(const ShapePool& pool, const CastPair& pair, double t) {
  SolverCounts counts;
  return solve_pair(pool.tables(), pair.moving, moved(pair, t), pair.stationary, pair.pose,
                    ContactLevel::distance, 0.0, counts)
      .distance;
}

TEST(ShapeCast, balls_match_closed_form) {
  Random random(1);
  for (std::size_t n = scaled(20000); n-- != 0;) {
    ShapePool pool;
    CastPair pair;
    const double size = random.log_uniform(1e-15, 1e15);
    const double radius[2] = {size * random.unit(), size * random.unit()};
    pair.moving = expect_ok(pool.add(SphereShape{radius[0]}));
    pair.stationary = expect_ok(pool.add(SphereShape{radius[1]}));
    for (double& x : pair.pose.position) x = size * random.uniform(-1, 1);
    back_off(pair, unit(random), size * random.log_uniform(1.0, 1e4),
             random.log_uniform(1e-9, 1e9));
    pair.max_t = kInfinity;
    // Solve |c - t d| = r in long double.
    long double cc = 0.0L;
    long double cd = 0.0L;
    long double dd = 0.0L;
    for (int i = 0; i < 3; ++i) {
      const long double c = static_cast<long double>(pair.pose.position[i]) - pair.from.position[i];
      const long double d = pair.direction[i];
      cc += c * c;
      cd += c * d;
      dd += d * d;
    }
    const long double r = static_cast<long double>(radius[0]) + radius[1];
    const long double nearest = cc - cd * cd / dd;
    const long double scale = std::sqrt(cc) + r;
    if (std::fabs(nearest - r * r) < 1e-15L * scale * scale) continue;
    const double tolerance = 1e-7 * size;
    CastTouch touch;
    const bool hit = cast_shape(pool.tables(), pair, tolerance, touch);
    ASSERT_EQ(hit, cc <= r * r || (cd > 0.0L && nearest < r * r)) << n;
    if (!hit) continue;
    const long double truth =
        cc <= r * r ? 0.0L
                    : (cc - r * r) / (cd + std::sqrt(std::max(0.0L, cd * cd - dd * (cc - r * r))));
    const auto length = static_cast<double>(std::sqrt(dd));
    const auto late = static_cast<double>((static_cast<long double>(touch.t) - truth)) * length;
    // If the balls graze, the error of the time of impact is the square root of the rounding.
    const double sine = static_cast<double>(std::sqrt(std::max(1e-30L, 1.0L - nearest / (r * r))));
    // Long double also loses digits over long distances.
    const auto noise = static_cast<double>(scale * (1e-15L + 1e-18L * scale / r)) / sine;
    EXPECT_LE(late, noise) << n;
    EXPECT_LE(-late, tolerance + 20.0 * noise) << n;
    EXPECT_LT(touch.steps, 60U);
  }
}

TEST(ShapeCast, bullet_never_tunnels_through_triangle) {
  Random random(2);
  for (std::size_t n = scaled(20000); n-- != 0;) {
    ShapePool pool;
    CastPair pair;
    const double radius = random.chance(0.2) ? 0.0 : random.log_uniform(1e-9, 0.1);
    pair.moving = expect_ok(pool.add(SphereShape{radius}));
    TriangleShape triangle;
    for (auto& corner : triangle.vertex) {
      for (double& x : corner) x = random.uniform(-1, 1);
    }
    pair.stationary = expect_ok(pool.add(triangle));
    // Aimed at a point inside the triangle.
    double weight[3] = {random.unit() + 0.01, random.unit() + 0.01, random.unit() + 0.01};
    const double sum = weight[0] + weight[1] + weight[2];
    const double offset = random.chance(0.5) ? 0.0 : random.log_uniform(1.0, 1e8);
    for (int i = 0; i < 3; ++i) {
      pair.pose.position[i] = pair.from.position[i] = offset;
      for (int k = 0; k < 3; ++k) pair.from.position[i] += weight[k] / sum * triangle.vertex[k][i];
    }
    const double way = random.log_uniform(0.3, 1e5);
    back_off(pair, unit(random), way, random.log_uniform(1e-6, 1e12));
    pair.max_t = random.chance(0.5) ? kInfinity : 1e13 * way;
    // Reference: a ray against the triangle with the bullet's radius as rounding.
    triangle.rounding = radius;
    ShapeId grown = expect_ok(pool.add(triangle));
    ShapeRay ray;
    ray.origin = pair.from.position;
    ray.direction = pair.direction;
    ray.max_t = pair.max_t;
    ShapeHit truth = expect_ok(cast_ray(pool.tables(), grown, pair.pose, ray));
    if (!truth.hit) continue;
    CastTouch touch;
    ASSERT_TRUE(cast_shape(pool.tables(), pair, 1e-6, touch)) << n;
    double speed = 0.0;
    double sine = 0.0;
    for (int i = 0; i < 3; ++i) {
      speed += pair.direction[i] * pair.direction[i];
      sine -= truth.normal[i] * pair.direction[i];
    }
    speed = std::sqrt(speed);
    const double noise = 1e-14 * (2.0 + 0.1 * way) / std::max(sine / speed, 1e-9);
    EXPECT_LE((touch.t - truth.t) * speed, noise) << n;
    EXPECT_LE((truth.t - touch.t) * speed, 1e-6 + noise) << n;
  }
}

TEST(ShapeCast, shapes_are_apart_before_and_touching_after_impact) {
  Random random(3);
  for (const PairStyle style : {PairStyle::ordinary, PairStyle::unequal, PairStyle::nearly_parallel,
                                PairStyle::extreme_sizes}) {
    for (const ShapeKind a : all_kinds()) {
      for (const ShapeKind b : all_kinds()) {
        if (a == ShapeKind::half_space) continue;
        PairScene scene;
        add_pairs(scene, a, b, style, scaled(6), random);
        for (const BodyPair& ids : scene.pairs) {
          const bool turned = scene.shapes[ids.a].kind() != a;
          const std::uint32_t first = turned ? ids.b : ids.a;
          const std::uint32_t second = turned ? ids.a : ids.b;
          CastPair pair{scene.shapes[first], scene.poses[first],   {},
                        kInfinity,           scene.shapes[second], scene.poses[second]};
          const double size = extent(scene, ids);
          const double way = size * random.log_uniform(0.1, 10.0);
          back_off(pair, unit(random), way, 1.0);
          const double tolerance = 1e-6 * size;
          const double noise = 1e-12 * (size + way);
          CastTouch touch;
          const bool hit = cast_shape(scene.pool.tables(), pair, tolerance, touch);
          EXPECT_LT(touch.steps, 120U);
          // The cast passes through the original pose, so that a miss implies that the shapes are
          // apart there.
          for (int k = 0; !hit && k <= 40; ++k) {
            ASSERT_GT(distance_at(scene.pool, pair, way * k / 20.0), -noise);
          }
          if (!hit) continue;
          describe_touch(scene.pool.tables(), pair, touch);
          if (touch.t > 0.0) {
            ASSERT_GT(distance_at(scene.pool, pair, touch.t), -noise);
          }
          ASSERT_LT(distance_at(scene.pool, pair, touch.t + 1.01 * tolerance), noise);
          double along = 0.0;
          double length = 0.0;
          for (int i = 0; i < 3; ++i) {
            along += touch.normal[i] * pair.direction[i];
            length += touch.normal[i] * touch.normal[i];
          }
          EXPECT_NEAR(length, 1.0, 1e-12);
          if (touch.t > 0.0) {
            EXPECT_LT(along, 1e-9);
          }
        }
      }
    }
  }
}

TEST(ShapeCast, separating_sliding_or_touching_cast_ends_early) {
  ShapePool pool;
  ShapeId ball;
  ShapeId floor;
  ShapeId box;
  ball = expect_ok(pool.add(SphereShape{1.0}));
  floor = expect_ok(pool.add(HalfSpaceShape{}));
  box = expect_ok(pool.add(BoxShape{{4.0, 4.0, 1.0}}));
  CastTouch touch;
  for (const double max_t : {1.0, 1e300, kInfinity}) {
    for (const double speed : {1e-300, 1.0, 1e300}) {
      CastPair pair{ball, Pose::at(0, 0, 1.0 + 1e-9), {speed, 0.0, 0.0}, max_t, floor, {}};
      EXPECT_FALSE(cast_shape(pool.tables(), pair, 1e-6, touch));
      EXPECT_LT(touch.steps, 4U);
      pair.from = Pose::at(0, 0, 2.0 + 1e-9);
      pair.stationary = box;
      EXPECT_FALSE(cast_shape(pool.tables(), pair, 1e-6, touch));
      EXPECT_LT(touch.steps, 60U);
      pair.from = Pose::at(0, 0, 2.0);
      ASSERT_TRUE(cast_shape(pool.tables(), pair, 1e-6, touch));
      EXPECT_EQ(touch.t, 0.0);
      describe_touch(pool.tables(), pair, touch);
      EXPECT_NEAR(touch.normal[2], 1.0, 1e-12);
      EXPECT_NEAR(touch.point[2], 1.0, 1e-12);
    }
  }
  CastPair away{ball, Pose::at(0, 0, 2.0 + 1e-15), {0.0, 0.0, 1.0}, kInfinity, box, {}};
  EXPECT_FALSE(cast_shape(pool.tables(), away, 1e-6, touch));
}

}  // namespace
}  // namespace winnow::test
