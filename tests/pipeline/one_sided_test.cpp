// One-sided triangles: shapes in front get the results for two-sided triangles, shapes behind get
// none, and no normal points to the back.

#include "pipeline/shapes/one_sided.h"
#include "core/numbers/rotation.h"
#include "tests/pipeline/composite_world.h"

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/core/pose.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <set>
#include <span>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"
#include "tests/support/meshes.h"

namespace winnow::test {
namespace {

using Vec = Eigen::Vector3d;

/// A triangle in world space: one corner and the normal of its front.
struct FacingTriangle {
  Vec corner;
  Vec front;
};

/// Returns the triangle of a primitive of a surface.
[[nodiscard]] FacingTriangle facing(const Primitive& part) {
  const Eigen::Matrix3d turn = rotation_of(scale_to_unit_max(part.pose.orientation));
  const Vec at = as_eigen(part.pose.position);
  Vec corner[3];
  for (int k = 0; k < 3; ++k) corner[k] = at + turn * as_eigen(part.triangle.vertex[k]);
  return {corner[0], (corner[1] - corner[0]).cross(corner[2] - corner[0]) * part.front};
}

/// Surfaces, one-sided or not, in pairs with shapes of all convex kinds.
struct FacingWorld : CompositeWorld {
  explicit FacingWorld(bool one_sided, std::uint64_t seed = 5) {
    Random random(seed);
    add_shapes(random);
    for (const ShapeId id : ids) {
      if (!id.is_composite() || id.composite_kind() == CompositeKind::compound) continue;
      surfaces.push_back(id);
      EXPECT_EQ(composites.set_one_sided(id, one_sided), Status::ok);
    }
    for (std::size_t i = 0; i < scaled(160); ++i) {
      body.push_back(surfaces[random.below(surfaces.size())]);
      pose.push_back(random_pose(random, 0.5));
      // A sphere, capsule, box, or another kind up to the hull.
      body.push_back(ids[random.below(6)]);
      pose.push_back(random_pose(random, 1.5));
      pairs.push_back({static_cast<std::uint32_t>(2 * i), static_cast<std::uint32_t>(2 * i + 1)});
    }
  }

  [[nodiscard]] bool is_behind_triangle(std::uint32_t shape, const Primitive& part) const {
    const Aabb box = shapes.bounds(body[shape], pose[shape]);
    Vec min;
    Vec max;
    for (int axis = 0; axis < 3; ++axis) {
      min[axis] = static_cast<double>(box.min[axis]);
      max[axis] = static_cast<double>(box.max[axis]);
    }
    const FacingTriangle to = facing(part);
    return is_behind(to.front, to.corner, min, max);
  }

  std::vector<ShapeId> surfaces;
};

/// Returns the triangles in the primitive pairs of pair i.
[[nodiscard]] std::set<std::uint32_t> parts_hit(const FacingWorld& world, std::size_t i,
                                                double margin) {
  PrimitivePairs found;
  const BodyPair pair[] = {world.pairs[i]};
  EXPECT_EQ(mid::find_primitive_pairs(world.composites, world.shapes, world.bodies(), pair, margin,
                                      Execution::serial(), found),
            Status::ok);
  std::set<std::uint32_t> parts;
  for (const BodyPair& of : found.pairs) parts.insert(found.part[of.a]);
  return parts;
}

TEST(OneSided, mid_phase_drops_triangles_seen_from_behind) {
  const FacingWorld both(false);
  const FacingWorld front(true);
  std::size_t behind = 0;
  for (std::size_t i = 0; i < both.pairs.size(); ++i) {
    std::set<std::uint32_t> expected = parts_hit(both, i, 0.1);
    for (const Primitive& part : parts_of(front, front.body[2 * i], front.pose[2 * i])) {
      ASSERT_NE(part.front, 0);
      if (front.is_behind_triangle(front.pairs[i].b, part)) behind += expected.erase(part.part);
    }
    EXPECT_EQ(parts_hit(front, i, 0.1), expected);
  }
  EXPECT_GT(behind, 10U);
}

/// A scene of one body, queried by rays, shape casts and overlaps.
struct QueriedBody {
  QueriedBody(const FacingWorld& world, ShapeId shape)
      : scene(world.shapes, {.composites = &world.composites}), queries(scene) {
    expect_ok(scene.add({.shape = shape, .pose = Pose::at(-1, 2, 0.5)}));
    EXPECT_EQ(scene.refresh(), Status::ok);
  }

  Scene scene;
  SceneQueries queries;
};

void expect_same(const SceneHit& a, const SceneHit& b) {
  EXPECT_EQ(static_cast<bool>(a), static_cast<bool>(b));
  EXPECT_EQ(a.t, b.t);
  EXPECT_EQ(a.part, b.part);
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(a.normal[axis], b.normal[axis]);
}

TEST(OneSided, compound_of_one_surface_matches_surface) {
  Random random(61);
  for (const bool one_sided : {false, true}) {
    FacingWorld world(one_sided, 9);
    std::size_t hit_count = 0;
    for (const ShapeId surface : world.surfaces) {
      const CompoundChild child[] = {{surface, {}}};
      ShapeId compound = expect_ok(world.composites.add_compound(child));
      ASSERT_EQ(world.composites.parts(compound), world.composites.parts(surface));
      QueriedBody plain(world, surface);
      QueriedBody inside(world, compound);
      for (int i = 0; i < 60; ++i) {
        const Pose from = random_pose(random, 5.0);
        ShapeRay ray;
        ShapeCast cast{.shape = world.ids[0], .pose = from};
        for (int axis = 0; axis < 3; ++axis) {
          ray.origin[axis] = from.position[axis];
          ray.direction[axis] = cast.direction[axis] =
              random.uniform(-1.0, 1.0) - (from.position[axis] + (axis == 1 ? -2.0 : 0.0));
        }
        SceneHit hits[2];
        hits[0] = expect_ok(plain.queries.closest(ray));
        hits[1] = expect_ok(inside.queries.closest(ray));
        expect_same(hits[0], hits[1]);
        hit_count += hits[0] ? 1 : 0;
        hits[0] = expect_ok(plain.queries.closest(cast));
        hits[1] = expect_ok(inside.queries.closest(cast));
        expect_same(hits[0], hits[1]);
      }
    }
    EXPECT_GT(hit_count, 30U);
    for (std::size_t i = 0; i < world.pairs.size(); ++i) {
      const std::set<std::uint32_t> expected = parts_hit(world, i, 0.1);
      const CompoundChild child[] = {{world.body[2 * i], {}}};
      ShapeId compound = expect_ok(world.composites.add_compound(child));
      world.body[2 * i] = compound;
      EXPECT_EQ(parts_hit(world, i, 0.1), expected);
    }
  }
}

/// Checks contact normals of scenes with one pair at level manifold.
TEST(OneSided, normals_never_point_to_the_back) {
  const FacingWorld world(true, 6);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < world.pairs.size(); ++i) {
    const auto parts = parts_of(world, world.body[2 * i], world.pose[2 * i]);
    for (const bool reduced : {false, true}) {
      Scene scene(world.shapes, {.execution = Execution::serial(),
                                 .contact_margin = 0.05,
                                 .part_manifolds = !reduced,
                                 .composites = &world.composites});
      Key keys[2];
      for (std::size_t k = 0; k < 2; ++k) {
        const BodyDefinition body{.shape = world.body[2 * i + k], .pose = world.pose[2 * i + k]};
        keys[k] = expect_ok(scene.add(body));
      }
      Contacts contacts;
      ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
      for (std::size_t m = 0; m < contacts.manifolds(); ++m) {
        // The convex shape comes first: its kind is smaller.
        const std::uint32_t number = contacts.part_b()[m];
        const auto part = std::find_if(parts.begin(), parts.end(),
                                       [&](const Primitive& p) { return p.part == number; });
        ASSERT_NE(part, parts.end());
        const FacingTriangle to = facing(*part);
        const Vec normal(contacts.normal(0)[m], contacts.normal(1)[m], contacts.normal(2)[m]);
        EXPECT_LE(normal.dot(to.front), 1e-6 * to.front.norm());
        EXPECT_GT(contacts.point_first()[m + 1], contacts.point_first()[m]);
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, scaled(100) / 2);
}

/// A fixed one-sided floor with its front up.
struct FrontFloor {
  FrontFloor(bool field, bool mirrored) {
    if (field) {
      const std::vector<float> heights(9 * 9, 0.0F);
      id = expect_ok(composites.add_height_field({heights, 9, 9, 0, {0.5, 0.5}}));
    } else {
      id = add(composites, grid(8, 0.5F, Cut::alternating, [](float, float) { return 0.0F; }));
      const double side = mirrored ? -1.0 : 1.0;
      id = expect_ok(composites.add_scaled(id, {side, 1.0, 1.0}));
    }
    EXPECT_EQ(composites.set_one_sided(id), Status::ok);
    ball = add(shapes, SphereShape{0.3});
    const double middle = field ? -2.0 : 0.0;
    const Pose at = Pose::at(middle, middle, 0.0);
    floor = expect_ok(scene.add({.shape = id, .pose = at, .state = BodyState::fixed}));
    EXPECT_EQ(scene.refresh(), Status::ok);
  }

  [[nodiscard]] double ray(double from, double to) {
    const ShapeRay query{{0.1, 0.2, from}, {0.0, 0.0, to - from}, 0.0, 1.0};
    SceneHit hit = expect_ok(queries.closest(query));
    return hit.key == floor ? hit.t : -1.0;
  }
  [[nodiscard]] double cast(double from, double to) {
    const ShapeCast query{ball, Pose::at(0.1, 0.2, from), {0.0, 0.0, to - from}, 1.0};
    SceneHit hit = expect_ok(queries.closest(query));
    return hit.key == floor ? hit.t : -1.0;
  }
  [[nodiscard]] bool overlaps(double height) {
    bool any = false;
    std::span<const SceneOverlap> found =
        expect_ok(queries.overlap(ball, Pose::at(0.1, 0.2, height)));
    for (const SceneOverlap& one : found) any = any || one.key == floor;
    return any;
  }

  ShapePool shapes;
  CompositePool composites{shapes};
  ShapeId id;
  ShapeId ball;
  Scene scene{shapes, {.composites = &composites}};
  Key floor;
  SceneQueries queries{scene};
};

TEST(OneSided, queries_hit_only_from_the_front) {
  for (const bool field : {false, true}) {
    for (const bool mirrored : {false, true}) {
      if (field && mirrored) continue;
      FrontFloor floor(field, mirrored);
      EXPECT_NEAR(floor.ray(1.0, -1.0), 0.5, 1e-12);
      EXPECT_EQ(floor.ray(-1.0, 1.0), -1.0);
      EXPECT_NEAR(floor.cast(1.3, -1.0), 1.0 / 2.3, 1e-6);
      EXPECT_EQ(floor.cast(-1.0, 1.0), -1.0);
      EXPECT_EQ(floor.cast(0.1, 2.0), 0.0);
      EXPECT_EQ(floor.cast(-0.1, 2.0), -1.0);
      EXPECT_TRUE(floor.overlaps(0.2));
      EXPECT_FALSE(floor.overlaps(-0.2));
      ASSERT_EQ(floor.composites.set_one_sided(floor.id, false), Status::ok);
      ASSERT_EQ(floor.scene.refresh(), Status::ok);
      EXPECT_NEAR(floor.ray(-1.0, 1.0), 0.5, 1e-12);
      EXPECT_NEAR(floor.cast(-1.3, 1.0), 1.0 / 2.3, 1e-6);
      EXPECT_TRUE(floor.overlaps(-0.2));
    }
  }
}

/// Returns small triangles near (x, 0, 0) in random directions.
[[nodiscard]] MeshData scattered_triangles(std::size_t count, float x, Random& random) {
  MeshData mesh;
  const auto about = [&](float middle, double by) {
    return middle + static_cast<float>(random.uniform(-by, by));
  };
  for (std::uint32_t t = 0; t < count; ++t) {
    const Eigen::Vector3f middle(about(x, 1.0), about(0.0F, 1.0), about(0.0F, 1.0));
    for (std::uint32_t k = 0; k < 3; ++k) {
      mesh.vertices.emplace_back(about(middle.x(), 0.2), about(middle.y(), 0.2),
                                 about(middle.z(), 0.2));
      mesh.corners.push_back(3 * t + k);
    }
  }
  return mesh;
}

/// One body of a whole mesh, and one body for each of its triangles.
struct Scattered {
  Scattered(const MeshData& mesh, bool one_sided, CompositePool& pool, Scene& scene) {
    const auto body = [&](const IndexView& triangles) {
      ShapeId id = expect_ok(pool.add_mesh(mesh.points(), triangles));
      EXPECT_EQ(pool.set_one_sided(id, one_sided), Status::ok);
      return scene.add({.shape = id});
    };
    whole = body(mesh.indices());
    for (std::size_t t = 0; t < mesh.triangles(); ++t) {
      single.push_back(body(std::span(mesh.corners).subspan(3 * t, 3)));
    }
  }

  Key whole;
  std::vector<Key> single;
};

TEST(OneSided, mesh_distance_uses_only_facing_triangles) {
  Random random(11);
  int with_behind = 0;
  for (unsigned round = 0; round < 60; ++round) {
    ShapePool shapes;
    CompositePool pool(shapes);
    Scene scene(shapes, {.composites = &pool});
    const Scattered a(scattered_triangles(1 + random.below(40), 0.0F, random), (round & 1U) != 0,
                      pool, scene);
    const Scattered b(scattered_triangles(1 + random.below(40), 3.0F, random), (round & 2U) != 0,
                      pool, scene);
    ASSERT_EQ(scene.refresh(), Status::ok);
    SceneQueries queries(scene);
    SceneDistance nearest;
    double expected = std::numeric_limits<double>::infinity();
    for (const Key one : a.single) {
      for (const Key other : b.single) {
        nearest = expect_ok(queries.distance(one, other));
        if (nearest) expected = std::min(expected, nearest.distance);
        with_behind += nearest ? 0 : 1;
      }
    }
    nearest = expect_ok(queries.distance(a.whole, b.whole));
    ASSERT_EQ(static_cast<bool>(nearest), expected < 100.0) << round;
    if (nearest) {
      EXPECT_NEAR(nearest.distance, expected, 1e-12) << round;
    }
  }
  EXPECT_GT(with_behind, 1000);
}

/// A box is pushed up at any depth while its centre is in front of the floor, and not at all after
/// that.
TEST(OneSided, sinking_box_is_pushed_until_centre_passes) {
  FrontFloor floor(false, false);
  const ShapeId box = add(floor.shapes, BoxShape{{0.4, 0.3, 0.2}, 0.0});
  Key key = expect_ok(floor.scene.add({.shape = box}));
  Contacts contacts;
  for (double height = 0.195; height > -0.21; height -= 0.0299) {
    ASSERT_EQ(floor.scene.move(key, Pose::at(0.13, 0.07, height)), Status::ok);
    ASSERT_EQ(floor.scene.collide(ContactLevel::manifold, contacts), Status::ok);
    EXPECT_EQ(contacts.size(), height >= 0.0 ? 1U : 0U) << height;
    for (std::size_t m = 0; m < contacts.manifolds(); ++m) {
      EXPECT_NEAR(contacts.normal(2)[m], -1.0, 1e-9);
      EXPECT_LE(-contacts.distance()[m], 0.2 - height + 1e-6);
    }
  }
}

TEST(OneSided, each_id_has_its_own_side) {
  CountingMemory memory;
  ShapePool shapes(&memory);
  CompositePool composites(shapes, &memory);
  const ShapeId mesh = add(composites, grid(2, 1.0F, Cut::same, [](float, float) { return 0.0F; }));
  ShapeId other = expect_ok(composites.add_scaled(mesh, {1.0, 1.0, 1.0}));
  const std::uint64_t before = composites.revision();
  ASSERT_EQ(composites.set_one_sided(other), Status::ok);
  EXPECT_GT(composites.revision(), before);
  EXPECT_TRUE(composites.is_one_sided(other));
  EXPECT_FALSE(composites.is_one_sided(mesh));
  ASSERT_EQ(composites.set_one_sided(mesh), Status::ok);
  ASSERT_EQ(composites.remove(other), Status::ok);
  EXPECT_FALSE(composites.is_one_sided(other));
  EXPECT_TRUE(composites.is_one_sided(mesh));
  EXPECT_EQ(composites.set_one_sided(other), Status::invalid_key);
  const ShapeId ball = add(shapes, SphereShape{1.0});
  EXPECT_EQ(composites.set_one_sided(ball), Status::invalid_key);
  const CompoundChild child[] = {{ball, {}}};
  ShapeId compound = expect_ok(composites.add_compound(child));
  EXPECT_EQ(composites.set_one_sided(compound), Status::invalid_key);
  EXPECT_EQ(composites.footprint().total().reserved + shapes.footprint().total().reserved,
            memory.outstanding());
}

}  // namespace
}  // namespace winnow::test
