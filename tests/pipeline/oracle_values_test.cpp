// The oracle compared with known values.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bench/oracle/oracle.h"
#include "tests/pipeline/pair_scenes.h"
#include "tests/support/answers.h"

namespace winnow::test {
namespace {

class Truths : public testing::Test {
 protected:
  template <typename Shape>
  ShapeId add(const Shape& shape) {
    ShapeId id = expect_ok(pool_.add(shape));
    return id;
  }
  [[nodiscard]] oracle::Truth solve(ShapeId a, const Pose& pose_a, ShapeId b,
                                    const Pose& pose_b) const {
    const oracle::Truth truth = oracle::solve(pool_.tables(), a, pose_a, b, pose_b);
    EXPECT_TRUE(truth.known);
    return truth;
  }

  ShapePool pool_;
};

TEST_F(Truths, spheres_have_known_distances) {
  const ShapeId one = add(SphereShape{1.0});
  const oracle::Truth apart = solve(one, Pose::at(1e9, 0, 0), one, Pose::at(1e9 + 3, 4, 0));
  EXPECT_EQ(apart.distance, 3.0L);
  EXPECT_FALSE(apart.overlap);
  EXPECT_TRUE(apart.normal_unique);
  EXPECT_DOUBLE_EQ(apart.normal[0], 0.6);
  EXPECT_DOUBLE_EQ(apart.normal[1], 0.8);
  const oracle::Truth touching = solve(one, Pose::at(0, 0, 0), one, Pose::at(0, 0, -2));
  EXPECT_EQ(touching.distance, 0.0L);
  EXPECT_TRUE(touching.overlap);
  const oracle::Truth same = solve(one, Pose{}, one, Pose{});
  EXPECT_EQ(same.distance, -2.0L);
  EXPECT_FALSE(same.normal_unique);
}

TEST_F(Truths, boxes_have_known_distances) {
  const ShapeId box = add(BoxShape{{1, 2, 3}, 0.0});
  const oracle::Truth deep = solve(box, Pose{}, box, Pose::at(1.5, 0.25, 0));
  EXPECT_EQ(deep.distance, -0.5L);
  EXPECT_EQ(deep.normal[0], 1.0);
  EXPECT_TRUE(deep.normal_unique);
  EXPECT_EQ(solve(box, Pose{}, box, Pose::at(0, 4, 6)).distance, 0.0L);
  EXPECT_EQ(solve(box, Pose{}, box, Pose::at(5, 8, 0)).distance, 5.0L);
  // Turned by 45 degrees about x: an edge touches the face.
  const oracle::Truth edge =
      solve(box, Pose{}, box, {{0, 5.5, 0}, {1, std::tan(std::numbers::pi / 8), 0, 0}});
  EXPECT_NEAR(static_cast<double>(edge.distance), 3.5 - 2.5 * std::sqrt(2.0), 1e-15);
  // Crossing edges: their cross product is the best axis.
  const double r = std::sqrt(0.5);
  const ShapeId rod = add(BoxShape{{r, r, 10}, 0.0});
  const Pose along_z{{0, 0, 0},
                     {std::cos(std::numbers::pi / 8), 0, 0, std::sin(std::numbers::pi / 8)}};
  const double h = std::numbers::pi / 8;
  const Pose along_y{
      {1.75, 0, 0},
      {std::cos(std::numbers::pi / 4) * std::cos(h), std::sin(std::numbers::pi / 4) * std::cos(h),
       -std::sin(std::numbers::pi / 4) * std::sin(h),
       std::cos(std::numbers::pi / 4) * std::sin(h)}};
  const oracle::Truth crossing = solve(rod, along_z, rod, along_y);
  EXPECT_NEAR(static_cast<double>(crossing.distance), -0.25, 1e-15);
  EXPECT_NEAR(crossing.normal[0], 1.0, 1e-14);
}

TEST_F(Truths, flat_shapes_have_known_distances) {
  const ShapeId flat = add(TriangleShape{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, 0.0});
  const ShapeId upright = add(TriangleShape{{{0.5, 0.5, -0.25}, {0.5, 0.5, 3}, {4, 4, 3}}, 0.0});
  const oracle::Truth pierced = solve(flat, Pose{}, upright, Pose{});
  EXPECT_EQ(pierced.distance, -0.25L);
  EXPECT_EQ(pierced.normal[2], 1.0);
  EXPECT_EQ(solve(flat, Pose{}, flat, Pose::at(0.5, 0.5, 0)).distance, 0.0L);
  EXPECT_EQ(solve(flat, Pose{}, flat, Pose::at(0.5, 0.5, 1e-30)).distance,
            static_cast<long double>(1e-30));
  const ShapeId segment = add(CapsuleShape{0.0, 1.0});
  EXPECT_EQ(solve(segment, Pose{}, segment, Pose::at(0, 0, 1)).distance, 0.0L);
  EXPECT_EQ(solve(segment, Pose{}, segment, Pose::at(0, 0, 5)).distance, 3.0L);
  const ShapeId tube = add(CapsuleShape{0.5, 1.0});
  EXPECT_EQ(solve(tube, Pose{}, tube, Pose::at(0, 0, 1)).distance, -1.0L);
}

TEST_F(Truths, half_spaces_have_known_distances) {
  const ShapeId ground = add(HalfSpaceShape{{0, 0, 2}, 2.0});
  const ShapeId box = add(BoxShape{{1, 1, 1}, 0.5});
  const oracle::Truth truth = solve(box, Pose::at(7, 8, 2), ground, Pose{});
  EXPECT_EQ(truth.distance, -0.5L);
  EXPECT_EQ(truth.normal[2], -1.0);
  const ShapeId cone = add(ConeShape{3.0, 4.0, 0.0});
  EXPECT_EQ(solve(ground, Pose{}, cone, Pose::at(0, 0, 6)).distance, 1.0L);
  EXPECT_EQ(solve(ground, Pose{}, cone, {{0, 0, 6}, {0, 1, 0, 0}}).distance, 1.0L);
}

/// No direction separates by more than the distance; the normal separates by it.
TEST_F(Truths, distance_is_widest_gap_of_all_directions) {
  Random random(71);
  for (const ShapeKind a : polytope_kinds()) {
    for (const ShapeKind b : polytope_kinds()) {
      PairScene scene;
      add_pairs(scene, a, b, PairStyle::ordinary, scaled(10), random);
      for (const BodyPair pair : scene.pairs) {
        const auto truth =
            oracle::solve(scene.pool.tables(), scene.shapes[pair.a], scene.poses[pair.a],
                          scene.shapes[pair.b], scene.poses[pair.b]);
        const auto back =
            oracle::solve(scene.pool.tables(), scene.shapes[pair.b], scene.poses[pair.b],
                          scene.shapes[pair.a], scene.poses[pair.a]);
        ASSERT_TRUE(truth.known);
        EXPECT_NEAR(static_cast<double>(truth.distance), static_cast<double>(back.distance), 1e-17);
        // Moving b along the normal to distance 0 makes the shapes touch, up to rounding.
        Pose moved = scene.poses[pair.b];
        for (int i = 0; i < 3; ++i) {
          moved.position[i] -= static_cast<double>(truth.distance) * truth.normal[i];
        }
        const auto after = oracle::solve(scene.pool.tables(), scene.shapes[pair.a],
                                         scene.poses[pair.a], scene.shapes[pair.b], moved);
        EXPECT_NEAR(static_cast<double>(after.distance), 0.0, 1e-14);
        // No shorter motion separates the shapes.
        for (int i = 0; i < 10 && truth.overlap; ++i) {
          double n[3];
          double square = 0.0;
          for (double& x : n) {
            x = random.uniform(-1.0, 1.0);
            square += x * x;
          }
          const double step = -0.99 * static_cast<double>(truth.distance) / std::sqrt(square);
          Pose inside = scene.poses[pair.b];
          for (int k = 0; k < 3; ++k) inside.position[k] += step * n[k];
          EXPECT_TRUE(oracle::solve(scene.pool.tables(), scene.shapes[pair.a], scene.poses[pair.a],
                                    scene.shapes[pair.b], inside)
                          .overlap);
        }
      }
    }
  }
}

}  // namespace
}  // namespace winnow::test
