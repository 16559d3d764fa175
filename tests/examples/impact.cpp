// Times of impact of bodies that move and rotate.

#include <winnow/pipeline/impacts.h>

#include <cstddef>
#include <vector>

#include "tests/examples/check.h"

int main() {
  double first = 1.0;
  const auto stop = [&first](std::uint32_t, double time) { first = time; };
  // [impact]
  winnow::ShapePool shapes;
  const winnow::ShapeId blade = shapes.add(winnow::BoxShape{{2, 0.1, 0.01}});
  const winnow::ShapeId bullet = shapes.add(winnow::SphereShape{0.05});

  using Motion = winnow::RigidMotion;
  const std::vector<winnow::ShapeId> shape_of{blade, bullet};
  const std::vector<Motion> motion_of{
      Motion::by_velocities(winnow::Pose::at(0, 0, 0), {0, 0, 0}, {0, 0, -300}, 0.1),
      Motion::between(winnow::Pose::at(1.5, -40, 0), winnow::Pose::at(1.5, 40, 0))};
  const std::vector<winnow::BodyPair> pairs{{0, 1}};
  winnow::ImpactResult impacts;  // keep it from call to call
  must(winnow::time_of_impact(shapes, {shape_of, motion_of}, pairs, {}, impacts));
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    if (impacts.hits(i)) stop(pairs[i].a, impacts.time()[i]);
    // also gap(), normal(axis), point(axis), error_bound() at that time
  }
  // [end]
  check(first > 0.45 && first < 0.55, "the blade hits the bullet as it passes");
}
