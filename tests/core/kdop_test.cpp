// Kdop for 14, 18 and 26 faces: bounds of points, boxes and rotated boxes, overlap and validity.

#include <gtest/gtest.h>
#include <winnow/core/regions.h>
#include <winnow/core/volumes.h>

#include <Eigen/Geometry>

#include <cstddef>
#include <limits>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

template <typename Volume>
class KdopTest : public testing::Test {};
using Volumes = testing::Types<Kdop<14>, Kdop<18>, Kdop<26>>;
TYPED_TEST_SUITE(KdopTest, Volumes);

template <int K>
constexpr int faces(const Kdop<K>&) {
  return K;
}

Eigen::Vector3f random_point(Random& random, double scale) {
  return Eigen::Vector3d(random.uniform(-scale, scale), random.uniform(-scale, scale),
                         random.uniform(-scale, scale))
      .cast<float>();
}

// The extent of a point along one slab direction, exact in long double for floats of similar size.
long double along(const std::array<int, 3>& direction, const Eigen::Vector3f& p) {
  return static_cast<long double>(direction[0]) * static_cast<long double>(p.x()) +
         static_cast<long double>(direction[1]) * static_cast<long double>(p.y()) +
         static_cast<long double>(direction[2]) * static_cast<long double>(p.z());
}

template <typename Volume>
bool contains(const Volume& volume, const Eigen::Vector3f& p) {
  const auto directions = kdop_directions<faces(Volume{})>();
  for (std::size_t s = 0; s < Volume::kSlabs; ++s) {
    const long double at = along(directions[s], p);
    if (!(static_cast<long double>(volume.min[s]) <= at &&
          at <= static_cast<long double>(volume.max[s]))) {
      return false;
    }
  }
  return true;
}

TYPED_TEST(KdopTest, directions_are_distinct_and_not_opposite) {
  const auto d = kdop_directions<faces(TypeParam{})>();
  ASSERT_EQ(d.size(), TypeParam::kSlabs);
  for (std::size_t i = 0; i < d.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_NE(d[i], d[j]);
      EXPECT_NE(d[i], (std::array<int, 3>{-d[j][0], -d[j][1], -d[j][2]}));
    }
  }
}

TYPED_TEST(KdopTest, volume_around_points_contains_them) {
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const double scale = random.log_uniform(1e-35, 1e35);
    std::vector<Eigen::Vector3f> points;
    for (int n = 0; n < 6; ++n) points.push_back(random_point(random, scale));
    // One point is about 1e6 times nearer to the origin than the other points.
    points.push_back(random_point(random, scale * 1e-6));
    const TypeParam volume = TypeParam::around(points);
    ASSERT_TRUE(volume.is_valid());
    for (const Eigen::Vector3f& p : points) ASSERT_TRUE(contains(volume, p));
  }
}

TYPED_TEST(KdopTest, box_near_the_largest_float_gives_valid_volume) {
  OrientedBox box;
  box.center = {2e38F, 2e38F, 2e38F};
  box.half = {1e38F, 1e38F, 1e38F};
  const TypeParam volume = kdop_around<faces(TypeParam{})>(box);
  ASSERT_TRUE(volume.is_valid());
  for (std::size_t s = 0; s < 3; ++s) {
    EXPECT_LE(volume.min[s], 1e38F);
    EXPECT_GE(volume.max[s], 3e38F);
  }
}

TYPED_TEST(KdopTest, volume_of_a_rotated_box_is_tight) {
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const double scale = random.log_uniform(1e-30, 1e30);
    OrientedBox box;
    box.center = random_point(random, scale);
    box.half = random_point(random, scale * random.log_uniform(1e-3, 1.0)).cwiseAbs();
    const Eigen::Vector3d axis(random.uniform(-1, 1), random.uniform(-1, 1), 1.0);
    box.axes = Eigen::AngleAxisd(random.uniform(-4, 4), axis.normalized())
                   .toRotationMatrix()
                   .cast<float>();
    const TypeParam volume = kdop_around<faces(TypeParam{})>(box);
    ASSERT_TRUE(volume.is_valid());
    const auto directions = kdop_directions<faces(TypeParam{})>();
    for (std::size_t s = 0; s < TypeParam::kSlabs; ++s) {
      long double most = 0;
      long double middle = 0;
      for (Eigen::Index a = 0; a < 3; ++a) {
        const long double d = directions[s][static_cast<std::size_t>(a)];
        middle += d * static_cast<long double>(box.center[a]);
      }
      for (Eigen::Index e = 0; e < 3; ++e) {
        long double part = 0;
        for (Eigen::Index a = 0; a < 3; ++a) {
          const long double d = directions[s][static_cast<std::size_t>(a)];
          part +=
              d * static_cast<long double>(box.axes(a, e)) * static_cast<long double>(box.half[e]);
        }
        most += std::abs(part);
      }
      const auto low = static_cast<long double>(volume.min[s]);
      const auto high = static_cast<long double>(volume.max[s]);
      ASSERT_LE(low, middle - most);
      ASSERT_GE(high, middle + most);
      const long double slack = 4e-7L * (std::abs(middle) + most) + 1e-13L * scale;
      ASSERT_GE(low, middle - most - slack);
      ASSERT_LE(high, middle + most + slack);
    }
  }
}

TYPED_TEST(KdopTest, points_of_mixed_magnitude_are_contained) {
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    Eigen::Vector3f p;
    for (int axis = 0; axis < 3; ++axis) {
      const double magnitude = random.log_uniform(1e-44, 3e37);
      p[axis] = static_cast<float>(random.chance(0.5) ? magnitude : -magnitude);
    }
    ASSERT_TRUE(contains(TypeParam::around(std::vector<Eigen::Vector3f>{p}), p));
  }
}

TYPED_TEST(KdopTest, volume_of_a_box_contains_its_corners) {
  Random random(3);
  for (int i = 0; i < 3000; ++i) {
    const double scale = random.log_uniform(1e-35, 1e35);
    const Eigen::Vector3f a = random_point(random, scale);
    const Eigen::Vector3f b = random_point(random, scale);
    const Aabb box{a.cwiseMin(b), a.cwiseMax(b)};
    const TypeParam volume = TypeParam::around(box);
    ASSERT_EQ(volume.bounds(), box);
    for (unsigned corner = 0; corner < 8; ++corner) {
      Eigen::Vector3f p;
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = (corner >> axis & 1U) != 0 ? box.max[axis] : box.min[axis];
      }
      ASSERT_TRUE(contains(volume, p));
    }
  }
}

// A k-DOP separates point sets whose boxes overlap.
TYPED_TEST(KdopTest, volumes_separate_sets_with_overlapping_boxes) {
  const std::vector<Eigen::Vector3f> low{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}};
  const std::vector<Eigen::Vector3f> high{{4, 4, 4}, {4, 3.5F, 3.5F}, {3.5F, 4, 3.5F}};
  const TypeParam a = TypeParam::around(low);
  const TypeParam b = TypeParam::around(high);
  EXPECT_TRUE(a.bounds().overlaps(b.bounds()));
  EXPECT_FALSE(a.overlaps(b));
  EXPECT_FALSE(b.overlaps(a));
  EXPECT_TRUE(a.overlaps(a));
}

TYPED_TEST(KdopTest, sets_that_share_a_point_always_overlap) {
  Random random(4);
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3f shared = random_point(random, 1.0);
    std::vector<Eigen::Vector3f> a{shared};
    std::vector<Eigen::Vector3f> b{shared};
    for (int n = 0; n < 4; ++n) {
      a.push_back(random_point(random, 1.0));
      b.push_back(random_point(random, 1.0));
    }
    ASSERT_TRUE(TypeParam::around(a).overlaps(TypeParam::around(b)));
  }
}

TYPED_TEST(KdopTest, volumes_that_touch_in_every_slab_overlap) {
  const TypeParam a = TypeParam::around(Aabb{{0, 0, 0}, {1, 1, 1}});
  const TypeParam b = TypeParam::around(Aabb{{1, 1, 1}, {2, 2, 2}});
  EXPECT_TRUE(a.overlaps(b));
  EXPECT_FALSE(a.overlaps(TypeParam::around(Aabb{{1.5F, 1, 1}, {2, 2, 2}})));
}

TYPED_TEST(KdopTest, default_volume_is_empty) {
  const TypeParam full = TypeParam::around(Aabb{{-1, -1, -1}, {1, 1, 1}});
  EXPECT_FALSE(TypeParam{}.is_valid());
  EXPECT_FALSE(TypeParam{}.overlaps(full));
  EXPECT_EQ(TypeParam::around(std::vector<Eigen::Vector3f>{}).min, TypeParam{}.min);
}

TYPED_TEST(KdopTest, nan_inverted_and_infinite_slabs_are_invalid) {
  const TypeParam good = TypeParam::around(Aabb{{-1, -1, -1}, {1, 1, 1}});
  constexpr float inf = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  ASSERT_TRUE(good.is_valid());
  for (std::size_t s = 0; s < TypeParam::kSlabs; ++s) {
    for (const auto& [low, high] :
         {std::pair{nan, 1.0F}, {0.0F, nan}, {2.0F, 1.0F}, {inf, inf}, {-inf, -inf}}) {
      TypeParam bad = good;
      bad.min[s] = low;
      bad.max[s] = high;
      EXPECT_FALSE(bad.is_valid()) << "slab " << s << ": " << low << " .. " << high;
    }
  }
}

TYPED_TEST(KdopTest, volume_of_an_unbounded_box_is_valid) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  const Aabb ground{{-inf, -inf, -1}, {inf, inf, 0}};
  const Aabb corner{{0, 0, 0}, {inf, inf, inf}};
  const TypeParam far_below = TypeParam::around(Aabb{{1e20F, -1e20F, -0.5F}, {1e20F, 1e20F, 3}});
  EXPECT_TRUE(TypeParam::around(ground).is_valid());
  EXPECT_TRUE(TypeParam::around(ground).overlaps(far_below));
  EXPECT_TRUE(TypeParam::around(corner).is_valid());
  EXPECT_TRUE(TypeParam::around(corner).overlaps(
      TypeParam::around(Aabb{{1e30F, 1e30F, 1e30F}, {2e30F, 2e30F, 2e30F}})));
}

}  // namespace
}  // namespace winnow::test
