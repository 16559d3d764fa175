// Clipping of two contact patches (supporting features) into contact points: depths, feature ids,
// thinning to four points. Compared with a plain search in long double.

#include "pipeline/manifold/contact_patch.h"

#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Eigen::Vector3d;

// A patch that owns its memory. Vertex i has the id 10 + i, the edge from it 20 + i.
struct TestPatch {
  std::vector<Vector3d> points;
  double rounding = 0.0;
  std::vector<std::uint32_t> vertex_ids = {};
  std::vector<std::uint32_t> edge_ids = {};

  SupportingFeature view() {
    vertex_ids.clear();
    edge_ids.clear();
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      vertex_ids.push_back(10 + i);
      edge_ids.push_back(20 + i);
    }
    return {reinterpret_cast<const double(*)[3]>(points.data()),
            vertex_ids.data(),
            edge_ids.data(),
            static_cast<std::uint32_t>(points.size()),
            7,
            rounding};
  }
};

std::vector<ContactPoint> contact_points(TestPatch& a, TestPatch& b, const Vector3d& normal,
                                         double margin = 0.0) {
  ContactPoint out[kManifoldPoints];
  const std::uint32_t count = contact_patch(a.view(), b.view(), normal.data(), margin, out);
  return {out, out + count};
}

Vector3d position(const ContactPoint& p) {
  return {p.position[0], p.position[1], p.position[2]};
}

Vector3d random_direction(Random& random) {
  Vector3d d;
  do {
    d = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  } while (d.norm() < 0.1 || d.norm() > 1.0);
  return d.normalized();
}

// Returns a convex polygon, segment or point. Its plane is tilted by up to `lean` from the plane
// perpendicular to the normal.
TestPatch random_patch(Random& random, const Vector3d& normal, double lean, std::size_t vertices) {
  const Vector3d tilted = (normal + lean * random.unit() * random_direction(random)).normalized();
  const Vector3d u = tilted.unitOrthogonal();
  const Vector3d v = tilted.cross(u) * (random.chance(0.5) ? 1.0 : -1.0);
  const Vector3d center = 0.7 * random.unit() * random_direction(random);
  const double radius[2] = {random.uniform(0.2, 1.5), random.uniform(0.2, 1.5)};
  TestPatch patch;
  for (std::size_t i = 0; i < vertices; ++i) {
    const double turn =
        2.0 * M_PI * (static_cast<double>(i) + 0.8 * random.unit()) / static_cast<double>(vertices);
    patch.points.emplace_back(center + radius[0] * std::cos(turn) * u +
                              radius[1] * std::sin(turn) * v);
  }
  patch.rounding = random.chance(0.3) ? random.uniform(0.0, 0.2) : 0.0;
  return patch;
}

// Returns the patch's height along the normal above a point of the plane of u and v, or nothing
// outside the patch. A plain fan of triangles in long double.
std::optional<double> height_at(const TestPatch& patch, const Vector3d& normal, const Vector3d& at,
                                double slack) {
  const Vector3d u = normal.unitOrthogonal();
  const Vector3d v = normal.cross(u);
  using Real = long double;
  const auto flat = [&](const Vector3d& p) {
    return Eigen::Matrix<Real, 2, 1>(static_cast<Real>(u.dot(p)), static_cast<Real>(v.dot(p)));
  };
  const auto p = flat(at);
  for (std::size_t i = 1; i + 1 < patch.points.size(); ++i) {
    const std::size_t index[3] = {0, i, i + 1};
    Real weight[3];
    Real sum = 0;
    for (int k = 0; k < 3; ++k) {
      const auto q = flat(patch.points[index[(k + 1) % 3]]);
      const auto r = flat(patch.points[index[(k + 2) % 3]]);
      weight[k] = (q - p).x() * (r - p).y() - (q - p).y() * (r - p).x();
      sum += weight[k];
    }
    Real height = 0;
    bool in = true;
    for (int k = 0; k < 3; ++k) {
      in = in && weight[k] / sum >= static_cast<Real>(-slack);
      height += weight[k] / sum * static_cast<Real>(normal.dot(patch.points[index[k]]));
    }
    if (in) return static_cast<double>(height);
  }
  return std::nullopt;
}

// Computes the largest depth by testing all candidates: vertices over the other patch, and
// crossings of edges.
std::optional<double> deepest(const TestPatch& a, const TestPatch& b, const Vector3d& normal) {
  const Vector3d u = normal.unitOrthogonal();
  const Vector3d v = normal.cross(u);
  std::vector<Vector3d> places(a.points);
  places.insert(places.end(), b.points.begin(), b.points.end());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    for (std::size_t k = 0; k < b.points.size(); ++k) {
      const Vector3d p = a.points[i];
      const Vector3d q = b.points[k];
      const Vector3d e = a.points[(i + 1) % a.points.size()] - p;
      const Vector3d f = b.points[(k + 1) % b.points.size()] - q;
      const auto turn = [&](const Vector3d& x, const Vector3d& y) {
        return u.dot(x) * v.dot(y) - v.dot(x) * u.dot(y);
      };
      if (turn(e, f) != 0.0) places.emplace_back(p + turn(q - p, f) / turn(e, f) * e);
    }
  }
  std::optional<double> most;
  for (const Vector3d& place : places) {
    const auto top = height_at(a, normal, place, 1e-9);
    const auto bottom = height_at(b, normal, place, 1e-9);
    if (!top || !bottom) continue;
    const double depth = *top - *bottom + a.rounding + b.rounding;
    if (!most || depth > *most) most = depth;
  }
  return most;
}

TestPatch square(double half, double height, double turn = 0.0) {
  TestPatch patch;
  for (int i = 0; i < 4; ++i) {
    const double angle = turn + M_PI / 4.0 + i * M_PI / 2.0;
    patch.points.emplace_back(half * std::sqrt(2.0) * std::cos(angle),
                              half * std::sqrt(2.0) * std::sin(angle), height);
  }
  return patch;
}

TEST(ContactPatch, square_on_larger_square_touches_at_corners) {
  TestPatch a = square(2.0, 1.0);
  TestPatch b = square(1.0, 0.75);
  const auto points = contact_points(a, b, Vector3d::UnitZ());
  ASSERT_EQ(points.size(), 4U);
  std::set<std::uint64_t> features;
  for (const ContactPoint& p : points) {
    EXPECT_FLOAT_EQ(p.depth, 0.25F);
    EXPECT_NEAR(std::abs(p.position[0]), 1.0, 1e-6);
    EXPECT_NEAR(std::abs(p.position[1]), 1.0, 1e-6);
    EXPECT_FLOAT_EQ(p.position[2], 0.875F);
    // The face 7 of a with a vertex of b.
    EXPECT_EQ(p.feature >> 32U, (2U << 30U) + 7U);
    EXPECT_LT(p.feature & 0xFFFFFFFFU, 14U);
    features.insert(p.feature);
  }
  EXPECT_EQ(features.size(), 4U);
}

TEST(ContactPatch, small_motion_keeps_features) {
  TestPatch a = square(1.0, 1.0);
  const auto features = [&](double turn, double shift) {
    TestPatch b = square(0.9, 0.9, 0.2 + turn);
    for (Vector3d& p : b.points) p += Vector3d(0.3 + shift, 0.2 - shift, 0.05 * p.x());
    std::set<std::uint64_t> ids;
    for (const ContactPoint& p : contact_points(a, b, Vector3d::UnitZ())) ids.insert(p.feature);
    return ids;
  };
  const auto before = features(0.0, 0.0);
  EXPECT_EQ(before.size(), 4U);
  EXPECT_EQ(before, features(1e-3, 0.0));
  EXPECT_EQ(before, features(0.0, 1e-3));
}

TEST(ContactPatch, crossing_edges_give_one_point_parallel_two) {
  TestPatch a = {{{-1, 0, 0.1}, {1, 0, 0.1}}};
  TestPatch crossing = {{{0.25, -1, 0}, {0.25, 1, 0}}};
  const auto point = contact_points(a, crossing, Vector3d::UnitZ());
  ASSERT_EQ(point.size(), 1U);
  EXPECT_LT((position(point[0]) - Vector3d(0.25, 0, 0.05)).norm(), 1e-6);
  EXPECT_FLOAT_EQ(point[0].depth, 0.1F);
  // The feature of a patch with two vertices is the edge.
  EXPECT_EQ(point[0].feature >> 32U, (1U << 30U) + 7U);

  TestPatch along = {{{0.25, 1e-5, 0}, {3, -1e-5, 0}}};
  const auto ends = contact_points(a, along, Vector3d::UnitZ());
  ASSERT_EQ(ends.size(), 2U);
  EXPECT_NEAR(std::min(ends[0].position[0], ends[1].position[0]), 0.25, 1e-6);
  EXPECT_NEAR(std::max(ends[0].position[0], ends[1].position[0]), 1.0, 1e-6);
}

TEST(ContactPatch, edge_on_face_is_clipped) {
  TestPatch a = square(1.0, 0.0);
  TestPatch b = {{{0, 0, -0.1}, {3, 0, -0.4}}};
  const auto points = contact_points(a, b, Vector3d::UnitZ(), 0.0);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_NEAR(points[0].depth, 0.2, 1e-6);
  EXPECT_NEAR(points[0].position[0], 1.0, 1e-6);
  EXPECT_NEAR(points[1].depth, 0.1, 1e-6);
}

TEST(ContactPatch, points_beyond_margin_are_dropped_except_deepest) {
  TestPatch a = square(1.0, 0.0);
  TestPatch b = {{{-0.5, -0.5, 0.1}, {0.5, -0.5, 0.1}, {0.5, 0.5, 0.3}, {-0.5, 0.5, 0.3}}};
  EXPECT_EQ(contact_points(a, b, Vector3d::UnitZ(), 0.5).size(), 4U);
  EXPECT_EQ(contact_points(a, b, Vector3d::UnitZ(), 0.2).size(), 2U);
  const auto least = contact_points(a, b, Vector3d::UnitZ(), 0.0);
  ASSERT_EQ(least.size(), 1U);
  EXPECT_NEAR(least[0].depth, -0.1, 1e-6);
}

TEST(ContactPatch, rounding_adds_to_depth_and_shifts_points) {
  TestPatch a = {{{0, 0, 0}}, 0.5};
  TestPatch b = square(1.0, 0.6);
  b.rounding = 0.2;
  const auto points = contact_points(a, b, Vector3d::UnitZ());
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR(points[0].depth, 0.1, 1e-6);
  EXPECT_NEAR(points[0].position[2], 0.45, 1e-6);
}

TEST(ContactPatch, disjoint_patches_give_closest_point) {
  TestPatch a = square(1.0, 0.0);
  TestPatch b = square(1.0, 0.0);
  for (Vector3d& p : b.points) p.x() += 2.5;
  EXPECT_EQ(contact_points(a, b, Vector3d::UnitZ()).size(), 1U);
  TestPatch vertex = {{{1.0 + 1e-12, 1.0, 0.0}}};
  const auto points = contact_points(a, vertex, Vector3d::UnitZ());
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR(points[0].depth, 0.0, 1e-9);
}

TEST(ContactPatch, degenerate_patches_give_valid_points) {
  TestPatch floor = square(2.0, 0.0);
  TestPatch sliver = {{{-1, 0, 0}, {1, 0, 0}, {0, 0, 0}}};
  TestPatch upright = {{{-1, 0, -0.1}, {0, 0, 1}, {1, 0, -0.1}}};
  TestPatch point = {{{0.5, 0, -0.1}, {0.5, 0, -0.1}, {0.5, 0, -0.1}}};
  TestPatch pole = {{{0.5, 0, 3}, {0.5, 0, -0.1}}};
  EXPECT_EQ(contact_points(floor, sliver, Vector3d::UnitZ()).size(), 2U);
  EXPECT_EQ(contact_points(floor, upright, Vector3d::UnitZ()).size(), 2U);
  for (TestPatch* p : {&point, &pole}) {
    const auto points = contact_points(floor, *p, Vector3d::UnitZ());
    ASSERT_EQ(points.size(), 1U);
    EXPECT_NEAR(points[0].depth, 0.1, 1e-6);
  }
  EXPECT_EQ(contact_points(sliver, sliver, Vector3d::UnitZ()).size(), 2U);
  EXPECT_EQ(contact_points(point, point, Vector3d::UnitZ()).size(), 1U);
}

TEST(ContactPatch, many_vertices_are_reduced_to_four_points) {
  TestPatch a;
  for (int i = 0; i < 100; ++i) {
    const double turn = 2.0 * M_PI * i / 100.0;
    a.points.emplace_back(std::cos(turn), std::sin(turn), 0.0);
  }
  TestPatch b = square(2.0, -0.1);
  const auto points = contact_points(a, b, Vector3d::UnitZ());
  ASSERT_EQ(points.size(), 4U);
  for (const ContactPoint& p : points) {
    EXPECT_NEAR(std::hypot(p.position[0], p.position[1]), 1.0, 1e-6);
    EXPECT_NEAR(p.depth, 0.1, 1e-6);
  }
  EXPECT_LT((position(points[0]) + position(points[1])).norm(), 0.5);
}

TEST(ContactPatch, results_scale_with_patches) {
  for (const double scale : {1e-20, 1e-6, 1.0, 1e6, 1e15}) {
    TestPatch a = square(scale, 0.0);
    TestPatch b = square(scale, -0.1 * scale, 0.5);
    const auto points = contact_points(a, b, Vector3d::UnitZ());
    ASSERT_EQ(points.size(), 4U);
    for (const ContactPoint& p : points) EXPECT_NEAR(p.depth / scale, 0.1, 1e-6);
  }
}

TEST(ContactPatch, deepest_point_is_first_all_on_both_patches) {
  Random random(1);
  for (std::size_t round = 0; round < scaled(20'000); ++round) {
    const Vector3d normal = random_direction(random);
    const double lean = random.chance(0.5) ? 1.0 : 1e-3;
    TestPatch a = random_patch(random, normal, lean, 3 + random.below(6));
    TestPatch b = random_patch(random, normal, lean, 3 + random.below(6));
    const double margin = random.uniform(0.0, 0.5);
    const auto points = contact_points(a, b, normal, margin);
    ASSERT_GE(points.size(), 1U);
    const auto most = deepest(a, b, normal);
    if (!most) continue;
    ASSERT_NEAR(points[0].depth, *most, 2e-6) << round;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto top = height_at(a, normal, position(points[i]), 1e-5);
      const auto bottom = height_at(b, normal, position(points[i]), 1e-5);
      ASSERT_TRUE(top && bottom) << round;
      // Heights of tilted patches change when positions are rounded to float. The first point has
      // the largest depth of all, possibly of a different tied point.
      const double tied = i == 0 ? 4.0 * kTiedDepth : 0.0;
      EXPECT_NEAR(points[i].depth, *top - *bottom + a.rounding + b.rounding, 1e-4 + tied) << round;
      EXPECT_NEAR(normal.dot(position(points[i])), 0.5 * (*top + a.rounding + *bottom - b.rounding),
                  1e-4);
      if (i > 0) {
        EXPECT_GE(points[i].depth, -margin - 1e-6);
      }
    }
  }
}

TEST(ContactPatch, swapped_patches_swap_features_only) {
  Random random(2);
  for (std::size_t round = 0; round < scaled(5'000); ++round) {
    const Vector3d normal = random_direction(random);
    TestPatch a = random_patch(random, normal, 1.0, 1 + random.below(7));
    TestPatch b = random_patch(random, normal, 1.0, 1 + random.below(7));
    const auto points = contact_points(a, b, normal);
    const auto mirrored = contact_points(b, a, -normal);
    ASSERT_EQ(points.size(), mirrored.size()) << round;
    EXPECT_NEAR(points[0].depth, mirrored[0].depth, 1e-6);
    for (const ContactPoint& p : points) {
      EXPECT_TRUE(std::any_of(mirrored.begin(), mirrored.end(), [&](const ContactPoint& q) {
        return p.feature == (q.feature << 32U | q.feature >> 32U) &&
               (position(p) - position(q)).norm() < 1e-5;
      })) << round;
    }
  }
}

}  // namespace
}  // namespace winnow::test
