// Contacts read as nested ranges of pairs, manifolds and points, compared with their columns.

#include <gtest/gtest.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/scene.h>
#include "tests/support/answers.h"

#include <array>
#include <type_traits>
#include <vector>

namespace winnow::test {
namespace {

// Boxes and balls on a floor of two triangles, and a ball that touches nothing.
class MeshFloor {
 public:
  MeshFloor() {
    const std::vector<std::array<double, 3>> corners{
        {-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
    const std::vector<int> triangles{0, 1, 2, 0, 2, 3};
    ShapeId floor = expect_ok(composites.add_mesh(corners, triangles));
    const ShapeId box = shapes.add(BoxShape{{1, 1, 1}});
    const ShapeId ball = shapes.add(SphereShape{1});
    key = expect_ok(scene.add({.shape = floor, .state = BodyState::fixed, .data = 1}));
    ClientData data = 2;
    for (const double x : {-5.0, -3.5, 0.0, 5.0}) {
      key = expect_ok(scene.add({.shape = box, .pose = Pose::at(x, 0, 0.9), .data = data++}));
      key = expect_ok(scene.add({.shape = ball, .pose = Pose::at(x, 4, 0.9), .data = data++}));
    }
    key = expect_ok(scene.add({.shape = ball, .pose = Pose::at(0, 0, 20)}));
  }

  ShapePool shapes;
  CompositePool composites{shapes};
  Scene scene{shapes, {.composites = &composites}};
  Key key;
};

void expect_columns(const Contacts& contacts, const ContactManifold& manifold) {
  const std::uint32_t m = manifold.index();
  EXPECT_EQ(manifold.part_a(), contacts.part_a()[m]);
  EXPECT_EQ(manifold.part_b(), contacts.part_b()[m]);
  if (contacts.level() == ContactLevel::boolean) {
    EXPECT_EQ(manifold.distance(), 0.0);
    EXPECT_EQ(manifold.normal(), Vec3d());
    return;
  }
  EXPECT_EQ(manifold.distance(), contacts.distance()[m]);
  EXPECT_EQ(manifold.error_bound(), contacts.error_bound()[m]);
  const bool has_point = contacts.level() == ContactLevel::distance;
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(manifold.normal()[k], contacts.normal(k)[m]);
    EXPECT_EQ(manifold.point()[k], has_point ? contacts.point(k)[m] : 0.0);
  }
}

TEST(ContactRanges, elements_match_columns) {
  MeshFloor world;
  for (const ContactLevel level : {ContactLevel::pairs, ContactLevel::boolean,
                                   ContactLevel::distance, ContactLevel::manifold}) {
    Contacts contacts;
    ASSERT_EQ(world.scene.collide(level, contacts), Status::ok);
    ASSERT_GE(contacts.size(), 10U);
    std::size_t pairs = 0;
    std::size_t manifolds = 0;
    std::size_t points = 0;
    for (const ContactPair& pair : contacts) {
      EXPECT_EQ(pair.index(), pairs);
      EXPECT_EQ(pair.a(), contacts.a()[pairs]);
      EXPECT_EQ(pair.b(), contacts.b()[pairs]);
      EXPECT_EQ(pair.data_a(), contacts.data_a()[pairs]);
      EXPECT_EQ(pair.data_b(), contacts.data_b()[pairs]);
      EXPECT_EQ(pair.event(), ContactEvent::begun);
      for (const ContactManifold& manifold : pair) {
        EXPECT_EQ(manifold.index(), manifolds++);
        expect_columns(contacts, manifold);
        for (const ContactPoint& point : manifold) {
          EXPECT_EQ(point.feature, contacts.contact(points).feature);
          EXPECT_EQ(point.position, contacts.contact(points++).position);
        }
      }
      ++pairs;
    }
    EXPECT_EQ(pairs, contacts.size());
    EXPECT_EQ(manifolds, contacts.manifolds());
    EXPECT_EQ(points, contacts.points());
    EXPECT_EQ(points > 0, level == ContactLevel::manifold);
  }
}

TEST(ContactRanges, empty_contacts_have_no_pair) {
  const Contacts contacts;
  EXPECT_EQ(contacts.begin(), contacts.end());
}

TEST(Scene, composite_without_pool_is_unsupported) {
  MeshFloor world;
  BodyDefinition floor = expect_ok(world.scene.body(world.scene.key_of(0)));
  Scene scene(world.shapes);
  expect_error(scene.add(floor), Status::unsupported);
  EXPECT_EQ(scene.size(), 0U);
}

// A scene or a composite pool of a temporary pool would refer to a destroyed object.
static_assert(std::is_constructible_v<Scene, ShapePool&>);
static_assert(!std::is_constructible_v<Scene, ShapePool>);
static_assert(!std::is_constructible_v<CompositePool, ShapePool>);

}  // namespace
}  // namespace winnow::test
