#include "bench/scenes/feature_steps.h"

#include "bench/common/exact_math.h"
#include "bench/scenes/random_shapes.h"

#include <Eigen/Geometry>

namespace winnow::bench {
namespace {

/// Four points at the start and at the end.
using Step = std::array<Vec3d, 8>;

Vec3d in_cube(Random& random) {
  return {random.unit(), random.unit(), random.unit()};
}

/// Returns a point with few binary digits, so that sums and small multiples are exact.
Vec3d on_lattice(Random& random, std::uint32_t reach) {
  const auto one = [&] {
    return (static_cast<double>(random.below(2 * reach + 1)) - reach) * 0x1p-4;
  };
  return {one(), one(), one()};
}

Step wandering(Random& random, double share) {
  Step step;
  for (std::size_t i = 0; i < 4; ++i) {
    step[i] = in_cube(random);
    step[i + 4] = (1.0 - share) * step[i] + share * in_cube(random);
  }
  return step;
}

/// Returns a vertex inside a face, or two crossing edges, at kTouchTime; all points move at
/// constant velocities.
Step touching(FeaturePair kind, Random& random) {
  const Vec3d a = on_lattice(random, 16);
  const Vec3d b = on_lattice(random, 16);
  const Vec3d at = on_lattice(random, 64);
  std::array<Vec3d, 4> middle{at + a + b, at, at + 4.0 * a, at + 4.0 * b};
  if (kind == FeaturePair::edge_edge) {
    middle = {at - 2.0 * a, at + 3.0 * a, at - 3.0 * b, at + 1.0 * b};
  }
  Step step;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3d way = on_lattice(random, 64);
    step[i] = middle[i] - way;
    step[i + 4] = middle[i] + way;
  }
  return step;
}

/// Returns an orthonormal basis of random orientation.
std::array<Vec3d, 3> random_axes(Random& random) {
  const Eigen::Vector3d first = random_unit(random);
  const Eigen::Vector3d second = first.cross(random_unit(random)).normalized();
  return {first, second, first.cross(second)};
}

/// Returns a vertex that falls past an edge of a triangle in the plane z = 0, or an edge that falls
/// past the end of another, on the side x < 0 of the other feature; everything in a random
/// orientation.
Step passing(FeaturePair kind, Random& random) {
  const double away = 1e-11 * power(1e7, random.unit());
  const double height = random.in(0.1, 1.0);
  const double slant = random.in(-0.5, 0.5);
  std::array<Vec3d, 4> still{Vec3d{-away, slant, height}, Vec3d{0.0, -1.0, 0.0},
                             Vec3d{0.0, 1.0, 0.0}, Vec3d{1.0, slant, 0.0}};
  const std::size_t falling = kind == FeaturePair::vertex_face ? 1 : 2;
  if (kind == FeaturePair::edge_edge) {
    still = {Vec3d{-away, slant - 1.0, height}, Vec3d{-away, slant + 1.0, height},
             Vec3d{0.0, random.in(-0.5, 0.5), 0.0}, Vec3d{1.0, slant, 0.0}};
  }
  Step step;
  for (std::size_t i = 0; i < 4; ++i) {
    step[i] = step[i + 4] = still[i];
    if (i < falling) step[i + 4] = still[i] - Vec3d{0.0, 0.0, 2.0 * height};
  }
  const auto axes = random_axes(random);
  for (Vec3d& point : step) {
    point = axes[0] * point.x() + axes[1] * point.y() + axes[2] * point.z();
  }
  return step;
}

Step step_of(FeaturePair kind, FeatureSteps steps, Random& random) {
  switch (steps) {
    case FeatureSteps::random:
      return wandering(random, 1.0);
    case FeatureSteps::small:
      return wandering(random, 0.01);
    case FeatureSteps::touching:
      return touching(kind, random);
    default:
      return passing(kind, random);
  }
}

}  // namespace

FeatureColumns FeatureStepSet::columns() const {
  FeatureColumns columns;
  columns.count = count;
  for (std::size_t point = 0; point < 4; ++point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      columns.start[point][axis] = column[point][axis].data();
      columns.end[point][axis] = column[point + 4][axis].data();
    }
  }
  return columns;
}

FeatureStepSet make_feature_steps(FeaturePair kind, FeatureSteps steps, std::size_t count,
                                  std::uint64_t seed) {
  FeatureStepSet set;
  set.count = count;
  Random random(seed);
  for (std::size_t i = 0; i < count; ++i) {
    const Step step = step_of(kind, steps, random);
    for (std::size_t point = 0; point < step.size(); ++point) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        set.column[point][axis].push_back(step[point][static_cast<int>(axis)]);
      }
    }
  }
  return set;
}

}  // namespace winnow::bench
