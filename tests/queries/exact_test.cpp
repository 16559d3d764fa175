// Tests the reference implementation with known results.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/queries/answers.h"
#include "tests/support/exact.h"

namespace winnow::test {
namespace {

using Eigen::Vector3f;

const Aabb kUnit{Vector3f::Zero(), Vector3f::Ones()};

TEST(Exact, exact_numbers_cover_the_range_of_float) {
  const Exact big(static_cast<double>(std::numeric_limits<float>::max()));
  const Exact small(static_cast<double>(std::numeric_limits<float>::denorm_min()));
  EXPECT_EQ((big + small - big - small).sign(), 0);
  EXPECT_EQ((big + small - big).sign(), 1);
  EXPECT_EQ((big - small - big).sign(), -1);
  const Exact product = (big + small) * (big - small);
  EXPECT_EQ((product - big * big + small * small).sign(), 0);
  EXPECT_EQ((product - big * big).sign(), -1);
  const Exact cube = (big + small) * (big + small) * (big + small);
  EXPECT_EQ((cube - big * big * big).sign(), 1);
  EXPECT_EQ((cube - big * big * big - big * big * small * 3.0 - big * small * small * 3.0 -
             small * small * small)
                .sign(),
            0);
}

TEST(Exact, grazing_ray_differs_from_miss_by_ulp) {
  Ray ray{{-1.0F, 1.0F, 0.5F}, {1.0F, 0.0F, 0.0F}};
  EXPECT_TRUE(truth_of(ray, kUnit).must);
  EXPECT_TRUE(is_first_touch(1.0F, truth_of(ray, kUnit)));
  EXPECT_FALSE(is_first_touch(std::nextafter(1.0F, 2.0F), truth_of(ray, kUnit)));
  EXPECT_FALSE(is_first_touch(1.0F - 0x1p-23F, truth_of(ray, kUnit)));
  ray.origin.y() = std::nextafter(1.0F, 2.0F);
  EXPECT_FALSE(truth_of(ray, kUnit).may);
  // Through the edge x = 0, y = 1: the ray enters on x and leaves on y at t = 1.
  ray = {{-1.0F, 0.0F, 0.5F}, {1.0F, 1.0F, 0.0F}};
  EXPECT_TRUE(truth_of(ray, kUnit).must);
  ray.direction.y() = std::nextafter(1.0F, 2.0F);
  EXPECT_FALSE(truth_of(ray, kUnit).may);
  ray.direction.y() = std::nextafter(1.0F, 0.0F);
  EXPECT_TRUE(truth_of(ray, kUnit).must);
}

TEST(Exact, round_casts_touch_at_known_times) {
  const SphereCast ball{{{-3.0F, 0.5F, 0.5F}, 1.0F}, {2.0F, 0.0F, 0.0F}};
  EXPECT_TRUE(truth_of(ball, kUnit).must);
  EXPECT_NEAR(truth_of(ball, kUnit).earliest, 1.0, 1e-11);
  EXPECT_NEAR(truth_of(ball, kUnit).latest, 1.0, 1e-11);
  // Passes a corner at a distance of sqrt(2).
  SphereCast past{{{-3.0F, 2.0F, 2.0F}, 1.4143F}, {1.0F, 0.0F, 0.0F}};
  EXPECT_TRUE(truth_of(past, kUnit).must);
  EXPECT_NEAR(truth_of(past, kUnit).latest, 3.0 - std::sqrt(1.4143 * 1.4143 - 2.0), 1e-3);
  past.sphere.radius = 1.4142F;
  EXPECT_FALSE(truth_of(past, kUnit).may);
  // A capsule that crosses an edge at a right angle.
  const CapsuleCast capsule{{{-2.0F, 0.5F, -4.0F}, {2.0F, 0.5F, -4.0F}, 0.5F}, {0.0F, 0.0F, 1.0F}};
  EXPECT_TRUE(truth_of(capsule, kUnit).must);
  EXPECT_NEAR(truth_of(capsule, kUnit).earliest, 3.5, 1e-4);
  EXPECT_NEAR(truth_of(capsule, kUnit).latest, 3.5, 1e-4);
}

TEST(Exact, regions_overlap_the_expected_boxes) {
  EXPECT_TRUE(truth_of(Region(Vector3f(1, 1, 1)), kUnit).must);
  EXPECT_FALSE(truth_of(Region(Vector3f(1, std::nextafter(1.0F, 2.0F), 1)), kUnit).may);
  EXPECT_TRUE(truth_of(Region(Sphere{{4, 1, 5}, 5.0F}), kUnit).must);
  EXPECT_FALSE(truth_of(Region(Sphere{{4, 1, 5}, 4.9999F}), kUnit).may);
  EXPECT_TRUE(truth_of(Region(Capsule{{3, -9, 0}, {3, 9, 0}, 2.001F}), kUnit).must);
  EXPECT_FALSE(truth_of(Region(Capsule{{3, -9, 0}, {3, 9, 0}, 1.999F}), kUnit).may);
  EXPECT_TRUE(truth_of(Region(OrientedBox{{3, 0, 0}, {2, 1, 1}}), kUnit).must);
  EXPECT_FALSE(truth_of(Region(OrientedBox{{3.0001F, 0, 0}, {2, 1, 1}}), kUnit).may);
  // A square rotated by 45 degrees beside the box: only the bounding boxes overlap.
  const float h = std::sqrt(0.5F);
  OrientedBox turned{{1.9F, 1.9F, 0.5F}, {1, 1, 1}};
  turned.axes = {h, -h, 0, h, h, 0, 0, 0, 1};
  EXPECT_FALSE(truth_of(Region(turned), kUnit).may);
  turned.center = {1.7F, 1.7F, 0.5F};
  EXPECT_TRUE(truth_of(Region(turned), kUnit).must);
  const std::vector<Plane> planes{{{1, 0, 0}, -1.0F}};
  EXPECT_TRUE(truth_of(Region(std::span<const Plane>(planes)), kUnit).must);
  EXPECT_FALSE(truth_of(Region(std::span<const Plane>(planes)), kUnit).may_inside);
  EXPECT_FALSE(truth_of(Region(std::span<const Plane>(planes)),
                        {Vector3f::Zero(), Vector3f::Constant(0.999F)})
                   .may);
}

}  // namespace
}  // namespace winnow::test
