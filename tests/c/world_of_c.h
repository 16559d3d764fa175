#pragma once

// Shapes of every kind, and a scene of them, made with C.

#include "tests/c/handles_of_c.h"

#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/scene.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace winnow::test {

/// The user shape of a cube with the half edge `context`.
inline void farthest_of_cube(const void* context, const double* direction, double* point) {
  const double half = *static_cast<const double*>(context);
  for (int i = 0; i < 3; ++i) point[i] = direction[i] < 0.0 ? -half : half;
}

/// A convex shape of each kind, and a mesh, a scaled mesh, a height field and a compound.
class ShapesOfC {
 public:
  explicit ShapesOfC(const winnow_memory* memory = nullptr)
      : pool(winnow_shape_pool_create, memory),
        composites(winnow_composite_pool_create, static_cast<const winnow_shape_pool*>(pool),
                   memory) {
    add_convex();
    add_composites();
  }

  static constexpr double kHalf = 0.25;
  static constexpr double kCorners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  OwnedShapes pool;
  OwnedComposites composites;
  std::vector<winnow_shape_id> convex;  ///< by kind; two hulls
  std::vector<winnow_shape_id> composite;

 private:
  void add_convex() {
    const winnow_shape shapes[] = {
        {WINNOW_SHAPE_SPHERE, {.sphere = {0.5}}},
        {WINNOW_SHAPE_CAPSULE, {.capsule = {0.3, 0.4}}},
        {WINNOW_SHAPE_BOX, {.box = {{0.5, 0.4, 0.3}, 0.05}}},
        {WINNOW_SHAPE_CYLINDER, {.cylinder = {0.4, 0.5, 0.0}}},
        {WINNOW_SHAPE_CONE, {.cone = {0.5, 0.5, 0.0}}},
        {WINNOW_SHAPE_TRIANGLE, {.triangle = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 0.1}}},
        {WINNOW_SHAPE_HALF_SPACE, {.half_space = {{0, 0, 2}, 0}}},
        {WINNOW_SHAPE_ELLIPSOID, {.ellipsoid = {{0.5, 0.4, 0.3}, 0.05}}},
        {WINNOW_SHAPE_TAPERED_CAPSULE, {.tapered_capsule = {{0.4, 0.2}, 0.5}}},
        {WINNOW_SHAPE_SUPPORT, {.support = {farthest_of_cube, &kHalf, 0.5, 0.1}}}};
    for (const winnow_shape& shape : shapes) {
      convex.push_back(got<winnow_shape_id>(winnow_shape_pool_add, pool, &shape));
    }
    const std::uint32_t indices[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    const std::uint32_t sizes[4] = {3, 3, 3, 3};
    const winnow_hull_faces faces = {indices, 12, sizes, 4};
    const winnow_point_view points = winnow_points(kCorners, 4);
    convex.push_back(
        got<winnow_shape_id>(winnow_shape_pool_add_hull_faces, pool, &points, &faces, 0.02));
    convex.push_back(got<winnow_shape_id>(winnow_shape_pool_add_hull, pool, &points, 0.02));
  }

  void add_composites() {
    const float x[4] = {-20, 20, 20, -20};
    const float y[4] = {-20, -20, 20, 20};
    const float z[4] = {0, 0, 0, 0};
    const std::uint16_t corners[6] = {0, 1, 2, 0, 2, 3};
    const winnow_point_view vertices = {{x, y, z}, 0, 4, WINNOW_FLOAT};
    const winnow_index_view triangles = {corners, 0, 2, WINNOW_UINT16};
    const winnow_mesh_options options = WINNOW_MESH_OPTIONS;
    const winnow_execution serial = {WINNOW_EXECUTION_SERIAL, {}};
    const double scale[3] = {2, 1, 1};
    const auto mesh = got<winnow_shape_id>(winnow_composite_pool_add_mesh, composites, &vertices,
                                           &triangles, &options, &serial);
    EXPECT_EQ(winnow_composite_pool_refit_mesh(composites, mesh, &vertices, nullptr), WINNOW_OK);
    composite = {mesh,
                 got<winnow_shape_id>(winnow_composite_pool_add_scaled, composites, mesh, scale)};
    float heights[9] = {0, 0.1F, 0, 0.2F, 0, 0.1F, 0, 0.3F, 0};
    winnow_height_samples samples = {heights, 9, 3, 3, 0, {4.0, 4.0}};
    composite.push_back(
        got<winnow_shape_id>(winnow_composite_pool_add_height_field, composites, &samples));
    heights[0] = 0.25F;
    samples.count = 1;
    samples.columns = samples.rows = 1;
    EXPECT_EQ(
        winnow_composite_pool_update_height_field(composites, composite.back(), 1, 1, &samples),
        WINNOW_OK);
    winnow_compound_child children[3] = {WINNOW_COMPOUND_CHILD, WINNOW_COMPOUND_CHILD,
                                         WINNOW_COMPOUND_CHILD};
    children[0].shape = convex[0];
    children[1].shape = convex[2];
    children[1].pose.position[2] = 0.4;
    children[2].shape = mesh;
    children[2].pose.position[2] = -0.3;
    composite.push_back(
        got<winnow_shape_id>(winnow_composite_pool_add_compound, composites, children, 3U));
  }
};

/// Returns a pose above the ground.
[[nodiscard]] inline winnow_pose pose_of_c(std::size_t i, std::size_t frame = 0) {
  const auto part = [i](std::size_t n) { return static_cast<double>(i % n); };
  return {{1.1 * part(8), 1.1 * static_cast<double>(i / 8),
           0.45 + 0.1 * part(4) - 0.05 * static_cast<double>(frame)},
          {1.0, 0.1 * part(3), 0.05 * part(5), 0.2 * part(7)}};
}

/// A scene of these shapes: the composites, then convex bodies; the first three are fixed.
class SceneOfC {
 public:
  static constexpr std::size_t kBodies = 40;

  SceneOfC()
      : memory(counted.functions()), scene(create()), contacts(winnow_contacts_create, &memory) {
    std::array<winnow_body_definition, kBodies> bodies;
    for (std::size_t i = 0; i < kBodies; ++i) {
      bodies[i] = WINNOW_BODY_DEFINITION;
      bodies[i].shape = i < 4 ? shapes.composite[i] : shapes.convex[i % 6];
      if (i < 3) bodies[i].state = WINNOW_BODY_STATE_FIXED;
      if (i >= 3) bodies[i].pose = pose_of_c(i);
      bodies[i].data = 1000 + 3 * i;
    }
    EXPECT_EQ(winnow_scene_add(scene, bodies.data(), kBodies, keys.data()), WINNOW_OK);
  }

  [[nodiscard]] Key key(std::size_t i) const { return c::to_cpp(keys[i]); }
  void collide(winnow_contact_level level = WINNOW_LEVEL_MANIFOLD) const {
    EXPECT_EQ(winnow_scene_collide(scene, level, contacts), WINNOW_OK);
  }

  CountedMemory counted;
  winnow_memory memory;
  ShapesOfC shapes;
  OwnedScene scene;
  OwnedContacts contacts;
  std::array<winnow_key, kBodies> keys{};

 private:
  [[nodiscard]] OwnedScene create() {
    winnow_scene_options options = WINNOW_SCENE_OPTIONS;
    options.memory = &memory;
    options.contact_margin = 0.02;
    options.cache_tolerance = 0.001;
    options.composites = shapes.composites;
    options.structures[WINNOW_BODY_STATE_FIXED].structure = WINNOW_STATIC_BVH;
    return OwnedScene(winnow_scene_create, static_cast<const winnow_shape_pool*>(shapes.pool),
                      &options);
  }
};

}  // namespace winnow::test
