// The kernel of hulls compared with a search over all features, and with itself: on every ISA, with
// swapped bodies, at other positions of a batch.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/simd/isa.h>
#include "pipeline/kernels/kernels.h"
#include "pipeline/solver/solver.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <ostream>
#include <utility>
#include <vector>

#include "tests/pipeline/hull_brute_force.h"
#include "tests/pipeline/pair_scenes.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/float_modes.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Points = std::vector<Eigen::Vector3d>;

/// Answers of one job in columns.
struct Answers {
  Answers(const PairScene& scene, int level, ShapeKind a = ShapeKind::hull,
          ShapeKind b = ShapeKind::hull)
      : count(static_cast<std::uint32_t>(scene.pairs.size())) {
    overlap.resize(count, 2);
    for (auto& c : column) c.resize(count, -77.0);
    first.resize(count);
    contacts.resize(count);
    uncertified.resize(count);
    for (auto& c : points) c.resize(kManifoldPoints * count + 16);
    feature.resize(kManifoldPoints * count + 16);
    NarrowJob job{};
    job.pairs = scene.pairs.data();
    job.count = count;
    job.shapes = scene.shapes.data();
    job.poses = scene.poses.data();
    job.tables = &scene.pool.tables();
    job.margin = 0.05;
    job.overlap = overlap.data();
    job.distance = column[0].data();
    job.error_bound = column[1].data();
    for (int k = 0; k < 3; ++k) {
      job.normal[k] = column[2 + k].data();
      job.point[k] = column[5 + k].data();
      job.contacts.position[k] = points[k].data();
    }
    job.contact_first = first.data();
    job.contact_count = contacts.data();
    job.contacts.depth = points[3].data();
    job.contacts.feature = feature.data();
    job.uncertified = uncertified.data();
    const NarrowKernels* kernels = narrow_kernels(a, b);
    uncertified.resize(kernels->of_level[level](job));
    is_certified.assign(count, 1);
    for (const std::uint32_t i : uncertified) is_certified[i] = 0;
  }
  [[nodiscard]] Eigen::Vector3d normal(std::uint32_t i) const {
    return {column[2][i], column[3][i], column[4][i]};
  }
  [[nodiscard]] Eigen::Vector3d point(std::uint32_t i) const {
    return {column[5][i], column[6][i], column[7][i]};
  }

  std::uint32_t count;
  std::vector<std::uint8_t> overlap;
  /// Distance, error bound, normal (3), point (3).
  std::vector<double> column[8];
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> contacts;
  std::vector<std::uint32_t> uncertified;
  std::vector<std::uint8_t> is_certified;
  std::vector<float> points[4];
  std::vector<std::uint64_t> feature;
};

enum class Style { ball, sphere_large, box, plate, rich, rounded, prism };

/// Relative orientation of hulls. Upright hulls have parallel faces and edges.
enum class Turn { any, upright, none };

/// Returns the corners of an upright prism.
Points prism_of(std::uint64_t sides, double half_height) {
  Points points;
  for (std::uint64_t i = 0; i < 2 * sides; ++i) {
    const double turn = 6.283185307179586 * static_cast<double>(i / 2) / static_cast<double>(sides);
    points.emplace_back(0.6 * std::cos(turn), 0.6 * std::sin(turn),
                        i % 2 == 0 ? half_height : -half_height);
  }
  return points;
}

Points points_of(Style style, Random& random) {
  if (style == Style::prism) return prism_of(3 + random.below(30), random.uniform(0.4, 1));
  Points points;
  if (style == Style::box || style == Style::plate || style == Style::rich) {
    const Eigen::Vector3d half(random.uniform(0.4, 1), random.uniform(0.4, 1),
                               style == Style::plate ? 1e-3 : random.uniform(0.4, 1));
    const int steps = style == Style::rich ? 3 : 1;
    for (int x = -steps; x <= steps; x += 2) {
      for (int y = -steps; y <= steps; y += 2) {
        for (int z = -steps; z <= steps; z += 2) {
          points.emplace_back(half[0] * x / steps, half[1] * y / steps, half[2] * z / steps);
        }
      }
    }
    return points;
  }
  const int count = style == Style::sphere_large ? 40 : 6 + static_cast<int>(random.below(11));
  while (points.size() < static_cast<std::size_t>(count)) {
    Eigen::Vector3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (p.norm() > 1) continue;
    if (style == Style::sphere_large) p.normalize();
    points.push_back(p);
  }
  return points;
}

Pose pose_near(const Eigen::Vector3d& origin, double reach, Random& random, Turn turn) {
  Pose pose;
  for (int k = 0; k < 3; ++k) pose.position[k] = origin[k] + random.uniform(-reach, reach);
  if (turn == Turn::none) return pose;
  for (double& q : pose.orientation) q = random.uniform(-1, 1);
  if (turn == Turn::upright) pose.orientation[1] = pose.orientation[2] = 0.0;
  return pose;
}

/// Pairs of hulls of one style near each other.
PairScene scene_of(Style style, std::size_t pairs, std::uint64_t seed, Turn turn = Turn::any) {
  PairScene scene;
  Random random(seed);
  const double rounding = style == Style::rounded ? 0.2 : 0.0;
  for (std::uint32_t i = 0; i < 2 * pairs; ++i) {
    ShapeId id = expect_ok(scene.pool.add_hull(points_of(style, random), rounding));
    scene.shapes.push_back(id);
    const Eigen::Vector3d origin(1e3 * (i / 2), -50.0, 7.0);
    scene.poses.push_back(pose_near(origin, 0.7, random, turn));
  }
  for (std::uint32_t i = 0; i < pairs; ++i) scene.pairs.push_back({2 * i, 2 * i + 1});
  return scene;
}

class HullKernels : public testing::TestWithParam<Style> {};

long double truth(const PairScene& scene, std::uint32_t i) {
  const BodyPair p = scene.pairs[i];
  const HullShape& a = scene.pool.tables().hulls[scene.shapes[p.a].index()];
  const HullShape& b = scene.pool.tables().hulls[scene.shapes[p.b].index()];
  return brute_force_distance(a, scene.poses[p.a], b, scene.poses[p.b]) - a.rounding - b.rounding;
}

TEST_P(HullKernels, answers_match_brute_force_within_error_bounds) {
  const bool rounded = GetParam() == Style::rounded;
  const PairScene scene = scene_of(GetParam(), scaled(150), 1);
  std::vector<long double> distance;
  for (std::uint32_t i = 0; i < scene.pairs.size(); ++i) distance.push_back(truth(scene, i));
  const Answers verdicts(scene, 0);
  const Answers answers(scene, 1);
  const Answers manifolds(scene, 2);
  for (std::uint32_t i = 0; i < answers.count; ++i) {
    const auto d = static_cast<double>(distance[i]);
    if (verdicts.is_certified[i]) {
      EXPECT_EQ(verdicts.overlap[i] != 0, d <= 0) << i << " " << d;
    }
    if (answers.is_certified[i]) {
      EXPECT_LE(std::abs(answers.column[0][i] - d), answers.column[1][i] + 1e-17) << i;
      EXPECT_LE(answers.column[1][i], 1e-11) << i;
      EXPECT_NEAR(answers.normal(i).norm(), 1.0, 1e-12) << i;
    }
    if (manifolds.is_certified[i]) {
      EXPECT_LE(std::abs(manifolds.column[0][i] - d), manifolds.column[1][i] + 1e-17) << i;
      if (manifolds.column[0][i] > 0.05) {
        EXPECT_LE(manifolds.column[0][i], d) << i;
      }
    }
  }
  EXPECT_LE(answers.uncertified.size(), answers.count / (rounded ? 5 : 10));
}

/// Returns an upper bound of how far a point is outside a hull.
double outside(const PairScene& scene, std::uint32_t body, const Eigen::Vector3d& world) {
  const HullShape& hull = scene.pool.tables().hulls[scene.shapes[body].index()];
  const Quaternion& q = scene.poses[body].orientation;
  const Eigen::Quaterniond turn = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
  const Eigen::Vector3d x = turn.conjugate() * (world - as_eigen(scene.poses[body].position));
  double most = -1e9;
  for (std::uint32_t f = 0; f < hull.face_count; ++f) {
    const HullFace& face = hull.faces[f];
    most = std::max(most, as_eigen(face.normal).dot(x) - face.offset);
  }
  return most - hull.rounding;
}

void expect_points_on_both(const PairScene& scene, bool rounded) {
  const Answers answers(scene, 1);
  const double doubt = 1e-9;
  for (std::uint32_t i = 0; i < answers.count; ++i) {
    if (!answers.is_certified[i]) continue;
    const BodyPair p = scene.pairs[i];
    const Eigen::Vector3d a = answers.point(i) + as_eigen(scene.poses[p.a].position);
    const Eigen::Vector3d b = a + answers.column[0][i] * answers.normal(i);
    // A point on the rounding of an edge may be inside all face planes.
    EXPECT_LE(outside(scene, p.a, a), doubt) << i;
    EXPECT_LE(outside(scene, p.b, b), doubt) << i;
    if (rounded) continue;
    EXPECT_GE(outside(scene, p.a, a), -doubt) << i;
    EXPECT_GE(outside(scene, p.b, b), -doubt) << i;
  }
}

TEST_P(HullKernels, witness_points_lie_on_both_hulls) {
  for (const Turn turn : {Turn::any, Turn::upright, Turn::none}) {
    const PairScene scene = scene_of(GetParam(), scaled(400), 2, turn);
    SCOPED_TRACE(testing::Message() << "turn " << static_cast<int>(turn));
    expect_points_on_both(scene, GetParam() == Style::rounded);
  }
}

TEST_P(HullKernels, swapped_pairs_give_mirrored_answers) {
  PairScene scene = scene_of(GetParam(), scaled(100), 3);
  const Answers one(scene, 1);
  PairScene& turned = scene;
  for (BodyPair& p : turned.pairs) std::swap(p.a, p.b);
  const Answers two(turned, 1);
  EXPECT_EQ(one.is_certified, two.is_certified);
  for (std::uint32_t i = 0; i < one.count; ++i) {
    if (!one.is_certified[i]) continue;
    EXPECT_EQ(one.column[0][i], two.column[0][i]);
    EXPECT_EQ(one.column[1][i], two.column[1][i]);
    EXPECT_EQ(one.normal(i), -two.normal(i));
  }
}

template <typename T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST_P(HullKernels, answers_match_on_every_isa) {
  const PairScene scene = scene_of(GetParam(), scaled(150), 4);
  for (int level = 0; level < 3; ++level) {
    const Answers expected(scene, level);
    for (const Isa isa : available_isas()) {
      const IsaScope scope(isa);
      const Answers answers(scene, level);
      EXPECT_EQ(answers.is_certified, expected.is_certified) << to_string(isa);
      EXPECT_TRUE(same(answers.overlap, expected.overlap)) << to_string(isa);
      for (int c = 0; c < 8; ++c) EXPECT_TRUE(same(answers.column[c], expected.column[c]));
      EXPECT_TRUE(same(answers.contacts, expected.contacts));
      for (int c = 0; c < 4; ++c) EXPECT_TRUE(same(answers.points[c], expected.points[c]));
    }
  }
}

TEST_P(HullKernels, batch_position_does_not_change_answers) {
  PairScene scene = scene_of(GetParam(), scaled(150), 5);
  const Answers forth(scene, 1);
  std::reverse(scene.pairs.begin(), scene.pairs.end());
  const Answers back(scene, 1);
  for (std::uint32_t i = 0; i < forth.count; ++i) {
    const std::uint32_t k = forth.count - 1 - i;
    EXPECT_EQ(forth.is_certified[i], back.is_certified[k]);
    for (int c = 0; c < 8 && forth.is_certified[i]; ++c) {
      EXPECT_EQ(forth.column[c][i], back.column[c][k]);
    }
  }
}

TEST_P(HullKernels, parallel_hulls_stay_within_error_bounds) {
  const PairScene scene = scene_of(GetParam(), scaled(60), 6, Turn::none);
  const Answers answers(scene, 2);
  for (std::uint32_t i = 0; i < answers.count; ++i) {
    if (!answers.is_certified[i]) continue;
    EXPECT_LE(std::abs(answers.column[0][i] - static_cast<double>(truth(scene, i))),
              answers.column[1][i] + 1e-17)
        << i;
    if (answers.column[0][i] <= 0) {
      EXPECT_GE(answers.contacts[i], 1U);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Styles, HullKernels,
                         testing::Values(Style::ball, Style::sphere_large, Style::box, Style::plate,
                                         Style::rich, Style::rounded, Style::prism));

// Parallel features touch in more than one point, which is no reason to call the solver.
TEST(UprightPrisms, parallel_features_are_certified) {
  for (const Turn turn : {Turn::upright, Turn::none}) {
    const PairScene scene = scene_of(Style::prism, 400, 7, turn);
    for (int level = 0; level < 3; ++level) {
      EXPECT_TRUE(Answers(scene, level).uncertified.empty()) << level;
    }
  }
}

TEST(HullKernel, touching_and_bad_pairs_are_not_certified) {
  PairScene scene;
  Random random(1);
  ShapeId id = expect_ok(scene.pool.add_hull(points_of(Style::ball, random), 0.0));
  Points cube;
  for (int i = 0; i < 8; ++i) cube.emplace_back(i & 1, i >> 1 & 1, i >> 2);
  id = expect_ok(scene.pool.add_hull(cube, 0.0));
  Pose nan;
  nan.position[1] = std::nan("");
  Pose zero;
  zero.orientation[0] = 0.0;
  Pose far = Pose::at(1e30, 0, 0);
  for (const Pose& pose : {Pose::at(1, 0, 0), Pose::at(-1, 0.5, 0), nan, zero, far}) {
    scene.pairs.push_back({static_cast<std::uint32_t>(scene.poses.size()),
                           static_cast<std::uint32_t>(scene.poses.size()) + 1});
    scene.poses.push_back(Pose{});
    scene.poses.push_back(pose);
    scene.shapes.push_back(id);
    scene.shapes.push_back(id);
  }
  for (int level = 0; level < 3; ++level) {
    const Answers answers(scene, level);
    for (std::uint32_t i = 0; i < answers.count; ++i) {
      EXPECT_FALSE(answers.is_certified[i]) << level << " " << i << " " << answers.column[0][i];
    }
  }
}

struct KindsAndStyle {
  ShapeKind a;
  ShapeKind b;
  PairStyle style;
};
void PrintTo(const KindsAndStyle& k, std::ostream* out) {
  *out << to_string(k.a) << "_" << to_string(k.b) << "_" << to_string(k.style);
}

class CoresAndHulls : public testing::TestWithParam<KindsAndStyle> {
 protected:
  /// Adds pairs whose bodies have kinds a and b in this order.
  static void add(PairScene& scene, std::size_t count) {
    const auto [a, b, style] = GetParam();
    Random random(9);
    add_pairs(scene, a, b, style, count, random);
    for (BodyPair& p : scene.pairs) {
      if (scene.shapes[p.a].kind() != a) std::swap(p.a, p.b);
    }
  }
};

TEST_P(CoresAndHulls, answers_match_solver_on_every_isa) {
  const auto [a, b, style] = GetParam();
  PairScene scene;
  add(scene, scaled(200));
  std::vector<PairAnswer> expected;
  SolverCounts counts;
  for (const BodyPair& p : scene.pairs) {
    expected.push_back(solve_pair(scene.pool.tables(), scene.shapes[p.a], scene.poses[p.a],
                                  scene.shapes[p.b], scene.poses[p.b], ContactLevel::distance, 0.0,
                                  counts));
  }
  for (const Isa isa : available_isas()) {
    const IsaScope scope(isa);
    for (int level = 0; level < 3; ++level) {
      const Answers answers(scene, level, a, b);
      if (style == PairStyle::ordinary) {
        EXPECT_LE(answers.uncertified.size(), answers.count / 10);
      }
      for (std::uint32_t i = 0; i < answers.count; ++i) {
        if (!answers.is_certified[i]) continue;
        const PairAnswer& e = expected[i];
        if (level == 0) {
          EXPECT_EQ(answers.overlap[i] != 0, e.overlap) << i << " " << e.distance;
          continue;
        }
        EXPECT_LE(std::abs(answers.column[0][i] - e.distance), answers.column[1][i] + e.error_bound)
            << i << " level " << level;
      }
    }
  }
}

// Vertices at height zero, such as a triangle in its own plane has, produce denormal numbers.
TEST_P(CoresAndHulls, flushed_denormals_do_not_change_answers) {
  const auto [a, b, style] = GetParam();
  if (style != PairStyle::lattice && style != PairStyle::ordinary) return;
  PairScene scene;
  add(scene, 400);
  for (int level = 0; level < 3; ++level) {
    const Answers expected(scene, level, a, b);
    for (const Isa isa : available_isas()) {
      const IsaScope scope(isa);
      const FloatModeScope flushed({FE_TONEAREST, true, true});
      const Answers answers(scene, level, a, b);
      EXPECT_EQ(answers.is_certified, expected.is_certified) << to_string(isa);
      for (std::uint32_t i = 0; i < answers.count; ++i) {
        if (!expected.is_certified[i]) continue;
        EXPECT_EQ(answers.overlap[i], expected.overlap[i]) << i;
        for (int c = 0; c < 8 && level > 0; ++c) {
          EXPECT_EQ(answers.column[c][i], expected.column[c][i]) << i << " column " << c;
        }
      }
    }
  }
}

std::vector<KindsAndStyle> all_cores_and_hulls() {
  std::vector<KindsAndStyle> all;
  for (const PairStyle style : kPairStyles) {
    for (const ShapeKind kind : {ShapeKind::sphere, ShapeKind::capsule, ShapeKind::box}) {
      all.push_back({kind, ShapeKind::hull, style});
    }
    all.push_back({ShapeKind::hull, ShapeKind::triangle, style});
    all.push_back({ShapeKind::hull, ShapeKind::hull, style});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Kinds, CoresAndHulls, testing::ValuesIn(all_cores_and_hulls()));

}  // namespace
}  // namespace winnow::test
