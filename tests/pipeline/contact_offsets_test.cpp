// Contact and rest offsets of bodies: each pair of a scene compared with a single-pair query.

#include "tests/pipeline/composite_world.h"
#include "tests/pipeline/scene_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

constexpr double kMargin = 0.03;

/// Sets offsets of about half of the bodies. A few contact offsets are large.
void give_offsets(SceneWorld& world) {
  for (BodyDefinition& body : world.bodies) {
    if (world.random.chance(0.5)) continue;
    body.offsets.contact = world.random.chance(0.1) ? 0.4 : world.random.uniform(0.0, 0.1);
    body.offsets.rest = world.random.uniform(-0.05, body.offsets.contact);
  }
}

/// The single-pair answer at the contact margin of the pair. Tests shift it by the rest offsets.
struct CorePairReference {
  CorePairReference(const SceneWorld& world, const BodyDefinition& a, const BodyDefinition& b,
                    NarrowTier tier, ContactLevel level)
      : rest{a.offsets.rest, b.offsets.rest} {
    const double gap = kMargin + (a.offsets.contact + b.offsets.contact);
    EXPECT_EQ(collide(world.pool, a.shape, a.pose, b.shape, b.pose, {level, tier, gap}, answer),
              Status::ok);
  }

  double rest[2];
  PairAnswer answer;
};

/// Compares bit by bit: the points of a manifold depend only on the pair and its contact margin.
void expect_points(const Contacts& contacts, std::size_t m, const CorePairReference& reference) {
  const std::uint32_t first = contacts.point_first()[m];
  ASSERT_EQ(contacts.point_first()[m + 1] - first, reference.answer.contact_count);
  const double between = 0.5 * (reference.rest[0] - reference.rest[1]);
  for (std::uint32_t i = 0; i < reference.answer.contact_count; ++i) {
    const ContactPoint shown = contacts.contact(first + i);
    ContactPoint expected = reference.answer.contacts[i];
    expected.depth = static_cast<float>(static_cast<double>(expected.depth) + reference.rest[0] +
                                        reference.rest[1]);
    for (int k = 0; k < 3; ++k) {
      expected.position[k] = static_cast<float>(static_cast<double>(expected.position[k]) +
                                                between * reference.answer.normal[k]);
      EXPECT_EQ(shown.position[k], expected.position[k]);
    }
    EXPECT_EQ(shown.depth, expected.depth);
    EXPECT_EQ(shown.feature, expected.feature);
  }
}

void expect_pair(const SceneWorld& world, const Contacts& contacts, std::size_t i,
                 const CorePairReference& reference) {
  const std::uint32_t m = contacts.manifold_first()[i];
  EXPECT_EQ(contacts.distance()[m],
            reference.answer.distance - (reference.rest[0] + reference.rest[1]));
  EXPECT_GE(contacts.error_bound()[m], reference.answer.error_bound);
  EXPECT_LE(contacts.error_bound()[m], reference.answer.error_bound + 1e-15);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(contacts.normal(k)[m], reference.answer.normal[k]);
  for (int k = 0; k < 3 && contacts.level() == ContactLevel::distance; ++k) {
    EXPECT_EQ(contacts.point(k)[m],
              reference.answer.point[k] + reference.rest[0] * reference.answer.normal[k]);
  }
  if (contacts.level() == ContactLevel::manifold) expect_points(contacts, m, reference);
  EXPECT_LT(contacts.data_a()[i], world.bodies.size());
}

/// The client data of a body is its index.
const BodyDefinition& body_of(const SceneWorld& world, ClientData data) {
  return world.bodies[static_cast<std::size_t>(data)];
}

/// Checks that the scene shows exactly the pairs within their own contact margin.
void expect_same_as_core_pairs(const SceneWorld& world, const Contacts& contacts, NarrowTier tier) {
  std::set<Names> near;
  for (const auto& [pair, distance] : world.touching(kMargin + 0.9)) {
    const BodyDefinition& a = body_of(world, pair.first);
    const BodyDefinition& b = body_of(world, pair.second);
    if (distance <= kMargin + a.offsets.contact + b.offsets.contact) near.insert(pair);
  }
  EXPECT_EQ(shown(contacts), near);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const CorePairReference reference(world, body_of(world, contacts.data_a()[i]),
                                      body_of(world, contacts.data_b()[i]), tier, contacts.level());
    expect_pair(world, contacts, i, reference);
  }
}

TEST(ContactOffsets, pairs_with_offsets_match_single_queries) {
  SceneWorld world(scaled(400), 71);
  give_offsets(world);
  for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
    Scene scene(world.pool, {.contact_margin = kMargin, .tier = tier});
    ASSERT_EQ(add_all(scene, world), Status::ok);
    Contacts contacts;
    for (const ContactLevel level : {ContactLevel::distance, ContactLevel::manifold}) {
      ASSERT_EQ(scene.collide(level, contacts), Status::ok);
      expect_same_as_core_pairs(world, contacts, tier);
    }
  }
}

/// A box on a mesh with contact reduction.
TEST(ContactOffsets, rest_offset_of_others_leaves_error_bounds) {
  CompositeWorld world;
  const ShapeId floor =
      add(world.composites, grid(4, 0.5F, Cut::same, [](float, float) { return 0.0F; }));
  const ShapeId box = add(world.shapes, BoxShape{{0.5, 0.4, 0.3}, 0.0});
  const auto bounds = [&](bool with_other) {
    Scene scene(world.shapes, {.composites = &world.composites});
    Key key = expect_ok(scene.add({.shape = floor, .state = BodyState::fixed}));
    key = expect_ok(scene.add({.shape = box, .pose = Pose::at(0.1, 0.2, 0.2)}));
    const BodyDefinition other{.shape = box, .pose = Pose::at(9, 9, 9), .offsets = {0.2, 0.1}};
    if (with_other) {
      key = expect_ok(scene.add(other));
    }
    Contacts contacts;
    EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    return std::vector(contacts.error_bound().begin(), contacts.error_bound().end());
  };
  ASSERT_EQ(bounds(false).size(), 1U);
  EXPECT_EQ(bounds(false), bounds(true));
}

TEST(ContactOffsets, level_boolean_ignores_offsets) {
  SceneWorld world(scaled(300), 72);
  std::set<Names> overlapping;
  for (const auto& [pair, distance] : world.touching()) overlapping.insert(pair);
  give_offsets(world);
  Scene scene(world.pool, {.contact_margin = kMargin});
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::boolean, contacts), Status::ok);
  EXPECT_EQ(shown(contacts), overlapping);
}

TEST(ContactOffsets, zero_offsets_change_no_bit) {
  SceneWorld world(scaled(300), 73);
  Scene plain(world.pool, {.contact_margin = kMargin});
  ASSERT_EQ(add_all(plain, world), Status::ok);
  const std::size_t without = plain.footprint().total().reserved;
  Contacts expected;
  ASSERT_EQ(plain.collide(ContactLevel::manifold, expected), Status::ok);
  CountingMemory memory;
  Scene scene(world.pool, {.memory = &memory, .contact_margin = kMargin});
  ASSERT_EQ(add_all(scene, world), Status::ok);
  EXPECT_EQ(scene.footprint().total().reserved, without);
  ASSERT_EQ(scene.set_offsets(world.keys[3], {0.2, 0.1}), Status::ok);
  EXPECT_GT(scene.footprint().total().reserved, without);
  EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
  BodyDefinition body = expect_ok(scene.body(world.keys[3]));
  EXPECT_EQ(body.offsets, (ContactOffsets{0.2, 0.1}));
  ASSERT_EQ(scene.set_offsets(world.keys[3], {}), Status::ok);
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  EXPECT_EQ(digest(contacts), digest(expected));
}

TEST(ContactOffsets, bad_offsets_are_refused_and_change_nothing) {
  SceneWorld world(8, 74);
  Scene scene(world.pool);
  ASSERT_EQ(add_all(scene, world), Status::ok);
  const double nan = std::nan("");
  const double inf = std::numeric_limits<double>::infinity();
  for (const ContactOffsets& bad :
       {ContactOffsets{-0.1, -0.2}, ContactOffsets{nan, 0.0}, ContactOffsets{0.1, nan},
        ContactOffsets{inf, 0.0}, ContactOffsets{0.1, -inf}, ContactOffsets{0.1, 0.2}}) {
    EXPECT_EQ(scene.set_offsets(world.keys[0], bad), Status::invalid_argument);
    BodyDefinition body = world.bodies[0];
    body.offsets = bad;
    expect_error(scene.add(body), Status::invalid_argument);
    EXPECT_EQ(scene.size(), 8U);
    body = expect_ok(scene.body(world.keys[0]));
    EXPECT_EQ(body.offsets, ContactOffsets{});
  }
  EXPECT_EQ(scene.set_offsets(Key{}, {}), Status::invalid_key);
}

TEST(ContactOffsets, largest_doubles_cause_no_nan) {
  SceneWorld world(20, 75);
  const double most = std::numeric_limits<double>::max();
  world.bodies[0].offsets = {most, most};
  world.bodies[1].offsets = {most, -most};
  Scene scene(world.pool, {.contact_margin = 1.0});
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  for (const double d : contacts.distance()) EXPECT_FALSE(std::isnan(d));
}

TEST(ContactOffsets, body_on_mesh_rests_at_its_offset) {
  CompositeWorld world;
  const ShapeId floor =
      add(world.composites, grid(8, 0.5F, Cut::alternating, [](float, float) { return 0.0F; }));
  const ShapeId box = add(world.shapes, BoxShape{{0.5, 0.4, 0.3}, 0.0});
  const ShapeId ball = add(world.shapes, SphereShape{0.2});
  for (const bool reduced : {false, true}) {
    Scene scene(world.shapes, {.part_manifolds = !reduced, .composites = &world.composites});
    Key ground;
    Key keys[2];
    ground = expect_ok(scene.add({.shape = floor, .state = BodyState::fixed}));
    keys[0] = expect_ok(scene.add({.shape = box,
                                   .pose = Pose::at(0.1, 0.2, 0.32),
                                   .offsets = {.contact = 0.05, .rest = 0.03}}));
    keys[1] = expect_ok(scene.add({.shape = ball, .pose = Pose::at(-1.3, 0.1, 0.22), .data = 1}));
    Contacts contacts;
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    ASSERT_EQ(contacts.size(), 1U);
    for (std::size_t m = 0; m < contacts.manifolds(); ++m) {
      EXPECT_NEAR(contacts.distance()[m], -0.01, 1e-9);
      EXPECT_NEAR(std::abs(contacts.normal(2)[m]), 1.0, 1e-9);
      for (auto p = contacts.point_first()[m]; p < contacts.point_first()[m + 1]; ++p) {
        EXPECT_NEAR(contacts.contact(p).depth, 0.01, 1e-6);
        const bool box_is_a = contacts.a()[0] == keys[0];
        // Halfway between the floor and the surface 0.03 below the box.
        EXPECT_NEAR(contacts.contact(p).position[2], box_is_a ? -0.325 : -0.005, 1e-6);
      }
    }
    ASSERT_EQ(scene.set_offsets(keys[0], {.contact = 0.01}), Status::ok);
    ASSERT_EQ(scene.set_offsets(keys[1], {.contact = 0.025}), Status::ok);
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    ASSERT_EQ(contacts.size(), 1U);
    EXPECT_EQ(contacts.data_a()[0] + contacts.data_b()[0], 1U);
    EXPECT_NEAR(contacts.distance()[0], 0.02, 1e-9);
  }
}

/// Changes offsets while bodies are removed, added and cached, and compares with a fresh
/// scene.
TEST(ContactOffsets, changed_offsets_apply_to_next_collide) {
  SceneWorld world(scaled(200), 76);
  Scene scene(world.pool, {.contact_margin = kMargin, .cache_tolerance = 0.02});
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  for (int frame = 0; frame < 6; ++frame) {
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      if (!world.random.chance(0.1)) continue;
      BodyDefinition& body = world.bodies[i];
      body.offsets.contact = world.random.uniform(0.0, 0.2);
      body.offsets.rest = world.random.uniform(-0.1, body.offsets.contact);
      ASSERT_EQ(scene.set_offsets(world.keys[i], body.offsets), Status::ok);
    }
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    Scene fresh(world.pool, {.contact_margin = kMargin});
    std::vector<Key> keys(world.bodies.size());
    ASSERT_EQ(fresh.add(world.bodies, keys), Status::ok);
    Contacts expected;
    ASSERT_EQ(fresh.collide(ContactLevel::manifold, expected), Status::ok);
    EXPECT_EQ(shown(contacts), shown(expected));
    const std::size_t gone = world.random.below(world.bodies.size());
    ASSERT_EQ(scene.remove(world.keys[gone]), Status::ok);
    world.keys[gone] = expect_ok(scene.add(world.bodies[gone]));
  }
}

}  // namespace
}  // namespace winnow::test
