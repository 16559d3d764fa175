// A resting body trembles by the last bits of its solver. Its contact points must keep their
// features from frame to frame, although many points of a round or regular face are equally good.

#include "tests/pipeline/composite_world.h"
#include "tests/pipeline/user_shapes.h"

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/winnow.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// A shape and its pose on the plane z = 0.
struct RestingShape {
  std::string name;
  ShapeId shape;
  Quaterniond turn = Quaterniond::Identity();
  double height = 0.0;
  bool has_parts = false;
  /// Allowed share of points without predecessor on a ground of several primitives: edges of the
  /// ground cross the sides of capsules and split contacts of round surfaces.
  double lost_on_parts = 0.01;
};

/// Standing shapes of radius 1, and grounds whose top is the plane z = 0.
class Stage {
 public:
  Stage() : composites(pool) {
    add_round();
    add_prisms();
    add_on_side();
    add_grounds();
  }

  ShapePool pool;
  CompositePool composites;
  std::vector<RestingShape> bodies;
  std::vector<RestingShape> grounds;

 private:
  template <typename Shape>
  ShapeId made(const Shape& shape) {
    ShapeId id = expect_ok(pool.add(shape));
    return id;
  }

  ShapeId prism(int sides, double radius, double half) {
    std::vector<Vec3d> points;
    for (int i = 0; i < sides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / sides;
      for (const double z : {-half, half}) {
        points.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
      }
    }
    ShapeId id = expect_ok(pool.add_hull(points, 0.0));
    return id;
  }

  ShapeId own(UserShape::Form form, double x, double y, double z) {
    sets_.push_back({form, {x, y, z}, {}});
    return made(shape_of(sets_.back(), 0.0));
  }

  void add_round() {
    bodies.push_back({"cylinder", made(CylinderShape{1.0, 0.5}), Quaterniond::Identity(), 0.5});
    bodies.push_back(
        {"rounded cylinder", made(CylinderShape{0.9, 0.4, 0.1}), Quaterniond::Identity(), 0.5});
    bodies.push_back({"cone", made(ConeShape{1.0, 0.5}), Quaterniond::Identity(), 0.5});
    bodies.push_back({"upturned cylinder", bodies[0].shape, Quaterniond(0.0, 0.6, 0.8, 0.0), 0.5});
    bodies.push_back(
        {"own drum", own(UserShape::drum, 1.0, 1.0, 0.5), Quaterniond::Identity(), 0.5});
  }

  void add_prisms() {
    for (const int sides : {3, 4, 5, 6, 7, 8, 12, 16, 17, 32, 100}) {
      bodies.push_back({"prism of " + std::to_string(sides), prism(sides, 1.0, 0.5),
                        Quaterniond::Identity(), 0.5});
    }
    const ShapeId box = made(BoxShape{{0.7, 0.7, 0.5}});
    const ShapeId own_block = own(UserShape::block, 0.7, 0.7, 0.5);
    const auto turned = [](double angle) {
      return Quaterniond(AngleAxisd(angle, Vector3d::UnitZ()));
    };
    bodies.push_back({"box", box, Quaterniond::Identity(), 0.5});
    bodies.push_back({"box turned by 45 degrees", box, turned(0.25 * std::numbers::pi), 0.5});
    bodies.push_back({"box turned by 30 degrees", box, turned(std::numbers::pi / 6.0), 0.5});
    bodies.push_back({"own block", own_block, Quaterniond::Identity(), 0.5});
  }

  void add_on_side() {
    const Quaterniond on_side(AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitY()));
    // Above a seam of tiles it touches one tile or the other.
    bodies.push_back({"lying cylinder", made(CylinderShape{0.5, 0.8}), on_side, 0.5, false, 0.11});
    bodies.push_back({"lying capsule", made(CapsuleShape{0.3, 0.7}), on_side, 0.3, false, 0.03});
    bodies.push_back({"lying prism of 6", prism(6, 0.5, 0.8), on_side, 0.5 * std::sqrt(0.75)});
    bodies.push_back({"flat egg", made(EllipsoidShape{{1.0, 1.0, 0.2}}), Quaterniond::Identity(),
                      0.2, false, 0.06});
    const double slope = std::asin(0.1 / 0.7);
    bodies.push_back({"lying tapered capsule", made(TaperedCapsuleShape{{0.4, 0.3}, 0.35}),
                      Quaterniond(AngleAxisd(0.5 * std::numbers::pi + slope, Vector3d::UnitY())),
                      0.35});
  }

  void add_grounds() {
    const auto add_ground = [&](const char* name, ShapeId id, double half) {
      grounds.push_back({name, id, Quaterniond::Identity(), -half});
    };
    add_ground("half-space", made(HalfSpaceShape{}), 0.0);
    add_ground("box", made(BoxShape{{3.0, 3.0, 0.5}}), 0.5);
    add_ground("smaller box", made(BoxShape{{0.6, 0.6, 0.5}}), 0.5);
    add_ground("triangle",
               made(TriangleShape{{{-5.0, -4.0, 0.0}, {5.0, -4.0, 0.0}, {0.0, 6.0, 0.0}}, 0.0}),
               0.0);
    add_ground("hull of 8 sides", prism(8, 3.0, 0.5), 0.5);
    add_ground("smaller hull of 12 sides", prism(12, 0.8, 0.5), 0.5);
    add_ground("cylinder", made(CylinderShape{1.0, 0.5}), 0.5);
    add_ground("wider cylinder", made(CylinderShape{2.0, 0.5}), 0.5);
    add_ground("own block", own(UserShape::block, 2.0, 2.0, 0.5), 0.5);
    add_ground("own drum", own(UserShape::drum, 1.2, 1.2, 0.5), 0.5);
    // Offsets keep the edges of meshes and tiles away from the edges of standing shapes.
    Surface surface = grid(12, 0.65F, Cut::same, [](float, float) { return 0.0F; });
    for (Point& vertex : surface.vertices) vertex += Point(0.07F, 0.11F, 0.0F);
    ShapeId mesh = expect_ok(composites.add_mesh(
        surface.vertices, IndexView(std::span<const std::uint32_t>(surface.corners))));
    add_ground("mesh", mesh, 0.0);
    grounds.back().has_parts = true;
    const ShapeId tile = made(BoxShape{{0.575, 0.575, 0.5}});
    std::vector<CompoundChild> tiles;
    for (int i = 0; i < 16; ++i) {
      tiles.push_back({tile, Pose::at(1.15 * (i % 4) - 1.645, 1.15 * (i / 4) - 1.605, -0.5)});
    }
    ShapeId compound = expect_ok(composites.add_compound(tiles));
    add_ground("tiles", compound, 0.0);
    grounds.back().has_parts = true;
  }

  std::deque<UserShape> sets_;
};

Pose resting_pose(const Quaterniond& turn, const Vector3d& place) {
  Pose pose = Pose::at(place.x(), place.y(), place.z());
  pose.orientation[0] = turn.w();
  for (int i = 0; i < 3; ++i) pose.orientation[i + 1] = turn.vec()[i];
  return pose;
}

struct Kept {
  std::size_t points = 0;
  std::size_t lost = 0;
  /// The largest distance of a point from its predecessor.
  double jump = 0.0;

  void operator+=(const Kept& other) {
    points += other.points;
    lost += other.lost;
    jump = std::max(jump, other.jump);
  }
};

struct Tremble {
  Quaterniond world;
  Vector3d place;
  double size;
};

Kept frames_of(Stage& stage, const RestingShape& body, const RestingShape& ground,
               const Tremble& tremble, Random& random) {
  SceneOptions options;
  options.execution = Execution::serial();
  options.contact_margin = 0.02;
  options.warm_start = true;
  options.composites = &stage.composites;
  Scene scene(stage.pool, options);
  Key key =
      expect_ok(scene.add({.shape = ground.shape,
                           .pose = resting_pose(tremble.world * ground.turn,
                                                tremble.world * Vector3d(0, 0, ground.height)),
                           .state = BodyState::fixed}));
  key = expect_ok(scene.add({.shape = body.shape}));
  const auto any = [&] {
    return Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  Kept kept;
  Contacts contacts;
  std::vector<Vector3d> before;
  for (std::size_t frame = 0; frame < 8; ++frame) {
    const Vector3d place =
        tremble.place + Vector3d(0, 0, body.height) + 0.01 * tremble.size * any();
    const Quaterniond turn(AngleAxisd(tremble.size * random.unit(), any().normalized()));
    EXPECT_EQ(scene.move(key, resting_pose((tremble.world * turn * body.turn).normalized(),
                                           tremble.world * place)),
              Status::ok);
    EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    std::vector<Vector3d> now;
    for (std::size_t i = 0; i < contacts.points(); ++i) {
      BodyDefinition a = expect_ok(scene.body(contacts.a()[0]));
      const ContactPoint point = contacts.contact(i);
      now.push_back(Eigen::Vector3f(as_eigen(point.position)).cast<double>() +
                    as_eigen(a.pose.position));
      if (frame == 0) continue;
      const std::uint32_t old = contacts.previous_point()[i];
      ++kept.points;
      kept.lost += old == kNoContact;
      if (old != kNoContact) kept.jump = std::max(kept.jump, (now.back() - before.at(old)).norm());
    }
    EXPECT_GE(now.size(), 1U) << body.name << " on " << ground.name;
    before = now;
  }
  return kept;
}

const Quaterniond kWorlds[] = {Quaterniond::Identity(),
                               Quaterniond(AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitY())),
                               Quaterniond(AngleAxisd(-0.5 * std::numbers::pi, Vector3d::UnitX())),
                               Quaterniond(AngleAxisd(2.2, Vector3d(0.3, 0.5, -0.8).normalized()))};

Kept frames_in_all_worlds(Stage& stage, const RestingShape& body, const RestingShape& ground,
                          double size, Random& random) {
  Kept kept;
  for (const Quaterniond& world : kWorlds) {
    for (const Vector3d& place :
         {Vector3d(0, 0, -0.01), Vector3d(0.15, 0.2, -0.01), Vector3d(0.15, 0.2, 0.01)}) {
      kept += frames_of(stage, body, ground, {world, place, size}, random);
    }
  }
  return kept;
}

TEST(WarmStart, trembling_shapes_keep_their_points) {
  Stage stage;
  Random random(41);
  for (const RestingShape& ground : stage.grounds) {
    for (const RestingShape& body : stage.bodies) {
      for (const double size : {1e-6, 1e-5, 1e-4}) {
        const Kept kept = frames_in_all_worlds(stage, body, ground, size, random);
        SCOPED_TRACE(body.name + " on " + ground.name + " trembles by " + std::to_string(size));
        const double share = ground.has_parts ? body.lost_on_parts : 0.01;
        EXPECT_LE(static_cast<double>(kept.lost), share * static_cast<double>(kept.points))
            << "of " << kept.points;
      }
    }
  }
}

}  // namespace
}  // namespace winnow::test
