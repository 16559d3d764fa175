// Chairs of two boxes each on a terrain of triangles: contacts, queries and sensors.

#include <winnow/winnow.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tests/examples/check.h"

namespace {

std::size_t manifolds = 0;
std::size_t forgotten = 0;
void push_apart(winnow::Key, winnow::Key, double depth) {
  if (depth >= 0.0) ++manifolds;
}
void forget(const winnow::EndedContact&) {
  ++forgotten;
}
std::size_t cheers = 0;
void cheer(winnow::Key) {
  ++cheers;
}

}  // namespace

int main() {
  const std::vector<winnow::Vec3f> points{{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}};
  const std::vector<std::uint32_t> corners{0, 1, 2, 0, 2, 3};
  winnow::ShapePool shapes;
  const winnow::ShapeId seat = shapes.add(winnow::BoxShape{{0.5, 0.5, 0.5}});
  const winnow::ShapeId back = shapes.add(winnow::BoxShape{{0.1, 0.5, 0.5}});
  const std::vector<winnow::CompoundChild> parts{{seat, winnow::Pose::at(0, 0, 0)},
                                                 {back, winnow::Pose::at(-0.4, 0, 1)}};

  // [scene]
  winnow::CompositePool composites(shapes);  // only for meshes, height fields, compounds
  const winnow::ShapeId terrain = composites.add_mesh(points, corners);  // see PointView, IndexView
  const winnow::ShapeId chair =
      composites.add_compound(parts);  // children at poses; also add_height_field, add_scaled
  winnow::Scene scene(
      shapes, {.contact_margin = 0.01, .cache_tolerance = 0.001, .composites = &composites});

  must(scene.add({.shape = terrain, .state = winnow::BodyState::fixed}).status);
  const winnow::Key one = scene.add({.shape = chair, .pose = winnow::Pose::at(0, 0, 0.495)});
  const winnow::Key other = scene.add({.shape = chair, .pose = winnow::Pose::at(9, 0, 0.495)});
  // [end]
  check(scene.size() == 3, "there are three bodies");

  winnow::Contacts contacts;
  const auto step = [&] {
    // [contacts]
    must(scene.collide(winnow::ContactLevel::manifold, contacts));  // or pairs, boolean, distance
    for (const winnow::ContactPair& pair : contacts) {              // pairs of bodies
      for (const winnow::ContactManifold& manifold : pair) {
        push_apart(pair.a(), pair.b(), -manifold.distance());
        // also part_a(), part_b(): triangle or child; error_bound(), normal(), a range of points
      }
    }
    for (const winnow::EndedContact& pair : contacts.ended()) forget(pair);
    // [end]
  };
  step();
  check(contacts.size() == 2 && manifolds >= 2, "both chairs touch the terrain");
  must(scene.move(other, winnow::Pose::at(9, 0, 5)));
  step();
  check(contacts.size() == 1 && forgotten == 1, "one has been lifted");

  const winnow::ShapeId ball = shapes.add(winnow::SphereShape{0.25});
  // [scene queries]
  must(scene.refresh());                // after changes; then any number of threads may query
  winnow::SceneQueries queries(scene);  // one per thread
  winnow::SceneHit hit = queries.closest(winnow::ShapeRay{{20, 0, 9}, {0, 0, -1}});
  hit = queries.closest(winnow::ShapeCast{ball, winnow::Pose::at(0, 0, 9), {0, 0, -20}, 1.0});
  // hit: body, triangle or child, t, normal, point; false if there is none
  const auto bodies = queries.overlap(chair, winnow::Pose::at(0.5, 0, 0.4));
  const winnow::SceneDistance gap = queries.distance(one, other);
  // [end]
  check(hit.key == one, "the ball would fall on the first chair");
  check(bodies.size() == 2, "there the terrain and a chair are in the way");
  check(gap.distance > 7.9, "the chairs are apart");

  // [sensors]
  winnow::Sensors sensors(scene);  // triggers: they detect bodies and have no contacts
  must(sensors.add({.shape = ball, .pose = winnow::Pose::at(0.5, 0, 0.2)}).status);
  must(sensors.sense());
  for (const winnow::SensedBody& in : sensors.sensed()) {
    if (in.event == winnow::ContactEvent::begun) cheer(in.body);
  }
  // [end]
  check(cheers == 2, "the terrain and a chair are in the goal");
}
