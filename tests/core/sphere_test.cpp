#include <gtest/gtest.h>
#include <winnow/core/volumes.h>

#include <cfloat>
#include <limits>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

// Distance in long double: exact to 64 bits, so its error is far below the ulp of a float.
long double distance(const Vec3f& a, const Vec3f& b) {
  return (a.cast<long double>() - b.cast<long double>()).norm();
}

Aabb random_box(Random& random, double scale) {
  const Vec3d low(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  const Vec3d extent(random.unit(), random.unit(), random.unit());
  return Aabb::outward(low * scale, (low + extent) * scale);
}

TEST(Sphere, spheres_that_touch_overlap) {
  const Sphere unit{{0, 0, 0}, 1};
  EXPECT_TRUE(unit.overlaps({{2, 0, 0}, 1}));
  EXPECT_TRUE(unit.overlaps({{0, 1, 0}, 0}));
  EXPECT_FALSE(unit.overlaps({{std::nextafter(2.0F, 3.0F), 0, 0}, 1}));
  EXPECT_TRUE((Sphere{{3, 4, 0}, 2}.overlaps({{0, 0, 0}, 3})));
}

TEST(Sphere, sphere_is_valid_if_finite_and_not_negative) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float inf = std::numeric_limits<float>::infinity();
  EXPECT_TRUE((Sphere{{1, 2, 3}, 0}.is_valid()));
  EXPECT_TRUE((Sphere{{FLT_MAX, 2, 3}, FLT_MAX}.is_valid()));
  for (const Sphere& bad : {Sphere{{1, 2, 3}, -1}, Sphere{{1, 2, 3}, nan}, Sphere{{1, 2, 3}, inf},
                            Sphere{{nan, 2, 3}, 1}, Sphere{{1, -inf, 3}, 1}}) {
    EXPECT_FALSE(bad.is_valid());
  }
}

TEST(Sphere, sphere_around_a_box_contains_its_corners) {
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    const Aabb box = random_box(random, random.log_uniform(1e-30, 1e30));
    const Sphere sphere = Sphere::around(box);
    ASSERT_TRUE(sphere.is_valid());
    for (unsigned corner = 0; corner < 8; ++corner) {
      Vec3f p;
      for (unsigned axis = 0; axis < 3; ++axis) {
        p[axis] = (corner >> axis & 1U) != 0 ? box.max[axis] : box.min[axis];
      }
      ASSERT_LE(distance(p, sphere.center), static_cast<long double>(sphere.radius));
    }
  }
}

TEST(Sphere, sphere_around_a_point_has_radius_zero) {
  const Sphere sphere = Sphere::around({{3, 4, 5}, {3, 4, 5}});
  EXPECT_EQ(sphere.center, Vec3f(3, 4, 5));
  EXPECT_EQ(sphere.radius, 0.0F);
}

TEST(Sphere, bounds_of_a_sphere_are_tight) {
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const double scale = random.log_uniform(1e-30, 1e30);
    const Sphere sphere{Vec3f(static_cast<float>(random.uniform(-scale, scale)), 0, 1),
                        static_cast<float>(random.unit() * scale)};
    const Aabb box = sphere.bounds();
    for (int axis = 0; axis < 3; ++axis) {
      const auto c = static_cast<long double>(sphere.center[axis]);
      const auto r = static_cast<long double>(sphere.radius);
      ASSERT_LE(static_cast<long double>(box.min[axis]), c - r);
      ASSERT_GE(static_cast<long double>(box.max[axis]), c + r);
    }
  }
  const Aabb exact = Sphere{{1, 2, 3}, 0.5F}.bounds();
  EXPECT_EQ(exact, (Aabb{{0.5F, 1.5F, 2.5F}, {1.5F, 2.5F, 3.5F}}));
}

// A filter may report too many pairs, never too few.
TEST(Sphere, spheres_around_overlapping_boxes_overlap) {
  Random random(4);
  for (int i = 0; i < 50000; ++i) {
    const Aabb a = random_box(random, 1.0);
    const Aabb b = random_box(random, 1.0);
    if (a.overlaps(b)) {
      ASSERT_TRUE(Sphere::around(a).overlaps(Sphere::around(b)));
    }
  }
}

}  // namespace
}  // namespace winnow::test
