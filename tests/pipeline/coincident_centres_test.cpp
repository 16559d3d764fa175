// Cylinders, cones and capsules with coincident centres and nearly parallel axes: many directions
// are nearly optimal, and the error bounds must still be narrow.

#include <gtest/gtest.h>
#include <winnow/core/pose.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers/rotation.h"
#include "tests/pipeline/pair_results.h"
#include "tests/pipeline/pair_scenes.h"
#include "tests/support/answers.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr NarrowTier kTiers[] = {NarrowTier::robust, NarrowTier::reference};

/// Adds a pair at the same position with axes tilted against each other.
template <typename A, typename B>
void add_tilted_pair(const A& a, const B& b, double tilt, Random& random, PairScene& scene) {
  const auto n = static_cast<std::uint32_t>(scene.shapes.size());
  scene.shapes.resize(n + 2);
  scene.shapes[n] = expect_ok(scene.pool.add(a));
  scene.shapes[n + 1] = expect_ok(scene.pool.add(b));
  Pose pose;
  scene.poses.push_back(pose);
  const double way = random.uniform(0.0, 2.0 * std::numbers::pi);
  pose.orientation[0] = std::cos(0.5 * tilt);
  pose.orientation[1] = std::sin(0.5 * tilt) * std::cos(way);
  pose.orientation[2] = std::sin(0.5 * tilt) * std::sin(way);
  scene.poses.push_back(pose);
  scene.pairs.push_back({n, n + 1});
}

// A cylinder that is at least as high as wide contains a capsule of the same radius. The direction
// of least depth is therefore perpendicular to both axes, and the depth is the sum of the radii.
TEST(CoincidentCentres, long_cylinders_and_capsules_have_narrow_bounds) {
  Random random(1);
  PairScene scene;
  std::vector<double> depth;
  for (std::size_t n = scaled(150); n-- != 0;) {
    const double tilt = random.log_uniform(1e-14, 1.0);
    const CylinderShape a{random.uniform(0.2, 1.0), random.uniform(1.0, 2.0), 0.0};
    const CylinderShape b{random.uniform(0.2, 1.0), random.uniform(1.0, 2.0), 0.125};
    const CapsuleShape c{random.uniform(0.2, 1.0), random.uniform(1.0, 2.0)};
    add_tilted_pair(a, b, tilt, random, scene);
    add_tilted_pair(c, b, tilt, random, scene);
    depth.push_back(a.radius + b.radius + b.rounding);
    depth.push_back(c.radius + b.radius + b.rounding);
  }
  for (const NarrowTier tier : kTiers) {
    const auto answers = compute_results(scene, {.level = ContactLevel::distance, .tier = tier});
    for (std::size_t i = 0; i < answers.size(); ++i) {
      EXPECT_LE(std::abs(answers[i].distance + depth[i]), answers[i].error_bound) << i;
      EXPECT_LE(answers[i].error_bound, 4e-7) << i;
    }
  }
}

TEST(CoincidentCentres, cones_turned_by_rounding_have_narrow_bounds) {
  Random random(2);
  PairScene scene;
  const auto length = [&] { return random.uniform(0.2, 1.0); };
  for (std::size_t n = scaled(80); n-- != 0;) {
    const double tilt = random.log_uniform(1e-17, 1e-8);
    add_tilted_pair(ConeShape{length(), length(), 0.0}, ConeShape{length(), length(), 0.125}, tilt,
                    random, scene);
    add_tilted_pair(CylinderShape{length(), length(), 0.0}, ConeShape{length(), length(), 0.0},
                    tilt, random, scene);
    add_tilted_pair(CapsuleShape{length(), length()}, ConeShape{length(), length(), 0.0}, tilt,
                    random, scene);
  }
  for (const NarrowTier tier : kTiers) {
    for (const auto& answer :
         compute_results(scene, {.level = ContactLevel::distance, .tier = tier})) {
      EXPECT_LE(answer.error_bound, 4e-7);
    }
  }
}

/// Adds pairs in a tilted frame and appends their exact depths: a sphere on the segment of a
/// capsule, on a triangle, and equally near to two sides of a box; and capsules whose segments are
/// collinear or cross.
void add_aligned_pairs(PairScene& scene, std::vector<double>& depth, Random& random) {
  const Quaternion lean = normalized({random.uniform(0.5, 1.0), random.uniform(-1.0, 1.0),
                                      random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)});
  const auto length = [&] { return random.uniform(0.5, 1.0); };
  const auto put = [&](const auto& a, const auto& b, double along, const Quaternion& turn,
                       double deep) {
    add_tilted_pair(a, b, 0.0, random, scene);
    Pose& first = scene.poses[scene.poses.size() - 2];
    Pose& second = scene.poses.back();
    first.orientation = lean;
    second.orientation = (lean * turn);
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

TEST(CoincidentCentres, round_shapes_separate_sideways_almost_without_solver) {
  Random random(3);
  PairScene scene;
  std::vector<double> depth;
  for (std::size_t n = scaled(200); n-- != 0;) add_aligned_pairs(scene, depth, random);
  NarrowPhase narrow;
  NarrowResult result;
  const NarrowOptions options{.level = ContactLevel::distance};
  ASSERT_EQ(narrow.collide(scene.pool, scene.bodies(), scene.pairs, options, result), Status::ok);
  EXPECT_LE(narrow.statistics().recomputed, scene.pairs.size() / 50);
  const auto answers = compute_results(scene, options);
  for (BodyPair& pair : scene.pairs) std::swap(pair.a, pair.b);
  const auto mirrored = compute_results(scene, options);
  for (BodyPair& pair : scene.pairs) std::swap(pair.a, pair.b);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    EXPECT_LE(std::abs(answers[i].distance + depth[i]), answers[i].error_bound) << i;
    for (const std::uint32_t body : {scene.pairs[i].a, scene.pairs[i].b}) {
      if (scene.shapes[body].kind() != ShapeKind::capsule) continue;
      const auto rotation = rotation_of(scale_to_unit_max(scene.poses[body].orientation));
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
