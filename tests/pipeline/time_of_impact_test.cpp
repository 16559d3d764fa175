// Times of impact of moving shapes, compared with closed forms, and with a proof by distances that
// the shapes are apart at every earlier time (motion_reference.h).

#include <gtest/gtest.h>
#include <winnow/pipeline/impacts.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory_resource>
#include <numbers>
#include <vector>

#include "tests/pipeline/motion_reference.h"
#include "tests/support/answers.h"
#include "tests/support/platform.h"

namespace winnow::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kEndless = std::numeric_limits<double>::infinity();

/// The result for a single pair.
struct PairImpact {
  Status status = Status::ok;
  bool hit = false;
  double time = 0.0;
  double gap = 0.0;
  double error = 0.0;
  Vec3d normal;
  Vec3d point;
};

PairImpact impact_of(const ShapePool& pool, const MovingShapes& pair, double tolerance = 1e-6) {
  ImpactResult result;
  const BodyPair pairs[1] = {{0, 1}};
  PairImpact impact;
  impact.status =
      time_of_impact(pool, {pair.shape, pair.motion}, pairs, {.tolerance = tolerance}, result);
  if (impact.status != Status::ok) return impact;
  impact.status = result.status(0);
  impact.hit = result.hits(0);
  impact.time = result.time()[0];
  impact.gap = result.gap()[0];
  impact.error = result.error_bound()[0];
  for (int i = 0; i < 3; ++i) {
    impact.normal[i] = result.normal(i)[0];
    impact.point[i] = result.point(i)[0];
  }
  return impact;
}

template <typename Shape>
ShapeId added(ShapePool& pool, const Shape& shape) {
  ShapeId id = expect_ok(pool.add(shape));
  return id;
}

RigidMotion moving(const Pose& start, Vec3d travel, Vec3d turn = {}) {
  return {start, {travel.x(), travel.y(), travel.z()}, {turn.x(), turn.y(), turn.z()}};
}

TEST(TimeOfImpact, impact_is_never_late_and_within_tolerance) {
  const std::vector<ShapeKind> kinds = moving_kinds();
  Random random(71);
  std::size_t unproved = 0;
  const std::size_t count = scaled(2500);
  for (std::size_t n = 0; n < count; ++n) {
    const ShapeKind a = kinds[random.below(kinds.size())];
    const ShapeKind b = kinds[random.below(kinds.size())];
    const PairStyle made = kPairStyles[random.below(std::size(kPairStyles))];
    const MotionStyle style = kMotionStyles[random.below(std::size(kMotionStyles))];
    PairScene scene;
    add_pairs(scene, a, b, made, 1, random);
    const MovingShapes pair = moving_pair(scene, scene.pairs[0], style, random);
    if (!pair.motion[0].is_valid() || !pair.motion[1].is_valid()) continue;
    constexpr double kTolerances[] = {1e-6, 1e-6, 1e-3, 1e-9};
    const double tolerance = kTolerances[random.below(std::size(kTolerances))];
    const PairImpact found = impact_of(scene.pool, pair, tolerance);
    ASSERT_EQ(found.status, Status::ok);
    SCOPED_TRACE(testing::Message()
                 << n << ": " << to_string(a) << " " << to_string(b) << " " << to_string(made)
                 << " " << to_string(style) << " " << tolerance);
    const Before then = before(scene.pool, pair, found.time, 2000);
    EXPECT_NE(then, Before::overlapping);
    unproved += then == Before::apart ? 0 : 1;
    if (!found.hit) continue;
    const DistanceAt at = distance_at(scene.pool, pair, found.time);
    const double resolution = resolution_of(scene.pool, pair);
    EXPECT_LE(std::abs(at.distance - found.gap), at.error + found.error + resolution);
    // Skip the gap if the solver's own error exceeds it.
    const double max_gap = tolerance * size_of(scene.pool, pair);
    if (doubt_of(scene.pool, pair) > max_gap) continue;
    EXPECT_LE(at.distance - at.error, max_gap + resolution);
  }
  EXPECT_LE(unproved, count / 50);
}

TEST(TimeOfImpact, balls_match_closed_form) {
  ShapePool pool;
  const ShapeId ball = added(pool, SphereShape{0.5});
  const MovingShapes pair{{ball, ball},
                          {RigidMotion::stationary(Pose::at(0, 0, 0)),
                           moving(Pose::at(5, 0.6, 0), {-10, 0, 0}, {0, 0, 100})}};
  const PairImpact found = impact_of(pool, pair);
  ASSERT_TRUE(found.hit);
  EXPECT_NEAR(found.time, 0.5 - 0.08, 1e-6);
  EXPECT_LE(found.time, 0.5 - 0.08);
  EXPECT_NEAR(found.normal[0], 0.8, 1e-5);
  EXPECT_NEAR(found.normal[1], 0.6, 1e-5);
  EXPECT_NEAR(found.point[0], 0.4, 1e-5);
}

// A thin rod of length 2 turns about its centre. A ball comes within reach of its tip after nearly
// twenty turns.
TEST(TimeOfImpact, rod_tip_hits_after_twenty_turns) {
  ShapePool pool;
  const ShapeId rod = added(pool, BoxShape{{1.0, 1e-4, 1e-4}});
  const ShapeId ball = added(pool, SphereShape{0.1});
  const double turns = 20.0;
  // The ball comes down and is within reach only at the very end.
  const MovingShapes pair{{rod, ball},
                          {moving(Pose::at(0, 0, 0), {}, {0, 0, 2 * kPi * turns}),
                           moving(Pose::at(1.05, 0, 3), {0, 0, -3})}};
  const PairImpact found = impact_of(pool, pair);
  ASSERT_TRUE(found.hit);
  EXPECT_GT(found.time, (3.0 - 0.11) / 3.0);
  EXPECT_NE(before(pool, pair, found.time, 20000), Before::overlapping);
  EXPECT_LE(distance_at(pool, pair, found.time).distance, 1e-7);
}

TEST(TimeOfImpact, initial_touch_hits_at_time_zero) {
  ShapePool pool;
  const ShapeId box = added(pool, BoxShape{{1, 1, 1}});
  const RigidMotion at_rest = RigidMotion::stationary(Pose::at(0, 0, 0));
  // Exactly touching, and separating at once.
  const PairImpact touching =
      impact_of(pool, {{box, box}, {at_rest, moving(Pose::at(2, 0, 0), {1, 0, 0})}});
  EXPECT_TRUE(touching.hit);
  EXPECT_EQ(touching.time, 0.0);
  EXPECT_EQ(touching.gap, 0.0);
  const PairImpact deep =
      impact_of(pool, {{box, box}, {at_rest, moving(Pose::at(1.5, 0, 0), {1, 0, 0}, {1, 2, 3})}});
  EXPECT_TRUE(deep.hit);
  EXPECT_EQ(deep.time, 0.0);
  EXPECT_NEAR(deep.gap, -0.5, 1e-12);
  EXPECT_NEAR(deep.normal[0], 1.0, 1e-12);
}

TEST(TimeOfImpact, sliding_or_separating_within_tolerance_misses) {
  ShapePool pool;
  const ShapeId floor = added(pool, HalfSpaceShape{{0, 0, 1}, 0});
  const ShapeId box = added(pool, BoxShape{{1, 1, 1}});
  const ShapeId wheel = added(pool, CylinderShape{1, 0.2});
  const RigidMotion at_rest = RigidMotion::stationary(Pose::at(0, 0, 0));
  const Pose near = Pose::at(0, 0, 1 + 1e-7);
  EXPECT_FALSE(impact_of(pool, {{floor, box}, {at_rest, moving(near, {5, 2, 0})}}).hit);
  EXPECT_FALSE(impact_of(pool, {{floor, box}, {at_rest, moving(near, {5, 2, 1})}}).hit);
  EXPECT_FALSE(impact_of(pool, {{box, floor}, {moving(near, {}, {0, 0, 30}), at_rest}}).hit);
  EXPECT_TRUE(impact_of(pool, {{floor, box}, {at_rest, moving(near, {5, 2, -1e-3})}}).hit);
  // The wheel rolls along y about its own axis.
  Pose rolling = near;
  rolling.orientation[0] = rolling.orientation[2] = std::sqrt(0.5);
  EXPECT_FALSE(
      impact_of(pool, {{floor, wheel}, {at_rest, moving(rolling, {0, 50, 0}, {-50, 0, 0})}}).hit);
}

TEST(TimeOfImpact, grazing_pass_hits_only_within_tolerance) {
  ShapePool pool;
  const ShapeId ball = added(pool, SphereShape{1});
  const RigidMotion at_rest = RigidMotion::stationary(Pose::at(0, 0, 0));
  for (const double miss : {1e-5, 1e-3}) {
    EXPECT_FALSE(
        impact_of(pool, {{ball, ball}, {at_rest, moving(Pose::at(-5, 2 + miss, 0), {10, 0, 0})}})
            .hit);
  }
  for (const double overlap : {1e-9, 1e-6, 1e-3}) {
    const MovingShapes pair{{ball, ball},
                            {at_rest, moving(Pose::at(-5, 2 - overlap, 0), {10, 0, 0})}};
    const PairImpact found = impact_of(pool, pair);
    EXPECT_TRUE(found.hit);
    EXPECT_NE(before(pool, pair, found.time, 100000), Before::overlapping);
  }
}

TEST(TimeOfImpact, far_or_swapped_pairs_give_equal_times) {
  ShapePool pool;
  const ShapeId box = added(pool, BoxShape{{1, 0.5, 0.25}});
  const ShapeId cone = added(pool, ConeShape{1, 1});
  const auto at = [&](double offset) {
    return MovingShapes{{box, cone},
                        {moving(Pose::at(offset, 0, 0), {1, 0, 0}, {1, 2, 3}),
                         moving(Pose::at(offset + 4, 0.5, 0), {-3, 0, 0}, {0, 5, 0})}};
  };
  const PairImpact near = impact_of(pool, at(0));
  const PairImpact far = impact_of(pool, at(1e9));
  ASSERT_TRUE(near.hit && far.hit);
  EXPECT_EQ(near.time, far.time);
  EXPECT_EQ(near.gap, far.gap);
  EXPECT_EQ(near.point, far.point);
  MovingShapes mirrored = at(0);
  std::swap(mirrored.shape[0], mirrored.shape[1]);
  std::swap(mirrored.motion[0], mirrored.motion[1]);
  const PairImpact back = impact_of(pool, mirrored);
  EXPECT_EQ(near.time, back.time);
  EXPECT_EQ(near.gap, back.gap);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(near.normal[i], -back.normal[i]);
    const double apart =
        mirrored.motion[0].at(near.time).position[i] - mirrored.motion[1].at(near.time).position[i];
    EXPECT_NEAR(near.point[i] + near.gap * near.normal[i], back.point[i] + apart, 1e-12);
  }
}

TEST(TimeOfImpact, turning_half_spaces_match_closed_form) {
  ShapePool pool;
  const ShapeId plane = added(pool, HalfSpaceShape{{0, 0, 1}, 0});
  const ShapeId ball = added(pool, SphereShape{0.5});
  // The plane turns about the x axis until it touches the ball at y = 10.
  const MovingShapes pair{{plane, ball},
                          {moving(Pose::at(0, 0, 0), {}, {kPi / 2, 0, 0}),
                           RigidMotion::stationary(Pose::at(0, 10, 1))}};
  const PairImpact found = impact_of(pool, pair);
  ASSERT_TRUE(found.hit);
  const double angle = std::atan2(1, 10) - std::asin(0.5 / std::hypot(1, 10));
  EXPECT_NEAR(found.time, angle / (kPi / 2), 1e-6);
  EXPECT_LE(found.time, angle / (kPi / 2));
  // Two half-spaces that face and approach each other.
  Pose above = Pose::at(0, 0, 2);
  above.orientation[0] = 0.0;
  above.orientation[1] = 1.0;
  const RigidMotion at_rest = RigidMotion::stationary(Pose::at(0, 0, 0));
  const PairImpact planes = impact_of(pool, {{plane, plane}, {at_rest, moving(above, {9, 0, -4})}});
  EXPECT_TRUE(planes.hit);
  EXPECT_NEAR(planes.time, 0.5, 1e-6);
  EXPECT_FALSE(impact_of(pool, {{plane, plane}, {at_rest, moving(above, {9, 0, 4})}}).hit);
  const PairImpact turning =
      impact_of(pool, {{plane, plane}, {at_rest, moving(above, {}, {1, 0, 0})}});
  EXPECT_TRUE(turning.hit);
  EXPECT_EQ(turning.time, 0.0);
}

TEST(TimeOfImpact, invalid_motions_are_refused) {
  ShapePool pool;
  const ShapeId ball = added(pool, SphereShape{1});
  const ShapeId box = added(pool, BoxShape{{1, 1, 1}});
  const ShapeId plane = added(pool, HalfSpaceShape{{0, 0, 1}, 0});
  const RigidMotion at_rest = RigidMotion::stationary(Pose::at(0, 0, 0));
  for (const ShapeId other : {ball, box, plane}) {
    const auto status_of = [&](const RigidMotion& of_ball, const RigidMotion& of_other) {
      const PairImpact found = impact_of(pool, {{ball, other}, {of_ball, of_other}});
      const PairImpact mirrored = impact_of(pool, {{other, ball}, {of_other, of_ball}});
      EXPECT_EQ(found.status, mirrored.status);
      EXPECT_FALSE(found.status != Status::ok && (found.hit || mirrored.hit));
      return found.status;
    };
    const auto status_with = [&](const RigidMotion& motion) {
      const Status status = status_of(at_rest, motion);
      EXPECT_EQ(status_of(motion, at_rest), status);
      return status;
    };
    EXPECT_EQ(status_with(at_rest), Status::ok);
    EXPECT_EQ(status_with(moving(Pose::at(0, 0, 0), {kNan, 0, 0})), Status::invalid_pose);
    EXPECT_EQ(status_with(moving(Pose::at(0, 0, 0), {kEndless, 0, 0})), Status::invalid_pose);
    EXPECT_EQ(status_with(moving(Pose::at(0, 0, 0), {}, {0, kNan, 0})), Status::invalid_pose);
    EXPECT_EQ(status_with(moving(Pose::at(0, 0, 0), {}, {0, 2e6, 0})), Status::invalid_pose);
    EXPECT_EQ(status_with(moving(Pose::at(kNan, 0, 0), {})), Status::invalid_pose);
    Pose unturned = Pose::at(1, 2, 3);
    unturned.orientation[0] = 0.0;
    EXPECT_EQ(status_with(RigidMotion::stationary(unturned)), Status::invalid_pose);
    EXPECT_EQ(status_with(RigidMotion::between(Pose::at(0, 0, 0), unturned)), Status::invalid_pose);
    EXPECT_EQ(status_with(RigidMotion::between(Pose::at(-1e308, 0, 0), Pose::at(1e308, 0, 0))),
              Status::invalid_pose);
    // Side by side all the way, until positions overflow.
    const RigidMotion away = moving(Pose::at(1e308, 0, 0), {1e308, 0, 0});
    EXPECT_EQ(status_of(away, away), Status::invalid_pose);
  }
  EXPECT_EQ(impact_of(pool, {{ball, ShapeId{}}, {at_rest, at_rest}}).status, Status::invalid_key);
  EXPECT_EQ(
      impact_of(pool, {{ShapeId::of(CompositeKind::mesh, 0), ball}, {at_rest, at_rest}}).status,
      Status::unsupported);
  ImpactResult result;
  const ShapeId shapes[2] = {ball, ball};
  const RigidMotion motions[2] = {at_rest, at_rest};
  const BodyPair pairs[1] = {{0, 1}};
  const BodyPair beyond[1] = {{0, 2}};
  EXPECT_EQ(time_of_impact(pool, {shapes, std::span(motions, 1)}, pairs, {}, result),
            Status::size_mismatch);
  EXPECT_EQ(time_of_impact(pool, {shapes, motions}, beyond, {}, result), Status::invalid_argument);
  for (const double tolerance : {0.0, -1.0, 2.0, kNan}) {
    EXPECT_EQ(time_of_impact(pool, {shapes, motions}, pairs, {.tolerance = tolerance}, result),
              Status::invalid_argument);
  }
  EXPECT_EQ(result.size(), 0U);
}

TEST(TimeOfImpact, refused_memory_is_reported) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  ShapePool pool;
  const ShapeId ball = added(pool, SphereShape{1});
  const ShapeId shapes[2] = {ball, ball};
  const RigidMotion motions[2] = {RigidMotion::stationary({}), RigidMotion::stationary({})};
  const BodyPair pairs[1] = {{0, 1}};
  ImpactResult without_memory(std::pmr::null_memory_resource());
  EXPECT_EQ(time_of_impact(pool, {shapes, motions}, pairs, {}, without_memory),
            Status::out_of_memory);
  EXPECT_EQ(without_memory.size(), 0U);
}

TEST(TimeOfImpact, impacts_match_on_any_thread_count) {
  Random random(73);
  PairScene scene;
  for (const ShapeKind kind : moving_kinds()) {
    add_pairs(scene, ShapeKind::box, kind, PairStyle::ordinary, 40, random);
  }
  std::vector<RigidMotion> motions(scene.shapes.size());
  for (const BodyPair& pair : scene.pairs) {
    const MovingShapes moves = moving_pair(scene, pair, MotionStyle::moving, random);
    motions[pair.a] = moves.motion[0];
    motions[pair.b] = moves.motion[1];
  }
  ImpactResult serial;
  ImpactResult parallel;
  const MovingBodies bodies{scene.shapes, motions};
  ASSERT_EQ(time_of_impact(scene.pool, bodies, scene.pairs, {}, serial), Status::ok);
  ASSERT_EQ(time_of_impact(scene.pool, bodies, scene.pairs, {.execution = Execution::parallel()},
                           parallel),
            Status::ok);
  EXPECT_TRUE(std::ranges::equal(serial.time(), parallel.time()));
  EXPECT_TRUE(std::ranges::equal(serial.gap(), parallel.gap()));
  EXPECT_TRUE(std::ranges::equal(serial.normal(0), parallel.normal(0)));
  EXPECT_GT(std::ranges::count(serial.hit(), std::uint8_t{1}), 100);
}

TEST(RigidMotions, motion_between_poses_takes_shorter_turn) {
  Random random(72);
  for (std::size_t n = scaled(5000); n-- != 0;) {
    Pose pose[2];
    for (Pose& p : pose) {
      for (double& x : p.position) x = random.uniform(-10, 10);
      for (double& q : p.orientation) q = random.uniform(-1, 1);
    }
    // Includes tiny turns and turns by almost half a turn.
    if (random.chance(0.3)) pose[1].orientation = pose[0].orientation;
    if (random.chance(0.5)) pose[1].orientation[1] += random.log_uniform(1e-18, 1.0);
    const RigidMotion motion = RigidMotion::between(pose[0], pose[1]);
    ASSERT_TRUE(motion.is_valid());
    EXPECT_LE(std::hypot(motion.turn[0], motion.turn[1], motion.turn[2]), kPi * (1 + 1e-15));
    const Pose end = motion.at(1.0);
    double cosine = 0.0;
    double square[2] = {0.0, 0.0};
    for (int i = 0; i < 4; ++i) {
      cosine += end.orientation[i] * pose[1].orientation[i];
      square[0] += end.orientation[i] * end.orientation[i];
      square[1] += pose[1].orientation[i] * pose[1].orientation[i];
    }
    const double sign = cosine < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(end.orientation[i] / std::sqrt(square[0]),
                  sign * pose[1].orientation[i] / std::sqrt(square[1]), 4e-15);
    }
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(end.position[i], pose[1].position[i], 1e-14);
  }
}

TEST(RigidMotions, motion_by_velocities_turns_by_full_angle) {
  const RigidMotion motion =
      RigidMotion::by_velocities(Pose::at(1, 2, 3), {1, 0, 0}, {0, 0, 2 * kPi}, 100.25);
  const Pose end = motion.at(1.0);
  EXPECT_NEAR(end.position[0], 101.25, 1e-12);
  EXPECT_NEAR(std::abs(end.orientation[0]), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(std::abs(end.orientation[3]), std::sqrt(0.5), 1e-12);
}

}  // namespace
}  // namespace winnow::test
