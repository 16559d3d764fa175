// exact_overlap: verdicts on small integer shapes compared with integers (lattice_truth), hand-made
// cases at one unit in the last place, and lengths that span the range of double.

#include <gtest/gtest.h>
#include "pipeline/exact/exact_overlap.h"
#include "pipeline/solver/solver.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "tests/pipeline/lattice_truth.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr double kAxis[3] = {1.0, 0.0, 0.0};

/// One shape of each kind for each side of a pair.
struct Pair {
  SphereShape spheres[2];
  CapsuleShape capsules[2];
  BoxShape boxes[2];
  CylinderShape cylinders[2];
  ConeShape cones[2];
  TriangleShape triangles[2];
  HalfSpaceShape half_spaces[2];
  EllipsoidShape ellipsoids[2];
  TaperedCapsuleShape tapered_capsules[2];
  HullShape hulls[2];
  Pose poses[2];

  [[nodiscard]] ShapeTables tables() const {
    ShapeTables result;
    result.spheres = spheres;
    result.capsules = capsules;
    result.boxes = boxes;
    result.cylinders = cylinders;
    result.cones = cones;
    result.hulls = hulls;
    result.triangles = triangles;
    result.half_spaces = half_spaces;
    result.ellipsoids = ellipsoids;
    result.tapered_capsules = tapered_capsules;
    return result;
  }
  [[nodiscard]] ExactVerdict verdict(ShapeKind a, ShapeKind b, const Vec3d& axis = kAxis) const {
    return exact_overlap(tables(), ShapeId::of(a, 0), poses[0], ShapeId::of(b, 1), poses[1],
                         axis.data());
  }
  [[nodiscard]] ExactVerdict mirrored(ShapeKind a, ShapeKind b) const {
    return exact_overlap(tables(), ShapeId::of(b, 1), poses[1], ShapeId::of(a, 0), poses[0], kAxis);
  }
};

[[nodiscard]] double digit(Random& random, int low, int high) {
  return low + static_cast<int>(random.below(static_cast<std::size_t>(high - low + 1)));
}

void set_orientation(Random& random, Pose& pose) {
  static const double kTurns[][4] = {{1, 0, 0, 0}, {1, 0, 0, 0}, {1, 1, 0, 0}, {1, 0, 1, 0},
                                     {0, 0, 0, 1}, {1, 1, 1, 1}, {2, 1, 0, 0}, {1, -1, 1, 0},
                                     {0, 1, 1, 0}, {2, 0, -1, 1}};
  const auto& turn = kTurns[random.below(std::size(kTurns))];
  for (int k = 0; k < 4; ++k) pose.orientation[k] = turn[k];
}

/// Vertex columns of the hull on one side.
using HullColumns = double[3][6];

void set_lattice(Random& random, Pair& pair, HullColumns (&columns)[2]) {
  for (int side = 0; side < 2; ++side) {
    const double rounding = random.chance(0.5) ? 0.0 : digit(random, 1, 2);
    pair.spheres[side].radius = digit(random, 0, 3);
    pair.capsules[side] = {rounding, digit(random, 0, 2)};
    BoxShape& box = pair.boxes[side];
    for (double& half : box.half) half = digit(random, 0, 2);
    box.rounding = rounding;
    TriangleShape& triangle = pair.triangles[side];
    for (auto& vertex : triangle.vertex) {
      for (double& x : vertex) x = digit(random, -2, 2);
    }
    triangle.rounding = rounding;
    HullShape& hull = pair.hulls[side];
    hull.vertex_count = 6;
    hull.rounding = rounding;
    for (int k = 0; k < 3; ++k) {
      for (double& x : columns[side][k]) x = digit(random, -2, 2);
      hull.vertex[k] = columns[side][k];
    }
    for (double& x : pair.poses[side].position) x = digit(random, -2, 2);
    set_orientation(random, pair.poses[side]);
  }
}

/// Checks pairs of two kinds on a lattice, where many touch exactly.
void expect_lattice_truth(ShapeKind a, ShapeKind b, std::size_t count) {
  Random random(static_cast<std::uint64_t>(a) * 8 + static_cast<std::uint64_t>(b) + 100);
  Pair pair;
  HullColumns columns[2];
  int seen[3] = {};
  for (std::size_t i = 0; i < count; ++i) {
    set_lattice(random, pair, columns);
    const ExactVerdict truth = lattice_truth(pair.tables(), ShapeId::of(a, 0), pair.poses[0],
                                             ShapeId::of(b, 1), pair.poses[1]);
    ++seen[static_cast<int>(truth)];
    const double axis[3] = {digit(random, -1, 1), digit(random, -1, 1), digit(random, -1, 1)};
    ASSERT_EQ(pair.verdict(a, b, axis), truth) << i << ' ' << to_string(a) << ' ' << to_string(b);
    ASSERT_EQ(pair.mirrored(a, b), truth) << i;
  }
  if (count >= 100) {
    for (const int verdict : seen) EXPECT_GT(verdict, 0) << to_string(a) << ' ' << to_string(b);
  }
}

constexpr ShapeKind kCores[] = {ShapeKind::sphere, ShapeKind::capsule, ShapeKind::box,
                                ShapeKind::triangle, ShapeKind::hull};

TEST(ExactOverlap, verdict_resolves_one_ulp) {
  Pair pair;
  pair.boxes[0] = {{0.1, 0.3, 0.7}, 0.0};
  pair.boxes[1] = {{0.1, 0.3, 0.7}, 0.0};
  pair.poses[1] = Pose::at(0.2, 0.0, 0.0);
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box), ExactVerdict::touching);
  pair.poses[1] = Pose::at(std::nextafter(0.2, 1.0), 0.0, 0.0);
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box), ExactVerdict::separated);
  pair.poses[1] = Pose::at(std::nextafter(0.2, 0.0), 0.0, 0.0);
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box), ExactVerdict::overlapping);

  pair.spheres[0].radius = 0.1;
  pair.spheres[1].radius = 0.2;
  // 0.1 + 0.2 is below the double 0.30000000000000004 and above 0.3.
  pair.poses[1] = Pose::at(0.0, 0.0, 0.3);
  EXPECT_EQ(pair.verdict(ShapeKind::sphere, ShapeKind::sphere), ExactVerdict::overlapping);
  pair.poses[1] = Pose::at(0.0, 0.0, std::nextafter(0.3, 1.0));
  EXPECT_EQ(pair.verdict(ShapeKind::sphere, ShapeKind::sphere), ExactVerdict::separated);
}

TEST(ExactOverlap, rounded_half_turn_quaternions_are_decided) {
  Pair pair;
  // cos(pi / 2) is 6e-17 in double: libraries produce such quaternions for half turns.
  for (Pose& pose : pair.poses) pose.orientation[0] = std::cos(std::acos(-1.0) / 2.0);
  pair.poses[0].orientation[2] = 1.0;
  pair.poses[1].orientation[1] = 1.0;
  pair.poses[1].position[1] = 2.0;
  for (BoxShape& box : pair.boxes) box = {{1.0, 1.0, 1.0}, 0.0};
  // The tiny turn about x lowers a corner of the second box into the first.
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box), ExactVerdict::overlapping);
  for (BoxShape& box : pair.boxes) box.rounding = 0.25;
  pair.poses[1].position[1] = 2.5;
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box), ExactVerdict::overlapping);
  pair.poses[1].position[1] = 2.5 + 0x1p-40;
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box), ExactVerdict::separated);
}

TEST(ExactOverlap, half_space_touches_lowest_point) {
  Pair pair;
  pair.half_spaces[0] = {{0.0, 0.0, 1.0}, 1.0};
  pair.poses[1].orientation[1] = 1.0;  // a quarter turn about x: local z becomes -y
  pair.spheres[1].radius = 2.0;
  pair.capsules[1] = {2.0, 5.0};
  pair.boxes[1] = {{1.0, 1.0, 9.0}, 1.0};
  pair.cylinders[1] = {1.0, 5.0, 1.0};
  pair.cones[1] = {1.0, 5.0, 1.0};
  for (const ShapeKind kind : {ShapeKind::sphere, ShapeKind::capsule, ShapeKind::box,
                               ShapeKind::cylinder, ShapeKind::cone}) {
    pair.poses[1].position[2] = 3.0;
    EXPECT_EQ(pair.verdict(ShapeKind::half_space, kind), ExactVerdict::touching) << to_string(kind);
    EXPECT_EQ(pair.mirrored(ShapeKind::half_space, kind), ExactVerdict::touching);
    pair.poses[1].position[2] = std::nextafter(3.0, 4.0);
    EXPECT_EQ(pair.verdict(ShapeKind::half_space, kind), ExactVerdict::separated);
    pair.poses[1].position[2] = std::nextafter(3.0, 2.0);
    EXPECT_EQ(pair.verdict(ShapeKind::half_space, kind), ExactVerdict::overlapping);
  }
  // A normal close to an axis. Its length is above 1, but rounds to 1.
  pair.half_spaces[0] = {{0.0, 0x1p-60, 1.0}, 1.0};
  pair.poses[1].position[2] = 3.0;
  EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::sphere), ExactVerdict::overlapping);
  EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::box), ExactVerdict::overlapping);
  // The unit normal is (0, 3/5, 4/5). Along it a horizontal disc of radius 4 extends by 3/5 of 4,
  // and its centre at z = 3 is 4/5 of 3 from the plane: both are 12/5.
  pair.half_spaces[0] = {{0.0, 0.75, 1.0}, 0.0};
  pair.poses[1] = Pose::at(0.0, 0.0, 0.0);
  pair.cylinders[1] = {4.0, 0.0, 0.0};
  pair.poses[1].position[2] = 3.0;
  EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::cylinder), ExactVerdict::touching);
  // With a rounding of 1, the disc touches 5/4 higher, which is 1 along the normal.
  pair.cylinders[1].rounding = 1.0;
  pair.poses[1].position[2] = 4.25;
  EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::cylinder), ExactVerdict::touching);
  pair.poses[1].position[2] = std::nextafter(4.25, 5.0);
  EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::cylinder), ExactVerdict::separated);
}

TEST(ExactOverlap, half_spaces_are_apart_only_if_opposite) {
  Pair pair;
  pair.half_spaces[0] = {{0.0, 0.0, 1.0}, 1.0};
  pair.half_spaces[1] = {{0.0, 0.0, 1.0}, 1.0};
  const auto verdict = [&] { return pair.verdict(ShapeKind::half_space, ShapeKind::half_space); };
  pair.poses[1].position[2] = 2.0;
  EXPECT_EQ(verdict(), ExactVerdict::overlapping);
  pair.poses[1].orientation[0] = 0.0;
  pair.poses[1].orientation[1] = 3.0;  // upside down
  EXPECT_EQ(verdict(), ExactVerdict::touching);
  pair.poses[1].position[2] = 2.5;
  EXPECT_EQ(verdict(), ExactVerdict::separated);
  pair.half_spaces[1] = {{0.0, 0.0, 4.0}, 6.0};  // z <= 3/2
  EXPECT_EQ(verdict(), ExactVerdict::touching);
  pair.poses[1].orientation[0] = 1e-9;
  EXPECT_EQ(verdict(), ExactVerdict::overlapping);
}

TEST(ExactOverlap, discs_are_decided_if_both_bounds_suffice) {
  Pair pair;
  pair.cylinders[0] = {1.0, 2.0, 0.0};
  pair.cones[1] = {1.0, 1.0, 0.5};
  const double wrong[3] = {0.0, 1.0, 0.0};
  pair.poses[1] = Pose::at(2.5 + 0x1p-50, 0.0, 0.0);
  EXPECT_EQ(pair.verdict(ShapeKind::cylinder, ShapeKind::cone), ExactVerdict::separated);
  EXPECT_EQ(pair.verdict(ShapeKind::cylinder, ShapeKind::cone, wrong), ExactVerdict::undecided);
  pair.poses[1] = Pose::at(2.5, 0.0, 0.0);
  EXPECT_EQ(pair.verdict(ShapeKind::cylinder, ShapeKind::cone), ExactVerdict::touching);
  EXPECT_EQ(pair.verdict(ShapeKind::cylinder, ShapeKind::cone, wrong), ExactVerdict::undecided);
  pair.poses[1] = Pose::at(2.5 - 0x1p-50, 0.0, 0.0);
  EXPECT_EQ(pair.verdict(ShapeKind::cylinder, ShapeKind::cone), ExactVerdict::overlapping);
}

TEST(ExactOverlap, cylinders_on_boxes_resolve_one_ulp) {
  Pair pair;
  pair.boxes[0] = {{1.0, 1.0, 1.0}, 0.0};
  pair.cylinders[1] = {0.5, 0.25, 0.0};
  const double up[3] = {1e-17, 0.0, 1.0};
  const auto verdict = [&](double z) {
    pair.poses[1].position[2] = z;
    return pair.verdict(ShapeKind::box, ShapeKind::cylinder, up);
  };
  EXPECT_EQ(verdict(1.25), ExactVerdict::touching);
  EXPECT_EQ(verdict(std::nextafter(1.25, 2.0)), ExactVerdict::separated);
  EXPECT_EQ(verdict(std::nextafter(1.25, 1.0)), ExactVerdict::overlapping);
  pair.poses[1].orientation[2] = 1.0;
  EXPECT_EQ(verdict(1.5), ExactVerdict::touching);
  EXPECT_EQ(verdict(std::nextafter(1.5, 2.0)), ExactVerdict::separated);
  EXPECT_EQ(verdict(std::nextafter(1.5, 1.0)), ExactVerdict::overlapping);
}

/// Makes a hull of the first `count` vertices of the columns.
void set_hull(HullShape& hull, const HullColumns& columns, std::uint32_t count) {
  hull.vertex_count = count;
  hull.rounding = 0.0;
  for (int k = 0; k < 3; ++k) hull.vertex[k] = columns[k];
}

TEST(ExactOverlap, collinear_segments_touch_for_any_axis) {
  for (int along = 0; along < 3; ++along) {
    HullColumns columns{};
    columns[along][0] = -1.0;
    columns[along][1] = 1.0;
    Pair pair;
    for (HullShape& hull : pair.hulls) set_hull(hull, columns, 2);
    double axis[3] = {};
    axis[along] = 1.0;
    const auto verdict = [&](double x) {
      pair.poses[1].position[along] = x;
      return pair.verdict(ShapeKind::hull, ShapeKind::hull, axis);
    };
    EXPECT_EQ(verdict(0.5), ExactVerdict::touching) << along;
    EXPECT_EQ(verdict(2.0), ExactVerdict::touching) << along;
    EXPECT_EQ(verdict(std::nextafter(2.0, 3.0)), ExactVerdict::separated) << along;
  }
}

TEST(ExactOverlap, point_on_prism_touches_and_inside_overlaps) {
  // A ring around the z axis. The axis is in the side x = 0, or inside with the last two vertices.
  constexpr double kRing[][2] = {{0.0, 0.0}, {0.0, 1.0}, {-2.0, -1.0}, {0.0, -3.0}, {0.5, 0.2}};
  double columns[3][10];
  std::size_t count = 0;
  for (const auto& [x, y] : kRing) {
    for (const double z : {1.0, -1.0}) {
      columns[0][count] = x;
      columns[1][count] = y;
      columns[2][count++] = z;
    }
  }
  Pair pair;
  HullShape& prism = pair.hulls[0];
  prism.rounding = 0.0;
  for (int k = 0; k < 3; ++k) prism.vertex[k] = columns[k];
  HullColumns point{};
  set_hull(pair.hulls[1], point, 1);
  const double up[3] = {0.0, 0.0, 1.0};
  prism.vertex_count = 8;
  EXPECT_EQ(pair.verdict(ShapeKind::hull, ShapeKind::hull, up), ExactVerdict::touching);
  prism.vertex_count = 10;
  EXPECT_EQ(pair.verdict(ShapeKind::hull, ShapeKind::hull, up), ExactVerdict::overlapping);
}

TEST(ExactOverlap, segment_through_triangle_is_not_separated) {
  for (int along = 0; along < 3; ++along) {
    Pair pair;
    pair.capsules[1] = {0.0, 1.0};
    // Turns z to the axis.
    pair.poses[1].orientation[0] = along == 2 ? 1.0 : 0.5;
    if (along == 0) pair.poses[1].orientation[2] = 0.5;
    if (along == 1) pair.poses[1].orientation[1] = -0.5;
    pair.poses[1].position[along] = 0.5;
    TriangleShape& triangle = pair.triangles[0];
    triangle = {};
    const int u = (along + 1) % 3;
    const int v = (along + 2) % 3;
    triangle.vertex[0][u] = triangle.vertex[1][v] = 2.0;
    triangle.vertex[2][u] = triangle.vertex[2][v] = -2.0;
    EXPECT_NE(pair.verdict(ShapeKind::triangle, ShapeKind::capsule), ExactVerdict::separated)
        << along;
  }
}

TEST(ExactOverlap, planes_with_long_normals_are_decided) {
  Pair pair;
  pair.half_spaces[0] = {{0.0, 0.0, 4.0}, 4.0};
  pair.boxes[1] = {{1.0, 1.0, 2.0}, 0.0};
  pair.poses[1].position[2] = 3.0;
  EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::box), ExactVerdict::touching);
  pair.poses[1].position[2] = std::nextafter(3.0, 4.0);
  EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::box), ExactVerdict::separated);
}

TEST(ExactOverlap, invalid_axis_of_turned_boxes_is_ignored) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const double axes[][3] = {{0.0, 0.0, 0.0}, {kInfinity, 0.0, 0.0}, {1.0, kNan, 0.0}};
  Pair pair;
  for (BoxShape& box : pair.boxes) box = {{1.0, 1.0, 1.0}, 0.0};
  pair.poses[0].orientation[1] = 0.5;
  for (const auto& axis : axes) {
    pair.poses[1].position[0] = 2.0;
    EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box, axis), ExactVerdict::touching);
    pair.poses[1].position[0] = std::nextafter(2.0, 3.0);
    EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box, axis), ExactVerdict::separated);
  }
}

TEST(ExactOverlap, wide_number_ranges_are_right_or_undecided) {
  const double up[3] = {0.0, 0.0, 1.0};
  Pair pair;
  pair.cylinders[0] = {1e300, 1e300, 0.0};
  pair.boxes[1] = {{1e-300, 1e-300, 1e-300}, 0.0};
  pair.poses[1].position[2] = 2e300;
  EXPECT_EQ(pair.verdict(ShapeKind::cylinder, ShapeKind::box, up), ExactVerdict::separated);
  // A point above a triangle.
  pair.triangles[0] = {{{-1e300, 1e-300, 0.0}, {1e300, -1e-300, 0.0}, {0.0, 1e300, 0.0}}, 0.0};
  pair.spheres[1].radius = 0.0;
  pair.poses[1].position[2] = 1e-300;
  EXPECT_EQ(pair.verdict(ShapeKind::triangle, ShapeKind::sphere, up), ExactVerdict::separated);
  // The sum of these coordinates overflows.
  HullColumns far;
  for (auto& column : far) std::fill(std::begin(column), std::end(column), 1.5e308);
  far[0][1] = far[1][2] = -1.5e308;
  set_hull(pair.hulls[0], far, 3);
  pair.poses[1] = {};
  EXPECT_EQ(pair.verdict(ShapeKind::hull, ShapeKind::box, up), ExactVerdict::separated);
  // The sum of these does not overflow, but their products with a direction do.
  for (int i = 0; i < 3; ++i) {
    far[0][i] = 1e308 + i * 1e307;
    far[1][i] = far[2][i] = i;
  }
  const double steep[3] = {1.9, 0.0, 0.0};
  EXPECT_EQ(pair.verdict(ShapeKind::hull, ShapeKind::box, steep), ExactVerdict::separated);
  // Rounded boxes.
  pair.boxes[0] = {{1e300, 1e300, 1e300}, 1e-300};
  pair.poses[0].orientation[1] = 0.5;
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box, up), ExactVerdict::undecided);
  pair.boxes[0] = {{1.0, 1.0, 1.0}, 1e-300};
  pair.boxes[1] = {{1.0, 1.0, 1.0}, 0.0};
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box, up), ExactVerdict::undecided);
  // Turns by a denormal angle: products of the two quaternions span too far.
  for (BoxShape& box : pair.boxes) box = {{1.0, 1.0, 1.0}, 0.0};
  for (Pose& pose : pair.poses) pose.orientation[1] = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box, up), ExactVerdict::undecided);
}

TEST(ExactOverlap, tiny_rims_are_decided_exactly) {
  const double up[3] = {0.0, 0.0, 1.0};
  Pair pair;
  pair.boxes[0] = {{1e-275, 1e-275, 1e-275}, 0.0};
  pair.cones[1] = {1e-280, 1e-275, 0.0};
  pair.poses[1].position[2] = 2e-275;
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::cone, up), ExactVerdict::touching);
  pair.poses[1].position[2] = std::nextafter(2e-275, 1.0);
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::cone, up), ExactVerdict::separated);
}

/// Sets one of eight rotations that map axes to axes.
void set_quarter_turns(Random& random, Pose& pose) {
  static const double kTurns[][4] = {{1, 0, 0, 0}, {0, 0, 3, 0},  {1, 1, 0, 0},  {0, -2, 0, 2},
                                     {0, 1, 1, 0}, {1, 0, -1, 0}, {1, 1, -1, 1}, {-5, 5, 5, 5}};
  const auto& turn = kTurns[random.below(std::size(kTurns))];
  for (int k = 0; k < 4; ++k) pose.orientation[k] = turn[k];
}

TEST(ExactOverlap, quarter_turned_cylinders_touch_at_distance_zero) {
  Random random(29);
  int seen[3] = {};
  int touching_triangles = 0;
  const ShapeKind others[] = {ShapeKind::sphere,   ShapeKind::capsule,    ShapeKind::box,
                              ShapeKind::cylinder, ShapeKind::half_space, ShapeKind::triangle};
  for (std::size_t i = 0; i < scaled(20000); ++i) {
    Pair pair;
    const ShapeKind other = others[random.below(std::size(others))];
    const bool rounded = random.chance(0.3);
    pair.half_spaces[1] = {{0.0, random.chance(0.5) ? 1.0 : -1.0, 0.0}, digit(random, -3, 3)};
    for (int side = 0; side < 2; ++side) {
      const double rounding = rounded ? digit(random, 1, 2) : 0.0;
      pair.cylinders[side] = {digit(random, 1, 5), digit(random, 1, 3), rounding};
      pair.capsules[side] = {digit(random, 1, 2), digit(random, 1, 2)};
      pair.boxes[side] = {{digit(random, 1, 3), digit(random, 1, 3), digit(random, 1, 3)},
                          rounding};
      pair.spheres[side].radius = digit(random, 1, 3);
      // A triangle that is perpendicular to an axis.
      TriangleShape& triangle = pair.triangles[side];
      triangle = {{{-1.0, -4.0, 2.0}, {4.0, -1.0, 2.0}, {0.0, 5.0, 2.0}}, rounding};
      for (auto& vertex : triangle.vertex) vertex[1] += digit(random, -2, 2);
      set_quarter_turns(random, pair.poses[side]);
      for (double& x : pair.poses[side].position) x = digit(random, -4, 4);
    }
    SolverCounts counts;
    const PairAnswer answer =
        solve_pair(pair.tables(), ShapeId::of(ShapeKind::cylinder, 0), pair.poses[0],
                   ShapeId::of(other, 1), pair.poses[1], ContactLevel::distance, 0.0, counts);
    const ExactVerdict verdict = pair.verdict(ShapeKind::cylinder, other);
    if (verdict == ExactVerdict::undecided) {
      // Rounded rims that cross, and triangles whose planes are pierced, may be undecided.
      ASSERT_TRUE((rounded && other == ShapeKind::cylinder) || other == ShapeKind::triangle) << i;
      continue;
    }
    ++seen[static_cast<int>(verdict)];
    if (other == ShapeKind::triangle && verdict == ExactVerdict::touching) ++touching_triangles;
    // Roots of small integers are either equal or farther apart than this.
    const bool zero = std::abs(answer.distance) < 1e-9;
    ASSERT_EQ(verdict == ExactVerdict::touching, zero) << i << ' ' << answer.distance;
    if (!zero) {
      ASSERT_EQ(verdict == ExactVerdict::separated, answer.distance > 0.0) << i;
    }
  }
  EXPECT_GT(touching_triangles, 0);
  for (const int count : seen) EXPECT_GT(count, 0);
}

TEST(ExactOverlap, points_touch_corners_sides_and_insides_of_triangles) {
  Random random(31);
  for (int round = 0; round < 300; ++round) {
    Pair pair{};
    TriangleShape& triangle = pair.triangles[0];
    for (auto& vertex : triangle.vertex) {
      for (double& x : vertex) x = 4.0 * digit(random, -5, 5);
    }
    const double first = digit(random, 0, 4);
    const double second = digit(random, 0, 4 - static_cast<int>(first));
    const double weight[3] = {first, second, 4.0 - first - second};
    for (int k = 0; k < 3; ++k) {
      pair.poses[0].position[k] = digit(random, -4, 4);
      double sum = 0.0;
      for (int i = 0; i < 3; ++i) sum += weight[i] * triangle.vertex[i][k] / 4.0;
      pair.poses[1].position[k] = pair.poses[0].position[k] + sum;
    }
    EXPECT_EQ(pair.verdict(ShapeKind::triangle, ShapeKind::sphere), ExactVerdict::touching);
    EXPECT_EQ(pair.mirrored(ShapeKind::triangle, ShapeKind::sphere), ExactVerdict::touching);
    // Move one coordinate of the point by one ulp. The point leaves the plane of the triangle,
    // unless the axis of this coordinate is parallel to the plane.
    const int k = static_cast<int>(random.below(3));
    double across[3];
    for (int i = 0; i < 3; ++i) {
      const auto edge = [&](int c, int axis) {
        return triangle.vertex[c][axis] - triangle.vertex[0][axis];
      };
      const int next = (i + 1) % 3;
      const int last = (i + 2) % 3;
      across[i] = edge(1, next) * edge(2, last) - edge(1, last) * edge(2, next);
    }
    if (across[k] == 0.0) continue;
    double& moved = pair.poses[1].position[k];
    moved = std::nextafter(moved, 100.0);
    EXPECT_EQ(pair.verdict(ShapeKind::triangle, ShapeKind::sphere), ExactVerdict::separated);
  }
}

TEST(ExactOverlap, discs_without_radius_are_segments) {
  Pair pair;
  pair.cylinders[0] = {0.0, 2.0, 0.0};
  pair.triangles[1] = {{{0.0, -1.0, 0.0}, {0.0, 1.0, 0.0}, {3.0, 0.0, 0.0}}, 0.0};
  EXPECT_EQ(pair.verdict(ShapeKind::cylinder, ShapeKind::triangle), ExactVerdict::touching);
  for (const double gap : {0x1p-200, 0x1p-1074}) {
    pair.poses[1].position[0] = gap;
    EXPECT_EQ(pair.verdict(ShapeKind::cylinder, ShapeKind::triangle), ExactVerdict::separated);
  }
}

TEST(ExactOverlap, numbers_too_far_apart_are_undecided) {
  Pair pair;
  pair.poses[1].orientation[1] = 1e-300;
  pair.poses[1].position[0] = 1.0;
  for (BoxShape& box : pair.boxes) box = {{1.0, 1.0, 1.0}, 0.0};
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box), ExactVerdict::undecided);
}

TEST(ExactOverlap, upright_boxes_of_any_range_are_decided) {
  Random random(77);
  Pair pair;
  int seen[3] = {};
  for (std::size_t i = 0; i < scaled(2000); ++i) {
    int sign = -1;
    for (int k = 0; k < 3; ++k) {
      // Each axis has its own scale, over the whole range of double.
      const double unit = std::ldexp(1.0, static_cast<int>(random.below(2000)) - 1000);
      double reach = 0.0;
      for (int side = 0; side < 2; ++side) {
        pair.boxes[side].half[k] = unit * digit(random, 0, 2);
        reach += pair.boxes[side].half[k];
        pair.poses[side].position[k] = unit * digit(random, -3, 3);
      }
      const double gap = std::abs(pair.poses[1].position[k] - pair.poses[0].position[k]) - reach;
      sign = std::max(sign, gap > 0.0 ? 1 : gap < 0.0 ? -1 : 0);
    }
    const ExactVerdict truth = sign > 0   ? ExactVerdict::separated
                               : sign < 0 ? ExactVerdict::overlapping
                                          : ExactVerdict::touching;
    ++seen[static_cast<int>(truth)];
    ASSERT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box), truth) << i;
    ASSERT_EQ(pair.mirrored(ShapeKind::box, ShapeKind::box), truth) << i;
  }
  for (const int verdict : seen) EXPECT_GT(verdict, 0);
}

/// Compares with the boxes in a frame that maps x to y, y to z, and z to x.
TEST(ExactOverlap, upright_boxes_match_permuted_frames) {
  Random random(21);
  int verdicts[3] = {};
  for (int round = 0; round < 4000; ++round) {
    Pair upright;
    Pair turned;
    const double unit = round % 2 == 0 ? 0.1 : 0.125;
    const double far = round % 3 == 0 ? 0.0 : std::ldexp(unit, 5 * (round % 9));
    for (int side = 0; side < 2; ++side) {
      for (int k = 0; k < 3; ++k) {
        double half = unit * digit(random, 0, 4) * 0.5;
        double at = far + unit * digit(random, -2, 2);
        if (random.chance(0.1)) half = std::nextafter(half, 1.0);
        if (random.chance(0.1)) at = std::nextafter(at, random.chance(0.5) ? 1e9 : -1e9);
        if (random.chance(0.05)) half *= 1e-12;
        upright.boxes[side].half[k] = half;
        upright.poses[side].position[k] = at;
        turned.boxes[side].half[(k + 2) % 3] = half;
        turned.poses[side].position[k] = at;
      }
      const int axis = static_cast<int>(random.below(4));
      for (int k = 0; k < 4; ++k) {
        upright.poses[side].orientation[k] = k == axis ? -3.0 : 0.0;
        turned.poses[side].orientation[k] = 1.0;
      }
    }
    const ExactVerdict verdict = upright.verdict(ShapeKind::box, ShapeKind::box);
    ASSERT_EQ(verdict, turned.verdict(ShapeKind::box, ShapeKind::box)) << round;
    ASSERT_EQ(verdict, upright.mirrored(ShapeKind::box, ShapeKind::box)) << round;
    ++verdicts[static_cast<int>(verdict)];
  }
  for (const int count : verdicts) EXPECT_GT(count, 100);
}

TEST(ExactOverlap, turned_boxes_of_any_range_are_decided) {
  Random random(78);
  Pair pair;
  HullColumns columns[2];
  int tested = 0;
  for (std::size_t i = 0; i < scaled(3000); ++i) {
    set_lattice(random, pair, columns);
    for (BoxShape& box : pair.boxes) box.rounding = 0.0;
    double& half = pair.boxes[0].half[random.below(3)];
    // If the verdicts for extents 0 and 0x1p-100 agree, any extent between them has the same
    // verdict.
    half = 0.0;
    const ExactVerdict flat = pair.verdict(ShapeKind::box, ShapeKind::box);
    half = 0x1p-100;
    const ExactVerdict thin = pair.verdict(ShapeKind::box, ShapeKind::box);
    half = 0x1p-1050;
    if (flat != thin) continue;
    ++tested;
    ASSERT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box), flat) << i;
    ASSERT_EQ(pair.mirrored(ShapeKind::box, ShapeKind::box), flat) << i;
  }
  EXPECT_GT(tested, 50);
}

TEST(ExactOverlap, shapes_over_level_planes_are_decided) {
  Pair pair;
  pair.boxes[1] = {{1.0, 0x1p-900, 0x1p900}, 0.0};
  pair.poses[1].position[2] = 0x1p900;
  constexpr double kLittle = 0x1p-1000;
  for (const double side : {1.0, -1.0}) {
    pair.poses[1].position[2] = side * 0x1p900;
    pair.half_spaces[0] = {{0.0, 0.0, side}, 0.0};
    EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::box), ExactVerdict::touching);
    EXPECT_EQ(pair.mirrored(ShapeKind::half_space, ShapeKind::box), ExactVerdict::touching);
    pair.half_spaces[0].offset = kLittle;
    EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::box), ExactVerdict::overlapping);
    EXPECT_EQ(pair.mirrored(ShapeKind::half_space, ShapeKind::box), ExactVerdict::overlapping);
    pair.half_spaces[0].offset = -kLittle;
    EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::box), ExactVerdict::separated);
    EXPECT_EQ(pair.mirrored(ShapeKind::half_space, ShapeKind::box), ExactVerdict::separated);
  }
}

TEST(ExactOverlap, upright_cylinders_spanning_1300_bits_are_decided) {
  Pair pair;
  pair.cylinders[0] = {0x1p-600, 1.0, 0.0};
  pair.cylinders[1] = {0x1p690, 1.0, 0.0};
  pair.poses[1].position[0] = 0x1p690;
  EXPECT_EQ(pair.verdict(ShapeKind::cylinder, ShapeKind::cylinder), ExactVerdict::overlapping);
  pair.poses[0].position[0] = -0x1p-600;
  EXPECT_EQ(pair.verdict(ShapeKind::cylinder, ShapeKind::cylinder), ExactVerdict::touching);
  pair.poses[0].position[0] = -0x1.8p-600;
  EXPECT_EQ(pair.verdict(ShapeKind::cylinder, ShapeKind::cylinder), ExactVerdict::separated);
}

TEST(ExactOverlap, polytopes_spanning_900_bits_are_decided) {
  constexpr double kLarge = 0x1p449;
  constexpr double kSmall = 0x1p-450;
  Pair pair;
  pair.triangles[0] = {{{-kLarge, -kLarge, 0.0}, {kLarge, -kLarge, 0.0}, {0.0, kLarge, 0.0}}, 0.0};
  pair.triangles[1] = {{{0.0, 0.0, 0.0}, {kSmall, 0.0, kSmall}, {0.0, kSmall, kSmall}}, 0.0};
  EXPECT_EQ(pair.verdict(ShapeKind::triangle, ShapeKind::triangle), ExactVerdict::touching);
  pair.triangles[1].vertex[0][2] = -kSmall;
  EXPECT_EQ(pair.verdict(ShapeKind::triangle, ShapeKind::triangle), ExactVerdict::overlapping);
  pair.triangles[1].vertex[0][2] = kSmall;
  EXPECT_EQ(pair.verdict(ShapeKind::triangle, ShapeKind::triangle), ExactVerdict::separated);
}

TEST(ExactOverlap, turns_spanning_too_far_are_undecided) {
  Pair pair;
  pair.triangles[0] = {{{-1.0, -1.0, 0.0}, {1.0, -1.0, 0.0}, {0.0, 1.0, 0.0}}, 0.0};
  pair.capsules[1] = {0.0, 1.0};
  EXPECT_EQ(pair.verdict(ShapeKind::triangle, ShapeKind::capsule), ExactVerdict::overlapping);
  for (Pose& pose : pair.poses) pose.orientation[1] = 0x1p-200;
  EXPECT_EQ(pair.verdict(ShapeKind::triangle, ShapeKind::capsule), ExactVerdict::overlapping);
  for (Pose& pose : pair.poses) pose.orientation[1] = 0x1p-250;
  EXPECT_EQ(pair.verdict(ShapeKind::triangle, ShapeKind::capsule), ExactVerdict::undecided);
}

TEST(ExactOverlap, half_spaces_with_distant_lengths_are_undecided) {
  Pair pair;
  const double turn[4] = {2.0, 1.0, 0.0, 0.0};
  pair.poses[0].orientation = turn;
  pair.half_spaces[0] = {{0.0, 0.0, 1.0}, 0.0};
  pair.boxes[1] = {{1.0, 1.0, 1.0}, 0.0};
  pair.poses[1].position[2] = 0x1p600;
  EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::box), ExactVerdict::separated);
  pair.boxes[1].half[0] = 0x1p-1000;
  EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::box), ExactVerdict::undecided);
  pair.boxes[1].half[0] = 1.0;
  pair.half_spaces[0].offset = 0x1p-1000;
  EXPECT_EQ(pair.verdict(ShapeKind::half_space, ShapeKind::box), ExactVerdict::undecided);
}

TEST(ExactOverlap, discs_are_approximated_by_sixteen_corners) {
  Pair pair;
  pair.cylinders[0] = {1.0, 1.0, 0.0};
  // Turned by the angle whose sine is 4/5.
  pair.poses[0].orientation[0] = 2.0;
  pair.poses[0].orientation[3] = 1.0;
  constexpr double kSixteenth[2] = {0.92387953251128674, 0.38268343236508977};
  const auto verdict_at = [&](double reach, int quarter) {
    double x = reach * kSixteenth[0];
    double y = reach * kSixteenth[1];
    for (int i = 0; i < quarter; ++i) y = -std::exchange(x, -y);
    pair.poses[1].position[0] = 0.6 * x - 0.8 * y;
    pair.poses[1].position[1] = 0.8 * x + 0.6 * y;
    const double axis[3] = {pair.poses[1].position[0], pair.poses[1].position[1], 0.0};
    return pair.verdict(ShapeKind::cylinder, ShapeKind::sphere, axis);
  };
  for (int quarter = 0; quarter < 4; ++quarter) {
    EXPECT_EQ(verdict_at(0.96, quarter), ExactVerdict::overlapping) << quarter;
    EXPECT_EQ(verdict_at(1.001, quarter), ExactVerdict::separated) << quarter;
  }
}

TEST(ExactOverlap, discs_touch_sides_and_corners_of_triangles) {
  Pair pair;
  pair.cylinders[0] = {2.0, 1.0, 0.0};
  const auto verdict = [&] { return pair.verdict(ShapeKind::cylinder, ShapeKind::triangle); };
  // A side parallel to x on the top of the cylinder: only its middle is near the disc.
  const auto verdict_of = [&](double low) {
    pair.triangles[1] = {{{-3.0, low, 1.0}, {3.0, low, 1.0}, {0.0, 6.0, 1.0}}, 0.0};
    return verdict();
  };
  // The plane of the triangle is perpendicular to each axis of the world in turn.
  const double turns[][4] = {{1, 0, 0, 0}, {1, 1, 0, 0}, {1, 0, 1, 0}};
  for (const auto& turn : turns) {
    for (Pose& pose : pair.poses) pose.orientation = turn;
    EXPECT_EQ(verdict_of(2.0), ExactVerdict::touching);
    EXPECT_EQ(verdict_of(std::nextafter(2.0, 3.0)), ExactVerdict::separated);
    EXPECT_EQ(verdict_of(-10.0), ExactVerdict::touching);
    pair.triangles[1] = {{{0.0, -2.0, 1.0}, {1.0, -5.0, 1.0}, {-1.0, -5.0, 1.0}}, 0.0};
    EXPECT_EQ(verdict(), ExactVerdict::touching);
    pair.triangles[1].vertex[0][1] = std::nextafter(-2.0, -3.0);
    EXPECT_EQ(verdict(), ExactVerdict::separated);
  }
}

TEST(ExactOverlap, coplanar_points_beyond_triangle_side_are_separated) {
  Pair pair{};
  pair.triangles[0] = {{{0.0, 0.0, 0.0}, {4.0, 0.0, 4.0}, {0.0, 4.0, 1.0}}, 0.0};
  const auto& vertex = pair.triangles[0].vertex;
  for (int side = 0; side < 3; ++side) {
    const auto verdict_at = [&](double beyond) {
      for (int k = 0; k < 3; ++k) {
        const double middle = 0.5 * (vertex[side][k] + vertex[(side + 1) % 3][k]);
        pair.poses[1].position[k] = middle + beyond * (middle - vertex[(side + 2) % 3][k]);
      }
      return pair.verdict(ShapeKind::triangle, ShapeKind::sphere);
    };
    EXPECT_EQ(verdict_at(-0.5), ExactVerdict::touching) << side;
    EXPECT_EQ(verdict_at(0.0), ExactVerdict::touching) << side;
    EXPECT_EQ(verdict_at(0x1p-40), ExactVerdict::separated) << side;
    EXPECT_EQ(verdict_at(1.0), ExactVerdict::separated) << side;
  }
}

TEST(ExactOverlap, half_spaces_turned_by_tiny_angles_are_undecided) {
  Pair pair;
  for (Pose& pose : pair.poses) pose.orientation[1] = 1e-300;
  pair.poses[1].position[0] = 1.0;
  for (BoxShape& box : pair.boxes) box = {{1.0, 1.0, 1.0}, 0.0};
  for (HalfSpaceShape& half_space : pair.half_spaces) half_space = {{0.0, 0.0, 1.0}, 0.0};
  for (const ShapeKind other : {ShapeKind::box, ShapeKind::half_space}) {
    EXPECT_EQ(pair.verdict(ShapeKind::half_space, other), ExactVerdict::undecided);
    EXPECT_EQ(pair.mirrored(ShapeKind::half_space, other), ExactVerdict::undecided);
  }
}

TEST(ExactOverlap, shapes_deep_in_half_spaces_overlap) {
  Pair pair;
  pair.half_spaces[0] = {{0.0, 0.0, 1.0}, 0.0};
  pair.boxes[1] = {{1.0, 1.0, 1.0}, 0.5};
  pair.cylinders[1] = {1.0, 1.0, 0.5};
  pair.poses[1].position[2] = -10.0;
  for (const ShapeKind other : {ShapeKind::box, ShapeKind::cylinder}) {
    EXPECT_EQ(pair.verdict(ShapeKind::half_space, other), ExactVerdict::overlapping);
  }
  pair.poses[1].position[2] = 10.0;
  for (const ShapeKind other : {ShapeKind::box, ShapeKind::cylinder}) {
    EXPECT_EQ(pair.verdict(ShapeKind::half_space, other), ExactVerdict::separated);
  }
}

TEST(ExactOverlap, smooth_shapes_are_undecided) {
  Pair pair;
  pair.boxes[0] = {{1.0, 1.0, 1.0}, 0.0};
  pair.half_spaces[0] = {{0.0, 0.0, 1.0}, 0.0};
  for (const ShapeKind other : {ShapeKind::ellipsoid, ShapeKind::tapered_capsule}) {
    for (const ShapeKind one : {ShapeKind::box, ShapeKind::half_space}) {
      EXPECT_EQ(pair.verdict(one, other), ExactVerdict::undecided);
      EXPECT_EQ(pair.mirrored(one, other), ExactVerdict::undecided);
    }
  }
}

TEST(ExactOverlap, invalid_axis_of_upright_boxes_is_ignored) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const double axes[][3] = {{inf, 0, 0}, {inf, -inf, 0}, {nan, 0, 0}, {1, nan, 0}, {0, 0, 0}};
  Pair pair;
  for (BoxShape& box : pair.boxes) box = {{1.0, 1.0, 1.0}, 0.0};
  for (const auto& axis : axes) {
    pair.poses[1].position[1] = 2.0;
    EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box, axis), ExactVerdict::touching);
    pair.poses[1].position[1] = std::nextafter(2.0, 3.0);
    EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box, axis), ExactVerdict::separated);
  }
}

TEST(ExactOverlap, discs_of_smallest_numbers_are_decided) {
  Pair pair;
  constexpr double kSmall = 1e-280;
  pair.boxes[0] = {{kSmall, kSmall, kSmall}, 0.0};
  pair.cylinders[1] = {kSmall, kSmall, 0.0};
  pair.poses[1].position[2] = 1.5 * kSmall;
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::cylinder), ExactVerdict::overlapping);
}

TEST(ExactOverlap, boxes_of_largest_numbers_are_decided) {
  constexpr double kLarge = 8e307;
  Pair pair;
  for (BoxShape& box : pair.boxes) box = {{kLarge, kLarge, kLarge}, 0.0};
  pair.poses[1].position[0] = 2.0 * kLarge;
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box), ExactVerdict::touching);
  pair.poses[1].position[0] = std::nextafter(2.0 * kLarge, 0.0);
  EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box), ExactVerdict::overlapping);
}

TEST(ExactOverlap, verdicts_match_integer_arithmetic) {
  for (const ShapeKind a : kCores) {
    for (const ShapeKind b : kCores) {
      const bool large = (a == ShapeKind::box || a == ShapeKind::hull) &&
                         (b == ShapeKind::box || b == ShapeKind::hull);
      expect_lattice_truth(a, b, scaled(large ? 200 : 1500));
    }
  }
}

TEST(ExactOverlap, common_motion_keeps_verdict) {
  Random random(17);
  for (const ShapeKind a : {ShapeKind::triangle, ShapeKind::hull}) {
    for (const ShapeKind b : {ShapeKind::triangle, ShapeKind::hull}) {
      for (std::size_t i = 0; i < scaled(300); ++i) {
        Pair pair;
        HullColumns columns[2];
        set_lattice(random, pair, columns);
        // Both shapes have the same pose and differ only in their vertices: any other common pose
        // must give the same verdict.
        pair.poses[0] = pair.poses[1] = {};
        const ExactVerdict truth = lattice_truth(pair.tables(), ShapeId::of(a, 0), pair.poses[0],
                                                 ShapeId::of(b, 1), pair.poses[1]);
        for (double& q : pair.poses[0].orientation) q = random.uniform(-1.0, 1.0);
        for (double& x : pair.poses[0].position) x = random.uniform(-1e9, 1e9);
        pair.poses[1] = pair.poses[0];
        ASSERT_EQ(pair.verdict(a, b), truth) << i << ' ' << to_string(a) << ' ' << to_string(b);
      }
    }
  }
}

TEST(ExactOverlap, scale_and_common_position_keep_verdict) {
  for (const int exponent : {-900, -60, 0, 60, 900}) {
    const double unit = std::ldexp(1.0, exponent);
    Pair pair;
    pair.boxes[0] = {{unit, unit, unit}, 0.0};
    pair.capsules[1] = {unit, 2.0 * unit};
    for (const double at : {0.0, 1024.0, 0x1p40}) {
      pair.poses[0] = Pose::at(at * unit, 0.0, -at * unit);
      pair.poses[1] = Pose::at((at + 2.0) * unit, 0.0, -at * unit);
      EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::capsule), ExactVerdict::touching);
      pair.capsules[1].radius = std::nextafter(unit, 0.0);
      EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::capsule), ExactVerdict::separated);
      pair.capsules[1].radius = std::nextafter(unit, 4.0 * unit);
      EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::capsule), ExactVerdict::overlapping);
      pair.capsules[1].radius = unit;
    }
  }
}

TEST(ExactOverlap, any_axis_gives_same_verdict) {
  const double inf = std::numeric_limits<double>::infinity();
  const double axes[][3] = {{0, 0, 0},     {NAN, 1, 0},       {inf, 0, 0}, {1e-320, 1e-310, 0},
                            {1e300, 1, 0}, {1e-200, -1, 1e9}, {-1, 0, 0}};
  Pair pair;
  for (BoxShape& box : pair.boxes) box = {{1.0, 1.0, 1.0}, 0.0};
  for (const auto& axis : axes) {
    pair.poses[1] = Pose::at(2.0, 2.0, 1.0);
    EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box, axis), ExactVerdict::touching);
    pair.poses[1] = Pose::at(2.0, 2.5, 1.0);
    EXPECT_EQ(pair.verdict(ShapeKind::box, ShapeKind::box, axis), ExactVerdict::separated);
  }
}

}  // namespace
}  // namespace winnow::test
