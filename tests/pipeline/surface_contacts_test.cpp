// Contacts of surfaces of triangles (mid::correct_surface_contacts): they are those of the surface,
// not of its single triangles. References: the convex hull of the same body, flat floors, and the
// same surface with other windings, scales and triangles.

#include <winnow/core/eigen.h>
#include <winnow/core/pose.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include "core/numbers/rotation.h"
#include "pipeline/shapes/extent.h"
#include "tests/pipeline/composite_world.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/config.h"

namespace winnow::test {
namespace {

using Vec = Eigen::Vector3d;

/// A contact region of two bodies, with its normal from the fixed body to the other.
struct Region {
  Vec normal;
  double distance;
  std::uint32_t points;
};

/// Returns the regions of a body at a pose with a fixed body at the origin.
[[nodiscard]] std::vector<Region> regions_of(const CompositeWorld& world, ShapeId fixed,
                                             ShapeId body, const Pose& pose, double margin) {
  Scene scene(world.shapes, {.contact_margin = margin, .composites = &world.composites});
  Key floor;
  Key key;
  floor = expect_ok(scene.add({.shape = fixed, .state = BodyState::fixed}));
  key = expect_ok(scene.add({.shape = body, .pose = pose}));
  Contacts contacts;
  EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  std::vector<Region> regions;
  for (std::uint32_t m = 0; m < contacts.manifolds(); ++m) {
    const double sign = contacts.a()[0] == floor ? 1.0 : -1.0;
    const Vec normal(contacts.normal(0)[m], contacts.normal(1)[m], contacts.normal(2)[m]);
    regions.push_back({sign * normal, contacts.distance()[m],
                       contacts.point_first()[m + 1] - contacts.point_first()[m]});
  }
  return regions;
}

/// Returns the signed distance of two convex bodies, and its normal, with the first at the origin.
[[nodiscard]] Region hull_contact(const ShapePool& shapes, ShapeId a, ShapeId b, const Pose& pose) {
  PairAnswer answer;
  EXPECT_EQ(collide(shapes, a, Pose{}, b, pose, {.level = ContactLevel::distance}, answer),
            Status::ok);
  return {answer.normal, answer.distance, 0};
}

/// The gap of two convex shapes along a unit direction, with the first at the origin.
[[nodiscard]] double gap_along(const ShapeTables& tables, ShapeId a, ShapeId b, const Pose& pose,
                               const Vec& normal) {
  const Eigen::Matrix3d turn = rotation_of(scale_to_unit_max(pose.orientation));
  const double top = mid::extent(tables, a, normal).high;
  const double bottom = mid::extent(tables, b, turn.transpose() * normal).low;
  return normal.dot(as_eigen(pose.position)) + bottom - top;
}

/// The triangles of a box, wound outward.
[[nodiscard]] Surface box_surface(const Vec& half) {
  Surface surface;
  for (int i = 0; i < 8; ++i) {
    const Vec corner((i & 1) != 0 ? half.x() : -half.x(), (i & 2) != 0 ? half.y() : -half.y(),
                     (i & 4) != 0 ? half.z() : -half.z());
    surface.vertices.push_back(corner.cast<float>());
  }
  surface.corners = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                     2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return surface;
}

/// The convex hull of random points on the unit sphere, by brute force, wound outward.
[[nodiscard]] Surface ball_surface(Random& random, std::size_t points) {
  Surface surface;
  for (std::size_t i = 0; i < points; ++i) {
    Vec at(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    surface.vertices.push_back(at.normalized().cast<float>());
  }
  const auto at = [&](std::size_t i) -> Vec { return surface.vertices[i].cast<double>(); };
  for (std::uint32_t i = 0; i < points; ++i) {
    for (std::uint32_t j = 0; j < points; ++j) {
      for (std::uint32_t k = 0; k < points; ++k) {
        // Each triangle once: its first corner has the lowest number.
        if (i >= j || i >= k || j == k) continue;
        const Vec normal = (at(j) - at(i)).cross(at(k) - at(i));
        bool is_face = true;
        for (std::size_t l = 0; l < points && is_face; ++l) {
          is_face = l == i || l == j || l == k || normal.dot(at(l) - at(i)) < 0.0;
        }
        if (is_face) surface.corners.insert(surface.corners.end(), {i, j, k});
      }
    }
  }
  return surface;
}

[[nodiscard]] ShapeId add_hull(ShapePool& pool, const Surface& surface) {
  ShapeId id = expect_ok(pool.add_hull(std::span<const Point>(surface.vertices), 0.0));
  return id;
}

[[nodiscard]] Surface wound_inward(Surface surface) {
  for (std::size_t i = 0; i < surface.corners.size(); i += 3) {
    std::swap(surface.corners[i + 1], surface.corners[i + 2]);
  }
  return surface;
}

/// Returns the surface without shared vertices.
[[nodiscard]] Surface torn(const Surface& surface) {
  Surface out;
  for (const std::uint32_t corner : surface.corners) {
    out.vertices.push_back(surface.vertices[corner]);
  }
  out.corners.resize(out.vertices.size());
  std::iota(out.corners.begin(), out.corners.end(), 0U);
  return out;
}

/// Moves the pose along the normal of its contact until the distance is `distance`.
[[nodiscard]] Pose settled(const ShapePool& shapes, ShapeId a, ShapeId b, Pose pose,
                           double distance) {
  for (int step = 0; step < 20; ++step) {
    const Region contact = hull_contact(shapes, a, b, pose);
    const Vec move = (distance - contact.distance) * contact.normal;
    for (int axis = 0; axis < 3; ++axis) pose.position[axis] += move[axis];
  }
  return pose;
}

// Each region of the mesh has the distance that the hull has along the region's normal, and the
// deepest has that of the hull.
TEST(SurfaceContacts, convex_mesh_touches_like_its_hull) {
  Random random(41);
  for (std::size_t round = 0; round < scaled(150); ++round) {
    CompositeWorld world;
    ShapePool& shapes = world.shapes;
    const Vec half(random.uniform(0.2, 1), random.uniform(0.2, 1), random.uniform(0.1, 1));
    const Surface surface =
        random.chance(0.5) ? box_surface(half) : ball_surface(random, 6 + random.below(10));
    const ShapeId hull = add_hull(shapes, surface);
    ShapeId mesh;
    switch (random.below(3)) {
      case 0:
        mesh = add(world.composites, surface);
        break;
      case 1:
        mesh = add(world.composites, wound_inward(surface));
        break;
      default:
        mesh = add(world.composites, torn(surface));
        break;
    }
    const double r = random.uniform(0.1, 0.8);
    const double h = random.uniform(0.1, 0.8);
    const Surface other = ball_surface(random, 8);
    struct Body {
      ShapeId convex;
      ShapeId shape;
    };
    const ShapeId box = add(shapes, BoxShape{{r, h, 0.4}, 0.0});
    const ShapeId ball = add(shapes, SphereShape{r});
    const ShapeId capsule = add(shapes, CapsuleShape{0.5 * r, h});
    const ShapeId cylinder = add(shapes, CylinderShape{r, h, 0.0});
    const ShapeId points = add_hull(shapes, other);
    const Body bodies[] = {{box, box},         {ball, ball},
                           {capsule, capsule}, {cylinder, cylinder},
                           {points, points},   {points, add(world.composites, other)}};
    for (const Body& body : bodies) {
      Pose pose = random_pose(random, 2.5);
      if (random.chance(0.3)) pose.orientation[1] = pose.orientation[2] = pose.orientation[3] = 0.0;
      pose = settled(shapes, hull, body.convex, pose, -random.log_uniform(1e-5, 0.03));
      const Region right = hull_contact(shapes, hull, body.convex, pose);
      if (!(right.distance < 0.0)) continue;
      const std::vector<Region> regions = regions_of(world, mesh, body.shape, pose, 0.02);
      ASSERT_FALSE(regions.empty());
      const double slack = 2e-4 + 1e-3 * std::abs(right.distance);
      double deepest = regions[0].distance;
      for (const Region& region : regions) {
        deepest = std::min(deepest, region.distance);
        // A body that pokes through the far side of a thin mesh touches it from inside, too.
        if (region.distance > right.distance && region.normal.dot(right.normal) < 0.0) continue;
        EXPECT_GE(gap_along(shapes.tables(), hull, body.convex, pose, region.normal),
                  right.distance - slack)
            << "round " << round << " kind " << body.convex.kind_index() << " as "
            << body.shape.kind_index() << " normal " << region.normal.transpose() << " distance "
            << region.distance << " of " << right.distance;
      }
      EXPECT_GE(deepest, right.distance - slack) << "round " << round;
      // The triangles of two meshes may miss the deepest point.
      if (body.shape == body.convex) {
        EXPECT_LE(deepest, right.distance + slack);
      }
    }
  }
}

/// Expects one region, with a normal.
void expect_one(const std::vector<Region>& regions, const Vec& normal, double distance) {
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_LT((regions[0].normal - normal).norm(), 1e-6) << regions[0].normal.transpose();
  EXPECT_NEAR(regions[0].distance, distance, 1e-6);
}

/// A roof with its ridge along y at x = 0, with a slope on both sides.
[[nodiscard]] Surface roof(float slope) {
  Surface surface;
  for (const float x : {-4.0F, 0.0F, 4.0F}) {
    for (const float y : {-4.0F, 4.0F}) surface.vertices.emplace_back(x, y, -slope * std::abs(x));
  }
  surface.corners = {0, 2, 3, 0, 3, 1, 2, 4, 5, 2, 5, 3};
  return surface;
}

TEST(SurfaceContacts, box_that_slides_over_crest_touches_slope) {
  constexpr double kSlope = 0.2;
  const double angle = std::atan(kSlope);
  const Vec up(-std::sin(angle), 0.0, std::cos(angle));
  const Vec along(std::cos(angle), 0.0, std::sin(angle));
  CompositeWorld world;
  const ShapeId box = add(world.shapes, BoxShape{{0.4, 0.3, 0.2}, 0.0});
  const Surface surface = roof(static_cast<float>(kSlope));
  const ShapeId both = add(world.composites, surface);
  const ShapeId inward = add(world.composites, wound_inward(surface));
  const ShapeId apart = add(world.composites, torn(surface));
  ShapeId facing = expect_ok(world.composites.add_scaled(both, {1.0, 1.0, 1.0}));
  ASSERT_EQ(world.composites.set_one_sided(facing), Status::ok);
  for (const double beyond : {-0.002, 0.002, 0.005, 0.009, 0.012, 0.05}) {
    const Vec at = along * (beyond - 0.4) + up * 0.19 + Vec(0.0, 0.1, 0.0);
    Pose pose = Pose::at(at.x(), at.y(), at.z());
    pose.orientation[0] = std::cos(0.5 * angle);
    pose.orientation[2] = -std::sin(0.5 * angle);
    for (const ShapeId fixed : {both, inward, apart, facing}) {
      expect_one(regions_of(world, fixed, box, pose, 0.0), up, -0.01);
    }
  }
}

// The ridge is seen from both sides, as a mesh and as the valley of a field from below.
TEST(SurfaceContacts, ball_on_ridge_touches_once_from_either_side) {
  for (const float slope : {0.1F, 0.5F, 1.0F, 2.0F}) {
    CompositeWorld world;
    const ShapeId ball = add(world.shapes, SphereShape{0.5});
    const ShapeId fixed[] = {add(world.composites, roof(slope)),
                             add(world.composites, wound_inward(roof(slope)))};
    for (const double depth : {0.01, 0.1}) {
      for (const double x : {0.0, 0.01}) {
        const Vec at(x, 0.1, 0.5 - depth);
        const Vec from_ridge(x, 0.0, 0.5 - depth);
        for (const ShapeId id : fixed) {
          expect_one(regions_of(world, id, ball, Pose::at(at.x(), at.y(), at.z()), 0.0),
                     from_ridge.normalized(), from_ridge.norm() - 0.5);
        }
      }
    }
  }
}

TEST(SurfaceContacts, scaled_mesh_touches_like_scaled_vertices) {
  for (const float slope : {0.005F, 0.009F, 0.05F}) {
    for (const double scale : {1.0, 10.0, 100.0, 400.0}) {
      CompositeWorld world;
      const ShapeId ball = add(world.shapes, SphereShape{0.5});
      const ShapeId flat = add(world.composites, roof(slope));
      ShapeId scaled_roof = expect_ok(world.composites.add_scaled(flat, {1.0, 1.0, scale}));
      const ShapeId direct = add(world.composites, roof(slope * static_cast<float>(scale)));
      const Pose pose = Pose::at(0.02, 0.1, 0.45);
      const std::vector<Region> right = regions_of(world, direct, ball, pose, 0.0);
      const std::vector<Region> found = regions_of(world, scaled_roof, ball, pose, 0.0);
      ASSERT_EQ(right.size(), found.size());
      for (std::size_t i = 0; i < right.size(); ++i) {
        EXPECT_LT((right[i].normal - found[i].normal).norm(), 1e-5);
        EXPECT_NEAR(right[i].distance, found[i].distance, 1e-6);
      }
    }
  }
}

// The slab is two-sided and one-sided; the seam of the floor is near its border.
TEST(SurfaceContacts, slab_on_seam_touches_up) {
  CompositeWorld world;
  const ShapeId slab = add(world.composites, box_surface({0.45, 0.45, 0.05}));
  const ShapeId box = add(world.shapes, BoxShape{{5.0, 5.0, 0.5}, 0.0});
  const Vec up = Vec::UnitZ();
  for (const float seam : {0.4505F, 0.4495F, 0.449F, 0.44F, 0.0F}) {
    Surface quads;
    quads.vertices = {{-5, -5, 0.5F}, {seam, -5, 0.5F}, {seam, 5, 0.5F},
                      {-5, 5, 0.5F},  {5, -5, 0.5F},    {5, 5, 0.5F}};
    quads.corners = {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2};
    const ShapeId floor = add(world.composites, quads);
    for (const double gap : {5e-4, 1e-4, -1e-4, -1e-3, -5e-3, -0.02}) {
      const Pose pose = Pose::at(0.0, 0.0, 0.55 + gap);
      for (const ShapeId fixed : {floor, box}) {
        expect_one(regions_of(world, fixed, slab, pose, 1e-3), up, gap);
      }
    }
  }
}

/// A flat floor around the origin, at height 0.
struct Floor {
  std::string name;
  ShapeId shape;
};

/// Floors of squares of side `side` in all the ways in which a floor can be made of triangles.
[[nodiscard]] std::vector<Floor> flat_floors(CompositePool& pool, float side, Random& random) {
  const auto flat = [](float, float) { return 0.0F; };
  const Surface even = grid(24, side, Cut::random, flat);
  const ShapeId mesh = add(pool, even);
  std::vector<Floor> floors{{"mesh", mesh},
                            {"mesh wound inward", add(pool, wound_inward(even))},
                            {"mesh without shared vertices", add(pool, torn(even))}};
  ShapeId id = expect_ok(pool.add_scaled(mesh, {1.3, -0.7, 2.0}));
  floors.push_back({"mirrored mesh", id});
  id = expect_ok(pool.add_scaled(mesh, {1.0, 1.0, 1.0}));
  EXPECT_EQ(pool.set_one_sided(id), Status::ok);
  floors.push_back({"one-sided mesh", id});
  // Rows of squares that are shifted against each other.
  Surface rows;
  for (int row = -10; row < 10; ++row) {
    const auto shift = static_cast<float>(random.uniform(0.0, static_cast<double>(side)));
    for (int column = -11; column < 10; ++column) {
      const auto first = static_cast<std::uint32_t>(rows.vertices.size());
      const float x = side * static_cast<float>(column) + shift;
      const float y = side * static_cast<float>(row);
      const float end[2] = {x + side, side * static_cast<float>(row + 1)};
      rows.vertices.insert(rows.vertices.end(),
                           {{x, y, 0}, {end[0], y, 0}, {end[0], end[1], 0}, {x, end[1], 0}});
      for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) rows.corners.push_back(first + k);
    }
  }
  floors.push_back({"mesh with T-junctions", add(pool, rows)});
  return floors;
}

TEST(SurfaceContacts, bodies_that_slide_on_flat_surfaces_touch_up) {
  Random random(42);
  for (std::size_t round = 0; round < scaled(40); ++round) {
    CompositeWorld world;
    const auto side = static_cast<float>(random.log_uniform(0.07, 3.0));
    const std::vector<Floor> floors = flat_floors(world.composites, side, random);
    const double x = random.uniform(0.2, 0.5);
    const double y = random.uniform(0.2, 0.5);
    const double z = random.uniform(0.05, 0.5);
    const Surface surface = box_surface({x, y, z});
    const auto height = static_cast<double>(static_cast<float>(z));
    const ShapeId box = add(world.shapes, BoxShape{{x, y, height}, 0.0});
    ShapeId compound;
    const CompoundChild child[] = {{box, Pose{}}};
    compound = expect_ok(world.composites.add_compound(child));
    const ShapeId bodies[] = {box,
                              compound,
                              add(world.shapes, CylinderShape{x, height, 0.0}),
                              add(world.shapes, SphereShape{height}),
                              add_hull(world.shapes, surface),
                              add(world.composites, surface)};
    for (const Floor& floor : floors) {
      for (const ShapeId body : bodies) {
        const double margin = random.chance(0.5) ? 0.0 : 0.02;
        const double depth = random.log_uniform(1e-5, 0.02);
        const double turn = random.chance(0.3) ? 0.0 : random.uniform(-1.5, 1.5);
        const double reach = static_cast<double>(side);
        Vec at(random.uniform(-reach, reach), random.uniform(-reach, reach), height - depth);
        const Vec step(random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05), 0.0);
        for (int frame = 0; frame < 5; ++frame, at += step) {
          Pose pose = Pose::at(at.x(), at.y(), at.z());
          pose.orientation[0] = std::cos(turn);
          pose.orientation[3] = std::sin(turn);
          SCOPED_TRACE(floor.name + ", kind " + std::to_string(body.kind_index()));
          const std::vector<Region> regions = regions_of(world, floor.shape, body, pose, margin);
          ASSERT_FALSE(regions.empty());
          for (const Region& region : regions) {
            EXPECT_GT(region.normal.z(), 1.0 - 1e-6) << region.normal.transpose();
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace winnow::test
