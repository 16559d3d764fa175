// A fast bullet and a thin wall, between two frames of a scene.

#include <winnow/pipeline/scene_sweep.h>

#include <vector>

#include "tests/examples/check.h"

int main() {
  winnow::ShapePool shapes;
  winnow::ShapeId ball, plate;
  shapes.add(winnow::SphereShape{0.05}, ball);
  shapes.add(winnow::BoxShape{{0.005, 2, 2}}, plate);
  winnow::Scene scene(shapes);
  winnow::Key wall, bullet;
  scene.add({.shape = plate, .motion = winnow::Motion::fixed}, wall);
  scene.add({.shape = ball, .pose = winnow::Pose::at(-6, 0, 0)}, bullet);
  double stopped = 1.0;
  const auto stop = [&](winnow::Key, double time) { stopped = time; };
  // [sweep]
  winnow::SceneSweep sweep(scene);
  const std::vector<winnow::Key> moving{bullet};
  const std::vector<winnow::Pose> ends{winnow::Pose::at(9, 0, 0)};
  const std::vector<std::uint8_t> bullets{1};
  sweep.sweep(
      moving, ends,
      {.pairs = winnow::SweepPairs::bullets_and_fixed, .bullets = bullets, .touching = false});
  for (std::size_t i = 0; i < moving.size(); ++i) {
    if (sweep.first()[i] == winnow::kNoImpact) continue;
    const winnow::SceneImpact& impact = sweep.impacts()[sweep.first()[i]];
    stop(moving[i], impact.time);  // also a, b, gap, normal, point
  }
  // [end]
  check(stopped > 0.39 && stopped < 0.4, "the bullet stops at the wall");
}
