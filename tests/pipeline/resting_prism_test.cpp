// A face with many vertices on a plane: the four contact points that are kept must span the face.

#include <gtest/gtest.h>
#include <winnow/winnow.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/pipeline/floor_contacts.h"
#include "tests/support/answers.h"

namespace winnow::test {
namespace {

/// Returns a prism with `sides` sides and a height equal to its radius. The base, at z = 0, is
/// turned about z.
std::vector<Vec3d> prism(int sides, double turn, double radius) {
  std::vector<Vec3d> points;
  for (int i = 0; i < sides; ++i) {
    const double angle = turn + 2.0 * std::numbers::pi * i / sides;
    const double x = radius * std::cos(angle);
    const double y = radius * std::sin(angle);
    points.push_back({x, y, 0.0});
    points.push_back({x, y, radius});
  }
  return points;
}

/// Returns the area of the convex hull of points in the plane z = 0, given in any order around
/// their centre.
double area_of(std::vector<ContactPoint> points) {
  std::ranges::sort(points, {},
                    [](const ContactPoint& p) { return std::atan2(p.position[1], p.position[0]); });
  double twice = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i].position;
    const auto& q = points[(i + 1) % points.size()].position;
    twice += static_cast<double>(p[0]) * static_cast<double>(q[1]) -
             static_cast<double>(p[1]) * static_cast<double>(q[0]);
  }
  return 0.5 * twice;
}

TEST(RestingPrism, contact_points_span_the_base) {
  for (const double radius : {1.0, 0x1p-6, 0x1p6}) {
    for (const int sides : {5, 6, 8, 12, 16, 20}) {
      for (const double turn : {0.0, 0.1, 1.7, 4.0}) {
        SCOPED_TRACE(testing::Message()
                     << sides << " sides, radius " << radius << ", turned by " << turn);
        ShapePool pool;
        ShapeId hull = expect_ok(pool.add_hull(prism(sides, turn, radius), 0.0));
        // A small tilt makes the lowest vertex unique.
        Pose pose = Pose::at(0, 0, -1e-4 * radius);
        pose.orientation[1] = 1e-5;
        const auto points = contacts_on_floor(pool, hull, pose, 0.01 * radius);
        ASSERT_EQ(points.size(), 4U);
        // A square inscribed in the unit circle has an area of 2, any other four points less.
        const double base =
            0.5 * sides * std::sin(2.0 * std::numbers::pi / sides) * radius * radius;
        EXPECT_GT(area_of(points), 0.63 * base);
      }
    }
  }
}

}  // namespace
}  // namespace winnow::test
