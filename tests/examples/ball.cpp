// A ball falls on a floor and comes to rest on a soft contact.

// [a program]
#include <winnow/winnow.h>

#include <algorithm>
#include <cstdio>

int main() {
  winnow::ShapePool shapes;
  const winnow::ShapeId ball = shapes.add(winnow::SphereShape{0.5});
  const winnow::ShapeId floor = shapes.add(winnow::HalfSpaceShape{});
  winnow::Scene scene(shapes);
  if (!scene.add({.shape = floor, .state = winnow::BodyState::fixed})) return 1;
  const winnow::Key body = scene.add({.shape = ball, .pose = winnow::Pose::at(0, 0, 2)});
  winnow::Contacts contacts;
  const double step = 0.005;
  double height = 2.0;
  double speed = 0.0;
  for (int i = 0; i < 1000; ++i) {
    if (scene.collide(winnow::ContactLevel::manifold, contacts) != winnow::Status::ok) return 1;
    speed -= 9.81 * step;
    for (const double distance : contacts.distance()) {
      speed += std::max(0.0, -1000.0 * distance - 20.0 * speed) * step;
    }
    height += speed * step;
    if (scene.move(body, winnow::Pose::at(0, 0, height)) != winnow::Status::ok) return 1;
  }
  std::printf("the ball rests at %.2f\n", height);
}
// [end]
