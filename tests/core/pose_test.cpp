#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/core/pose.h>

#include <Eigen/Geometry>
#include <array>
#include <numbers>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr double kPi = std::numbers::pi;

// A quaternion of any length up to `scale`, and the same rotation in Eigen.
struct RandomTurn {
  RandomTurn(Random& random, double scale) {
    for (double& q : turn) q = scale * random.uniform(-1.0, 1.0);
    eigen = Eigen::Quaterniond(turn).normalized();
  }
  Quaternion turn;
  Eigen::Quaterniond eigen;
};

Vec3d random_point(Random& random) {
  return {random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0)};
}

TEST(Quaternion, rotation_of_any_length_matches_eigen) {
  Random random(401);
  for (const double scale : {1e-150, 1.0, 1e150}) {
    for (int i = 0; i < 100; ++i) {
      const RandomTurn q(random, scale);
      const Vec3d v = random_point(random);
      const Eigen::Vector3d expected = q.eigen * as_eigen(v);
      EXPECT_LT((as_eigen(q.turn * v) - expected).norm(), 1e-13);
      EXPECT_LT((as_eigen(q.turn.inverse() * (q.turn * v)) - as_eigen(v)).norm(), 1e-13);
    }
  }
}

TEST(Quaternion, product_applies_inner_first) {
  Random random(402);
  for (int i = 0; i < 100; ++i) {
    const RandomTurn outer(random, 1.0);
    const RandomTurn inner(random, 1.0);
    const Vec3d v = random_point(random);
    const Eigen::Vector3d expected = outer.eigen * (inner.eigen * as_eigen(v));
    EXPECT_LT((as_eigen((outer.turn * inner.turn) * v) - expected).norm(), 1e-13);
  }
}

TEST(Quaternion, about_axis_turns_counter_clockwise) {
  const Vec3d turned = Quaternion::about({0, 0, 7}, kPi / 2) * Vec3d(1, 0, 0);
  EXPECT_LT((turned - Vec3d(0, 1, 0)).norm(), 1e-15);
  EXPECT_EQ(Quaternion::about({1, 2, 3}, 0.0), Quaternion());
}

TEST(Quaternion, conversion_to_eigen_keeps_coordinates) {
  const Quaternion q(1, 2, 3, 4);
  const Eigen::Quaterniond eigen = q;
  EXPECT_EQ(eigen.w(), 1.0);
  EXPECT_EQ(eigen.vec(), Eigen::Vector3d(2, 3, 4));
  EXPECT_EQ(Quaternion(eigen), q);
  EXPECT_EQ(Quaternion(std::array{1.0, 2.0, 3.0, 4.0}), q);
}

TEST(Pose, product_maps_through_both_frames) {
  Random random(403);
  for (int i = 0; i < 100; ++i) {
    const Pose outer{random_point(random), RandomTurn(random, 1.0).turn};
    const Pose inner{random_point(random), RandomTurn(random, 1.0).turn};
    const Vec3d v = random_point(random);
    EXPECT_LT((outer * inner * v - outer * (inner * v)).norm(), 1e-13);
  }
}

TEST(Pose, inverse_maps_back) {
  Random random(404);
  for (int i = 0; i < 100; ++i) {
    const Pose pose{random_point(random), RandomTurn(random, 1e3).turn};
    const Vec3d v = random_point(random);
    EXPECT_LT((pose.inverse() * (pose * v) - v).norm(), 1e-13);
  }
}

TEST(Pose, at_has_no_rotation) {
  EXPECT_EQ(Pose::at({1, 2, 3}), Pose::at(1, 2, 3));
  EXPECT_EQ(Pose::at(1, 2, 3) * Vec3d(1, 1, 1), Vec3d(2, 3, 4));
}

}  // namespace
}  // namespace winnow::test
