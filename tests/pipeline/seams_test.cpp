// Floors of several fixed bodies against one large floor: what slides over a seam is held alike.

#include "tests/pipeline/composite_world.h"

#include <gtest/gtest.h>
#include <winnow/pipeline/scene.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

constexpr double kSlidingMargin = 0.03;
constexpr double kAboutUp = 0.99619;

/// Shapes that slide, each with how high it stands on a plane.
struct Slider {
  ShapeId shape;
  double height;
};

/// What floors are made of; each tile is 4 x 4 with its top, or its surface, at z = 0.
enum class Tiles { boxes, meshes, fields, compounds };

struct SeamWorld {
  SeamWorld() {
    sliders = {{add(shapes, SphereShape{0.5}), 0.5},
               {add(shapes, BoxShape{{0.5, 0.4, 0.3}, 0.0}), 0.3},
               {add(shapes, CylinderShape{0.4, 0.3, 0.0}), 0.3}};
    block = add(shapes, BoxShape{{2.0, 2.0, 1.0}, 0.0});
    mesh = add(composites, grid(4, 1.0F, Cut::alternating, [](float, float) { return 0.0F; }));
    const std::vector<float> heights(5 * 5, 0.0F);
    EXPECT_EQ(composites.add_height_field({heights, 5, 5, 0, {1.0, 1.0}}, field), Status::ok);
    const CompoundChild child[] = {{block, Pose::at(0, 0, -1)}};
    EXPECT_EQ(composites.add_compound(child, compound), Status::ok);
  }

  /// The tile whose middle is at (x, y), with its top at z.
  [[nodiscard]] BodyDefinition tile(Tiles kind, double x, double y, double z = 0.0) const {
    const ShapeId ids[] = {block, mesh, field, compound};
    BodyDefinition body{
        .shape = ids[static_cast<int>(kind)], .pose = Pose::at(x, y, z), .motion = Motion::fixed};
    if (kind == Tiles::boxes) body.pose.position[2] -= 1.0;
    for (int k = 0; k < 2 && kind == Tiles::fields; ++k) body.pose.position[k] -= 2.0;
    return body;
  }

  ShapePool shapes;
  CompositePool composites{shapes};
  std::vector<Slider> sliders;
  ShapeId block;
  ShapeId mesh;
  ShapeId field;
  ShapeId compound;
};

[[nodiscard]] Pose sliding(Random& random, double height) {
  const double yaw = random.uniform(-3.0, 3.0);
  Pose pose = Pose::at(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), height);
  pose.orientation[0] = std::cos(yaw);
  pose.orientation[3] = std::sin(yaw);
  return pose;
}

/// Of all manifolds: the deepest, and how many normals are not about up.
struct Held {
  double distance = std::numeric_limits<double>::infinity();
  std::size_t aslant = 0;
  std::size_t manifolds = 0;
};

[[nodiscard]] Held held(Scene& scene, Contacts& contacts,
                        ContactLevel level = ContactLevel::manifold) {
  EXPECT_EQ(scene.collide(level, contacts), Status::ok);
  Held held;
  held.manifolds = contacts.manifolds();
  for (std::size_t m = 0; m < contacts.manifolds(); ++m) {
    held.distance = std::min(held.distance, contacts.distance()[m]);
    if (std::abs(contacts.normal(2)[m]) < kAboutUp) ++held.aslant;
  }
  return held;
}

/// Sinks or hovers by a little over the place where four tiles meet.
TEST(Seams, what_slides_over_flush_tiles_is_held_as_by_one_floor) {
  SeamWorld world;
  Random random(81);
  for (const Tiles kind : {Tiles::boxes, Tiles::meshes, Tiles::fields, Tiles::compounds}) {
    std::size_t ghosts = 0;
    for (const bool reduced : {false, true}) {
      for (const Slider& slider : world.sliders) {
        for (const bool seamless : {true, false}) {
          Scene scene(world.shapes, {.margin = kSlidingMargin,
                                     .carry_over = 0.001,
                                     .contact_reduction = reduced,
                                     .seamless_floors = seamless,
                                     .composites = &world.composites});
          Key key;
          for (const double x : {-2.0, 2.0}) {
            for (const double y : {-2.0, 2.0}) {
              ASSERT_EQ(scene.add(world.tile(kind, x, y), key), Status::ok);
            }
          }
          ASSERT_EQ(scene.add({.shape = slider.shape}, key), Status::ok);
          Contacts contacts;
          for (std::size_t i = 0; i < scaled(60); ++i) {
            const double gap = random.uniform(-0.03, 0.02);
            ASSERT_EQ(scene.move(key, sliding(random, slider.height + gap)), Status::ok);
            for (const ContactLevel level : {ContactLevel::manifold, ContactLevel::distance}) {
              const Held found = held(scene, contacts, level);
              EXPECT_GT(found.manifolds, 0U);
              EXPECT_NEAR(found.distance, gap, 1e-6);
              if (seamless) {
                EXPECT_EQ(found.aslant, 0U)
                    << static_cast<int>(kind) << ' ' << slider.height << ' ' << gap;
              }
              ghosts += found.aslant;
            }
          }
        }
      }
    }
    EXPECT_GT(ghosts, 0U) << static_cast<int>(kind);
  }
}

/// Two tiles with the seam at x = 0, and a slider.
struct TwoTiles {
  TwoTiles(const SeamWorld& world, double second_x, double second_z, ShapeId slider)
      : scene(
            world.shapes,
            {.margin = kSlidingMargin, .seamless_floors = true, .composites = &world.composites}) {
    EXPECT_EQ(scene.add(world.tile(Tiles::boxes, -2.0, 0.0), tiles[0]), Status::ok);
    EXPECT_EQ(scene.add(world.tile(Tiles::boxes, second_x, 0.0, second_z), tiles[1]), Status::ok);
    EXPECT_EQ(scene.add({.shape = slider}, key), Status::ok);
  }
  [[nodiscard]] bool touches_second(const Pose& pose) {
    EXPECT_EQ(scene.move(key, pose), Status::ok);
    EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    return std::ranges::count(contacts.a(), tiles[1]) + std::ranges::count(contacts.b(), tiles[1]) >
           0;
  }

  Scene scene;
  Key tiles[2];
  Key key;
  Contacts contacts;
};

TEST(Seams, steps_walls_ditches_and_valleys_stay) {
  SeamWorld world;
  const ShapeId box = world.sliders[1].shape;
  const ShapeId ball = world.sliders[0].shape;
  TwoTiles step(world, 2.0, 0.05, box);
  EXPECT_TRUE(step.touches_second(Pose::at(-0.49, 0.1, 0.295)));
  EXPECT_TRUE(step.touches_second(Pose::at(-0.51, 0.1, 0.305)));
  TwoTiles wall(world, 2.0, 1.5, ball);
  EXPECT_TRUE(wall.touches_second(Pose::at(-0.49, 0.1, 0.495)));
  // A ball sinks into a ditch of width 0.6, and touches both of its edges.
  TwoTiles ditch(world, 2.6, 0.0, ball);
  EXPECT_TRUE(ditch.touches_second(Pose::at(0.3, 0.0, 0.399)));
  EXPECT_EQ(ditch.contacts.size(), 2U);
  EXPECT_FALSE(ditch.touches_second(Pose::at(-0.49, 0.0, 0.49)));
}

/// Bodies that are not fixed are no floor, and what is told of bytes holds.
TEST(Seams, floors_are_fixed_and_their_bytes_are_counted) {
  SeamWorld world;
  CountingMemory memory;
  Scene scene(world.shapes, {.memory = &memory,
                             .margin = kSlidingMargin,
                             .seamless_floors = true,
                             .composites = &world.composites});
  Key tiles[2];
  Key key;
  ASSERT_EQ(scene.add(world.tile(Tiles::boxes, -2.0, 0.0), tiles[0]), Status::ok);
  ASSERT_EQ(scene.add(world.tile(Tiles::boxes, 2.0, 0.0), tiles[1]), Status::ok);
  ASSERT_EQ(scene.add({.shape = world.sliders[0].shape, .pose = Pose::at(-0.05, 0.0, 0.49)}, key),
            Status::ok);
  Contacts contacts;
  EXPECT_EQ(held(scene, contacts).manifolds, 1U);
  EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
  ASSERT_EQ(scene.set_motion(tiles[1], Motion::sleeping), Status::ok);
  EXPECT_EQ(held(scene, contacts).manifolds, 2U);
}

}  // namespace
}  // namespace winnow::test
