// The contact cache: contacts that are kept from frame to frame (SceneOptions::cache_tolerance),
// compared with a fresh scene.

#include <winnow/winnow.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "tests/pipeline/composite_world.h"
#include "tests/pipeline/scene_world.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"

namespace winnow::test {
namespace {

constexpr double kCacheTolerance = 0.1;

/// Pairs of balls, 9 apart.
struct Balls {
  explicit Balls(std::size_t pairs, double gap) {
    ball = expect_ok(shapes.add(SphereShape{0.5}));
    for (std::size_t i = 0; i < pairs; ++i) {
      const double y = 9.0 * static_cast<double>(i);
      Key key = expect_ok(scene.add({.shape = ball, .pose = Pose::at(-0.5 - gap / 2, y, 0)}));
      left.push_back(key);
      key = expect_ok(scene.add({.shape = ball, .pose = Pose::at(0.5 + gap / 2, y, 0)}));
      right.push_back(key);
    }
  }
  /// Moves the two balls of a pair to the given gap.
  void part(std::size_t pair, double gap) {
    const double y = 9.0 * static_cast<double>(pair);
    ASSERT_EQ(scene.move(left[pair], Pose::at(-0.5 - gap / 2, y, 0)), Status::ok);
    ASSERT_EQ(scene.move(right[pair], Pose::at(0.5 + gap / 2, y, 0)), Status::ok);
  }

  ShapePool shapes;
  ShapeId ball;
  Scene scene{shapes, {.execution = Execution::serial(), .cache_tolerance = kCacheTolerance}};
  std::vector<Key> left;
  std::vector<Key> right;
};

std::set<std::uint32_t> shown_with(const Contacts& contacts, ContactEvent event) {
  std::set<std::uint32_t> ids;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (contacts.event()[i] == event) ids.insert(contacts.b()[i].id);
  }
  return ids;
}

TEST(ContactCache, resting_pairs_report_begin_and_end_events) {
  constexpr std::size_t kPairs = 8;
  Balls balls(kPairs, 0.03);
  for (std::size_t i = 0; i < kPairs; i += 2) balls.part(i, -0.01);
  Contacts contacts;
  for (int frame = 0; frame < 6; ++frame) {
    const bool swapped = frame % 2 == 1;
    ASSERT_EQ(balls.scene.collide(ContactLevel::manifold, contacts), Status::ok);
    std::set<std::uint32_t> touching;
    for (std::size_t i = 0; i < kPairs; ++i) {
      if ((i % 2 == 0) != swapped) touching.insert(balls.right[i].id);
    }
    EXPECT_EQ(shown_with(contacts, ContactEvent::begun), touching) << frame;
    EXPECT_EQ(contacts.ended().size(), frame == 0 ? 0 : kPairs / 2);
    for (const EndedContact& ended : contacts.ended()) EXPECT_FALSE(touching.contains(ended.b.id));
    // Moves by more than the cache tolerance, but not out of the fat boxes.
    for (std::size_t i = 0; i < kPairs; ++i) balls.part(i, (i % 2 == 0) != swapped ? 0.12 : -0.01);
  }
}

TEST(ContactCache, first_contact_among_resting_pairs_begins) {
  Balls balls(3, 0.03);
  Contacts contacts;
  ASSERT_EQ(balls.scene.collide(ContactLevel::manifold, contacts), Status::ok);
  EXPECT_EQ(contacts.size(), 0U);
  balls.part(2, -0.02);
  ASSERT_EQ(balls.scene.collide(ContactLevel::manifold, contacts), Status::ok);
  EXPECT_EQ(shown_with(contacts, ContactEvent::begun), std::set{balls.right[2].id});
  EXPECT_TRUE(contacts.ended().empty());
}

/// `collide` is called with a second Contacts while the pair sleeps.
TEST(ContactCache, pair_moved_while_asleep_is_recomputed) {
  Balls balls(2, -0.01);
  Contacts contacts;
  Contacts others;
  const auto set_body_state = [&](BodyState state) {
    for (const std::uint32_t id : {0U, 1U}) {
      const Key key{id, contacts.a()[0].stamp};
      ASSERT_EQ(balls.scene.set_body_state(key, state), Status::ok);
    }
  };
  ASSERT_EQ(balls.scene.collide(ContactLevel::distance, contacts), Status::ok);
  ASSERT_EQ(contacts.size(), 2U);
  set_body_state(BodyState::sleeping);
  ASSERT_EQ(balls.scene.collide(ContactLevel::distance, contacts), Status::ok);
  balls.part(0, -0.4);
  ASSERT_EQ(balls.scene.collide(ContactLevel::distance, contacts), Status::ok);
  ASSERT_EQ(balls.scene.collide(ContactLevel::distance, others), Status::ok);
  set_body_state(BodyState::dynamic);
  ASSERT_EQ(balls.scene.collide(ContactLevel::distance, contacts), Status::ok);
  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_NEAR(contacts.distance()[0], -0.4, 1e-12);
  EXPECT_NEAR(contacts.distance()[1], -0.01, 1e-12);
}

/// Boxes, cylinders and balls on a mesh: the contact cache must not widen the contact margin of the
/// first frame.
TEST(ContactCache, first_frame_matches_scene_without_cache) {
  CompositeWorld world;
  const auto hills = [](float x, float y) {
    return 0.2F * std::sin(3.0F * x) * std::cos(2.0F * y);
  };
  const ShapeId ground = add(world.composites, grid(12, 0.5F, Cut::alternating, hills));
  const ShapeId shapes[] = {add(world.shapes, BoxShape{{0.5, 0.4, 0.3}, 0.0}),
                            add(world.shapes, CylinderShape{0.3, 0.4, 0.05}),
                            add(world.shapes, SphereShape{0.35})};
  Random random(7);
  std::vector<BodyDefinition> bodies{{.shape = ground, .state = BodyState::fixed}};
  for (std::size_t i = 1; i < scaled(300); ++i) {
    BodyDefinition body{.shape = shapes[i % 3]};
    body.pose = Pose::at(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-0.2, 0.6));
    for (double& q : body.pose.orientation) q = random.uniform(-1, 1);
    body.data = i;
    bodies.push_back(body);
  }
  for (const bool reduced : {false, true}) {
    Contacts contacts[2];
    for (const bool uses_cache : {false, true}) {
      Scene scene(world.shapes, {.contact_margin = 0.05,
                                 .cache_tolerance = uses_cache ? 0.3 : 0.0,
                                 .part_manifolds = !reduced,
                                 .composites = &world.composites});
      std::vector<Key> keys(bodies.size());
      ASSERT_EQ(scene.add(bodies, keys), Status::ok);
      ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts[uses_cache ? 1 : 0]), Status::ok);
    }
    EXPECT_GT(contacts[0].points(), 0U);
    EXPECT_EQ(digest(contacts[0]), digest(contacts[1]));
  }
}

/// A pair that was dropped as a ghost contact counts as touching.
TEST(ContactCache, ghost_contact_of_dynamic_floor_is_reported) {
  ShapePool shapes;
  ShapeId tile;
  ShapeId ball;
  tile = expect_ok(shapes.add(BoxShape{{1, 1, 0.5}, 0.0}));
  ball = expect_ok(shapes.add(SphereShape{0.5}));
  Scene scene(shapes, {.cache_tolerance = kCacheTolerance, .suppress_ghost_contacts = true});
  Key floor;
  Key beside;
  Key key;
  floor = expect_ok(scene.add({.shape = tile, .state = BodyState::fixed}));
  beside =
      expect_ok(scene.add({.shape = tile, .pose = Pose::at(2, 0, 0), .state = BodyState::fixed}));
  key = expect_ok(scene.add({.shape = ball, .pose = Pose::at(0.8, 0, 0.9)}));
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  ASSERT_EQ(contacts.size(), 1U);
  ASSERT_EQ(scene.set_body_state(beside, BodyState::dynamic), Status::ok);
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  std::size_t with_ball = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    with_ball += contacts.a()[i] == key || contacts.b()[i] == key ? 1 : 0;
  }
  EXPECT_EQ(with_ball, 2U);
}

}  // namespace
}  // namespace winnow::test
