// A fast bullet, collision layers and triggers.

#include <winnow/winnow.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tests/examples/check.h"

int main() {
  winnow::ShapePool shapes;
  const winnow::ShapeId wall = shapes.add(winnow::BoxShape{{0.001, 5, 5}});  // thin
  const winnow::ShapeId bullet = shapes.add(winnow::SphereShape{0.01});
  const winnow::ShapeId soldier = shapes.add(winnow::CapsuleShape{0.3, 0.6});
  const winnow::ShapeId zone = shapes.add(winnow::BoxShape{{1, 1, 1}});

  // [layers]
  enum Layer : std::uint32_t { level = 1, players = 2 };
  winnow::Scene scene(shapes);
  const winnow::Key door =
      scene.add({wall, winnow::Pose::at(10, 0, 0), winnow::BodyState::fixed, {.layers = level}});
  const winnow::Key hero = scene.add({.shape = soldier,
                                      .pose = winnow::Pose::at(20, 0, 0),
                                      .filter = {.layers = players, .mask = level | players}});
  // [end]

  must(scene.refresh());
  winnow::SceneQueries queries(scene);
  // [projectile]
  const double step = 1.0 / 60.0;
  const winnow::SceneHit hit =
      queries.closest(winnow::ShapeCast{bullet, winnow::Pose::at(0, 0, 0), {900, 0, 0}, step},
                      {.mask = level | players});
  if (hit) check(hit.t < step, "hit.t is the time, hit.point the place, hit.normal the side");
  // [end]
  check(hit.key == door, "nothing is too thin to be hit");

  std::size_t entered = 0, left = 0;
  winnow::Sensors sensors(scene);
  const winnow::Key trap =
      sensors.add({.shape = zone, .pose = winnow::Pose::at(25, 0, 0), .filter = {.mask = players}});
  const auto frame = [&](double x) {
    must(scene.move(hero, winnow::Pose::at(x, 0, 0)));
    // [triggers]
    must(sensors.sense());
    for (const winnow::SensedBody& in : sensors.sensed()) {
      if (in.event == winnow::ContactEvent::begun) ++entered;
    }
    for (const winnow::ExitedBody& out : sensors.left()) {
      if (out.sensor == trap) ++left;  // keys of removed bodies are stale here
    }
    // [end]
  };
  frame(20);
  frame(24.5);
  frame(25);
  frame(30);
  check(entered == 1 && left == 1, "the hero walked through the trap");
}
