// Solid meshes as bodies: convex ones equal their hulls, and others have the depth of a translation
// that parts them, with bounds.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/core/pose.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/scene_queries.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/numbers/rotation.h"
#include "tests/pipeline/query_world.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Vec = Eigen::Vector3d;

/// A polygon in the plane z = 0, counter-clockwise, extruded from z = -1 to 1. The faces are cut
/// into triangles from corner 0, which must see all others.
MeshData prism(const std::vector<Eigen::Vector2f>& outline) {
  MeshData mesh{"prism", {}, {}};
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const float z : {-1.0F, 1.0F}) {
    for (const Eigen::Vector2f& at : outline) mesh.vertices.emplace_back(at.x(), at.y(), z);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    if (i != 0 && next != 0) {
      mesh.corners.insert(mesh.corners.end(), {0, next, i, n, n + i, n + next});
    }
    mesh.corners.insert(mesh.corners.end(), {i, next, n + i, next, n + next, n + i});
  }
  return mesh;
}

/// A regular polygon of radius 1 as a prism.
MeshData round_prism(int sides) {
  std::vector<Eigen::Vector2f> outline;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    outline.emplace_back(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
  }
  return prism(outline);
}

/// An L of arms that are 1 wide and 3 long, whose reflex edge is x = y = 0.
MeshData angle_iron() {
  return prism({{0, 0}, {0, 2}, {-1, 2}, {-1, -1}, {2, -1}, {2, 0}});
}

/// Turns the vertices and rounds them to float, so that no face is exactly flat.
MeshData turned(MeshData mesh, Random& random) {
  const Eigen::Matrix3f turn =
      rotation_of(scale_to_unit_max(random_pose(1.0, random).orientation)).cast<float>();
  for (Eigen::Vector3f& vertex : mesh.vertices) vertex = turn * vertex;
  return mesh;
}

struct SolidPool {
  ShapeId solid(const MeshData& mesh, const Vec3d& scale = {1.0, 1.0, 1.0}) {
    const ShapeId id = expect_ok(composites.add_scaled(
        expect_ok(composites.add_mesh(mesh.points(), mesh.indices())), scale));
    EXPECT_EQ(composites.set_solid(id), Status::ok) << mesh.name;
    return id;
  }
  ShapeId hull(const MeshData& mesh, const Vec3d& scale = {1.0, 1.0, 1.0}) {
    std::vector<Vec3d> points;
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      points.emplace_back(Vec(vertex.cast<double>().cwiseProduct(Vec::Map(scale.data()))));
    }
    return expect_ok(shapes.add_hull(points));
  }

  ShapePool shapes;
  CompositePool composites{shapes};
};

/// The distance of two shapes, the first at the origin.
SceneDistance distance_of(const SolidPool& pool, ShapeId a, ShapeId b, const Pose& pose) {
  Scene scene(pool.shapes, {.composites = &pool.composites});
  const Key keys[] = {expect_ok(scene.add({.shape = a})),
                      expect_ok(scene.add({.shape = b, .pose = pose}))};
  EXPECT_EQ(scene.refresh(), Status::ok);
  return expect_ok(SceneQueries(scene).distance(keys[0], keys[1]));
}

bool do_overlap(const SolidPool& pool, ShapeId a, ShapeId b, const Pose& pose) {
  Scene scene(pool.shapes, {.composites = &pool.composites});
  expect_ok(scene.add({.shape = a}));
  EXPECT_EQ(scene.refresh(), Status::ok);
  return !expect_ok(SceneQueries(scene).overlap(b, pose)).empty();
}

Pose moved(Pose pose, const Vec& by) {
  as_eigen(pose.position) += by;
  return pose;
}

TEST(SolidDepth, convex_solid_equals_its_hull) {
  Random random(1);
  SolidPool pool;
  const MeshData box = round_prism(4);
  const Vec3d scales[] = {{1.0, 1.0, 1.0}, {0.5, -2.0, 1.5}};
  const ShapeId others[] = {expect_ok(pool.shapes.add(SphereShape{0.4})),
                            expect_ok(pool.shapes.add(BoxShape{{0.5, 0.3, 0.7}})),
                            pool.hull(round_prism(5)), pool.solid(round_prism(6))};
  for (const MeshData& mesh : {box, round_prism(32), turned(box, random)}) {
    for (const auto& scale : scales) {
      const ShapeId solid = pool.solid(mesh, scale);
      const ShapeId hull = pool.hull(mesh, scale);
      for (const ShapeId other : others) {
        for (std::size_t i = 0; i < scaled(60); ++i) {
          const Pose pose = random_pose(1.5, random);
          const SceneDistance got = distance_of(pool, solid, other, pose);
          const SceneDistance right = distance_of(pool, hull, other, pose);
          ASSERT_NEAR(got.distance, right.distance, 2e-6) << mesh.name;
          if (right.distance > 0.0) continue;
          const Vec out = as_eigen(got.normal) * (1e-5 - got.distance);
          ASSERT_FALSE(do_overlap(pool, hull, other, moved(pose, out)));
        }
      }
    }
  }
}

TEST(SolidDepth, convex_solid_has_contacts_of_its_hull) {
  Random random(2);
  SolidPool pool;
  const MeshData mesh = turned(round_prism(4), random);
  const ShapeId other = expect_ok(pool.shapes.add(BoxShape{{3.0, 3.0, 0.5}}));
  for (const ShapeId shape : {pool.solid(mesh), pool.hull(mesh)}) {
    Scene scene(pool.shapes, {.composites = &pool.composites});
    expect_ok(scene.add({.shape = shape}));
    expect_ok(scene.add({.shape = other, .pose = Pose::at(0.0, 0.0, 1.2)}));
    Contacts contacts;
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    ASSERT_EQ(contacts.size(), 1U);
    ASSERT_EQ(contacts.manifolds(), 1U);
    EXPECT_LT(contacts.distance()[0], 0.0);
    EXPECT_EQ(contacts.part_a()[0], kWholeShape);
  }
}

TEST(SolidDepth, face_of_turned_solid_touches_at_four_points) {
  Random random(3);
  SolidPool pool;
  MeshData mesh = round_prism(4);
  const Pose pose = random_pose(1.0, random);
  const Eigen::Matrix3d turn = rotation_of(scale_to_unit_max(pose.orientation));
  for (Eigen::Vector3f& vertex : mesh.vertices) vertex = turn.transpose().cast<float>() * vertex;
  const ShapeId floor = expect_ok(pool.shapes.add(HalfSpaceShape{{0.0, 0.0, 1.0}, -0.999}));
  Scene scene(pool.shapes, {.composites = &pool.composites});
  expect_ok(scene.add({.shape = floor, .state = BodyState::fixed}));
  expect_ok(scene.add({.shape = pool.solid(mesh), .pose = {{}, pose.orientation}}));
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  ASSERT_EQ(contacts.manifolds(), 1U);
  EXPECT_EQ(contacts.points(), 4U);
}

TEST(SolidDepth, refit_to_concave_mesh_keeps_solid_right) {
  SolidPool pool;
  const MeshData square = prism({{-1, -1}, {1, -1}, {1, 1}, {0, 1}, {-1, 1}});
  MeshData notched = square;
  notched.vertices[3].y() = notched.vertices[8].y() = -0.5F;
  const ShapeId id = pool.solid(square);
  const ShapeId ball = expect_ok(pool.shapes.add(SphereShape{0.1}));
  const Pose in_notch = Pose::at(0.0, 0.5, 0.0);
  EXPECT_TRUE(do_overlap(pool, id, ball, in_notch));
  ASSERT_EQ(pool.composites.refit_mesh(id, notched.points()), Status::ok);
  EXPECT_FALSE(do_overlap(pool, id, ball, in_notch));
  ASSERT_EQ(pool.composites.refit_mesh(id, square.points()), Status::ok);
  EXPECT_TRUE(do_overlap(pool, id, ball, in_notch));
}

TEST(SolidDepth, footprint_of_hulls_is_exact) {
  ShapePool shapes;
  CountingMemory memory;
  CompositePool pool(shapes, &memory);
  const MeshData mesh = round_prism(6);
  const ShapeId solids[] = {expect_ok(pool.add_mesh(mesh.points(), mesh.indices())),
                            expect_ok(pool.add_mesh(mesh.points(), mesh.indices()))};
  for (const ShapeId id : solids) ASSERT_EQ(pool.set_solid(id), Status::ok);
  EXPECT_EQ(pool.footprint().total().reserved, memory.outstanding());
  ASSERT_EQ(pool.set_solid(solids[0], false), Status::ok);
  EXPECT_EQ(pool.footprint().total().reserved, memory.outstanding());
  ASSERT_EQ(pool.remove(solids[1]), Status::ok);
  EXPECT_EQ(pool.footprint().total().reserved, memory.outstanding());
}

TEST(SolidDepth, pyramid_that_winds_twice_is_not_convex) {
  MeshData mesh{"pentagram", {}, {}};
  for (int i = 0; i < 5; ++i) {
    const double angle = 4.0 * std::numbers::pi * i / 5.0;
    mesh.vertices.emplace_back(static_cast<float>(std::cos(angle)),
                               static_cast<float>(std::sin(angle)), 0.0F);
  }
  mesh.vertices.emplace_back(0.0F, 0.0F, 1.0F);
  mesh.vertices.emplace_back(0.0F, 0.0F, -1.0F);
  for (std::uint32_t i = 0; i < 5; ++i) {
    mesh.corners.insert(mesh.corners.end(), {i, (i + 1) % 5, 5, (i + 1) % 5, i, 6});
  }
  SolidPool pool;
  const ShapeId id = pool.solid(mesh);
  const ShapeId ball = expect_ok(pool.shapes.add(SphereShape{0.02}));
  const double between = std::numbers::pi / 5.0;
  const Pose beside = Pose::at(0.7 * std::cos(between), 0.7 * std::sin(between), 0.0);
  EXPECT_FALSE(do_overlap(pool, id, ball, beside)) << "between two points of the star";
  EXPECT_TRUE(do_overlap(pool, id, ball, Pose::at(0.0, 0.0, 0.3)));
}

TEST(SolidDepth, ball_that_sinks_gets_steadily_deeper) {
  SolidPool pool;
  const ShapeId ball = expect_ok(pool.shapes.add(SphereShape{0.3}));
  const MeshData square = prism({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});
  for (const ShapeId solid : {pool.solid(angle_iron()), pool.solid(square)}) {
    for (const Vec& way : {Vec(0.0, 0.0, 1.0), Vec(-1.0, 0.0, 0.0)}) {
      for (double depth = 0.0; depth <= 0.7; depth += 0.05) {
        const Pose pose = moved(Pose::at(-0.45, -0.4, 0.0), way * 10.0);
        const double start = distance_of(pool, solid, ball, pose).distance;
        const SceneDistance got =
            distance_of(pool, solid, ball, moved(pose, -way * (start + depth)));
        // Near the other side of an arm, the shorter way leads there.
        if (depth > 0.55) continue;
        ASSERT_NEAR(got.distance, -depth, 1e-6);
        ASSERT_NEAR(as_eigen(got.normal).dot(way), 1.0, 1e-3);
        ASSERT_LE(got.error_bound, 1e-6);
      }
    }
  }
}

TEST(SolidDepth, reported_translation_parts_concave_solids) {
  Random random(4);
  SolidPool pool;
  const ShapeId iron = pool.solid(angle_iron());
  const ShapeId others[] = {expect_ok(pool.shapes.add(SphereShape{0.5})),
                            expect_ok(pool.shapes.add(BoxShape{{0.5, 0.3, 0.7}})),
                            pool.solid(angle_iron(), {0.5, 0.7, -0.4}),
                            pool.solid(torus(12, 7), {0.3, 0.3, 0.3})};
  std::size_t overlapping = 0;
  for (std::size_t i = 0; i < scaled(150); ++i) {
    const ShapeId other = others[i % 4];
    const Pose pose = random_pose(2.0, random);
    const SceneDistance got = distance_of(pool, iron, other, pose);
    ASSERT_EQ(got.distance <= 0.0, do_overlap(pool, iron, other, pose));
    if (got.distance > 0.0) continue;
    ++overlapping;
    const Vec normal = as_eigen(got.normal);
    ASSERT_NEAR(normal.norm(), 1.0, 1e-12);
    ASSERT_FALSE(do_overlap(pool, iron, other, moved(pose, normal * (1e-8 - got.distance))));
    // No translation below the lower bound parts them.
    const double least = -got.distance - got.error_bound;
    for (int k = 0; k < 20; ++k) {
      const Vec way = as_eigen(random_pose(1.0, random).position).normalized();
      ASSERT_TRUE(do_overlap(pool, iron, other, moved(pose, way * least * 0.999)))
          << "depth " << -got.distance << " bound " << got.error_bound;
    }
  }
  EXPECT_GT(overlapping, scaled(30));
}

TEST(SolidDepth, few_sampled_directions_are_shorter) {
  Random random(5);
  SolidPool pool;
  const ShapeId iron = pool.solid(angle_iron());
  const ShapeId small = pool.solid(angle_iron(), {0.5, 0.7, -0.4});
  std::size_t overlapping = 0;
  std::size_t shorter = 0;
  for (std::size_t i = 0; i < scaled(100); ++i) {
    const Pose pose = random_pose(1.5, random);
    const double depth = -distance_of(pool, iron, small, pose).distance;
    if (depth <= 0.0) continue;
    ++overlapping;
    for (int k = 0; k < 200; ++k) {
      const Vec way = as_eigen(random_pose(1.0, random).position).normalized();
      ASSERT_TRUE(do_overlap(pool, iron, small, moved(pose, way * depth * 0.5)));
      if (do_overlap(pool, iron, small, moved(pose, way * depth * 0.95))) continue;
      ++shorter;
      break;
    }
  }
  EXPECT_GT(overlapping, scaled(20));
  EXPECT_LE(10 * shorter, overlapping + 10);
}

/// Appends a mesh, moved along x.
void append(MeshData& mesh, const MeshData& other, float by) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Eigen::Vector3f& at : other.vertices) {
    mesh.vertices.emplace_back(at.x() + by, at.y(), at.z());
  }
  for (const std::uint32_t corner : other.corners) mesh.corners.push_back(first + corner);
}

TEST(SolidDepth, parts_of_one_mesh_are_a_union) {
  Random random(7);
  SolidPool pool;
  const MeshData square = prism({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});
  const ShapeId others[] = {expect_ok(pool.shapes.add(SphereShape{0.3})),
                            expect_ok(pool.shapes.add(BoxShape{{0.3, 0.2, 0.4}}))};
  // Given twice, touching, and overlapping.
  for (const float by : {0.0F, 2.0F, 1.5F}) {
    MeshData two = square;
    append(two, square, by);
    const ShapeId solid = pool.solid(two);
    const ShapeId box = expect_ok(pool.shapes.add(BoxShape{{1.0 + 0.5 * by, 1.0, 1.0}}));
    for (std::size_t i = 0; i < scaled(60); ++i) {
      const Pose pose = random_pose(1.2, random);
      const ShapeId other = others[i % 2];
      const SceneDistance got =
          distance_of(pool, solid, other, moved(pose, {0.5 * static_cast<double>(by), 0, 0}));
      const SceneDistance right = distance_of(pool, box, other, pose);
      ASSERT_LE(-got.distance, -right.distance + 1e-6 + 0.1 * std::abs(right.distance)) << by;
      ASSERT_GE(-got.distance, -right.distance - 1e-6) << by;
      ASSERT_LE(-got.distance - got.error_bound, -right.distance + 1e-9);
    }
  }
}

TEST(SolidDepth, cubes_that_share_an_edge_are_solid) {
  SolidPool pool;
  const MeshData square = prism({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});
  MeshData two = square;
  append(two, square, 2.0F);
  for (std::size_t i = square.vertices.size(); i < two.vertices.size(); ++i) {
    two.vertices[i].y() += 2.0F;
  }
  const ShapeId id = pool.solid(two);
  const ShapeId ball = expect_ok(pool.shapes.add(SphereShape{0.05}));
  EXPECT_TRUE(do_overlap(pool, id, ball, {}));
  EXPECT_TRUE(do_overlap(pool, id, ball, Pose::at(1.5, 1.5, 0.0)));
  EXPECT_FALSE(do_overlap(pool, id, ball, Pose::at(1.1, 0.9, 0.0)));
}

/// Returns the contacts of two bodies.
void collide(const SolidPool& pool, ContactLevel level, ShapeId a, ShapeId b, const Pose& pose,
             Contacts& contacts) {
  Scene scene(pool.shapes, {.composites = &pool.composites});
  expect_ok(scene.add({.shape = a}));
  expect_ok(scene.add({.shape = b, .pose = pose}));
  ASSERT_EQ(scene.collide(level, contacts), Status::ok);
}

TEST(SolidDepth, contacts_push_deep_box_out) {
  SolidPool pool;
  const ShapeId iron = pool.solid(angle_iron());
  const ShapeId box = expect_ok(pool.shapes.add(BoxShape{{0.4, 0.4, 0.4}}));
  for (double depth = 0.02; depth < 0.85; depth += 0.04) {
    Contacts contacts;
    collide(pool, ContactLevel::manifold, iron, box, Pose::at(-1.4 + depth, -0.3, 0.1), contacts);
    ASSERT_EQ(contacts.manifolds(), 1U) << depth;
    const double sign = contacts.a()[0].id == 0 ? 1.0 : -1.0;
    ASSERT_NEAR(contacts.distance()[0], -depth, 1e-6);
    ASSERT_NEAR(contacts.normal(0)[0] * sign, -1.0, 1e-6);
    ASSERT_EQ(contacts.points(), 4U);
    for (const ContactPoint& point : contacts[0][0]) {
      ASSERT_NEAR(static_cast<double>(point.depth), depth, 1e-6);
    }
  }
}

TEST(SolidDepth, body_within_solid_has_contact_at_every_level) {
  SolidPool pool;
  const ShapeId iron = pool.solid(angle_iron(), {3.0, 3.0, 3.0});
  const MeshData ring = torus(12, 7);
  const std::array children{
      CompoundChild{pool.solid(ring, {0.1, 0.1, 0.1}), {}},
      CompoundChild{pool.hull(round_prism(5), {0.1, 0.1, 0.1}), Pose::at(0.5, 0.0, 0.0)}};
  const ShapeId others[] = {expect_ok(pool.shapes.add(SphereShape{0.3})), children[0].shape,
                            expect_ok(pool.composites.add_compound(children))};
  for (const ShapeId other : others) {
    for (const auto& [a, b] : {std::pair{iron, other}, {other, iron}}) {
      const double side = a == iron ? 1.0 : -1.0;
      const Pose pose = Pose::at(side * -1.5, side * -1.5, 0.0);
      for (const ContactLevel level :
           {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
        Contacts contacts;
        collide(pool, level, a, b, pose, contacts);
        ASSERT_EQ(contacts.size(), 1U);
        ASSERT_EQ(contacts.manifolds(), 1U);
        if (level == ContactLevel::boolean) continue;
        const SceneDistance right = distance_of(pool, a, b, pose);
        ASSERT_LT(right.distance, -1.0);
        ASSERT_NEAR(contacts.distance()[0], right.distance, 0.02);
      }
    }
  }
}

TEST(SolidDepth, contacts_are_equal_on_any_number_of_threads) {
  Random random(6);
  SolidPool pool;
  const ShapeId iron = pool.solid(angle_iron());
  std::vector<BodyDefinition> bodies;
  for (std::size_t i = 0; i < 60; ++i)
    bodies.push_back({.shape = iron, .pose = random_pose(6.0, random)});
  std::vector<double> distances[2];
  for (const bool parallel : {false, true}) {
    Scene scene(pool.shapes, {.execution = parallel ? Execution::parallel() : Execution::serial(),
                              .composites = &pool.composites});
    std::vector<Key> keys(bodies.size());
    ASSERT_EQ(scene.add(bodies, keys), Status::ok);
    Contacts contacts;
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    distances[parallel].assign(contacts.distance().begin(), contacts.distance().end());
  }
  EXPECT_GT(distances[0].size(), 40U);
  EXPECT_EQ(distances[0], distances[1]);
}

}  // namespace
}  // namespace winnow::test
