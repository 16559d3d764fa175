// A scene far from (0, 0, 0) finds the same pairs at the same cost as one near it.

#include <gtest/gtest.h>

#include <winnow/winnow.h>

#include <cmath>
#include <vector>

#include "tests/pipeline/scene_world.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

/// Multiples of this step are exact at the places below.
constexpr double kPlaceStep = 0x1p-16;
constexpr double kFarPlaces[][3] = {{1e8, 0, 0}, {-1e8, 1e8, 3e7}, {1e9, -2e9, 1e9}};

/// Rounds positions to multiples of kPlaceStep: they stay exact when they are moved far away.
void make_exact(SceneWorld& world) {
  for (BodyDefinition& body : world.bodies) {
    for (double& p : body.pose.position) p = std::round(p / kPlaceStep) * kPlaceStep;
  }
}

void displace(SceneWorld& world, const double by[3]) {
  for (BodyDefinition& body : world.bodies) {
    for (int k = 0; k < 3; ++k) body.pose.position[k] += by[k];
  }
}

std::uint64_t body_pairs(Scene& scene) {
  Contacts contacts;
  EXPECT_EQ(scene.collide(ContactLevel::boolean, contacts), Status::ok);
  return scene.statistics().body_pairs;
}

TEST(SceneOrigin, far_balls_have_tight_boxes) {
  ShapePool pool;
  ShapeId ball = expect_ok(pool.add(SphereShape{0.5}));
  Scene scene(pool);
  Key key = expect_ok(scene.add({.shape = ball, .pose = Pose::at(1e8, 0, 0)}));
  key = expect_ok(scene.add({.shape = ball, .pose = Pose::at(1e8 + 1.5, 0, 0)}));
  EXPECT_EQ(body_pairs(scene), 0U);
  ASSERT_EQ(scene.move(key, Pose::at(1e8 + 0.9, 0, 0)), Status::ok);
  EXPECT_EQ(body_pairs(scene), 1U);
  EXPECT_LT((scene.origin() - Vec3d(1e8, 0, 0)).norm(), 10.0);
}

TEST(SceneOrigin, scene_near_zero_keeps_origin_zero) {
  SceneWorld world(scaled(400));
  Scene scene(world.pool);
  ASSERT_EQ(add_all(scene, world), Status::ok);
  ASSERT_EQ(scene.refresh(), Status::ok);
  EXPECT_EQ(scene.origin(), Vec3d{});
}

TEST(SceneOrigin, far_scene_matches_near_scene_and_its_memory) {
  for (const auto& place : kFarPlaces) {
    SceneWorld near(scaled(1000));
    make_exact(near);
    SceneWorld far(scaled(1000));
    make_exact(far);
    displace(far, place);
    Scene near_scene(near.pool);
    Scene far_scene(far.pool);
    ASSERT_EQ(add_all(near_scene, near), Status::ok);
    ASSERT_EQ(add_all(far_scene, far), Status::ok);
    Contacts found;
    Contacts far_found;
    ASSERT_EQ(near_scene.collide(ContactLevel::distance, found), Status::ok);
    ASSERT_EQ(far_scene.collide(ContactLevel::distance, far_found), Status::ok);
    EXPECT_EQ(shown(far_found), shown(found));
    const auto near_pairs = static_cast<double>(near_scene.statistics().body_pairs);
    const auto far_pairs = static_cast<double>(far_scene.statistics().body_pairs);
    EXPECT_NEAR(far_pairs / near_pairs, 1.0, 0.02);
    const auto near_bytes = static_cast<double>(near_scene.footprint().total().used);
    const auto far_bytes = static_cast<double>(far_scene.footprint().total().used);
    EXPECT_NEAR(far_bytes / near_bytes, 1.0, 0.02);
  }
}

TEST(SceneOrigin, origin_follows_bodies_far_away_and_back) {
  SceneWorld world(300);
  make_exact(world);
  const double step[3] = {1e7, -3e6, 0};
  const double back[3] = {-4e7, 12e6, 0};
  Scene scene(world.pool);
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts before;
  ASSERT_EQ(scene.collide(ContactLevel::distance, before), Status::ok);
  const auto truth = shown(before);
  const std::uint64_t pairs = scene.statistics().body_pairs;
  for (int frame = 0; frame < 5; ++frame) {
    displace(world, frame < 4 ? step : back);
    ASSERT_EQ(move_all(scene, world), Status::ok);
    ASSERT_EQ(scene.refresh(), Status::ok);
    // The scene chooses its origin after the boxes are made: after a jump the boxes are tight one
    // frame later.
    ASSERT_EQ(move_all(scene, world), Status::ok);
    Contacts contacts;
    ASSERT_EQ(scene.collide(ContactLevel::distance, contacts), Status::ok);
    EXPECT_EQ(shown(contacts), truth);
    EXPECT_LE(scene.statistics().body_pairs, pairs + pairs / 20);
  }
}

TEST(SceneOrigin, two_distant_groups_find_all_pairs) {
  SceneWorld world(scaled(300));
  make_exact(world);
  for (std::size_t i = 0; i < world.bodies.size(); i += 3) {
    world.bodies[i].pose.position[1] += 1e8;
  }
  const auto truth = world.touching();
  Scene scene(world.pool);
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::distance, contacts), Status::ok);
  std::set<Names> names_of_truth;
  for (const auto& [pair, distance] : truth) names_of_truth.insert(pair);
  EXPECT_EQ(shown(contacts), names_of_truth);
}

TEST(SceneOrigin, refused_change_of_origin_is_made_later) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  for (std::size_t allowed = 0; allowed < 12; ++allowed) {
    CountingMemory memory;
    SceneWorld world(200);
    make_exact(world);
    Scene scene(world.pool, {.memory = &memory});
    ASSERT_EQ(add_all(scene, world), Status::ok);
    Contacts before(&memory);
    ASSERT_EQ(scene.collide(ContactLevel::distance, before), Status::ok);
    displace(world, kFarPlaces[0]);
    ASSERT_EQ(move_all(scene, world), Status::ok);
    Contacts contacts(&memory);
    memory.refuse_after(allowed);
    (void)scene.collide(ContactLevel::distance, contacts);
    ASSERT_EQ(move_all(scene, world), Status::ok);
    const Status refused = scene.collide(ContactLevel::distance, contacts);
    EXPECT_TRUE(refused == Status::ok || refused == Status::out_of_memory);
    memory.grant_all();
    ASSERT_EQ(scene.collide(ContactLevel::distance, contacts), Status::ok);
    EXPECT_EQ(shown(contacts), shown(before)) << allowed;
  }
}

}  // namespace
}  // namespace winnow::test
