// mesh_overlap with a hull: the traversal compared with distances of all triangles from the hull.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>
#include "pipeline/mesh/mesh_traversal.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Slots = std::vector<std::uint32_t>;

Vector3d random_vector(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach),
          random.uniform(-reach, reach)};
}

Matrix3d random_turn(Random& random) {
  const Vector3d axis = random_vector(random, 1.0);
  return Eigen::AngleAxisd(random.uniform(0.0, 3.0), axis.normalized()).toRotationMatrix();
}

/// A hull near a corner of a mesh. The mesh is rotated, scaled and mirrored in the hull's frame.
struct HullOnMesh {
  ShapePool shapes;
  ShapeId hull;
  Matrix3d linear;
  Vector3d offset;
  double size;

  HullOnMesh(const TriangleMesh& mesh, Random& random)
      : size(mesh.radius() * random.log_uniform(1e-3, 1.0)) {
    const Vector3d center = size * random_vector(random, random.chance(0.5) ? 0.0 : 50.0);
    std::vector<Vector3d> points;
    const std::size_t count = random.chance(0.2) ? 3 : 4 + random.below(60);
    for (std::size_t i = 0; i < count; ++i) points.push_back(center + random_vector(random, size));
    hull = expect_ok(shapes.add_hull(points, 0.0));
    Vector3d scale = Vector3d::Ones();
    if (random.chance(0.5)) scale = random_vector(random, 3.0) + Vector3d::Constant(0.1);
    linear = random_turn(random) * scale.asDiagonal();
    const auto slot = static_cast<std::uint32_t>(random.below(view_of(mesh).triangle_count));
    offset = center + random_vector(random, size) - linear * corner(mesh, slot, 0);
  }

  [[nodiscard]] const HullShape& shape() const { return shapes.tables().hulls[hull.index()]; }

  [[nodiscard]] static Vector3d corner(const TriangleMesh& mesh, std::uint32_t slot, int k) {
    const MeshView& view = view_of(mesh);
    Vector3d at;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      at[static_cast<Eigen::Index>(axis)] = static_cast<double>(
          coordinate(view, corner_of(view, static_cast<std::size_t>(k), slot), axis));
    }
    return at;
  }

  /// Returns the slots that the traversal reports.
  [[nodiscard]] Slots find(const TriangleMesh& mesh, double reach) const {
    MeshHull query{shape(), {}, reach};
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        query.mesh_in_hull.matrix[row][column] = linear(row, column);
      }
      query.mesh_in_hull.offset[row] = offset[row];
    }
    const Vector3d center = linear.inverse() * (as_eigen(shape().center) - offset);
    const double infinity = std::numeric_limits<double>::infinity();
    const double low[3] = {-infinity, -infinity, -infinity};
    const double high[3] = {infinity, infinity, infinity};
    Slots slots(view_of(mesh).triangle_count);
    SlotSink sink{slots.data(), slots.size(), 0};
    mesh_overlap(view_of(mesh), low, high, center.data(), infinity, &query, sink);
    EXPECT_LE(sink.size, slots.size());
    slots.resize(static_cast<std::size_t>(sink.size));
    return slots;
  }

  /// Returns the distance of every triangle from the hull, by slot.
  [[nodiscard]] std::vector<double> distances(const TriangleMesh& mesh) {
    const std::uint32_t count = view_of(mesh).triangle_count;
    std::vector<ShapeId> ids{hull};
    std::vector<BodyPair> pairs;
    for (std::uint32_t slot = 0; slot < count; ++slot) {
      TriangleShape triangle{};
      for (int k = 0; k < 3; ++k) {
        as_eigen(triangle.vertex[k]) = linear * corner(mesh, slot, k) + offset;
      }
      ids.emplace_back();
      ids.back() = expect_ok(shapes.add(triangle));
      pairs.push_back({0, slot + 1});
    }
    const std::vector<Pose> poses(ids.size());
    NarrowPhase narrow;
    NarrowResult result;
    EXPECT_EQ(
        narrow.collide(shapes, {ids, poses}, pairs, {.level = ContactLevel::distance}, result),
        Status::ok);
    std::vector<double> distance(count);
    for (std::size_t i = 0; i < result.size(); ++i) {
      distance[result.pair_of(i)] = result.distance()[i];
    }
    return distance;
  }
};

TEST(MeshHulls, all_triangles_within_reach_are_found) {
  Random random(31);
  std::size_t near = 0;
  std::size_t kept = 0;
  std::size_t dropped = 0;
  for (const MeshData& data : sample_meshes()) {
    TriangleMesh mesh;
    ASSERT_EQ(data.build(mesh), Status::ok);
    for (std::size_t k = 0; k < scaled(60); ++k) {
      HullOnMesh scene(mesh, random);
      const double reach = random.chance(0.5) ? 0.0 : scene.size * random.uniform(0.0, 0.5);
      const Slots found = scene.find(mesh, reach);
      for (const Isa isa : available_isas()) {
        const IsaScope scope(isa);
        EXPECT_EQ(scene.find(mesh, reach), found) << to_string(isa);
      }
      const std::vector<double> distance = scene.distances(mesh);
      for (std::uint32_t slot = 0; slot < distance.size(); ++slot) {
        const bool is_found = std::binary_search(found.begin(), found.end(), slot);
        const double rounding = 1e-9 * (scene.size + scene.offset.norm());
        if (distance[slot] <= reach - rounding) {
          EXPECT_TRUE(is_found) << data.name << ' ' << slot << ' ' << distance[slot] - reach;
        }
        const bool is_near = distance[slot] <= reach + 1e-3 * scene.size;
        near += is_near ? 1U : 0U;
        (is_found && !is_near ? kept : dropped) += is_near ? 0U : 1U;
      }
    }
  }
  EXPECT_GT(near, scaled(300));
  // The remaining false positives are separated only by a cross product of two edges.
  EXPECT_LT(kept, dropped / 50);
  EXPECT_LT(kept, near);
}

TEST(MeshHulls, numbers_beyond_float_keep_all_triangles) {
  Random random(32);
  TriangleMesh mesh;
  ASSERT_EQ(terrain(4).build(mesh), Status::ok);
  const std::size_t all = view_of(mesh).triangle_count;
  HullOnMesh scene(mesh, random);
  scene.linear *= 1e60;
  EXPECT_EQ(scene.find(mesh, 0.0).size(), all);
  scene.linear *= 1e-60;
  scene.offset.array() += 1e40;
  EXPECT_EQ(scene.find(mesh, 0.0).size(), all);
  scene.offset.array() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(scene.find(mesh, 0.0).size(), all);
}

}  // namespace
}  // namespace winnow::test
