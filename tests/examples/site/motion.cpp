// A fast bullet and a thin wall, between two frames of a scene.

#include <winnow/pipeline/continuous_collision.h>

#include <vector>

#include "tests/examples/check.h"

int main() {
  winnow::ShapePool shapes;
  const winnow::ShapeId ball = shapes.add(winnow::SphereShape{0.05});
  const winnow::ShapeId plate = shapes.add(winnow::BoxShape{{0.005, 2, 2}});
  winnow::Scene scene(shapes);
  must(scene.add({.shape = plate, .state = winnow::BodyState::fixed}).status);
  const winnow::Key bullet = scene.add({.shape = ball, .pose = winnow::Pose::at(-6, 0, 0)});
  double stopped = 1.0;
  const auto stop = [&](winnow::Key, double time) { stopped = time; };
  // [impacts]
  winnow::ContinuousCollision ccd(scene);
  const std::vector<winnow::Key> moving{bullet};
  const std::vector<winnow::Pose> ends{winnow::Pose::at(9, 0, 0)};
  const std::vector<std::uint8_t> bullets{1};
  must(ccd.find_impacts(moving, ends,
                        {.pairs = winnow::ContinuousPairs::bullets_and_fixed,
                         .bullets = bullets,
                         .touching = false}));
  for (std::size_t i = 0; i < moving.size(); ++i) {
    if (ccd.first()[i] == winnow::kNoImpact) continue;
    const winnow::SceneImpact& impact = ccd.impacts()[ccd.first()[i]];
    stop(moving[i], impact.time);  // also a, b, gap, normal, point
  }
  // [end]
  check(stopped > 0.39 && stopped < 0.4, "the bullet stops at the wall");
}
