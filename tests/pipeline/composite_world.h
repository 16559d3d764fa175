#pragma once

// Shapes of every kind, convex and composite, with random bodies and pairs, and helpers that split
// a body into primitives. Used by tests of the mid phase, composites and scenes.

#include <gtest/gtest.h>
#include <winnow/core/pose.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/narrow_phase.h>
#include "pipeline/composites/mid_phase.h"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/random.h"

namespace winnow::test {

using Point = Eigen::Vector3f;
using Corner = std::array<std::uint32_t, 3>;

struct Surface {
  std::vector<Point> vertices;
  std::vector<std::uint32_t> corners;
};

/// The diagonals that cut the squares of a grid into triangles.
enum class Cut { same, mirrored, alternating, random };

/// Returns a grid of `n` x `n` squares of side `side` with the given heights, centred on the
/// origin.
template <typename Height>
Surface grid(int n, float side, Cut cut, Height&& height) {
  Surface surface;
  Random random(5);
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      const float at[2] = {side * (static_cast<float>(x) - 0.5F * static_cast<float>(n)),
                           side * (static_cast<float>(y) - 0.5F * static_cast<float>(n))};
      surface.vertices.emplace_back(at[0], at[1], height(at[0], at[1]));
    }
  }
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const auto i = static_cast<std::uint32_t>(y * (n + 1) + x);
      const auto up = i + static_cast<std::uint32_t>(n) + 1;
      const bool other = cut == Cut::mirrored || (cut == Cut::alternating && (x + y) % 2 == 0) ||
                         (cut == Cut::random && random.chance(0.5));
      const std::vector<std::uint32_t> square =
          other ? std::vector<std::uint32_t>{i, i + 1, up, i + 1, up + 1, up}
                : std::vector<std::uint32_t>{i, i + 1, up + 1, i, up + 1, up};
      surface.corners.insert(surface.corners.end(), square.begin(), square.end());
    }
  }
  return surface;
}

inline Surface soup(Random& random, int triangles, double reach, double size) {
  Surface surface;
  for (int t = 0; t < triangles; ++t) {
    const Eigen::Vector3d at(random.uniform(-reach, reach), random.uniform(-reach, reach),
                             random.uniform(-reach, reach));
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d off(random.uniform(-size, size), random.uniform(-size, size),
                                random.uniform(-size, size));
      surface.vertices.push_back((at + off).cast<float>());
      surface.corners.push_back(static_cast<std::uint32_t>(surface.vertices.size() - 1));
    }
    // Sometimes degenerate to a segment or a point.
    if (random.chance(0.05)) surface.corners.back() = surface.corners[surface.corners.size() - 2];
    if (random.chance(0.02)) {
      surface.corners[surface.corners.size() - 2] = surface.corners.back();
      surface.corners[surface.corners.size() - 3] = surface.corners.back();
    }
  }
  return surface;
}

inline ShapeId add(CompositePool& pool, const Surface& surface) {
  ShapeId id = expect_ok(pool.add_mesh(std::span<const Point>(surface.vertices),
                                       std::span<const std::uint32_t>(surface.corners)));
  return id;
}

template <typename Shape>
ShapeId add(ShapePool& pool, const Shape& shape) {
  ShapeId id = expect_ok(pool.add(shape));
  return id;
}

inline ShapeId add_octahedron(ShapePool& pool, double size) {
  std::vector<Eigen::Vector3d> points;
  for (int axis = 0; axis < 3; ++axis) {
    points.push_back(size * Eigen::Vector3d::Unit(axis));
    points.push_back(-size * Eigen::Vector3d::Unit(axis));
  }
  const std::vector<std::uint32_t> indices{0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                           2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  const std::vector<std::uint32_t> sizes(8, 3);
  ShapeId id = expect_ok(pool.add_hull(points, {indices, sizes}, 0.0));
  return id;
}

inline Pose random_pose(Random& random, double reach) {
  Pose pose;
  for (double& x : pose.position) x = random.uniform(-reach, reach);
  for (double& q : pose.orientation) q = random.uniform(-1.0, 1.0);
  return pose;
}

/// Shapes of every kind, and bodies and pairs of them.
struct CompositeWorld {
  explicit CompositeWorld(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : shapes(memory), composites(shapes, memory) {}

  ShapePool shapes;
  CompositePool composites;
  std::vector<ShapeId> ids;
  std::vector<ShapeId> body;
  std::vector<Pose> pose;
  std::vector<BodyPair> pairs;

  [[nodiscard]] Bodies bodies() const { return {body, pose}; }

  void add_shapes(Random& random) {
    ids = {add(shapes, SphereShape{0.6}),
           add(shapes, CapsuleShape{0.3, 0.7}),
           add(shapes, BoxShape{{0.5, 0.3, 0.8}, 0.0}),
           add(shapes, CylinderShape{0.4, 0.6, 0.0}),
           add(shapes, ConeShape{0.5, 0.7, 0.05}),
           add_octahedron(shapes, 0.8),
           add(shapes, TriangleShape{{{0.0, 0.0, 0.0}, {1.0, 0.2, 0.0}, {0.1, 0.9, 0.3}}, 0.0}),
           add(shapes, HalfSpaceShape{{0.2, -0.5, 1.0}, 0.1})};
    const std::size_t convex = ids.size();
    for (const int children : {1, 3, 16, 17, 60}) {
      std::vector<CompoundChild> list;
      for (int i = 0; i < children; ++i) {
        list.push_back({ids[random.below(convex - 1)], random_pose(random, 1.5)});
      }
      ids.emplace_back();
      ids.back() = expect_ok(composites.add_compound(list));
    }
    const CompoundChild endless[] = {{ids[0], Pose{}}, {ids[7], random_pose(random, 0.5)}};
    ids.emplace_back();
    ids.back() = expect_ok(composites.add_compound(endless));
    const ShapeId mesh = add(composites, soup(random, 150, 2.0, 0.5));
    ids.push_back(mesh);
    ids.push_back(add(composites, grid(7, 0.5F, Cut::random, [](float x, float y) {
                        return 0.5F * std::sin(3.0F * x) * std::cos(2.0F * y);
                      })));
    for (const Vec3d scale :
         {std::array{-1.0, 1.0, 1.0}, std::array{0.3, 1.7, -0.9}, std::array{2.0, 2.0, 2.0}}) {
      ids.emplace_back();
      ids.back() = expect_ok(composites.add_scaled(mesh, scale));
    }
    std::vector<float> heights;
    for (int i = 0; i < 9 * 6; ++i)
      heights.push_back(static_cast<float>(random.uniform(-0.3, 0.5)));
    heights[17] = std::nanf("");
    ids.emplace_back();
    ids.back() = expect_ok(composites.add_height_field({heights, 9, 6, 0, {0.4, 0.6}}));
    add_compounds_of_surfaces(random, mesh, heights);
  }

  /// Adds compounds of few and of many children. Their surfaces are separate, so that the shapes in
  /// `ids` can be removed one by one.
  void add_compounds_of_surfaces(Random& random, ShapeId mesh, const std::vector<float>& heights) {
    ShapeId surfaces[3];
    surfaces[0] = expect_ok(composites.add_scaled(mesh, {1.0, 1.0, 1.0}));
    surfaces[1] = expect_ok(composites.add_scaled(mesh, {0.5, -0.7, 0.2}));
    surfaces[2] = expect_ok(composites.add_height_field({heights, 9, 6, 0, {0.4, 0.6}}));
    for (const int children : {3, 20}) {
      std::vector<CompoundChild> list;
      for (int i = 0; i < children; ++i) {
        const bool is_surface = i % 7 < 2;
        list.push_back({is_surface ? surfaces[random.below(3)] : ids[random.below(7)],
                        random_pose(random, 1.5)});
      }
      ids.emplace_back();
      ids.back() = expect_ok(composites.add_compound(list));
    }
  }

  void add_pairs(Random& random, std::size_t count, double reach, const Vec3d& at) {
    for (std::size_t i = 0; i < count; ++i) {
      ShapeId a = ids[random.below(ids.size())];
      ShapeId b = ids[random.below(ids.size())];
      if (!a.is_composite() && !b.is_composite()) b = ids[8 + random.below(ids.size() - 8)];
      for (const ShapeId id : {a, b}) {
        body.push_back(id);
        pose.push_back(random_pose(random, reach));
        for (int axis = 0; axis < 3; ++axis) pose.back().position[axis] += at[axis];
      }
      const auto n = static_cast<std::uint32_t>(body.size());
      pairs.push_back({n - 2, n - 1});
    }
  }
};

/// Returns all primitives of a body by `visit` without a limit.
inline std::vector<Primitive> parts_of(const CompositeWorld& world, ShapeId id, const Pose& pose) {
  std::vector<Primitive> parts;
  if (!id.is_composite()) {
    Primitive whole;
    whole.shape = id;
    whole.pose = pose;
    if (id.kind() == ShapeKind::triangle) {
      whole.triangle = world.shapes.tables().triangles[id.index()];
    }
    return {whole};
  }
  MovingBox all{{-1e30, -1e30, -1e30}, {1e30, 1e30, 1e30}};
  mid::visit(world.composites, id, pose, all, mid::Solids::hulls,
             {[](void* context, const Primitive& primitive, double limit) {
                static_cast<std::vector<Primitive>*>(context)->push_back(primitive);
                return limit;
              },
              &parts});
  return parts;
}

/// Runs the narrow phase on pairs of primitives.
inline void answer(const ShapePool& shapes, const PrimitivePairs& pairs,
                   const NarrowOptions& options, NarrowResult& result) {
  NarrowPhase narrow;
  ASSERT_EQ(narrow.collide(pairs.tables(shapes),
                           {{pairs.shapes.data(), pairs.shapes.size()},
                            {pairs.poses.data(), pairs.poses.size()}},
                           {pairs.pairs.data(), pairs.pairs.size()}, options, result),
            Status::ok);
}

}  // namespace winnow::test
