// Benchmarks of the times of impact of mesh features: a vertex and a face, or two edges, that move
// linearly in a step.

#include "bench/micro/micro.h"

#include <winnow/pipeline/impacts.h>
#include "bench/common/exact_math.h"
#include "bench/common/need.h"
#include "bench/scenes/random_shapes.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

namespace winnow::bench::micro {
namespace {

constexpr std::size_t kFeatures = 20'000;
constexpr double kTouchTime = 0.5;

/// Kinds of motion of two mesh features in a step.
enum class FeatureSteps {
  random,    ///< all points anywhere in a unit cube, at the start and at the end
  small,     ///< start anywhere in a unit cube, and move by a hundredth
  touching,  ///< touch exactly at kTouchTime, perhaps also earlier
  passing,   ///< pass at a distance of 1e-11 to 1e-4 without touching
};
constexpr std::array<std::string_view, 4> kStepNames{"random", "small steps", "touching exactly",
                                                     "passing by 1e-11 to 1e-4"};

/// Four points at the start and at the end.
using Step = std::array<Vec3d, 8>;

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
    step[i] = random.in_cube(0.0, 1.0);
    step[i + 4] = (1.0 - share) * step[i] + share * random.in_cube(0.0, 1.0);
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

/// Steps in columns.
struct StepColumns {
  /// Indexed by point, axis and pair; points 4 to 7 are the end positions.
  std::array<std::array<std::vector<double>, 3>, 8> column;

  StepColumns(FeaturePair kind, FeatureSteps steps) {
    Random random(1);
    for (std::size_t i = 0; i < kFeatures; ++i) {
      const Step step = step_of(kind, steps, random);
      for (std::size_t point = 0; point < 8; ++point) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          column[point][axis].push_back(step[point][axis]);
        }
      }
    }
  }
  [[nodiscard]] FeatureColumns view() const {
    FeatureColumns view;
    view.count = kFeatures;
    for (std::size_t point = 0; point < 4; ++point) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        view.start[point][axis] = column[point][axis].data();
        view.end[point][axis] = column[point + 4][axis].data();
      }
    }
    return view;
  }
};

void add_feature(FeaturePair kind, FeatureSteps steps) {
  const std::string path = std::string("feature/") +
                           (kind == FeaturePair::vertex_face ? "vertex-face/" : "edge-edge/") +
                           word_of(kStepNames[static_cast<std::size_t>(steps)]);
  add(path, [=](benchmark::State& state) {
    const auto& set = prepared<const StepColumns>(path, kind, steps);
    std::vector<double> times(kFeatures);
    need(feature_impacts(kind, set.view(), times), "features");
    std::size_t hits = 0;
    std::size_t missed = 0;
    std::size_t invented = 0;
    for (const double time : times) {
      const bool hit = std::isfinite(time);
      hits += hit ? 1 : 0;
      missed += steps == FeatureSteps::touching && !(time <= kTouchTime) ? 1 : 0;
      invented += steps == FeatureSteps::passing && hit ? 1 : 0;
    }
    check(missed == 0 && invented == 0, "an impact was missed or invented");
    run(state, 1, [&] { need(feature_impacts(kind, set.view(), times), "features"); });
    count_ns(state, "ns_per_pair", kFeatures);
    count(state, "pairs", kFeatures);
    count(state, "hits", hits);
    count(state, "missed", missed);
    count(state, "invented", invented);
  });
}

}  // namespace

void add_features() {
  using enum FeatureSteps;
  for (const FeaturePair kind : {FeaturePair::vertex_face, FeaturePair::edge_edge}) {
    for (const FeatureSteps steps : {random, small, touching, passing}) add_feature(kind, steps);
  }
}

}  // namespace winnow::bench::micro
