// Kernels of cylinders, cones, ellipsoids, tapered capsules and user shapes, and of hulls on
// half-spaces: small cases derived on paper, then compared with the solver, on every ISA, far from
// the origin and at other positions of a batch.

#include <gtest/gtest.h>
#include <winnow/core/pose.h>
#include <winnow/simd/isa.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/pipeline/pair_results.h"
#include "tests/pipeline/pair_scenes.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

using enum ShapeKind;

/// Returns a scene with one pair of shapes at the two poses.
template <typename A, typename B>
PairScene pair_of(const A& a, const B& b, const Pose& pose_a, const Pose& pose_b) {
  PairScene scene;
  scene.shapes.resize(2);
  scene.shapes[0] = expect_ok(scene.pool.add(a));
  scene.shapes[1] = expect_ok(scene.pool.add(b));
  scene.poses = {pose_a, pose_b};
  scene.pairs = {{0, 1}};
  return scene;
}

PairResults answer_to(const PairScene& scene, ContactLevel level, double margin = 0.0) {
  return compute_results(scene, {.level = level, .contact_margin = margin}).at(0);
}

/// Returns the depths of the contacts, deepest first.
std::vector<float> depths(const PairResults& answer) {
  std::vector<float> depth;
  for (const ContactPoint& contact : answer.contacts) depth.push_back(contact.depth);
  std::sort(depth.begin(), depth.end(), std::greater<>());
  return depth;
}

Pose turned_about_x(double angle, double z) {
  Pose pose = Pose::at(0, 0, z);
  pose.orientation[0] = std::cos(0.5 * angle);
  pose.orientation[1] = std::sin(0.5 * angle);
  return pose;
}

constexpr double kRightAngle = 1.5707963267948966;

TEST(CurvedKernels, upright_cylinder_on_plane_has_four_rim_points) {
  const PairScene scene =
      pair_of(CylinderShape{1.0, 2.0, 0.0}, HalfSpaceShape{}, Pose::at(0, 0, 1.5), Pose{});
  const PairResults answer = answer_to(scene, ContactLevel::manifold);
  EXPECT_EQ(answer.distance, -0.5);
  ASSERT_EQ(answer.contacts.size(), 4U);
  for (const ContactPoint& contact : answer.contacts) {
    EXPECT_EQ(contact.depth, 0.5F);
    EXPECT_NEAR(std::hypot(contact.position[0], contact.position[1]), 1.0, 1e-6);
    EXPECT_NEAR(contact.position[2], -1.75, 1e-6);
  }
  const auto& p = answer.contacts;
  EXPECT_NEAR(p[0].position[0] + p[3].position[0], 0.0, 1e-6);
  EXPECT_NEAR(p[1].position[1] + p[2].position[1], 0.0, 1e-6);
}

TEST(CurvedKernels, lying_cylinder_on_plane_has_two_points) {
  const PairScene scene = pair_of(CylinderShape{1.0, 2.0, 0.25}, HalfSpaceShape{},
                                  turned_about_x(kRightAngle, 1.0), Pose{});
  const PairResults answer = answer_to(scene, ContactLevel::manifold);
  EXPECT_NEAR(answer.distance, -0.25, 1e-15);
  ASSERT_EQ(answer.contacts.size(), 2U);
  EXPECT_NEAR(std::abs(answer.contacts[0].position[1] - answer.contacts[1].position[1]), 4.0, 1e-6);
}

TEST(CurvedKernels, cone_on_plane_rests_on_base_or_tip) {
  const ConeShape cone{1.0, 1.0, 0.0};
  const PairResults base = answer_to(pair_of(cone, HalfSpaceShape{}, Pose::at(0, 0, 1.25), Pose{}),
                                     ContactLevel::manifold, 0.5);
  EXPECT_EQ(base.distance, 0.25);
  EXPECT_EQ(depths(base), std::vector<float>(4, -0.25F));
  const PairResults tip =
      answer_to(pair_of(cone, HalfSpaceShape{}, turned_about_x(2 * kRightAngle, 0.5), Pose{}),
                ContactLevel::manifold);
  EXPECT_NEAR(tip.distance, -0.5, 1e-15);
  EXPECT_EQ(tip.contacts.size(), 1U);
}

TEST(CurvedKernels, ball_beside_cone_has_distance_from_side) {
  // The side has a slope of 45 degrees and is sqrt(1/2) from (1, 0, 0).
  const PairScene scene =
      pair_of(SphereShape{0.25}, ConeShape{1.0, 0.5, 0.0}, Pose::at(1, 0, 0.5), Pose{});
  const PairResults answer = answer_to(scene, ContactLevel::distance);
  EXPECT_NEAR(answer.distance, std::sqrt(0.5) - 0.25, 1e-15);
  EXPECT_NEAR(answer.normal[0], -std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(answer.normal[2], -std::sqrt(0.5), 1e-15);
}

TEST(CurvedKernels, cylinder_in_box_top_has_least_depth) {
  const PairScene scene = pair_of(BoxShape{{4, 4, 1}, 0.0}, CylinderShape{1.0, 1.0, 0.0}, Pose{},
                                  Pose::at(0.5, 0, 1.75));
  const PairResults answer = answer_to(scene, ContactLevel::manifold);
  EXPECT_NEAR(answer.distance, -0.25, 1e-9);
  EXPECT_NEAR(answer.normal[2], 1.0, 1e-9);
  ASSERT_EQ(answer.contacts.size(), 4U);
  for (const float depth : depths(answer)) EXPECT_NEAR(depth, 0.25F, 1e-6F);
}

TEST(CurvedKernels, crossed_separate_cylinders_have_distance_of_sides) {
  const CylinderShape drum{0.5, 2.0, 0.0};
  const PairScene scene = pair_of(drum, drum, Pose{}, [] {
    Pose pose = turned_about_x(kRightAngle, 0.25);
    pose.position[0] = 1.75;
    return pose;
  }());
  const PairResults answer = answer_to(scene, ContactLevel::distance);
  EXPECT_NEAR(answer.distance, 0.75, 1e-12);
  EXPECT_NEAR(answer.normal[0], 1.0, 1e-7);
}

/// Checks depth and normal of a pair to the last digits, and that lanes answered it without the
/// solver.
void expect_depth(const PairScene& scene, double depth, const Vec3d& normal) {
  NarrowPhase narrow;
  NarrowResult result;
  ASSERT_EQ(narrow.collide(scene.pool, scene.bodies(), scene.pairs,
                           {.level = ContactLevel::distance}, result),
            Status::ok);
  EXPECT_EQ(narrow.statistics().recomputed, 0U);
  EXPECT_NEAR(result.distance()[0], -depth, 2e-15);
  EXPECT_LE(result.error_bound()[0], 1e-12);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(result.normal(axis)[0], normal[axis], 1e-14);
}

TEST(CurvedKernels, crossed_overlapping_cylinders_have_depth_of_sides) {
  Pose across = turned_about_x(kRightAngle, 0.25);
  across.position[0] = 0.75;
  const CylinderShape drum{0.5, 2.0, 0.0};
  expect_depth(pair_of(drum, drum, Pose{}, across), 0.25, {1.0, 0.0, 0.0});
}

TEST(CurvedKernels, cylinder_cap_in_box_gives_depth) {
  expect_depth(pair_of(BoxShape{{4, 4, 1}, 0.0}, CylinderShape{1.0, 1.0, 0.0}, Pose{},
                       Pose::at(0.5, 0.125, 1.75)),
               0.25, {0.0, 0.0, 1.0});
}

TEST(CurvedKernels, parallel_cylinders_have_depth_of_sides) {
  Pose beside = Pose::at(0.6, 0.8, 1.0);
  expect_depth(pair_of(CylinderShape{0.75, 2.0, 0.0}, CylinderShape{0.5, 4.0, 0.0}, Pose{}, beside),
               0.25, {0.6, 0.8, 0.0});
}

TEST(CurvedKernels, cone_side_at_box_edge_gives_depth) {
  // The cone's side has a slope of 45 degrees. The edge of the box that is parallel to y is 0.125 /
  // sqrt(2) inside the cone.
  const ConeShape cone{1.0, 0.5, 0.0};
  const double slope = std::sqrt(0.5);
  Pose corner = Pose::at(-1.0 - 0.5 + 0.125, 0.0, 1.0);
  const PairScene scene = pair_of(BoxShape{{1.0, 4.0, 1.0}, 0.0}, cone, corner, Pose{});
  expect_depth(scene, 0.125 * slope, {slope, 0.0, -slope});
}

TEST(CurvedKernels, cylinder_rim_at_box_edge_gives_depth) {
  // A coin on the edge of a box that is turned by 45 degrees about y. The coin's rim is along x and
  // tilted by one degree: its lower rim is the deeper one.
  Pose on_edge;
  on_edge.orientation[0] = std::cos(0.25 * kRightAngle);
  on_edge.orientation[2] = std::sin(0.25 * kRightAngle);
  const double lean = kRightAngle / 90.0;
  const CylinderShape coin{1.0, 0.125, 0.0};
  const double reach = std::cos(lean) + 0.125 * std::sin(lean);
  const double top = std::sqrt(2.0);
  const PairScene scene = pair_of(BoxShape{{1.0, 4.0, 1.0}, 0.0}, coin, on_edge,
                                  turned_about_x(kRightAngle - lean, top + reach - 0.0625));
  expect_depth(scene, 0.0625, {0.0, 0.0, 1.0});
}

TEST(CurvedKernels, ellipsoid_on_plane_has_distance_of_lowest_point) {
  // The turn by a right angle about x makes the second axis upright.
  const PairScene scene = pair_of(HalfSpaceShape{{0.0, 0.0, 1.0}, 0.5}, EllipsoidShape{{1, 3, 2}},
                                  Pose{}, turned_about_x(kRightAngle, 3.25));
  const PairResults answer = answer_to(scene, ContactLevel::manifold);
  EXPECT_NEAR(answer.distance, -0.25, 1e-15);
  EXPECT_NEAR(answer.normal[2], 1.0, 1e-15);
  ASSERT_EQ(answer.contacts.size(), 1U);
  EXPECT_NEAR(answer.contacts[0].position[2], 0.375, 1e-6);
}

TEST(CurvedKernels, ball_by_ellipsoid_matches_closed_form) {
  // The point (r cos t, s sin t) of an ellipse with radii r and s has the normal (cos t / r, sin t
  // / s). Here the radii are 2 and 1 and sin t is 0.6. The centre of the ball is outside and
  // inside.
  const double surface[2] = {2.0 * 0.8, 0.6};
  const double out[2] = {0.4 / std::hypot(0.4, 0.6), 0.6 / std::hypot(0.4, 0.6)};
  for (const double away : {1.0, -0.125}) {
    const Pose at = Pose::at(surface[0] + away * out[0], surface[1] + away * out[1], 0);
    const PairScene scene = pair_of(SphereShape{0.25}, EllipsoidShape{{2.0, 1.0, 4.0}}, at, Pose{});
    const PairResults answer = answer_to(scene, ContactLevel::distance);
    EXPECT_NEAR(answer.distance, away - 0.25, 4e-15);
    EXPECT_LE(answer.error_bound, 1e-13);
    for (int k = 0; k < 2; ++k) EXPECT_NEAR(answer.normal[k], -out[k], 1e-14);
  }
}

TEST(CurvedKernels, ellipsoid_in_box_has_depth_of_lowest_point) {
  expect_depth(pair_of(BoxShape{{4, 4, 1}, 0.0}, EllipsoidShape{{1.0, 2.0, 1.5}}, Pose{},
                       Pose::at(0.5, 0.125, 1.75)),
               0.75, {0.0, 0.0, 1.0});
}

TEST(CurvedKernels, ellipsoids_end_to_end_have_depth_of_ends) {
  const EllipsoidShape egg{{1.0, 1.25, 1.5}};
  expect_depth(pair_of(egg, egg, Pose{}, Pose::at(0, 0, 2.75)), 0.25, {0.0, 0.0, 1.0});
}

/// Balls of radii 4 and 1 whose centres are 5 apart: the side between them has the normal (0.8, 0,
/// 0.6) and starts at (3.2, 0, -0.1).
constexpr TaperedCapsuleShape kTaper{{4.0, 1.0}, 2.5};

TEST(CurvedKernels, ball_beside_tapered_capsule_has_distance_from_side) {
  // The centre of the ball is on the normal of the side at its midpoint (2, 0, 1.5), outside and
  // inside.
  for (const double away : {1.0, -0.125}) {
    const Pose at = Pose::at(2.0 + 0.8 * away, 0, 1.5 + 0.6 * away);
    const PairResults answer =
        answer_to(pair_of(SphereShape{0.25}, kTaper, at, Pose{}), ContactLevel::distance);
    EXPECT_NEAR(answer.distance, away - 0.25, 4e-15);
    EXPECT_LE(answer.error_bound, 1e-13);
    EXPECT_NEAR(answer.normal[0], -0.8, 1e-14);
    EXPECT_NEAR(answer.normal[2], -0.6, 1e-14);
  }
}

TEST(CurvedKernels, lying_tapered_capsule_on_plane_has_two_points) {
  // Turned about y so that the normal of the side points down.
  const double half = 0.5 * (std::acos(0.6) - 2.0 * kRightAngle);
  Pose on_side = Pose::at(0, 0, 2.25);
  on_side.orientation[0] = std::cos(half);
  on_side.orientation[2] = std::sin(half);
  const PairScene scene = pair_of(HalfSpaceShape{}, kTaper, Pose{}, on_side);
  const PairResults answer = answer_to(scene, ContactLevel::manifold);
  EXPECT_NEAR(answer.distance, -0.25, 4e-15);
  ASSERT_EQ(answer.contacts.size(), 2U);
  for (const ContactPoint& contact : answer.contacts) {
    EXPECT_NEAR(contact.depth, 0.25F, 1e-6F);
    EXPECT_NEAR(contact.position[2], -0.125F, 1e-6F);
  }
  EXPECT_NEAR(std::abs(answer.contacts[0].position[0] - answer.contacts[1].position[0]), 4.0, 1e-6);
}

TEST(CurvedKernels, nested_tapered_capsule_matches_larger_ball) {
  const PairScene scene =
      pair_of(SphereShape{1.0}, TaperedCapsuleShape{{3.0, 1.0}, 0.5}, Pose::at(0, 0, 4.0), Pose{});
  EXPECT_EQ(answer_to(scene, ContactLevel::distance).distance, 0.5);
}

TEST(CurvedKernels, tapered_capsule_in_box_has_depth_of_ball) {
  expect_depth(pair_of(BoxShape{{8, 8, 1}, 0.0}, TaperedCapsuleShape{{1.5, 0.5}, 1.0}, Pose{},
                       Pose::at(0.5, 0.125, 1.0 + 1.0 + 1.5 - 1.75)),
               1.75, {0.0, 0.0, 1.0});
}

TEST(CurvedKernels, parallel_tapered_capsules_have_depth_of_sides) {
  // The second capsule is the mirror image of the first, so that their sides are parallel.
  const double n[3] = {0.8, 0.0, 0.6};
  const TaperedCapsuleShape upside_down{{1.0, 4.0}, 2.5};
  Pose beside = Pose::at(2.0 * 2.0, 0, 2.0 * 1.5);
  for (int k = 0; k < 3; ++k) beside.position[k] -= 0.25 * n[k];
  expect_depth(pair_of(kTaper, upside_down, Pose{}, beside), 0.25, {0.8, 0.0, 0.6});
}

TEST(CurvedKernels, overlapping_tapered_capsules_have_depth_of_balls) {
  // Both capsules are upright. The centres of the larger balls are 0.3 apart, at the same height.
  const TaperedCapsuleShape taper{{0.5, 0.125}, 0.25};
  expect_depth(pair_of(taper, taper, Pose{}, Pose::at(0.18, 0.24, 0)), 0.7, {0.6, 0.8, 0.0});
}

TEST(CurvedKernels, needle_through_coin_has_least_depth) {
  // The coin is 1e-8 wide, and the Minkowski difference of the cores 3e-10 thin: its faces are
  // slivers.
  Pose along = Pose::at(0.69512259845849433, 0.69512259845849433, 0.69512259845849433);
  Pose coin = along;
  constexpr double kTurns[2][4] = {
      {-0.63636952790856949, 0.49819173039831766, 0.64560454435751824, -0.35531863388147844},
      {0.85442363077535899, 0.5283548791324173, -0.20992183015313848, -0.96507352250783573}};
  along.orientation = kTurns[0];
  coin.orientation = kTurns[1];
  const double rounding = 0.25;
  const PairScene scene = pair_of(
      EllipsoidShape{{0.65358348169210523, 0.0, 0.0}, 0.0},
      EllipsoidShape{{1.1007418655307882e-08, 6.7142671839396405e-09, 0.0}, rounding}, along, coin);
  for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
    const auto answer =
        compute_results(scene, {.level = ContactLevel::distance, .tier = tier}).at(0);
    // The least extent of the coin across the needle, in long double.
    EXPECT_NEAR(-answer.distance, rounding + 3.2603644706036771e-10, answer.error_bound);
    EXPECT_LE(answer.error_bound, 1e-9);
  }
}

TEST(CurvedKernels, equal_opposite_directions_give_either_normal) {
  // The depths of the drums along +x and -x are equal.
  const CylinderShape drum{0.5, 2.0, 0.0};
  const PairScene scene = pair_of(drum, drum, Pose{}, turned_about_x(kRightAngle, 0.0));
  NarrowPhase narrow;
  NarrowResult result;
  ASSERT_EQ(narrow.collide(scene.pool, scene.bodies(), scene.pairs,
                           {.level = ContactLevel::distance}, result),
            Status::ok);
  EXPECT_NEAR(result.distance()[0], -1.0, 2e-15);
  EXPECT_NEAR(std::abs(result.normal(0)[0]), 1.0, 1e-14);
}

/// Returns how far the second drum must move along a direction to separate from the first one. The
/// first is upright at the origin, the second is tilted by `lean` about x. The direction is
/// `around` about z and `up` above the horizon.
double separating_distance(const CylinderShape& a, const CylinderShape& b, double lean,
                           const Pose& at, double around, double up) {
  const double n[3] = {std::cos(up) * std::cos(around), std::cos(up) * std::sin(around),
                       std::sin(up)};
  const auto reach = [](const CylinderShape& drum, double along) {
    return drum.radius * std::sqrt(std::max(1.0 - along * along, 0.0)) +
           drum.half_length * std::abs(along);
  };
  const double along_b = std::cos(lean) * n[2] - std::sin(lean) * n[1];
  return reach(a, n[2]) + reach(b, along_b) -
         (at.position[0] * n[0] + at.position[1] * n[1] + at.position[2] * n[2]);
}

TEST(CurvedKernels, nearly_coaxial_cylinders_stay_within_error_bounds) {
  Random random(11);
  for (int i = 0; i < 40; ++i) {
    const double lean = std::pow(10.0, random.uniform(-6.0, -2.0));
    const CylinderShape a{random.uniform(0.5, 1.0), random.uniform(1.5, 3.0), 0.0};
    const CylinderShape b{random.uniform(0.25, 0.5), random.uniform(1.5, 3.0), 0.0};
    Pose pose = turned_about_x(lean, random.uniform(-0.1, 0.1));
    for (int k = 0; k < 2; ++k) pose.position[k] = lean * random.uniform(-1.0, 1.0);
    const PairResults answer = answer_to(pair_of(a, b, Pose{}, pose), ContactLevel::distance);
    double least = a.half_length + b.half_length;
    for (int around = 0; around < 2000; ++around) {
      for (int up = -2; up <= 2; ++up) {
        least = std::min(least,
                         separating_distance(a, b, lean, pose, 4.0 * kRightAngle * around / 2000.0,
                                             0.5 * lean * up));
      }
    }
    const double sizes = a.radius + a.half_length + b.radius + b.half_length;
    ASSERT_LE(answer.error_bound, 1e-3 * sizes) << i;
    ASSERT_LE(-answer.distance - answer.error_bound, least) << i;
    ASSERT_GE(-answer.distance + answer.error_bound, least - 1e-4 * lean) << i;
  }
}

TEST(CurvedKernels, user_shape_depth_ignores_its_radius) {
  PairScene scene;
  Random random(13);
  add_pairs(scene, support, support, PairStyle::ordinary, 500, random);
  const NarrowOptions narrow_options{.level = ContactLevel::distance};
  const auto close = compute_results(scene, narrow_options);
  std::vector<double> sizes;
  for (const BodyPair& pair : scene.pairs) sizes.push_back(extent(scene, pair));
  for (ShapeId& id : scene.shapes) {
    SupportShape loose = scene.pool.tables().supports[id.index()];
    loose.radius *= 1000.0;
    id = expect_ok(scene.pool.add(loose));
  }
  const auto wide = compute_results(scene, narrow_options);
  for (std::size_t i = 0; i < close.size(); ++i) {
    EXPECT_EQ(close[i].overlap, wide[i].overlap) << i;
    EXPECT_NEAR(close[i].distance, wide[i].distance, 6e-7 * sizes[i]) << i;
    EXPECT_LE(wide[i].error_bound, 4e-7 * sizes[i]) << i;
  }
}

struct CurvedKind {
  ShapeKind a;
  ShapeKind b;
};
void PrintTo(const CurvedKind& kind, std::ostream* out) {
  *out << to_string(kind.a) << "_" << to_string(kind.b);
}
constexpr CurvedKind kCurvedKinds[] = {{sphere, cylinder},
                                       {sphere, cone},
                                       {capsule, cylinder},
                                       {capsule, cone},
                                       {box, cylinder},
                                       {box, cone},
                                       {cylinder, cylinder},
                                       {cylinder, cone},
                                       {cone, cone},
                                       {cylinder, triangle},
                                       {cone, triangle},
                                       {cylinder, hull},
                                       {cone, hull},
                                       {hull, half_space},
                                       {cylinder, half_space},
                                       {cone, half_space},
                                       {sphere, ellipsoid},
                                       {half_space, ellipsoid},
                                       {capsule, ellipsoid},
                                       {box, ellipsoid},
                                       {cylinder, ellipsoid},
                                       {cone, ellipsoid},
                                       {hull, ellipsoid},
                                       {triangle, ellipsoid},
                                       {ellipsoid, ellipsoid},
                                       {sphere, tapered_capsule},
                                       {half_space, tapered_capsule},
                                       {capsule, tapered_capsule},
                                       {box, tapered_capsule},
                                       {cylinder, tapered_capsule},
                                       {cone, tapered_capsule},
                                       {hull, tapered_capsule},
                                       {triangle, tapered_capsule},
                                       {ellipsoid, tapered_capsule},
                                       {tapered_capsule, tapered_capsule},
                                       {sphere, support},
                                       {capsule, support},
                                       {box, support},
                                       {cylinder, support},
                                       {cone, support},
                                       {hull, support},
                                       {triangle, support},
                                       {half_space, support},
                                       {ellipsoid, support},
                                       {tapered_capsule, support},
                                       {support, support}};

class CurvedPairs : public testing::TestWithParam<CurvedKind> {
 protected:
  static PairScene scene_of(PairStyle style, std::size_t count, std::uint64_t seed = 11) {
    PairScene scene;
    Random random(seed);
    add_pairs(scene, GetParam().a, GetParam().b, style, count, random);
    return scene;
  }
};

constexpr double kReach = 0.05;

NarrowOptions options(ContactLevel level, NarrowTier tier) {
  return {.level = level, .tier = tier, .contact_margin = kReach};
}

/// If `is_exact`, exact arithmetic decides pairs that touch.
void expect_answers_of_the_solver(const PairScene& scene, bool is_exact) {
  const auto solved =
      compute_results(scene, options(ContactLevel::distance, NarrowTier::reference));
  const auto verdict = compute_results(scene, options(ContactLevel::boolean, NarrowTier::robust));
  const auto found = compute_results(scene, options(ContactLevel::distance, NarrowTier::robust));
  const auto touch = compute_results(scene, options(ContactLevel::manifold, NarrowTier::robust));
  for (std::size_t i = 0; i < solved.size(); ++i) {
    const double d = solved[i].distance;
    const double doubt = solved[i].error_bound + found[i].error_bound;
    if (is_exact || std::abs(d) > solved[i].error_bound) {
      ASSERT_EQ(verdict[i].overlap, solved[i].overlap) << i << " " << d;
      ASSERT_EQ(found[i].overlap, solved[i].overlap) << i << " " << d;
    }
    ASSERT_LE(std::abs(found[i].distance - d), doubt) << i;
    ASSERT_EQ(!touch[i].contacts.empty(), touch[i].distance <= kReach) << i;
    if (touch[i].contacts.empty()) continue;
    ASSERT_LE(std::abs(touch[i].distance - d), solved[i].error_bound + touch[i].error_bound) << i;
    const double reach = extent(scene, scene.pairs[i]) + std::abs(d);
    ASSERT_NEAR(depths(touch[i]).front(), -touch[i].distance, 2e-6 * reach) << i;
    ASSERT_GE(depths(touch[i]).back(), -kReach - 2e-6 * reach) << i;
  }
}

TEST_P(CurvedPairs, answers_match_solver) {
  for (const PairStyle style : kPairStyles) {
    SCOPED_TRACE(to_string(style));
    // Exact arithmetic does not cover shapes given by support functions.
    expect_answers_of_the_solver(scene_of(style, scaled(1000)), GetParam().b < ellipsoid);
  }
}

/// Returns the distance of each point from a body of the scene.
std::vector<double> distances_to_points(PairScene& scene, std::uint32_t body,
                                        const std::vector<Pose>& points) {
  ShapeId point = expect_ok(scene.pool.add(SphereShape{0.0}));
  std::vector<ShapeId> shapes{scene.shapes[body]};
  std::vector<Pose> poses{scene.poses[body]};
  std::vector<BodyPair> pairs;
  for (const Pose& at : points) {
    pairs.push_back({0, static_cast<std::uint32_t>(poses.size())});
    shapes.push_back(point);
    poses.push_back(at);
  }
  NarrowPhase narrow;
  NarrowResult result;
  EXPECT_EQ(
      narrow.collide(scene.pool, {shapes, poses}, pairs, {.level = ContactLevel::distance}, result),
      Status::ok);
  return {result.distance().begin(), result.distance().end()};
}

void expect_contacts_on_both_surfaces(PairScene& scene) {
  const auto touch = compute_results(scene, options(ContactLevel::manifold, NarrowTier::robust));
  for (std::size_t i = 0; i < touch.size(); ++i) {
    // Lines within 0.001 of parallel get a contact at each end of their common part, where they may
    // be slightly farther apart.
    const double bound =
        (touch[i].contacts.size() > 1 ? 5e-4 : 2e-6) * (extent(scene, scene.pairs[i]) + kReach);
    for (const double side : {0.5, -0.5}) {
      std::vector<Pose> points;
      const std::uint32_t body = side > 0.0 ? scene.pairs[i].a : scene.pairs[i].b;
      for (const ContactPoint& contact : touch[i].contacts) {
        Pose at = scene.poses[scene.pairs[i].a];
        at.orientation = Pose{}.orientation;
        for (int k = 0; k < 3; ++k) {
          at.position[k] += static_cast<double>(contact.position[k]) +
                            side * static_cast<double>(contact.depth) * touch[i].normal[k];
        }
        points.push_back(at);
      }
      for (const double distance : distances_to_points(scene, body, points)) {
        ASSERT_LE(distance, bound) << i << " of " << (side > 0.0 ? "a" : "b");
      }
    }
  }
}

TEST_P(CurvedPairs, contacts_lie_on_both_surfaces) {
  PairScene scene = scene_of(PairStyle::ordinary, scaled(1000), 12);
  expect_contacts_on_both_surfaces(scene);
}

void expect_few_solved(const PairScene& scene) {
  for (const ContactLevel level :
       {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
    NarrowPhase narrow;
    NarrowResult result;
    ASSERT_EQ(narrow.collide(scene.pool, scene.bodies(), scene.pairs,
                             options(level, NarrowTier::robust), result),
              Status::ok);
    EXPECT_EQ(narrow.statistics().without_lanes, 0U);
    EXPECT_LE(narrow.statistics().recomputed, scene.pairs.size() / 50) << static_cast<int>(level);
  }
}

TEST_P(CurvedPairs, ordinary_pairs_rarely_need_solver) {
  expect_few_solved(scene_of(PairStyle::ordinary, 2000));
}

/// Makes bodies upright in a tilted frame: turned about their own axes, upside down or not; boxes
/// stand on any of their faces.
void make_upright(PairScene& scene, const Quaternion& lean, Random& random) {
  for (std::size_t i = 0; i < scene.poses.size(); ++i) {
    const double spin = random.uniform(0.0, 2.0 * kRightAngle);
    Quaternion turn = lean * Quaternion(std::cos(spin), 0.0, 0.0, std::sin(spin));
    if (random.below(2) == 0) turn = turn * Quaternion(0.0, 1.0, 0.0, 0.0);
    if (scene.shapes[i].kind() == box) {
      constexpr Quaternion kFaces[] = {{1, 0, 0, 0}, {0.5, 0.5, 0.5, 0.5}, {0.5, -0.5, -0.5, -0.5}};
      turn = turn * Quaternion(kFaces[random.below(3)]);
    }
    scene.poses[i].orientation = turn;
  }
}

TEST_P(CurvedPairs, upright_pairs_match_solver) {
  Random random(17);
  for (const PairStyle style : kPairStyles) {
    SCOPED_TRACE(to_string(style));
    for (const Quaternion& lean : {Quaternion{1, 0, 0, 0}, Quaternion{0.6, 0.0, 0.8, 0.0},
                                   Quaternion{0.1, 0.7, -0.5, 0.5}}) {
      PairScene scene = scene_of(style, scaled(300), 18);
      make_upright(scene, lean, random);
      expect_answers_of_the_solver(scene, GetParam().b < ellipsoid);
      // If a user shape is on a half-space, the contact at the deepest point may be above the
      // shape's surface.
      const bool is_level = GetParam().a == half_space && GetParam().b == support;
      if (style == PairStyle::ordinary && !is_level) expect_contacts_on_both_surfaces(scene);
    }
  }
}

TEST_P(CurvedPairs, upright_pairs_rarely_need_solver) {
  Random random(19);
  PairScene scene = scene_of(PairStyle::ordinary, 2000);
  make_upright(scene, {1, 0, 0, 0}, random);
  expect_few_solved(scene);
}

TEST_P(CurvedPairs, answers_match_on_every_isa) {
  for (const PairStyle style : kPairStyles) {
    SCOPED_TRACE(to_string(style));
    const PairScene scene = scene_of(style, scaled(200));
    for (const ContactLevel level :
         {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
      std::vector<PairResults> expected;
      for (const Isa isa : available_isas()) {
        const IsaScope scope(isa);
        const auto answers = compute_results(scene, options(level, NarrowTier::robust));
        if (expected.empty()) expected = answers;
        for (std::size_t i = 0; i < answers.size(); ++i) {
          ASSERT_TRUE(same(answers[i], expected[i])) << i << " " << to_string(isa);
        }
      }
    }
  }
}

TEST_P(CurvedPairs, single_pair_matches_batch) {
  PairScene scene = scene_of(PairStyle::lattice, 60);
  const auto all = compute_results(scene, options(ContactLevel::manifold, NarrowTier::robust));
  const std::vector<BodyPair> pairs = scene.pairs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    scene.pairs = {pairs[i]};
    const auto one = compute_results(scene, options(ContactLevel::manifold, NarrowTier::robust));
    ASSERT_TRUE(same(one.at(0), all[i])) << i;
  }
}

TEST_P(CurvedPairs, far_pairs_match_near_pairs) {
  PairScene scene = scene_of(PairStyle::ordinary, scaled(300));
  for (Pose& pose : scene.poses) {
    for (double& x : pose.position) x = std::round(x * 0x1p10) * 0x1p-10;
  }
  const auto here = compute_results(scene, options(ContactLevel::manifold, NarrowTier::robust));
  for (Pose& pose : scene.poses) pose.position[1] += 1e9;
  const auto there = compute_results(scene, options(ContactLevel::manifold, NarrowTier::robust));
  for (std::size_t i = 0; i < here.size(); ++i) ASSERT_TRUE(same(here[i], there[i])) << i;
}

INSTANTIATE_TEST_SUITE_P(Kinds, CurvedPairs, testing::ValuesIn(kCurvedKinds),
                         [](const testing::TestParamInfo<CurvedKind>& kind) {
                           return std::string(to_string(kind.param.a)) + "_" +
                                  to_string(kind.param.b);
                         });

}  // namespace
}  // namespace winnow::test
