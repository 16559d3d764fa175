// Ghost contacts (SceneOptions::suppress_ghost_contacts): floors of several fixed bodies must
// support sliding bodies like one large floor.

#include "tests/pipeline/composite_world.h"

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/pipeline/scene.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

constexpr double kSlidingMargin = 0.03;
constexpr double kAboutUp = 0.99619;

/// A sliding shape and the height of its centre above a plane.
struct Slider {
  ShapeId shape;
  double height;
};

/// The kinds of floor tiles. Each tile is 4 x 4 with its top or surface at z = 0.
enum class Tiles { boxes, meshes, fields, compounds };

struct SeamWorld {
  SeamWorld() {
    sliders = {{add(shapes, SphereShape{0.5}), 0.5},
               {add(shapes, BoxShape{{0.5, 0.4, 0.3}, 0.0}), 0.3},
               {add(shapes, CylinderShape{0.4, 0.3, 0.0}), 0.3}};
    block = add(shapes, BoxShape{{2.0, 2.0, 1.0}, 0.0});
    mesh = add(composites, grid(4, 1.0F, Cut::alternating, [](float, float) { return 0.0F; }));
    const std::vector<float> heights(5 * 5, 0.0F);
    field = expect_ok(composites.add_height_field({heights, 5, 5, 0, {1.0, 1.0}}));
    const CompoundChild child[] = {{block, Pose::at(0, 0, -1)}};
    compound = expect_ok(composites.add_compound(child));
  }

  /// Returns the tile with its centre at (x, y) and its top at z.
  [[nodiscard]] BodyDefinition tile(Tiles kind, double x, double y, double z = 0.0) const {
    const ShapeId ids[] = {block, mesh, field, compound};
    BodyDefinition body{
        .shape = ids[static_cast<int>(kind)], .pose = Pose::at(x, y, z), .state = BodyState::fixed};
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

/// Summary of all manifolds: the least distance, and the number of normals that are not nearly
/// vertical.
struct ContactsSummary {
  double distance = std::numeric_limits<double>::infinity();
  std::size_t aslant = 0;
  std::size_t manifolds = 0;
};

[[nodiscard]] ContactsSummary summarize(Scene& scene, Contacts& contacts,
                                        ContactLevel level = ContactLevel::manifold) {
  EXPECT_EQ(scene.collide(level, contacts), Status::ok);
  ContactsSummary summary;
  summary.manifolds = contacts.manifolds();
  for (std::size_t m = 0; m < contacts.manifolds(); ++m) {
    summary.distance = std::min(summary.distance, contacts.distance()[m]);
    if (std::abs(contacts.normal(2)[m]) < kAboutUp) ++summary.aslant;
  }
  return summary;
}

/// The sliders are near the point that four tiles share, with gaps from -0.03 to 0.02.
TEST(GhostContacts, flush_tiles_hold_sliders_like_one_floor) {
  SeamWorld world;
  Random random(81);
  for (const Tiles kind : {Tiles::boxes, Tiles::meshes, Tiles::fields, Tiles::compounds}) {
    std::size_t ghosts = 0;
    for (const bool reduced : {false, true}) {
      for (const Slider& slider : world.sliders) {
        for (const bool seamless : {true, false}) {
          Scene scene(world.shapes, {.contact_margin = kSlidingMargin,
                                     .cache_tolerance = 0.001,
                                     .part_manifolds = !reduced,
                                     .suppress_ghost_contacts = seamless,
                                     .composites = &world.composites});
          Key key;
          for (const double x : {-2.0, 2.0}) {
            for (const double y : {-2.0, 2.0}) {
              key = expect_ok(scene.add(world.tile(kind, x, y)));
            }
          }
          key = expect_ok(scene.add({.shape = slider.shape}));
          Contacts contacts;
          for (std::size_t i = 0; i < scaled(60); ++i) {
            const double gap = random.uniform(-0.03, 0.02);
            ASSERT_EQ(scene.move(key, sliding(random, slider.height + gap)), Status::ok);
            for (const ContactLevel level : {ContactLevel::manifold, ContactLevel::distance}) {
              const ContactsSummary found = summarize(scene, contacts, level);
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

/// Two tiles with a seam at x = 0, and a slider.
struct TwoTiles {
  TwoTiles(const SeamWorld& world, double second_x, double second_z, ShapeId slider)
      : scene(world.shapes, {.contact_margin = kSlidingMargin,
                             .suppress_ghost_contacts = true,
                             .composites = &world.composites}) {
    tiles[0] = expect_ok(scene.add(world.tile(Tiles::boxes, -2.0, 0.0)));
    tiles[1] = expect_ok(scene.add(world.tile(Tiles::boxes, second_x, 0.0, second_z)));
    key = expect_ok(scene.add({.shape = slider}));
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

TEST(GhostContacts, steps_walls_and_ditches_keep_contacts) {
  SeamWorld world;
  const ShapeId box = world.sliders[1].shape;
  const ShapeId ball = world.sliders[0].shape;
  TwoTiles step(world, 2.0, 0.05, box);
  EXPECT_TRUE(step.touches_second(Pose::at(-0.49, 0.1, 0.295)));
  EXPECT_TRUE(step.touches_second(Pose::at(-0.51, 0.1, 0.305)));
  TwoTiles wall(world, 2.0, 1.5, ball);
  EXPECT_TRUE(wall.touches_second(Pose::at(-0.49, 0.1, 0.495)));
  // A ball sinks into a ditch of width 0.6 and touches both edges.
  TwoTiles ditch(world, 2.6, 0.0, ball);
  EXPECT_TRUE(ditch.touches_second(Pose::at(0.3, 0.0, 0.399)));
  EXPECT_EQ(ditch.contacts.size(), 2U);
  EXPECT_FALSE(ditch.touches_second(Pose::at(-0.49, 0.0, 0.49)));
}

/// Shapes that stand in corners. Most of them come near a wall only with their bottom edge.
std::vector<BodyDefinition> standing_bodies(ShapePool& shapes) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) {
    const double half = i < 4 ? 0.5 : 0.25;
    corners.emplace_back(i % 2 == 0 ? half : -half, i / 2 % 2 == 0 ? half : -half, i < 4 ? 0 : 1);
  }
  ShapeId frustum = expect_ok(shapes.add_hull(corners, 0.0));
  const auto leaning = [&](ShapeId shape, double angle) {
    Pose pose;
    pose.orientation[0] = std::cos(0.5 * angle);
    pose.orientation[2] = std::sin(0.5 * angle);
    return BodyDefinition{.shape = shape, .pose = pose};
  };
  return {{.shape = frustum},
          {.shape = add(shapes, ConeShape{0.5, 0.5})},
          {.shape = add(shapes, SphereShape{0.5})},
          {.shape = add(shapes, CylinderShape{0.3, 0.3, 0.0})},
          leaning(add(shapes, BoxShape{{0.02, 0.3, 1.5}, 0.0}), -0.35),
          leaning(add(shapes, CapsuleShape{0.1, 0.6}), -0.2)};
}

/// Fixed bodies, no two of which are flush: a floor with its top at z = 0; and at x = 1 a wall,
/// with a second wall at a right angle, or a kerb, or a slope.
struct FloorCorner {
  std::vector<BodyDefinition> bodies;
};

/// Returns a box with its least corner at `least`, turned about y around that corner.
BodyDefinition box_from(ShapePool& shapes, const Eigen::Vector3d& least,
                        const Eigen::Vector3d& half, double angle = 0.0) {
  BodyDefinition body{.shape = add(shapes, BoxShape{{half.x(), half.y(), half.z()}, 0.0}),
                      .state = BodyState::fixed};
  const Eigen::AngleAxisd turn(-angle, Eigen::Vector3d::UnitY());
  as_eigen(body.pose.position) = least + turn * half;
  body.pose.orientation[0] = std::cos(0.5 * angle);
  body.pose.orientation[2] = -std::sin(0.5 * angle);
  return body;
}

std::vector<FloorCorner> corners_of(SeamWorld& world) {
  std::vector<FloorCorner> corners;
  const auto box = [&](double x, double y, double z, double hx, double hy, double hz,
                       double angle = 0.0) {
    return box_from(world.shapes, {x, y, z}, {hx, hy, hz}, angle);
  };
  const BodyDefinition floors[] = {
      box(-7, -5, -2, 4, 5, 1),
      box(-7, -5, -2, 8, 5, 1),
      {.shape = add(world.shapes, HalfSpaceShape{{0, 0, 1}, 0}), .state = BodyState::fixed},
      world.tile(Tiles::meshes, -0.9, 0),
      world.tile(Tiles::fields, -0.9, 0),
      world.tile(Tiles::compounds, -0.9, 0)};
  // A wall of triangles that crosses the floor.
  BodyDefinition sheet{
      .shape = world.mesh, .pose = Pose::at(1, 0.1, 0.3), .state = BodyState::fixed};
  sheet.pose.orientation[0] = sheet.pose.orientation[2] = std::sqrt(0.5);
  const CompoundChild courses[] = {{world.block, Pose::at(0, 0, -0.6)},
                                   {world.block, Pose::at(0, 0, 1.4)}};
  ShapeId bricks = expect_ok(world.composites.add_compound(courses));
  const BodyDefinition walls[] = {
      box(1, -5, -1, 1, 5, 3),
      box(1, -5, 0, 1, 5, 3),
      box(1, -5, -0.01, 1, 5, 0.03),
      sheet,
      {.shape = bricks, .pose = Pose::at(3, 0, 0), .state = BodyState::fixed}};
  for (const BodyDefinition& floor : floors) {
    for (const BodyDefinition& wall : walls) {
      // Add a second wall at right angles, which makes a corner.
      corners.push_back({{floor, wall, box(-5, 0.5, -1, 6.5, 1, 3)}});
    }
    // Kerbs, which rise above the floor by 0.004 and 0.05.
    for (const double height : {0.004, 0.05}) {
      corners.push_back({{floor, box(1, -5, -1, 1, 5, 0.5 * (1 + height))}});
    }
  }
  for (const double slope : {0.12, 0.4, 1.0}) {
    const double deep = 0.2;
    FloorCorner foot{{floors[0], box(1 + deep * std::sin(slope), -5, -deep * std::cos(slope), 2, 5,
                                     0.5 * deep, slope)}};
    corners.push_back(foot);
  }
  return corners;
}

/// A rigid motion of the whole scene.
struct Placement {
  Eigen::Quaterniond turn;
  Eigen::Vector3d at;

  [[nodiscard]] BodyDefinition operator()(BodyDefinition body) const {
    const Quaternion& q = body.pose.orientation;
    const Eigen::Quaterniond turned = turn * Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    as_eigen(body.pose.position) = turn * as_eigen(body.pose.position) + at;
    const double to[4] = {turned.w(), turned.x(), turned.y(), turned.z()};
    body.pose.orientation = to;
    return body;
  }
};

/// Returns a body in a corner, at the given depths in the floor and in the wall to its right.
BodyDefinition in_corner(const ShapePool& shapes, BodyDefinition body, double in_floor,
                         double in_wall) {
  const Aabb box = shapes.bounds(body.shape, body.pose);
  body.pose.position[0] = 1.0 - static_cast<double>(box.max[0]) + in_wall;
  body.pose.position[2] = -static_cast<double>(box.min[2]) - in_floor;
  return body;
}

/// Returns the contacts of a scene of these bodies.
std::vector<double> shown_contacts(const SeamWorld& world,
                                   const std::vector<BodyDefinition>& bodies, ContactLevel level,
                                   SceneOptions options) {
  options.composites = &world.composites;
  Scene scene(world.shapes, options);
  std::vector<Key> keys(bodies.size());
  EXPECT_EQ(scene.add(bodies, keys), Status::ok);
  Contacts contacts;
  EXPECT_EQ(scene.collide(level, contacts), Status::ok);
  std::vector<double> shown;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    shown.insert(shown.end(), {static_cast<double>(contacts.a()[i].id),
                               static_cast<double>(contacts.b()[i].id)});
    for (std::uint32_t m = contacts.manifold_first()[i]; m < contacts.manifold_first()[i + 1];
         ++m) {
      shown.insert(shown.end(), {contacts.distance()[m], contacts.normal(0)[m]});
    }
  }
  return shown;
}

/// The bottom edges of standing bodies touch a wall in the plane of the floor.
TEST(GhostContacts, floors_that_are_not_flush_keep_contacts) {
  SeamWorld world;
  Random random(83);
  const std::vector<BodyDefinition> standing = standing_bodies(world.shapes);
  const std::vector<FloorCorner> corners = corners_of(world);
  std::size_t walls = 0;
  for (const FloorCorner& corner : corners) {
    for (const BodyDefinition& body : standing) {
      const Placement placed{Eigen::Quaterniond(random.uniform(-1, 1), random.uniform(-1, 1),
                                                random.uniform(-1, 1), random.uniform(-1, 1))
                                 .normalized(),
                             {random.uniform(-9, 9), random.uniform(-9, 9), 5}};
      std::vector<BodyDefinition> bodies;
      for (const BodyDefinition& fixed : corner.bodies) bodies.push_back(placed(fixed));
      const double in_floor = std::max(random.uniform(-0.004, 0.012), 0.0);
      const double in_wall = random.uniform(-0.004, 0.01);
      bodies.push_back(placed(in_corner(world.shapes, body, in_floor, in_wall)));
      const bool has_offsets = random.chance(0.3);
      for (BodyDefinition& each : bodies) {
        if (has_offsets) each.offsets = {0.003, random.uniform(-0.001, 0.001)};
      }
      SceneOptions options{.contact_margin = random.chance(0.5) ? 0.005 : 0.0,
                           .part_manifolds = random.chance(0.5)};
      for (const ContactLevel level : {ContactLevel::distance, ContactLevel::manifold}) {
        options.suppress_ghost_contacts = false;
        const std::vector<double> all = shown_contacts(world, bodies, level, options);
        options.suppress_ghost_contacts = true;
        EXPECT_EQ(shown_contacts(world, bodies, level, options), all)
            << &corner - corners.data() << ' ' << &body - standing.data() << ' ' << in_floor << ' '
            << in_wall;
        walls += all.size() > 4 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(walls, 100U);
}

/// A manifold, with the data that the rule of SceneOptions::suppress_ghost_contacts uses.
struct FloorManifold {
  Key floor;
  /// Pose of the floor, which is a tile.
  Pose pose;
  Eigen::Vector3d up;
  double distance;
  std::vector<Eigen::Vector3d> points;
  bool is_dropped = false;

  /// The single manifold of pair i, whose body a is the floor.
  FloorManifold(const Contacts& contacts, std::size_t i, const Pose& at_pose)
      : floor(contacts.a()[i]),
        pose(at_pose),
        up(contacts.normal(0)[i], contacts.normal(1)[i], contacts.normal(2)[i]),
        distance(contacts.distance()[i]) {
    for (std::uint32_t p = contacts.point_first()[i]; p < contacts.point_first()[i + 1]; ++p) {
      const ContactPoint point = contacts.contact(p);
      const Eigen::Vector3d at = as_eigen(point.position).cast<double>() + as_eigen(pose.position);
      points.push_back(at + 0.5 * static_cast<double>(point.depth) * up);
    }
  }

  /// Returns the largest projection of the tile's corners on a direction.
  [[nodiscard]] double highest(const Eigen::Vector3d& along) const {
    const Quaternion& q = pose.orientation;
    const Eigen::Quaterniond turn = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
    double most = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d corner(i & 1 ? 2 : -2, i & 2 ? 2 : -2, i & 4 ? 1 : -1);
      most = std::max(most, along.dot(as_eigen(pose.position) + turn * corner));
    }
    return most;
  }
};

/// Returns whether the tile rises by more than 5 degrees, away from the body, above the line where
/// the manifold's tangent plane intersects the other plane.
bool rises(const FloorManifold& one, const Eigen::Vector3d& up, double plane, double slack) {
  const double angle = std::acos(up.dot(one.up));
  const Eigen::Vector3d side = (one.up - up * std::cos(angle)) / std::sin(angle);
  const Eigen::Vector3d climb = up * std::sin(angle) - side * std::cos(angle);
  const Eigen::Vector3d on_line =
      one.points[0] + climb * (plane - up.dot(one.points[0])) / std::sin(angle);
  const double tilt = std::acos(kRegionCosine);
  const Eigen::Vector3d steepest = up * std::cos(tilt) + side * std::sin(tilt);
  return one.highest(steepest) - steepest.dot(on_line) > slack;
}

/// Relies on the deepest point being the first one.
bool is_seam_of(const FloorManifold& one, const FloorManifold& other, double radius) {
  const double cosine = one.up.dot(other.up);
  if (other.is_dropped || other.distance > one.distance + 1e-6 * radius ||
      cosine >= kRegionCosine || cosine < -0.5) {
    return false;
  }
  const double plane = other.up.dot(other.points[0]);
  const double slack = 1e-3 * radius;
  const bool is_below = std::ranges::all_of(
      one.points, [&](const Eigen::Vector3d& at) { return other.up.dot(at) <= plane + slack; });
  return is_below && !rises(one, other.up, plane, slack);
}

/// Returns 8 x 8 tiles and a plate on top of them. Tiles that are not flush are tilted and slightly
/// higher or lower.
std::vector<BodyDefinition> plate_on_tiles(const SeamWorld& world, ShapeId plate, double flush,
                                           Random& random) {
  std::vector<BodyDefinition> bodies;
  for (int i = 0; i < 64; ++i) {
    BodyDefinition tile = world.tile(Tiles::boxes, 4.0 * (i % 8) - 14.0, 4.0 * (i / 8) - 14.0);
    if (!random.chance(flush)) {
      tile.pose.position[2] += random.uniform(-0.02, 0.02);
      for (int k = 1; k < 4; ++k) tile.pose.orientation[k] = random.uniform(-0.06, 0.06);
    }
    bodies.push_back(tile);
  }
  bodies.push_back({.shape = plate, .pose = Pose::at(0.0, 0.0, 0.27)});
  return bodies;
}

/// Returns the ids of floors whose manifolds are kept by the rule, testing each manifold with each
/// other one.
std::vector<ObjectId> kept_floors(const Scene& scene, const Contacts& contacts, double radius) {
  std::vector<FloorManifold> raw;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    BodyDefinition body = expect_ok(scene.body(contacts.a()[i]));
    raw.emplace_back(contacts, i, body.pose);
  }
  std::vector<ObjectId> kept;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    for (std::size_t k = 0; k < raw.size() && !raw[i].is_dropped; ++k) {
      raw[i].is_dropped = k != i && is_seam_of(raw[i], raw[k], radius);
    }
    if (!raw[i].is_dropped) kept.push_back(raw[i].floor.id);
  }
  return kept;
}

TEST(GhostContacts, plate_on_many_tiles_matches_brute_force) {
  SeamWorld world;
  Random random(82);
  const double half = 15.0;
  const ShapeId plate = add(world.shapes, BoxShape{{half, half, 0.3}, 0.0});
  const double radius = std::sqrt(2.0 * half * half + 0.09);
  std::size_t dropped = 0;
  for (std::size_t round = 0; round < scaled(20); ++round) {
    // In odd rounds four of five tiles are tilted, so that few normals are equal.
    const auto bodies = plate_on_tiles(world, plate, round % 2 == 0 ? 0.8 : 0.2, random);
    std::vector<Key> keys(bodies.size());
    Scene raw(world.shapes, {.contact_margin = 0.05});
    Contacts all;
    ASSERT_EQ(raw.add(bodies, keys), Status::ok);
    ASSERT_EQ(raw.collide(ContactLevel::manifold, all), Status::ok);
    Scene seamless(world.shapes, {.contact_margin = 0.05, .suppress_ghost_contacts = true});
    Contacts contacts;
    ASSERT_EQ(seamless.add(bodies, keys), Status::ok);
    ASSERT_EQ(seamless.collide(ContactLevel::manifold, contacts), Status::ok);
    std::vector<ObjectId> shown;
    for (const Key& key : contacts.a()) shown.push_back(key.id);
    EXPECT_EQ(shown, kept_floors(raw, all, radius));
    dropped += all.size() - contacts.size();
  }
  EXPECT_GT(dropped, scaled(20));
}

/// Bodies that are not fixed are not floors. The footprint matches the allocated memory.
TEST(GhostContacts, only_fixed_bodies_are_floors) {
  SeamWorld world;
  CountingMemory memory;
  Scene scene(world.shapes, {.memory = &memory,
                             .contact_margin = kSlidingMargin,
                             .suppress_ghost_contacts = true,
                             .composites = &world.composites});
  Key tiles[2];
  Key key;
  tiles[0] = expect_ok(scene.add(world.tile(Tiles::boxes, -2.0, 0.0)));
  tiles[1] = expect_ok(scene.add(world.tile(Tiles::boxes, 2.0, 0.0)));
  key = expect_ok(scene.add({.shape = world.sliders[0].shape, .pose = Pose::at(-0.05, 0.0, 0.49)}));
  Contacts contacts;
  EXPECT_EQ(summarize(scene, contacts).manifolds, 1U);
  EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
  ASSERT_EQ(scene.set_body_state(tiles[1], BodyState::sleeping), Status::ok);
  EXPECT_EQ(summarize(scene, contacts).manifolds, 2U);
}

}  // namespace
}  // namespace winnow::test
