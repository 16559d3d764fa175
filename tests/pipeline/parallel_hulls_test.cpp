// Hulls with almost equal orientations, whose edges and faces are parallel in float but not
// exactly. Bounds must hold nevertheless.

#include <gtest/gtest.h>
#include <winnow/simd/isa.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "tests/pipeline/hull_brute_force.h"
#include "tests/pipeline/pair_results.h"
#include "tests/pipeline/pair_scenes.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

std::vector<Eigen::Vector3d> block(double x, double y, double z) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back((i & 1) != 0 ? x : -x, (i & 2) != 0 ? y : -y, (i & 4) != 0 ? z : -z);
  }
  return corners;
}

std::vector<Eigen::Vector3d> prism(std::uint64_t sides) {
  std::vector<Eigen::Vector3d> corners;
  for (std::uint64_t i = 0; i < sides; ++i) {
    const double turn = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(sides);
    corners.emplace_back(std::cos(turn), std::sin(turn), -0.7);
    corners.emplace_back(std::cos(turn), std::sin(turn), 0.7);
  }
  return corners;
}

enum class Form { cubes, boxes, prisms, scattered };
void PrintTo(Form form, std::ostream* out) {
  *out << (form == Form::cubes    ? "cubes"
           : form == Form::boxes  ? "boxes"
           : form == Form::prisms ? "prisms"
                                  : "scattered");
}

std::vector<Eigen::Vector3d> corners_of(Form form, Random& random) {
  const auto length = [&] { return random.uniform(0.5, 1.5); };
  switch (form) {
    case Form::cubes:
      return block(1, 1, 1);
    case Form::boxes:
      return block(length(), length(), length());
    case Form::prisms:
      return prism(3 + random.below(8));
    case Form::scattered:
      break;
  }
  std::vector<Eigen::Vector3d> points;
  for (std::uint64_t i = 0; i < 8 + random.below(12); ++i) {
    points.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  }
  return points;
}

void put(const Eigen::Quaterniond& turn, const Eigen::Vector3d& place, PairScene& scene) {
  Pose pose = Pose::at(place.x(), place.y(), place.z());
  pose.orientation[0] = turn.w();
  for (int i = 0; i < 3; ++i) pose.orientation[i + 1] = turn.vec()[i];
  scene.poses.push_back(pose);
}

/// Pairs that nearly touch by faces or are placed at random. A third is also turned by a right
/// angle.
PairScene nearly_parallel(Form form, std::size_t count, Random& random) {
  constexpr double kRightAngle = 1.5707963267948966;
  const auto any = [&](double reach) { return random.uniform(-reach, reach); };
  PairScene scene;
  std::vector<ShapeId> hulls(20);
  for (ShapeId& id : hulls) {
    id = expect_ok(scene.pool.add_hull(corners_of(form, random), 0.0));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(any(1.0), any(1.0), any(1.0), 0.3).normalized();
    const Eigen::Vector3d axis = Eigen::Vector3d(any(1.0), any(1.0), any(1.0)).normalized();
    Eigen::Quaterniond other(Eigen::AngleAxisd(random.log_uniform(1e-14, 1e-4), axis));
    if (random.chance(0.3)) {
      other = other * Eigen::AngleAxisd(kRightAngle, Eigen::Vector3d::UnitZ());
    }
    const Eigen::Vector3d place(random.chance(0.5) ? 1.9 : any(2.0), any(1.5), any(1.5));
    const auto first = static_cast<std::uint32_t>(scene.shapes.size());
    scene.shapes.push_back(hulls[random.below(hulls.size())]);
    scene.shapes.push_back(random.chance(0.7) ? scene.shapes.back()
                                              : hulls[random.below(hulls.size())]);
    put(turn, Eigen::Vector3d::Zero(), scene);
    put(turn * other, turn * place, scene);
    scene.pairs.push_back({first, first + 1});
  }
  return scene;
}

TEST(ParallelCubes, slightly_turned_cubes_touch_edge_on_edge) {
  PairScene scene;
  scene.shapes.resize(2);
  for (ShapeId& id : scene.shapes) {
    id = expect_ok(scene.pool.add_hull(block(1, 1, 1), 0.0));
  }
  put(Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(), scene);
  constexpr double kTurn = 2.886751345948128e-08;
  put({0.9999999999999988, kTurn, kTurn, kTurn}, {1.9, 0.1, 0.1}, scene);
  scene.pairs = {{0, 1}};
  for (const ContactLevel level : {ContactLevel::distance, ContactLevel::manifold}) {
    const PairResults answer = compute_results(scene, {.level = level}).at(0);
    // Computed from the cross products of edges in a hundred digits. The best face normal is 6e-9
    // off.
    EXPECT_NEAR(answer.distance, -0.1000001096965479, answer.error_bound);
    EXPECT_LE(answer.error_bound, 1e-12);
  }
}

class ParallelHulls : public testing::TestWithParam<Form> {};

TEST_P(ParallelHulls, depth_matches_brute_force) {
  Random random(17);
  const PairScene scene = nearly_parallel(GetParam(), scaled(8000), random);
  std::vector<double> truth;
  for (const BodyPair& pair : scene.pairs) {
    const auto hull = [&](std::uint32_t body) -> const HullShape& {
      return scene.pool.tables().hulls[scene.shapes[body].index()];
    };
    truth.push_back(static_cast<double>(brute_force_distance(hull(pair.a), scene.poses[pair.a],
                                                             hull(pair.b), scene.poses[pair.b])));
  }
  for (const ContactLevel level : {ContactLevel::distance, ContactLevel::manifold}) {
    for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
      const auto answers =
          compute_results(scene, {.level = level, .tier = tier, .contact_margin = 10.0});
      for (std::size_t i = 0; i < answers.size(); ++i) {
        ASSERT_NEAR(answers[i].distance, truth[i], answers[i].error_bound + 1e-15) << i;
        ASSERT_LE(answers[i].error_bound, 2e-11) << i;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Forms, ParallelHulls,
                         testing::Values(Form::cubes, Form::boxes, Form::prisms, Form::scattered),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
