// The ten-minute tutorial: boxes, pairs, changes, bodies, contacts, queries.

#include <winnow/winnow.h>

#include <cstddef>
#include <span>
#include <vector>

#include "tests/examples/check.h"

namespace {

std::size_t pushed = 0;

void boxes_and_pairs() {
  // [boxes]
  std::vector<winnow::Aabb> boxes;  // smallest and largest corner of each
  for (int i = 0; i < 1000; ++i) {
    const float x = 0.9F * static_cast<float>(i);
    boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});
  }
  std::vector<winnow::Key> keys(boxes.size());  // a key identifies an object
  winnow::Partition partition(winnow::linear_bvh());
  if (partition.insert(boxes, {}, keys) != winnow::Status::ok) return;

  winnow::PairBuffer pairs;
  must(partition.self_pairs(pairs));  // each box overlaps the next one
  for (const winnow::Pair& pair : pairs) check(pair.first + 1 == pair.second, "neighbours");
  // [end]
  check(pairs.size() == 999, "there are as many pairs as gaps");

  // [changes]
  winnow::PairEvents events;
  must(partition.self_pairs(pairs, events));  // later calls report changes
  boxes[500] = {{450, 5, 0}, {451, 6, 1}};    // moves away
  must(partition.update(keys[500], boxes[500]));
  must(partition.self_pairs(pairs, events));  // cost depends on the moved objects
  for (const winnow::KeyPair& pair : events.ended()) {
    check(pair.first == keys[500] || pair.second == keys[500], "its two pairs ended");
  }
  // [end]
  check(events.ended().size() == 2 && pairs.size() == 997, "two pairs ended");
}

void push(winnow::Key, winnow::Key, double, double) {
  ++pushed;
}

void bodies_and_contacts() {
  // [bodies]
  winnow::ShapePool shapes;  // bodies share shapes
  const winnow::ShapeId crate = shapes.add(winnow::BoxShape{{0.5, 0.5, 0.5}});  // half extents
  const winnow::ShapeId ball = shapes.add(winnow::SphereShape{0.25});
  const winnow::ShapeId floor = shapes.add(winnow::HalfSpaceShape{});  // all below z = 0

  winnow::Scene scene(shapes, {.contact_margin = 0.01});  // contacts within 1 cm
  must(scene.add({.shape = floor, .state = winnow::BodyState::fixed}).status);
  const winnow::Key lower =
      scene.add({.shape = crate, .pose = winnow::Pose::at(0, 0, 0.5), .data = 1});
  const winnow::Key upper =
      scene.add({.shape = crate, .pose = winnow::Pose::at(0, 0, 1.495), .data = 2});
  const winnow::Key rolling =
      scene.add({.shape = ball, .pose = winnow::Pose::at(3, 0, 0.25), .data = 3});
  // [end]

  // [contacts]
  winnow::Contacts contacts;  // keep it from frame to frame
  must(scene.collide(winnow::ContactLevel::manifold, contacts));
  for (const winnow::ContactPair& pair : contacts) {  // pairs of bodies that touch
    for (const winnow::ContactManifold& manifold : pair) {
      for (const winnow::ContactPoint& point : manifold) {
        push(pair.a(), pair.b(), manifold.normal().z(), point.depth);
      }
    }
  }
  // [end]
  check(contacts.size() == 3, "crate and floor, crate and crate, ball and floor");
  check(pushed == 9, "four corners, four corners, one point");

  // [queries]
  must(scene.move(rolling, winnow::Pose::at(6, 0, 0.25)));
  must(scene.refresh());  // updates the partitions
  winnow::SceneQueries queries(scene);
  const winnow::SceneHit hit =
      queries.closest(winnow::ShapeRay{{-5, 0, 0.5}, {1, 0, 0}});  // hits the lower crate
  const winnow::SceneDistance gap =
      queries.distance(upper, rolling);  // closest points, distance, error bound
  // [end]
  check(hit.key == lower && hit.t == 4.5, "the ray hits the lower crate");
  check(gap.distance > 4.9 && gap.error_bound < 1e-6, "they are apart");
}

}  // namespace

int main() {
  boxes_and_pairs();
  bodies_and_contacts();
}
