// Query shapes: their bounds, their validity, and rays in arrays of the caller.

#include <gtest/gtest.h>
#include <winnow/core/rays.h>
#include <winnow/core/regions.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Vector3f some_vector(Random& random, double size) {
  return Vector3d(random.uniform(-size, size), random.uniform(-size, size),
                  random.uniform(-size, size))
      .cast<float>();
}

TEST(OrientedBox, oriented_box_bounds_hold_every_corner_tightly) {
  Random random(81);
  for (int n = 0; n < 2000; ++n) {
    OrientedBox box;
    const double size = random.log_uniform(1e-30, 1e30);
    box.center = some_vector(random, size * random.log_uniform(1e-3, 1e6));
    box.half = some_vector(random, size).cwiseAbs();
    if (random.chance(0.5)) {
      const Vector3f axis = some_vector(random, 1.0).normalized();
      box.axes = Eigen::AngleAxisf(static_cast<float>(random.unit()), axis).toRotationMatrix();
    }
    ASSERT_TRUE(box.is_valid());
    const Aabb bounds = box.bounds();
    for (int k = 0; k < 3; ++k) {
      // In long double the sums of products of floats are practically exact here.
      long double reach = 0.0L;
      for (int i = 0; i < 3; ++i) {
        reach += std::abs(static_cast<long double>(box.axes(k, i))) *
                 static_cast<long double>(box.half[i]);
      }
      const auto center = static_cast<long double>(box.center[k]);
      EXPECT_LE(static_cast<long double>(bounds.min[k]), center - reach);
      EXPECT_GE(static_cast<long double>(bounds.max[k]), center + reach);
      float inner = bounds.min[k];
      for (int ulp = 0; ulp < 3; ++ulp) inner = std::nextafter(inner, kInf);
      EXPECT_GE(static_cast<long double>(inner), center - reach);
      inner = bounds.max[k];
      for (int ulp = 0; ulp < 3; ++ulp) inner = std::nextafter(inner, -kInf);
      EXPECT_LE(static_cast<long double>(inner), center + reach);
    }
  }
}

TEST(OrientedBox, oriented_box_with_a_bad_number_is_invalid) {
  EXPECT_TRUE(OrientedBox{}.is_valid());
  for (int k = 0; k < 3; ++k) {
    for (const float value : {kNan, kInf, -kInf}) {
      OrientedBox box;
      box.center[k] = value;
      EXPECT_FALSE(box.is_valid());
      box = {};
      box.half[k] = value;
      EXPECT_FALSE(box.is_valid());
      box = {};
      box.axes(k, 2 - k) = value;
      EXPECT_FALSE(box.is_valid());
    }
    OrientedBox box;
    box.half[k] = -std::numeric_limits<float>::denorm_min();
    EXPECT_FALSE(box.is_valid());
    box.half[k] = -0.0F;
    EXPECT_TRUE(box.is_valid());
  }
}

TEST(Capsule, capsule_bounds_hold_both_ends_tightly) {
  Random random(82);
  for (int n = 0; n < 2000; ++n) {
    const double size = random.log_uniform(1e-30, 1e30);
    const Capsule capsule{some_vector(random, size * 100), some_vector(random, size * 100),
                          static_cast<float>(size * random.unit())};
    ASSERT_TRUE(capsule.is_valid());
    const Aabb bounds = capsule.bounds();
    for (int k = 0; k < 3; ++k) {
      const auto low = static_cast<long double>(std::min(capsule.a[k], capsule.b[k])) -
                       static_cast<long double>(capsule.radius);
      const auto high = static_cast<long double>(std::max(capsule.a[k], capsule.b[k])) +
                        static_cast<long double>(capsule.radius);
      EXPECT_LE(static_cast<long double>(bounds.min[k]), low);
      EXPECT_GT(static_cast<long double>(std::nextafter(bounds.min[k], kInf)), low);
      EXPECT_GE(static_cast<long double>(bounds.max[k]), high);
      EXPECT_LT(static_cast<long double>(std::nextafter(bounds.max[k], -kInf)), high);
    }
  }
}

TEST(Capsule, capsule_with_a_bad_number_is_invalid) {
  EXPECT_TRUE(Capsule{}.is_valid());
  for (const float value : {kNan, kInf, -kInf}) {
    EXPECT_FALSE((Capsule{{0, value, 0}, {1, 1, 1}, 1.0F}).is_valid());
    EXPECT_FALSE((Capsule{{1, 1, 1}, {0, 0, value}, 1.0F}).is_valid());
    EXPECT_FALSE((Capsule{{1, 1, 1}, {0, 0, 0}, value}).is_valid());
  }
  EXPECT_FALSE((Capsule{{1, 1, 1}, {0, 0, 0}, -1e-45F}).is_valid());
}

TEST(Ray, ray_without_direction_or_range_is_invalid) {
  EXPECT_TRUE(Ray{}.is_valid());
  EXPECT_TRUE((Ray{{0, 0, 0}, {0, -0.0F, std::numeric_limits<float>::denorm_min()}}.is_valid()));
  EXPECT_TRUE((Ray{{0, 0, 0}, {1, 0, 0}, 2.0F, 2.0F}.is_valid()));
  EXPECT_TRUE((Ray{{0, 0, 0}, {1, 0, 0}, -0.0F, 0.0F}.is_valid()));
  EXPECT_FALSE((Ray{{0, 0, 0}, {0, -0.0F, 0}}.is_valid()));
  EXPECT_FALSE((Ray{{0, kNan, 0}, {1, 0, 0}}.is_valid()));
  EXPECT_FALSE((Ray{{0, kInf, 0}, {1, 0, 0}}.is_valid()));
  EXPECT_FALSE((Ray{{0, 0, 0}, {1, kInf, 0}}.is_valid()));
  EXPECT_FALSE((Ray{{0, 0, 0}, {1, 0, 0}, 2.0F, 1.0F}.is_valid()));
  EXPECT_FALSE((Ray{{0, 0, 0}, {1, 0, 0}, -1.0F, 1.0F}.is_valid()));
  EXPECT_FALSE((Ray{{0, 0, 0}, {1, 0, 0}, kInf, kInf}.is_valid()));
  EXPECT_FALSE((Ray{{0, 0, 0}, {1, 0, 0}, 0.0F, kNan}.is_valid()));
}

TEST(RayBatch, rays_at_any_stride_are_read) {
  struct Shot {
    int weapon = 0;
    Ray ray;
    double damage = 0.0;
  };
  std::vector<Shot> shots(5);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const auto x = static_cast<float>(i);
    shots[i].ray = {{x, x + 1, x + 2}, {-x, 1, 2 * x}, 0.5F * x, 7 * x};
    rays.push_back(shots[i].ray);
  }
  Ray& first = shots[0].ray;
  const std::array<const float*, 3> origins{&first.origin[0], &first.origin[1], &first.origin[2]};
  const std::array<const float*, 3> directions{&first.direction[0], &first.direction[1],
                                               &first.direction[2]};
  const RayBatch members(origins, directions, 5, &first.min_t, &first.max_t, sizeof(Shot));
  const RayBatch unbounded(origins, directions, 5, nullptr, nullptr, sizeof(Shot));
  const RayBatch array{std::span<const Ray>(rays)};
  ASSERT_EQ(array.count, 5U);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (const Ray& ray : {members[i], array[i], unbounded[i]}) {
      EXPECT_EQ(ray.origin, rays[i].origin);
      EXPECT_EQ(ray.direction, rays[i].direction);
    }
    for (const Ray& ray : {members[i], array[i]}) {
      EXPECT_EQ(ray.min_t, rays[i].min_t);
      EXPECT_EQ(ray.max_t, rays[i].max_t);
    }
    EXPECT_EQ(unbounded[i].min_t, 0.0F);
    EXPECT_EQ(unbounded[i].max_t, kInf);
  }
  EXPECT_EQ(RayBatch{}.count, 0U);
  EXPECT_EQ(RayBatch(std::span<const Ray>{}).count, 0U);
}

}  // namespace
}  // namespace winnow::test
