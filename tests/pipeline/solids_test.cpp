// Closed meshes as solids (CompositePool::set_solid): inside tests compared with winding numbers,
// and the effect on queries.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/core/pose.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/scene_queries.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory_resource>
#include <numbers>
#include <span>
#include <vector>

#include "core/numbers/rotation.h"
#include "tests/pipeline/query_world.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Vec = Eigen::Vector3d;
using LongVec = Eigen::Matrix<long double, 3, 1>;

/// Returns the winding number of a mesh around a point of its frame, as the sum of solid angles.
long double winding(const MeshData& mesh, const Vec& point) {
  long double sum = 0.0L;
  for (std::size_t t = 0; t < mesh.triangles(); ++t) {
    LongVec corner[3];
    long double length[3];
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] =
          mesh.vertices[mesh.corners[3 * t + k]].cast<long double>() - point.cast<long double>();
      length[k] = corner[k].norm();
    }
    const long double under =
        length[0] * length[1] * length[2] + corner[0].dot(corner[1]) * length[2] +
        corner[1].dot(corner[2]) * length[0] + corner[2].dot(corner[0]) * length[1];
    sum += 2.0L * std::atan2(corner[0].dot(corner[1].cross(corner[2])), under);
  }
  return sum / (4.0L * std::numbers::pi_v<long double>);
}

/// Returns true if eight points around `point` have different winding numbers.
bool is_on_surface(const MeshData& mesh, const Vec& point) {
  long least = 1;
  long greatest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec beside(corner & 1 ? 3e-7 : -3e-7, corner & 2 ? 5e-7 : -5e-7,
                     corner & 4 ? 2e-7 : -2e-7);
    const long around = std::lround(winding(mesh, point + beside));
    least = std::min(least, around);
    greatest = std::max(greatest, around);
  }
  return least != greatest;
}

/// A cube with edges of length 2 around the origin: twelve triangles wound outward.
MeshData cube() {
  MeshData mesh{"cube", {}, {}};
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back(i & 1 ? 1.0F : -1.0F, i & 2 ? 1.0F : -1.0F, i & 4 ? 1.0F : -1.0F);
  }
  mesh.corners = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return mesh;
}

/// Returns the same triangles without shared vertices.
MeshData split(const MeshData& mesh) {
  MeshData result{mesh.name, {}, {}};
  for (const std::uint32_t corner : mesh.corners) {
    result.corners.push_back(static_cast<std::uint32_t>(result.vertices.size()));
    result.vertices.push_back(mesh.vertices[corner]);
  }
  return result;
}

ShapeId add(CompositePool& pool, const MeshData& mesh) {
  ShapeId id = expect_ok(pool.add_mesh(mesh.points(), mesh.indices()));
  return id;
}

TEST(Solids, only_closed_outward_meshes_can_be_solid) {
  ShapePool shapes;
  CompositePool pool(shapes);
  for (const MeshData& mesh : {cube(), torus(12, 7), gear(9)}) {
    const ShapeId id = add(pool, mesh);
    EXPECT_FALSE(pool.is_solid(id));
    EXPECT_EQ(pool.set_solid(id), Status::ok) << mesh.name;
    EXPECT_TRUE(pool.is_solid(id));
    ShapeId mirrored = expect_ok(pool.add_scaled(id, {1.0, -2.0, 3.0}));
    EXPECT_FALSE(pool.is_solid(mirrored)) << "each id has its own flag";
    EXPECT_EQ(pool.set_solid(mirrored), Status::ok);
    EXPECT_EQ(pool.set_solid(id, false), Status::ok);
    EXPECT_FALSE(pool.is_solid(id));
    EXPECT_TRUE(pool.is_solid(mirrored));
    EXPECT_EQ(pool.set_solid(add(pool, split(mesh))), Status::ok)
        << "coincident vertices count as one";
    MeshData inward = mesh;
    for (std::size_t t = 0; t < inward.triangles(); ++t) {
      std::swap(inward.corners[3 * t], inward.corners[3 * t + 1]);
    }
    EXPECT_EQ(pool.set_solid(add(pool, inward)), Status::invalid_shape);
    MeshData one_turned = mesh;
    std::swap(one_turned.corners[0], one_turned.corners[1]);
    EXPECT_EQ(pool.set_solid(add(pool, one_turned)), Status::invalid_shape);
    MeshData open = mesh;
    open.corners.resize(open.corners.size() - 3);
    EXPECT_EQ(pool.set_solid(add(pool, open)), Status::invalid_shape);
    MeshData with_segment = mesh;
    with_segment.corners.insert(with_segment.corners.end(), {0, 1, 1});
    EXPECT_EQ(pool.set_solid(add(pool, with_segment)), Status::ok)
        << "degenerate triangles are ignored";
  }
  for (const MeshData& mesh : {terrain(4), thin_sheets(3), degenerate_soup(60, 3)}) {
    EXPECT_EQ(pool.set_solid(add(pool, mesh)), Status::invalid_shape) << mesh.name;
  }
}

TEST(Solids, only_meshes_can_be_solid) {
  ShapePool shapes;
  CompositePool pool(shapes);
  ShapeId ball;
  ShapeId field;
  ShapeId compound;
  ball = expect_ok(shapes.add(SphereShape{1.0}));
  const std::vector<float> heights(4, 0.0F);
  field = expect_ok(pool.add_height_field({heights, 2, 2, 0, {1.0, 1.0}}));
  const std::array children{CompoundChild{ball, {}}};
  compound = expect_ok(pool.add_compound(children));
  const ShapeId removed = add(pool, cube());
  ASSERT_EQ(pool.set_solid(removed), Status::ok);
  ASSERT_EQ(pool.remove(removed), Status::ok);
  for (const ShapeId id : {ball, field, compound, removed, ShapeId{}}) {
    EXPECT_EQ(pool.set_solid(id), Status::invalid_key);
    EXPECT_FALSE(pool.is_solid(id));
  }
  EXPECT_FALSE(pool.is_solid(add(pool, cube()))) << "a reused id starts without the flag";
}

/// Returns random points, points on a lattice whose planes contain vertices and edges, and
/// midpoints of vertices.
std::vector<Vec> points_about(const MeshData& mesh, Random& random) {
  std::vector<Vec> points;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex.cast<double>());
  const Vec size = box.sizes();
  for (std::size_t i = 0; i < scaled(600); ++i) {
    Vec point;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = box.min()[axis] - 0.2 * size[axis];
      point[axis] = random.uniform(low, low + 1.4 * size[axis]);
      if (i % 3 == 1) point[axis] = 0.25 * std::round(4.0 * point[axis]);
    }
    if (i % 3 == 2) {
      const auto vertex = [&] {
        return mesh.vertices[random.below(mesh.vertices.size())].cast<double>();
      };
      point = 0.5 * (vertex() + vertex());
    }
    points.push_back(point);
  }
  return points;
}

TEST(Solids, inside_test_matches_winding_number) {
  Random random(1);
  ShapePool shapes;
  CompositePool pool(shapes);
  std::size_t inside = 0;
  std::size_t outside = 0;
  for (const MeshData& mesh : {cube(), torus(16, 9), gear(11)}) {
    const ShapeId id = add(pool, mesh);
    const Vec3d scales[] = {{1.0, 1.0, 1.0}, {3.0, -0.5, 2.0}};
    for (const auto& scale : scales) {
      ShapeId scaled_id = expect_ok(pool.add_scaled(id, scale));
      ASSERT_EQ(pool.set_solid(scaled_id), Status::ok);
      const std::array children{CompoundChild{scaled_id, Pose::at(0.5, -2.0, 1.0)}};
      ShapeId compound = expect_ok(pool.add_compound(children));
      for (const Vec& own : points_about(mesh, random)) {
        // Skip points so near the surface that the pose may move them across.
        if (is_on_surface(mesh, own)) continue;
        const bool is_inside = std::lround(winding(mesh, own)) != 0;
        const Pose pose = random_pose(random.chance(0.5) ? 10.0 : 1e5, random);
        const Eigen::Matrix3d turn = rotation_of(scale_to_unit_max(pose.orientation));
        const Vec stretched = own.cwiseProduct(Vec::Map(scale.data()));
        const Vec world = as_eigen(pose.position) + turn * stretched;
        (is_inside ? inside : outside) += 1;
        ASSERT_EQ(mid::solid_contains_point(pool, scaled_id, pose, world), is_inside)
            << mesh.name << " " << own.transpose();
        const Vec in_child = world + turn * Vec(0.5, -2.0, 1.0);
        ASSERT_EQ(mid::solid_contains_point(pool, compound, pose, in_child), is_inside)
            << mesh.name;
      }
    }
  }
  EXPECT_GT(inside, scaled(300));
  EXPECT_GT(outside, scaled(300));
}

/// Two bodies with the same mesh: one is solid, the other one is not.
struct SolidWorld {
  explicit SolidWorld(const MeshData& mesh) : composites(shapes) {
    const ShapeId surface = add(composites, mesh);
    solid = expect_ok(composites.add_scaled(surface, {1.0, 1.0, 1.0}));
    EXPECT_EQ(composites.set_solid(solid), Status::ok);
    plain_key = expect_ok(scene.add({.shape = surface, .pose = pose}));
    solid_key = expect_ok(scene.add({.shape = solid, .pose = pose}));
  }
  Key put(ShapeId shape, const Pose& at) {
    Key key = expect_ok(scene.add({.shape = shape, .pose = at}));
    EXPECT_EQ(scene.refresh(), Status::ok);
    return key;
  }

  ShapePool shapes;
  CompositePool composites;
  Scene scene{shapes, {.composites = &composites}};
  Pose pose = Pose::at(5.0, -3.0, 2.0);
  ShapeId solid;
  Key plain_key;
  Key solid_key;
};

TEST(Solids, distance_of_inner_points_is_negative) {
  Random random(2);
  const MeshData mesh = torus(16, 9);
  SolidWorld world(mesh);
  ASSERT_EQ(world.scene.refresh(), Status::ok);
  SceneQueries queries(world.scene);
  std::size_t inside = 0;
  for (const Vec& own : points_about(mesh, random)) {
    const Vec point = own + as_eigen(world.pose.position);
    std::span<const SceneDistance> found = expect_ok(queries.nearest(point, 2, kInfinity));
    ASSERT_EQ(found.size(), 2U);
    const SceneDistance solid = found[found[0].key == world.solid_key ? 0 : 1];
    const SceneDistance plain = found[found[0].key == world.solid_key ? 1 : 0];
    ASSERT_EQ(solid.part, plain.part);
    if (plain.distance < 1e-9) continue;  // on the surface
    const bool is_contained =
        mid::solid_contains_point(world.composites, world.solid, world.pose, point);
    ASSERT_EQ(solid.distance, is_contained ? -plain.distance : plain.distance);
    ASSERT_EQ(solid.normal[0], is_contained ? -plain.normal[0] : plain.normal[0]);
    ASSERT_EQ(solid.point_b[2], plain.point_b[2]);
    if (!is_contained || plain.distance < 0.01) continue;
    ++inside;
    ASSERT_EQ(found[0].key, world.solid_key);
    found = expect_ok(queries.nearest(point, 2, 0.5 * plain.distance));
    ASSERT_EQ(found.size(), 1U) << "a point inside is within any radius";
    ASSERT_EQ(found[0].distance, solid.distance);
  }
  EXPECT_GT(inside, scaled(50));
}

TEST(Solids, solid_cube_matches_box) {
  Random random(3);
  SolidWorld world(cube());
  ShapeId box = expect_ok(world.shapes.add(BoxShape{{1.0, 1.0, 1.0}}));
  const Key convex = world.put(box, world.pose);
  SceneQueries queries(world.scene);
  for (std::size_t i = 0; i < scaled(200); ++i) {
    const double point[3] = {5.0 + random.uniform(-1.5, 1.5), -3.0 + random.uniform(-1.5, 1.5),
                             2.0 + random.uniform(-1.5, 1.5)};
    std::span<const SceneDistance> found = expect_ok(queries.nearest(point, 3, kInfinity));
    double distance[2] = {1.0, -1.0};
    for (const SceneDistance& one : found) {
      if (one.key == convex) distance[0] = one.distance;
      if (one.key == world.solid_key) distance[1] = one.distance;
    }
    ASSERT_NEAR(distance[0], distance[1], 1e-12);
  }
}

TEST(Solids, contained_shapes_overlap_solid) {
  SolidWorld world(cube());
  ShapeId shapes[3];
  shapes[0] = expect_ok(world.shapes.add(SphereShape{0.25}));
  const std::vector<Vec3d> off_origin{
      {7.0, 0.0, 0.0}, {7.5, 0.0, 0.0}, {7.0, 0.5, 0.0}, {7.0, 0.0, 0.5}};
  shapes[1] = expect_ok(world.shapes.add_hull(off_origin, 0.0));
  MeshData small = cube();
  for (Eigen::Vector3f& vertex : small.vertices) vertex *= 0.25F;
  shapes[2] = add(world.composites, small);
  const std::array children{CompoundChild{shapes[1], Pose::at(-7.0, 0.0, 0.0)},
                            CompoundChild{shapes[2], {}}};
  ShapeId compound = expect_ok(world.composites.add_compound(children));
  const Pose within[] = {Pose::at(5.0, -3.0, 2.25), Pose::at(-2.25, -3.25, 2.0),
                         Pose::at(5.0, -3.25, 2.0), Pose::at(5.0, -3.0, 2.0)};
  const ShapeId all[] = {shapes[0], shapes[1], shapes[2], compound};
  for (int i = 0; i < 4; ++i) {
    const Key key = world.put(all[i], within[i]);
    SceneQueries queries(world.scene);
    std::span<const SceneOverlap> overlaps = expect_ok(queries.overlap(all[i], within[i]));
    const auto has_overlap = [&](Key other) {
      return std::any_of(overlaps.begin(), overlaps.end(),
                         [&](const SceneOverlap& one) { return one.key == other; });
    };
    EXPECT_TRUE(has_overlap(world.solid_key)) << i;
    EXPECT_FALSE(has_overlap(world.plain_key)) << i;
    SceneDistance plain;
    SceneDistance solid;
    SceneDistance back;
    plain = expect_ok(queries.distance(key, world.plain_key));
    solid = expect_ok(queries.distance(key, world.solid_key));
    back = expect_ok(queries.distance(world.solid_key, key));
    EXPECT_GT(plain.distance, 0.1) << i;
    EXPECT_NEAR(solid.distance, -1.0, 1e-12) << i << ": the way out is longer than the gap";
    EXPECT_NEAR(back.distance, -1.0, 1e-12) << i;
    solid = expect_ok(queries.distance(key, world.solid_key, -10.0));
    EXPECT_FALSE(solid) << "the limit is below the distance";
    const Key one[] = {key};
    const Key both[] = {world.plain_key, world.solid_key};
    std::span<const KeyPair> pairs = expect_ok(queries.overlaps(one, both));
    ASSERT_EQ(pairs.size(), 1U) << i;
    EXPECT_EQ(pairs[0].second, world.solid_key);
    SetDistance least = expect_ok(queries.least_distance(one, both));
    EXPECT_EQ(least.to.key, world.solid_key) << i;
  }
}

TEST(Solids, shapes_outside_do_not_overlap_solid) {
  const MeshData mesh = torus(16, 9);
  SolidWorld world(mesh);
  ShapeId ball = expect_ok(world.shapes.add(SphereShape{0.5}));
  ShapeId ground = expect_ok(world.shapes.add(HalfSpaceShape{{0.0, 0.0, 1.0}, 0.0}));
  SceneQueries queries(world.scene);
  ASSERT_EQ(world.scene.refresh(), Status::ok);
  std::span<const SceneOverlap> overlaps = expect_ok(queries.overlap(ball, world.pose));
  EXPECT_TRUE(overlaps.empty()) << "in the hole";
  overlaps = expect_ok(queries.overlap(ground, {}));
  EXPECT_TRUE(overlaps.empty()) << "above";
}

TEST(Solids, snapshot_keeps_solid_flag) {
  ShapePool shapes;
  CompositePool pool(shapes);
  const ShapeId mesh = add(pool, cube());
  Column<std::byte> without(std::pmr::get_default_resource());
  ASSERT_EQ(pool.save(without), Status::ok);
  ASSERT_EQ(pool.set_solid(mesh), Status::ok);
  Column<std::byte> with(std::pmr::get_default_resource());
  ASSERT_EQ(pool.save(with), Status::ok);
  CompositePool other(shapes);
  ASSERT_EQ(other.load({with.data(), with.size()}), Status::ok);
  EXPECT_TRUE(other.is_solid(mesh));
  ASSERT_EQ(other.load({without.data(), without.size()}), Status::ok);
  EXPECT_FALSE(other.is_solid(mesh));
}

TEST(Solids, changed_solid_flag_requires_refresh) {
  SolidWorld world(cube());
  ASSERT_EQ(world.scene.refresh(), Status::ok);
  SceneQueries queries(world.scene);
  ASSERT_EQ(world.composites.set_solid(world.solid, false), Status::ok);
  const double point[3] = {5.0, -3.0, 2.0};
  expect_error(queries.nearest(point, 1, 10.0), Status::invalid_argument);
  ASSERT_EQ(world.scene.refresh(), Status::ok);
  EXPECT_EQ(expect_ok(queries.nearest(point, 1, 10.0))[0].distance, 1.0);
}

}  // namespace
}  // namespace winnow::test
