#pragma once

// Scenes of all kinds of shapes, and their bodies split into convex primitives for brute force.
// Used by tests of scene queries.

#include <gtest/gtest.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/scene.h>
#include "pipeline/composites/mid_phase.h"
#include "pipeline/solver/solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "tests/pipeline/pair_scenes.h"
#include "tests/support/answers.h"

namespace winnow::test {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Coordinates of the scene's centre on each axis.
inline constexpr double kCenters[] = {0.0, 1e6, -1e8};

/// A convex primitive relative to the position of its body.
struct FlatPart {
  ShapeId shape;
  Pose pose;
  std::uint32_t part = kWholeShape;
  TriangleShape triangle{};
};

struct QueryWorld {
  explicit QueryWorld(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : composites(shapes.pool, memory) {}

  PairScene shapes;
  CompositePool composites;
  std::unique_ptr<Scene> scene;
  std::vector<BodyDefinition> bodies;
  std::vector<Key> keys;
  double center = 0.0;
  double size = 1.0;

  [[nodiscard]] std::vector<FlatPart> parts(ShapeId shape, const Pose& pose) const {
    std::vector<FlatPart> result;
    Pose here = pose;
    here.position = {};
    if (!shape.is_composite()) return {{shape, here}};
    const auto collect = [](void* list, const Primitive& p, double limit) {
      static_cast<std::vector<FlatPart>*>(list)->push_back({p.shape, p.pose, p.part, p.triangle});
      return limit;
    };
    mid::visit_near(composites, shape, here, {}, std::numeric_limits<double>::infinity(),
                    {collect, &result});
    return result;
  }
  [[nodiscard]] std::vector<FlatPart> parts(std::size_t body) const {
    return parts(bodies[body].shape, bodies[body].pose);
  }

  void add(ShapeId shape, const Pose& pose, Random& random) {
    BodyDefinition body;
    body.shape = shape;
    body.pose = pose;
    for (double& x : body.pose.position) x += center;
    body.state = static_cast<BodyState>(random.below(kBodyStates));
    body.data = 1000 + bodies.size();
    bodies.push_back(body);
  }
  void add_to_scene(SceneOptions options = {}) {
    options.composites = &composites;
    scene = std::make_unique<Scene>(shapes.pool, options);
    keys.resize(bodies.size());
    ASSERT_EQ(scene->add(bodies, keys), Status::ok);
    ASSERT_EQ(scene->refresh(), Status::ok);
  }
};

inline Pose random_pose(double spread, Random& random) {
  Pose pose;
  for (double& x : pose.position) x = random.uniform(-spread, spread);
  for (double& q : pose.orientation) q = random.uniform(-1.0, 1.0);
  return pose;
}

/// Draws a random direction, sometimes along an axis or perpendicular to one.
inline void draw_direction(double length, Random& random, double direction[3]) {
  for (int i = 0; i < 3; ++i) direction[i] = length * random.uniform(-1.0, 1.0);
  if (random.chance(0.3)) direction[random.below(3)] = 0.0;
  if (random.chance(0.2)) direction[0] = direction[1] = 0.0;
  if (direction[0] == 0.0 && direction[1] == 0.0 && direction[2] == 0.0) direction[0] = -length;
}

inline double length_of(const double v[3]) {
  return std::hypot(v[0], v[1], v[2]);
}

/// Adds a wavy sheet of 2 n^2 triangles over [-1, 1] x [-1, 1].
inline ShapeId add_sheet(CompositePool& pool, std::uint32_t n) {
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      const float x = 2.0F * static_cast<float>(i) / static_cast<float>(n) - 1.0F;
      const float y = 2.0F * static_cast<float>(j) / static_cast<float>(n) - 1.0F;
      vertices.emplace_back(x, y, 0.2F * std::sin(5.0F * x) * std::cos(4.0F * y));
      if (i == n || j == n) continue;
      const std::uint32_t at = j * (n + 1) + i;
      for (const std::uint32_t k : {0U, 1U, n + 2, 0U, n + 2, n + 1}) corners.push_back(at + k);
    }
  }
  ShapeId id;
  const std::span<const Vec3f> points(vertices);
  const std::span<const std::uint32_t> triangles(corners);
  id = expect_ok(pool.add_mesh(points, triangles));
  return id;
}

/// Adds `count` convex bodies of all kinds, which fill about a tenth of a cube around (center,
/// center, center), and some composite ones.
inline void fill(QueryWorld& world, std::size_t count, double center, Random& random) {
  world.center = center;
  const double spread = world.size = 1.5 * std::cbrt(static_cast<double>(count));
  const std::vector<ShapeKind> kinds = all_kinds();
  const auto bounded = static_cast<std::size_t>(
      std::find(kinds.begin(), kinds.end(), ShapeKind::half_space) - kinds.begin());
  while (world.shapes.shapes.size() < count) {
    const PairStyle style = random.chance(0.3) ? PairStyle::degenerate : PairStyle::ordinary;
    add_pairs(world.shapes, kinds[random.below(bounded)], kinds[random.below(bounded)], style, 1,
              random);
  }
  for (const ShapeId shape : world.shapes.shapes) {
    world.add(shape, random_pose(spread, random), random);
  }
  ShapeId ids[5];
  ids[0] = add_sheet(world.composites, 6);
  ids[1] = expect_ok(world.composites.add_scaled(ids[0], {2.0, 0.5, -3.0}));
  std::vector<CompoundChild> children;
  for (std::size_t i = 0; i < 20; ++i) {
    children.push_back({world.shapes.shapes[i], random_pose(2.0, random)});
  }
  ids[2] = expect_ok(world.composites.add_compound(children));
  std::vector<float> heights(12 * 9);
  for (float& h : heights) h = static_cast<float>(random.unit());
  ids[3] = expect_ok(world.composites.add_height_field({heights, 12, 9, 0, {0.4, 0.5}}));
  std::vector<CompoundChild> surfaces;
  for (const std::size_t i : {0U, 1U, 3U, 0U}) {
    surfaces.push_back({ids[i], random_pose(2.0, random)});
    surfaces.push_back({world.shapes.shapes[i], random_pose(2.0, random)});
  }
  ids[4] = expect_ok(world.composites.add_compound(surfaces));
  for (std::size_t i = 0; i < 15; ++i) {
    world.add(ids[i % 5], random_pose(spread, random), random);
  }
}

/// The tables of a pool in which a primitive's triangle replaces the triangles of the pool.
struct PartTable {
  ShapeTables tables;
  ShapeId id;

  PartTable(const ShapePool& pool, const FlatPart& part) : tables(pool.tables()), id(part.shape) {
    if (part.part == kWholeShape || id.kind() != ShapeKind::triangle) return;
    tables.triangles = &part.triangle;
    tables.count[static_cast<std::size_t>(ShapeKind::triangle)] = 1;
    id = ShapeId::of(ShapeKind::triangle, 0);
  }
};

/// Solves two primitives, `b` displaced by `offset`.
inline PairAnswer solve_parts(const ShapePool& pool, const FlatPart& a, FlatPart b,
                              const double offset[3], ContactLevel level) {
  TriangleShape both[2];
  ShapeTables tables = pool.tables();
  ShapeId ids[2] = {a.shape, b.shape};
  const FlatPart* const parts[2] = {&a, &b};
  tables.triangles = both;
  for (std::uint32_t i = 0; i < 2; ++i) {
    if (ids[i].kind() != ShapeKind::triangle) continue;
    both[i] = parts[i]->part != kWholeShape ? parts[i]->triangle
                                            : pool.tables().triangles[ids[i].index()];
    ids[i] = ShapeId::of(ShapeKind::triangle, i);
  }
  for (int i = 0; i < 3; ++i) b.pose.position[i] += offset[i];
  SolverCounts counts;
  return solve_pair(tables, ids[0], a.pose, ids[1], b.pose, level, 0.0, counts);
}

}  // namespace winnow::test
