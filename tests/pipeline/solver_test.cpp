// Properties of the solver for pairs of all kinds. oracle_test.cpp checks the values.

#include "pipeline/solver/solver.h"
#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include "pipeline/exact/exact_overlap.h"
#include "pipeline/solver/problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tests/pipeline/pair_scenes.h"
#include "tests/pipeline/reproduction.h"
#include "tests/support/answers.h"

namespace winnow::test {
namespace {

using Vec = Eigen::Vector3d;

/// A pair, with calls of the solver.
struct SolverPair {
  const PairScene& scene;
  BodyPair pair;

  [[nodiscard]] PairAnswer solve(ContactLevel level, double margin = 0.0) const {
    SolverCounts counts;
    return solve_pair(scene.pool.tables(), scene.shapes[pair.a], scene.poses[pair.a],
                      scene.shapes[pair.b], scene.poses[pair.b], level, margin, counts);
  }
  [[nodiscard]] PairAnswer solve_at(const Pose& a, const Pose& b) const {
    SolverCounts counts;
    return solve_pair(scene.pool.tables(), scene.shapes[pair.a], a, scene.shapes[pair.b], b,
                      ContactLevel::distance, 0.0, counts);
  }
  [[nodiscard]] const Pose& pose_a() const { return scene.poses[pair.a]; }
  [[nodiscard]] const Pose& pose_b() const { return scene.poses[pair.b]; }
  [[nodiscard]] bool has(ShapeKind kind) const {
    return scene.shapes[pair.a].kind() == kind || scene.shapes[pair.b].kind() == kind;
  }
  /// Tolerance of points and normals relative to the size. With cylinders and cones it is larger,
  /// because the distance hardly changes while a point moves along a curved surface.
  [[nodiscard]] double relative_error() const {
    return has(ShapeKind::cylinder) || has(ShapeKind::cone) ? 1e-8 : 1e-13;
  }
  /// Returns the sum of the pair's lengths, including |c|.
  [[nodiscard]] double size() const {
    solver::Problem problem;
    solver::prepare(scene.pool.tables(), scene.shapes[pair.a], pose_a(), scene.shapes[pair.b],
                    pose_b(), false, problem);
    return unscaled(problem, problem.size);
  }
};

/// Calls body(solver_pair) for pairs of all kinds except two half-spaces.
template <typename Body>
void for_pairs(PairStyle style, Body&& body) {
  for (const ShapeKind a : all_kinds()) {
    for (const ShapeKind b : all_kinds()) {
      if (a == ShapeKind::half_space && b == ShapeKind::half_space) continue;
      Random random(100 * static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
      PairScene scene;
      add_pairs(scene, a, b, style, scaled(30), random);
      for (const BodyPair pair : scene.pairs) {
        SCOPED_TRACE(reproduction(scene, pair));
        body(SolverPair{scene, pair});
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

/// Returns how far x is outside the core's shape along the worst of some directions.
double outside(const solver::Core& core, const Vec& x, const Vec& along, Random& random) {
  if (core.kind == ShapeKind::half_space) {
    return core.normal.dot(x - core.center) - core.offset;
  }
  double worst = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 40; ++i) {
    Vec d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (i == 0) d = along;
    if (i == 1) d = -along;
    d = solver::unit(d);
    worst = std::max(worst, d.dot(x - core.center) - solver::project(core, d).high - core.rounding);
  }
  return worst;
}

class SolverCases : public testing::Test {
 protected:
  template <typename Shape>
  ShapeId add(const Shape& shape) {
    ShapeId id = expect_ok(pool_.add(shape));
    return id;
  }
  PairAnswer solve(ShapeId a, const Pose& pose_a, ShapeId b, const Pose& pose_b,
                   ContactLevel level = ContactLevel::manifold, double margin = 0.0) {
    return solve_pair(pool_.tables(), a, pose_a, b, pose_b, level, margin, counts_);
  }

  ShapePool pool_;
  SolverCounts counts_;
};

TEST_F(SolverCases, coincident_centres_use_first_axis_of_a) {
  const ShapeId sphere = add(SphereShape{1.0});
  const ShapeId cube = add(BoxShape{{1, 1, 1}, 0.0});
  const ShapeId rod = add(CapsuleShape{0.5, 2.0});
  const ShapeId drum = add(CylinderShape{1.0, 3.0, 0.0});
  // Turned by 90 degrees about z: the x axis of a is the y axis of the world.
  const Pose turned{{0, 0, 0}, {1, 0, 0, 1}};
  for (const auto& [shape, depth] :
       {std::pair{sphere, 2.0}, {cube, 2.0}, {rod, 1.0}, {drum, 2.0}}) {
    const PairAnswer answer = solve(shape, turned, shape, turned);
    EXPECT_NEAR(answer.distance, -depth, 1e-14);
    EXPECT_NEAR(answer.normal[1], 1.0, 1e-14);
  }
  const PairAnswer mixed = solve(sphere, Pose{}, cube, Pose{});
  EXPECT_EQ(mixed.distance, -2.0);
  EXPECT_EQ(mixed.normal[0], 1.0);
  const PairAnswer other = solve(cube, Pose{}, sphere, turned);
  EXPECT_EQ(other.normal[0], 1.0);
}

TEST_F(SolverCases, coincident_points_have_one_contact) {
  const ShapeId point = add(SphereShape{0.0});
  const PairAnswer answer = solve(point, Pose{}, point, Pose{});
  EXPECT_TRUE(answer.overlap);
  EXPECT_EQ(answer.distance, 0.0);
  EXPECT_EQ(answer.contact_count, 1U);
}

TEST_F(SolverCases, touching_shapes_overlap_at_distance_zero) {
  const ShapeId sphere = add(SphereShape{1.0});
  const ShapeId cube = add(BoxShape{{1, 1, 1}, 0.0});
  const ShapeId drum = add(CylinderShape{0.5, 0.25, 0.0});
  const ShapeId cone = add(ConeShape{0.5, 0.25, 0.0});
  const Pose on_side{{0, 0, 1.5}, {1, 0, 1, 0}};
  const Pose on_tip{{0.25, 0, 1.25}, {0, 1, 0, 0}};
  EXPECT_EQ(solve(cube, Pose{}, sphere, Pose::at(0, 0, 2)).distance, 0.0);
  EXPECT_EQ(solve(cube, Pose{}, cube, Pose::at(2, 2, 2)).distance, 0.0);
  EXPECT_EQ(solve(cube, Pose{}, drum, on_side).distance, 0.0);
  EXPECT_EQ(solve(cube, Pose{}, drum, Pose::at(0, 0, 1.25)).distance, 0.0);
  EXPECT_EQ(solve(cube, Pose{}, cone, Pose::at(0, 0, 1.25)).distance, 0.0);
  EXPECT_EQ(solve(cube, Pose{}, cone, on_tip).distance, 0.0);
}

TEST_F(SolverCases, touching_faces_have_tight_error_bounds) {
  const ShapeId cube = add(BoxShape{{1, 1, 1}, 0.0});
  const ShapeId drum = add(CylinderShape{0.5, 0.25, 0.0});
  const ShapeId cone = add(ConeShape{0.5, 0.25, 0.0});
  for (const ShapeId shape : {cube, drum, cone}) {
    const double half = shape == cube ? 1.0 : 0.25;
    for (const double x : {0.0, 0.25}) {
      const PairAnswer answer = solve(cube, Pose{}, shape, Pose::at(x, 0, 1.0 + half));
      EXPECT_EQ(answer.distance, 0.0);
      EXPECT_LE(answer.error_bound, 1e-13);
      EXPECT_NEAR(answer.normal[2], 1.0, 1e-14);
    }
  }
}

/// Returns the core of a shape, placed and scaled.
solver::Core core_of(const ShapePool& pool, ShapeId id, const Pose& pose) {
  solver::Problem problem;
  solver::prepare(pool.tables(), id, pose, id, Pose{}, false, problem);
  return problem.a;
}

/// Checks the corners, edges and faces of a core against each other.
void expect_features_agree(const solver::Core& core) {
  const std::uint32_t corners = vertex_count(core);
  for (std::uint32_t i = 0; i < edge_count(core); ++i) {
    const auto [p, q] = edge(core, i);
    ASSERT_LT(std::max(p, q), corners);
    ASSERT_NE(p, q);
  }
  for (std::uint32_t f = 0; f < face_count(core); ++f) {
    const Vec n = face_normal(core, f);
    EXPECT_NEAR(n.norm(), 1.0, 1e-14);
    const std::uint32_t size = face_size(core, f);
    const Vec first = vertex(core, face_vertex(core, f, 0));
    for (std::uint32_t i = 0; i < corners; ++i) {
      EXPECT_LE(n.dot(vertex(core, i) - first), 1e-14) << "face " << f << " corner " << i;
    }
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::uint32_t p = face_vertex(core, f, i);
      const std::uint32_t q = face_vertex(core, f, (i + 1) % size);
      EXPECT_NEAR(n.dot(vertex(core, p) - first), 0.0, 1e-14);
      const auto ends = edge(core, face_edge(core, f, i));
      EXPECT_TRUE((ends[0] == p && ends[1] == q) || (ends[0] == q && ends[1] == p));
      const Vec side = vertex(core, q) - vertex(core, p);
      const std::uint32_t r = face_vertex(core, f, (i + 2) % size);
      EXPECT_GT(n.dot(side.cross(vertex(core, r) - vertex(core, q))), 0.0) << "face " << f;
    }
  }
}

/// Checks that supports, projections and heights agree with the corners.
void expect_corners_are_farthest(const solver::Core& core) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Vec d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::uint32_t k = 0; k < vertex_count(core); ++k) {
      low = std::min(low, d.dot(vertex(core, k) - core.center));
      high = std::max(high, d.dot(vertex(core, k) - core.center));
    }
    EXPECT_NEAR(d.dot(support(core, d) - core.center), high, 1e-14);
    EXPECT_NEAR(project(core, d).low, low, 1e-14);
    EXPECT_NEAR(project(core, d).high, high, 1e-14);
    EXPECT_NEAR(highest(core, d), high, 1e-14);
  }
}

TEST_F(SolverCases, core_features_are_consistent) {
  const Pose turned{{1, 2, 3}, {2, -1, 0.5, 1}};
  ShapeId hull;
  const std::vector<Vec3d> corners{{1, 0, 0},  {-1, 0, 0}, {0, 0.75, 0},
                                   {0, -1, 0}, {0, 0, 1},  {0, 0, -0.5}};
  const std::vector<std::uint32_t> loops{0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                         2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  const std::vector<std::uint32_t> sizes(8, 3);
  hull = expect_ok(pool_.add_hull(corners, {loops, sizes}, 0.0));
  const ShapeId triangle = add(TriangleShape{{{1, 0, 0}, {0, 2, 0.5}, {-1, -1, 0}}, 0.0});
  for (const ShapeId shape : {add(BoxShape{{1, 0.5, 0.75}, 0.0}), hull, triangle}) {
    SCOPED_TRACE(to_string(shape.kind()));
    const solver::Core core = core_of(pool_, shape, turned);
    expect_features_agree(core);
    expect_corners_are_farthest(core);
  }
  expect_corners_are_farthest(core_of(pool_, add(CapsuleShape{0.5, 2.0}), turned));
}

TEST_F(SolverCases, coaxial_round_shapes_have_exact_depths) {
  const ShapeId drum = add(CylinderShape{2.0, 1.0, 0.0});
  const ShapeId cone = add(ConeShape{1.0, 1.0, 0.25});
  const ShapeId sphere = add(SphereShape{0.5});
  const PairAnswer drums = solve(drum, Pose{}, drum, Pose::at(0, 0, 0.5));
  EXPECT_EQ(drums.distance, -1.5);
  EXPECT_LE(drums.error_bound, 1e-13);
  // Depth 0.75 below the cone's base plane, 1.25 / sqrt(5) from its side.
  const PairAnswer in_cone = solve(cone, Pose{}, sphere, Pose::at(0, 0, -0.25));
  EXPECT_NEAR(in_cone.distance, -1.25 / std::sqrt(5.0) - 0.75, 1e-14);
  EXPECT_LE(in_cone.error_bound, 1e-13);
}

TEST_F(SolverCases, box_on_ground_keeps_four_features) {
  const ShapeId box = add(BoxShape{{1, 2, 0.5}, 0.0});
  const ShapeId drum = add(CylinderShape{1.0, 0.5, 0.0});
  const ShapeId ground = add(HalfSpaceShape{{0, 0, 1}, 0.0});
  const ShapeId slab = add(BoxShape{{10, 10, 1}, 0.0});
  for (const auto& [floor, below] : {std::pair{ground, 0.0}, {slab, -1.0}}) {
    for (const ShapeId body : {box, drum}) {
      const PairAnswer now = solve(body, Pose::at(0, 0, 0.49), floor, Pose::at(0, 0, below));
      ASSERT_EQ(now.contact_count, 4U);
      const Pose rocked{{0.1, 0, 0.491}, {1, 1e-4, 1e-4, 0}};
      const PairAnswer next = solve(body, rocked, floor, Pose::at(0, 0, below));
      ASSERT_EQ(next.contact_count, 4U);
      if (body == drum) continue;
      std::uint64_t features[2][4];
      for (int i = 0; i < 4; ++i) {
        features[0][i] = now.contacts[i].feature;
        features[1][i] = next.contacts[i].feature;
        EXPECT_NEAR(now.contacts[i].depth, 0.01F, 1e-6F);
      }
      std::sort(features[0], features[0] + 4);
      std::sort(features[1], features[1] + 4);
      EXPECT_TRUE(std::equal(features[0], features[0] + 4, features[1]));
    }
  }
}

TEST_F(SolverCases, half_spaces_are_apart_only_if_opposite) {
  const ShapeId up = add(HalfSpaceShape{{0, 0, 1}, 0.0});
  const ShapeId down = add(HalfSpaceShape{{0, 0, -1}, 0.0});
  EXPECT_EQ(solve(up, Pose{}, down, Pose::at(5, 0, 2)).distance, 2.0);
  EXPECT_EQ(solve(up, Pose{}, down, Pose::at(5, 0, -2)).distance, -2.0);
  const PairAnswer endless = solve(up, Pose{}, up, Pose::at(0, 0, -9));
  EXPECT_TRUE(endless.overlap);
  EXPECT_LT(endless.distance, -1e300);
  EXPECT_TRUE(std::isfinite(endless.distance));
}

// Coordinates of the large hull are coarse relative to the rod. A polytope of their differences may
// have the origin on the wrong side by more than rounding.
TEST_F(SolverCases, rod_beside_huge_hull_is_apart) {
  const std::vector<Vec> rod_ends{{0.7578125, -0.25, -0.03125},
                                  {0.863372802734375, -0.125, 0.1630859375}};
  constexpr double kUnit = 0x1p33;
  std::vector<Vec> corners{{-32, 16, 64}, {32, -16, 64}, {16, 32, 96},   {64, -32, 32},
                           {-8, 64, 64},  {32, 32, 96},  {-32, -32, 64}, {-32, -16, -64},
                           {32, 64, 64},  {26, 2, -92},  {-32, -64, 49}, {16, 64, -64},
                           {-64, 1, -16}};
  for (Vec& corner : corners) corner *= kUnit;
  corners.insert(corners.end(), {{287540023407.08252, 440519093884.23438, -536225659384.42578},
                                 {329539548069.05029, 358437933230.01367, -556772389866.53418},
                                 {283094055835.81445, 66267112995.037109, -742520916180.31445}});
  ShapeId rod;
  ShapeId world;
  rod = expect_ok(pool_.add_hull(rod_ends, 0.0));
  world = expect_ok(pool_.add_hull(corners, 0.0));
  const Pose at_rod{{-1.125, 1.0330810546875, 3.60107421875},
                    {-0.6171875, -0.35546875, -0.3203125, 0.625}};
  const Pose at_world{
      {33828603836.1875, -421841837546.11523, -615947021952.91602},
      {-0.45780498874663866, -0.84916710831400266, 0.10720536226435229, -0.24049287876795233}};
  const PairAnswer answer = solve(rod, at_rod, world, at_world, ContactLevel::distance);
  ASSERT_EQ(exact_overlap(pool_.tables(), rod, at_rod, world, at_world, answer.normal.data()),
            ExactVerdict::separated);
  EXPECT_FALSE(answer.overlap) << answer.distance << " +- " << answer.error_bound;
}

/// Returns a random orientation.
Eigen::Quaterniond any_turn(Random& random) {
  return Eigen::Quaterniond(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1),
                            random.uniform(-1, 1))
      .normalized();
}
Pose pose_of(const Eigen::Quaterniond& turn, const Vec& at) {
  return {{at.x(), at.y(), at.z()}, {turn.w(), turn.x(), turn.y(), turn.z()}};
}

TEST_F(SolverCases, nearly_parallel_crossing_rods_touch) {
  const std::vector<Vec> ends{{-1, 0, 0}, {1, 0, 0}};
  ShapeId hull = expect_ok(pool_.add_hull(ends, 0.0));
  const ShapeId rods[] = {add(BoxShape{{1, 0, 0}, 0.0}),
                          add(TriangleShape{{{-1, 0, 0}, {1, 0, 0}, {0, 0, 0}}, 0.0}), hull};
  Random random(5);
  for (std::size_t i = 0; i < scaled(1000); ++i) {
    const Eigen::Quaterniond turn = any_turn(random);
    const double tilt = random.log_uniform(1e-13, 1e-4);
    const Eigen::Quaterniond off =
        random.chance(0.5) ? Eigen::Quaterniond(1, 0, tilt, 0) : Eigen::Quaterniond(tilt, 0, 0, 1);
    const Eigen::Quaterniond tilted = turn * off.normalized();
    // A point of the second rod that is on the first one, too.
    const double at = random.uniform(-0.9, 0.9);
    const double from = random.uniform(-0.9, 0.9);
    const Vec middle = turn * Vec(at, 0, 0) - tilted * Vec(from, 0, 0);
    const PairAnswer answer =
        solve(rods[random.below(3)], pose_of(turn, Vec::Zero()), rods[random.below(3)],
              pose_of(tilted, middle), ContactLevel::distance);
    ASSERT_LE(std::abs(answer.distance), answer.error_bound + 1e-15) << i << " tilt " << tilt;
  }
}

TEST_F(SolverCases, small_balls_on_rods_overlap) {
  Random random(6);
  for (std::size_t i = 0; i < scaled(200); ++i) {
    const double radius = random.log_uniform(1e-7, 1e-2);
    const double length = random.uniform(0.1, 1.0);
    const ShapeId ball = add(TaperedCapsuleShape{{radius, 0.0}, 0.0});
    const ShapeId rods[] = {add(ConeShape{0.0, length, 0.0}),
                            add(TaperedCapsuleShape{{0.0, 0.0}, length}),
                            add(EllipsoidShape{{0.0, 0.0, length}, 0.0})};
    const Eigen::Quaterniond turn = any_turn(random);
    const double at = random.chance(0.5) ? 0.0 : random.uniform(-0.9, 0.9) * length;
    const PairAnswer answer = solve(ball, pose_of(turn, Vec::Zero()), rods[random.below(3)],
                                    pose_of(turn, turn * Vec(0, 0, at)), ContactLevel::distance);
    ASSERT_TRUE(answer.overlap) << i << " radius " << radius << " " << answer.distance << " +- "
                                << answer.error_bound;
    ASSERT_NEAR(answer.distance, -radius, answer.error_bound + 1e-15) << i;
    ASSERT_LT(answer.error_bound, radius) << i;
  }
}

TEST_F(SolverCases, extreme_curved_shapes_give_finite_results) {
  const ShapeId plate = add(CylinderShape{2.3e12, 3e-265, 0.0});
  const ShapeId dust = add(SphereShape{5.6e-305});
  const ShapeId disc = add(ConeShape{std::numeric_limits<double>::max(), 5e-324, 0.0});
  const ShapeId drum = add(CylinderShape{1e-9, 0.2, 0.0});
  for (const auto& [a, b] : {std::pair{plate, dust}, {disc, drum}}) {
    const PairAnswer answer = solve(a, Pose::at(-4e-296, 3e-297, 4e-296), b, Pose{});
    EXPECT_TRUE(answer.overlap);
    EXPECT_TRUE(std::isfinite(answer.distance));
    EXPECT_TRUE(as_eigen(answer.point).allFinite());
    EXPECT_NEAR(as_eigen(answer.normal).norm(), 1.0, 1e-14);
  }
}

TEST_F(SolverCases, extreme_positions_give_finite_results) {
  const ShapeId sphere = add(SphereShape{1.0});
  const ShapeId dust = add(SphereShape{5e-324});
  const double most = std::numeric_limits<double>::max();
  const PairAnswer far = solve(sphere, Pose::at(-most, 0, 0), sphere, Pose::at(most, 0, 0));
  EXPECT_EQ(far.distance, most);
  EXPECT_EQ(far.normal[0], 1.0);
  const PairAnswer tiny = solve(dust, Pose{}, dust, Pose::at(0, 1.5e-323, 0));
  EXPECT_EQ(tiny.distance, 5e-324);
  EXPECT_EQ(tiny.normal[1], 1.0);
}

class Solver : public testing::TestWithParam<PairStyle> {};
INSTANTIATE_TEST_SUITE_P(Styles, Solver, testing::ValuesIn(kPairStyles),
                         [](const auto& style) { return to_string(style.param); });

TEST_P(Solver, answers_are_finite_and_levels_agree) {
  for_pairs(GetParam(), [](const SolverPair& solver_pair) {
    const PairAnswer answer = solver_pair.solve(ContactLevel::distance);
    EXPECT_TRUE(std::isfinite(answer.distance));
    EXPECT_TRUE(std::isfinite(answer.error_bound));
    EXPECT_NEAR(as_eigen(answer.normal).norm(), 1.0, 1e-14);
    EXPECT_TRUE(as_eigen(answer.point).allFinite());
    EXPECT_EQ(answer.overlap, answer.distance <= 0.0);
    EXPECT_EQ(solver_pair.solve(ContactLevel::boolean).overlap, answer.overlap);
    const PairAnswer manifold = solver_pair.solve(ContactLevel::manifold);
    EXPECT_EQ(manifold.overlap, answer.overlap);
    EXPECT_EQ(manifold.contact_count > 0, answer.overlap);
  });
}

TEST_P(Solver, swapped_pairs_give_mirrored_answers) {
  for_pairs(GetParam(), [](const SolverPair& solver_pair) {
    const PairAnswer answer = solver_pair.solve(ContactLevel::distance);
    const PairAnswer mirrored =
        SolverPair{solver_pair.scene, {solver_pair.pair.b, solver_pair.pair.a}}.solve(
            ContactLevel::distance);
    EXPECT_EQ(answer.overlap, mirrored.overlap);
    EXPECT_NEAR(answer.distance, mirrored.distance,
                std::max(answer.error_bound, mirrored.error_bound));
  });
}

TEST_P(Solver, common_motion_keeps_distance_within_error_bounds) {
  for_pairs(GetParam(), [](const SolverPair& solver_pair) {
    // A rotation by a rational unit quaternion.
    Pose moved[2] = {solver_pair.pose_a(), solver_pair.pose_b()};
    const Eigen::Quaterniond turn = Eigen::Quaterniond(0.8, 0.0, 0.36, 0.48).normalized();
    for (Pose& pose : moved) {
      as_eigen(pose.position) = turn * as_eigen(pose.position);
      const double* q = pose.orientation.data();
      const Eigen::Quaterniond turned = turn * Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
      pose.orientation = turned;
    }
    const PairAnswer answer = solver_pair.solve(ContactLevel::distance);
    const PairAnswer other = solver_pair.solve_at(moved[0], moved[1]);
    // Moving rounds positions and orientations.
    const double rounding = 1e-15 * (solver_pair.size() + as_eigen(moved[0].position).norm() +
                                     as_eigen(moved[1].position).norm());
    EXPECT_NEAR(answer.distance, other.distance, answer.error_bound + other.error_bound + rounding);
  });
}

TEST_P(Solver, witness_points_lie_on_both_shapes) {
  Random random(7);
  for_pairs(GetParam(), [&](const SolverPair& solver_pair) {
    const PairAnswer answer = solver_pair.solve(ContactLevel::distance);
    solver::Problem problem;
    solver::prepare(solver_pair.scene.pool.tables(), solver_pair.scene.shapes[solver_pair.pair.a],
                    solver_pair.pose_a(), solver_pair.scene.shapes[solver_pair.pair.b],
                    solver_pair.pose_b(), false, problem);
    const double scale = std::ldexp(1.0, -problem.exponent);
    const Vec n = as_eigen(answer.normal);
    const Vec on_a = as_eigen(answer.point) * scale;
    const Vec on_b = on_a + n * (answer.distance * scale);
    // If a part of the distance is unproved, the points may be off by its square root, relative to
    // the size.
    const double gap = answer.error_bound * scale / problem.size;
    const double unproved = gap > 1e-13 ? 4.0 * std::sqrt(gap) : 0.0;
    const double tolerance = problem.size * (solver_pair.relative_error() + unproved);
    EXPECT_LE(outside(problem.a, on_a, n, random), tolerance);
    EXPECT_LE(outside(problem.b, on_b, n, random), tolerance);
  });
}

TEST_P(Solver, moving_b_by_depth_separates) {
  for_pairs(GetParam(), [](const SolverPair& solver_pair) {
    const PairAnswer answer = solver_pair.solve(ContactLevel::distance);
    if (answer.distance > 0.0) return;
    Pose moved = solver_pair.pose_b();
    as_eigen(moved.position) -= as_eigen(answer.normal) * answer.distance;
    const PairAnswer after = solver_pair.solve_at(solver_pair.pose_a(), moved);
    const double rounding = solver_pair.relative_error() * solver_pair.size() +
                            1e-15 * as_eigen(solver_pair.pose_b().position).cwiseAbs().maxCoeff();
    EXPECT_NEAR(after.distance, 0.0, answer.error_bound + after.error_bound + rounding);
  });
}

TEST_P(Solver, manifold_starts_deepest_and_respects_margin) {
  for_pairs(GetParam(), [](const SolverPair& solver_pair) {
    const double size = solver_pair.size();
    const double margin = 0.1 * size;
    const PairAnswer answer = solver_pair.solve(ContactLevel::manifold, margin);
    if (answer.distance > margin) return;
    ASSERT_GE(answer.contact_count, 1U);
    ASSERT_LE(answer.contact_count, kManifoldPoints);
    EXPECT_NEAR(answer.contacts[0].depth, -answer.distance, 1e-6 * size);
    for (std::uint32_t i = 0; i < answer.contact_count; ++i) {
      const ContactPoint& contact = answer.contacts[i];
      EXPECT_GE(contact.depth, -margin - 1e-6 * size);
      EXPECT_LE(contact.depth, -answer.distance + 1e-6 * size);
      EXPECT_LE(as_eigen(contact.position).norm(), 1.001 * size);
    }
  });
}

TEST_P(Solver, powers_of_two_scale_answers_exactly) {
  for (const int exponent : {-900, 900}) {
    Random random(11);
    PairScene scene;
    const double scale = std::ldexp(1.0, exponent);
    for (int i = 0; i < 200; ++i) {
      BoxShape box{{random.unit(), random.unit(), random.unit()}, 0.1 * random.unit()};
      ConeShape cone{random.unit(), random.unit(), 0.0};
      const Pose at{{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)},
                    {random.unit(), random.unit(), random.unit(), random.unit()}};
      Pose far_at = at;
      ShapeId ids[4];
      ids[0] = expect_ok(scene.pool.add(box));
      ids[1] = expect_ok(scene.pool.add(cone));
      for (double* x :
           {&box.half[0], &box.half[1], &box.half[2], &box.rounding, &cone.radius,
            &cone.half_length, &far_at.position[0], &far_at.position[1], &far_at.position[2]}) {
        *x *= scale;
      }
      ids[2] = expect_ok(scene.pool.add(box));
      ids[3] = expect_ok(scene.pool.add(cone));
      SolverCounts counts;
      const auto solve = [&](int first, const Pose& pose) {
        return solve_pair(scene.pool.tables(), ids[first], Pose{}, ids[first + 1], pose,
                          ContactLevel::distance, 0.0, counts);
      };
      EXPECT_EQ(solve(0, at).distance * scale, solve(2, far_at).distance);
    }
  }
}

}  // namespace
}  // namespace winnow::test
