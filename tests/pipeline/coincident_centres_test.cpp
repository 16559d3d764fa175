// Cylinders, cones and capsules whose centres are the same and whose axes are nearly so: many
// directions are nearly as good as the best, and bounds must be narrow all the same.

#include <gtest/gtest.h>
#include <winnow/core/rotation.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/pipeline/pair_answers.h"
#include "tests/pipeline/pair_scenes.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr NarrowTier kTiers[] = {NarrowTier::robust, NarrowTier::reference};

/// A pair at one place, its axes tilted against each other.
template <typename A, typename B>
void put_together(const A& a, const B& b, double tilt, Random& random, PairScene& scene) {
  const auto n = static_cast<std::uint32_t>(scene.shapes.size());
  scene.shapes.resize(n + 2);
  EXPECT_EQ(scene.pool.add(a, scene.shapes[n]), Status::ok);
  EXPECT_EQ(scene.pool.add(b, scene.shapes[n + 1]), Status::ok);
  Pose pose;
  scene.poses.push_back(pose);
  const double way = random.uniform(0.0, 2.0 * std::numbers::pi);
  pose.orientation[0] = std::cos(0.5 * tilt);
  pose.orientation[1] = std::sin(0.5 * tilt) * std::cos(way);
  pose.orientation[2] = std::sin(0.5 * tilt) * std::sin(way);
  scene.poses.push_back(pose);
  scene.pairs.push_back({n, n + 1});
}

// What stands as high as it is wide has a capsule within, of the same radius: the two of them part
// the soonest at right angles to both axes.
TEST(CoincidentCentres, of_long_cylinders_and_capsules_leave_narrow_bounds) {
  Random random(1);
  PairScene scene;
  std::vector<double> depth;
  for (std::size_t n = scaled(150); n-- != 0;) {
    const double tilt = random.log_uniform(1e-14, 1.0);
    const CylinderShape a{random.uniform(0.2, 1.0), random.uniform(1.0, 2.0), 0.0};
    const CylinderShape b{random.uniform(0.2, 1.0), random.uniform(1.0, 2.0), 0.125};
    const CapsuleShape c{random.uniform(0.2, 1.0), random.uniform(1.0, 2.0)};
    put_together(a, b, tilt, random, scene);
    put_together(c, b, tilt, random, scene);
    depth.push_back(a.radius + b.radius + b.rounding);
    depth.push_back(c.radius + b.radius + b.rounding);
  }
  for (const NarrowTier tier : kTiers) {
    const auto answers = ask(scene, {.level = ContactLevel::distance, .tier = tier});
    for (std::size_t i = 0; i < answers.size(); ++i) {
      EXPECT_LE(std::abs(answers[i].distance + depth[i]), answers[i].error_bound) << i;
      EXPECT_LE(answers[i].error_bound, 4e-7) << i;
    }
  }
}

TEST(CoincidentCentres, of_what_is_turned_by_rounding_leave_narrow_bounds) {
  Random random(2);
  PairScene scene;
  const auto length = [&] { return random.uniform(0.2, 1.0); };
  for (std::size_t n = scaled(80); n-- != 0;) {
    const double tilt = random.log_uniform(1e-17, 1e-8);
    put_together(ConeShape{length(), length(), 0.0}, ConeShape{length(), length(), 0.125}, tilt,
                 random, scene);
    put_together(CylinderShape{length(), length(), 0.0}, ConeShape{length(), length(), 0.0}, tilt,
                 random, scene);
    put_together(CapsuleShape{length(), length()}, ConeShape{length(), length(), 0.0}, tilt, random,
                 scene);
  }
  for (const NarrowTier tier : kTiers) {
    for (const auto& answer : ask(scene, {.level = ContactLevel::distance, .tier = tier})) {
      EXPECT_LE(answer.error_bound, 4e-7);
    }
  }
}

/// Spheres on the segments of capsules, on triangles and as near to two sides of a box, and
/// capsules whose segments are in one line or cross, in a frame that leans; with how deep they are.
void put_on_axes(PairScene& scene, std::vector<double>& depth, Random& random) {
  const Quaternion lean = normalized({random.uniform(0.5, 1.0), random.uniform(-1.0, 1.0),
                                      random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)});
  const auto length = [&] { return random.uniform(0.5, 1.0); };
  const auto put = [&](const auto& a, const auto& b, double along, const Quaternion& turn,
                       double deep) {
    put_together(a, b, 0.0, random, scene);
    Pose& first = scene.poses[scene.poses.size() - 2];
    Pose& second = scene.poses.back();
    std::copy_n(lean.begin(), 4, first.orientation);
    std::copy_n(product(lean, turn).begin(), 4, second.orientation);
    const auto rotation = rotation_of(lean);
    for (int k = 0; k < 3; ++k) second.position[k] = rotation(k, 2) * along;
    depth.push_back(deep);
  };
  constexpr Quaternion kStraight{1.0, 0.0, 0.0, 0.0};
  const double half_turn = random.uniform(0.05, 1.5);
  const SphereShape ball{length()};
  const CapsuleShape capsule[2] = {{length(), length()}, {length(), length()}};
  const double both = capsule[0].radius + capsule[1].radius;
  put(capsule[0], ball, random.uniform(-0.5, 0.5), kStraight, capsule[0].radius + ball.radius);
  put(capsule[0], capsule[1], random.uniform(0.01, 0.9), kStraight, both);
  put(capsule[0], capsule[1], 0.0, {std::cos(half_turn), std::sin(half_turn), 0.0, 0.0}, both);
  const double side = random.uniform(0.2, 0.4);
  put(BoxShape{{side, side, 1.0}, 0.125}, ball, random.uniform(-0.5, 0.5), kStraight,
      side + 0.125 + ball.radius);
  put(TriangleShape{{{-1.0, -1.0, 0.0}, {1.0, 0.0, 0.0}, {-1.0, 1.0, 0.0}}}, ball, 0.0, kStraight,
      ball.radius);
}

TEST(CoincidentCentres, of_round_shapes_part_across_others_and_hardly_need_the_solver) {
  Random random(3);
  PairScene scene;
  std::vector<double> depth;
  for (std::size_t n = scaled(200); n-- != 0;) put_on_axes(scene, depth, random);
  NarrowPhase narrow;
  NarrowResult result;
  const NarrowOptions asked{.level = ContactLevel::distance};
  ASSERT_EQ(narrow.collide(scene.pool, scene.bodies(), scene.pairs, asked, result), Status::ok);
  EXPECT_LE(narrow.statistics().recomputed, scene.pairs.size() / 50);
  const auto answers = ask(scene, asked);
  for (BodyPair& pair : scene.pairs) std::swap(pair.a, pair.b);
  const auto mirrored = ask(scene, asked);
  for (BodyPair& pair : scene.pairs) std::swap(pair.a, pair.b);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    EXPECT_LE(std::abs(answers[i].distance + depth[i]), answers[i].error_bound) << i;
    for (const std::uint32_t body : {scene.pairs[i].a, scene.pairs[i].b}) {
      if (scene.shapes[body].kind() != ShapeKind::capsule) continue;
      const auto rotation = rotation_of(tame(scene.poses[body].orientation));
      double along = 0.0;
      for (int k = 0; k < 3; ++k) along += rotation(k, 2) * answers[i].normal[k];
      EXPECT_NEAR(along, 0.0, 1e-12) << i;
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(mirrored[i].normal[k], -answers[i].normal[k], 1e-12) << i;
    }
  }
}

}  // namespace
}  // namespace winnow::test
