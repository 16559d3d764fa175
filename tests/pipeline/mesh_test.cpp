// TriangleMesh: storage, bounds, memory, refused input, refit, and the detection of active
// (non-internal) edges.

#include <gtest/gtest.h>
#include <winnow/pipeline/surfaces.h>
#include "pipeline/mesh/mesh_traversal.h"
#include "pipeline/mesh/mesh_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/config.h"
#include "tests/support/counting_memory.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Slots = std::vector<std::uint32_t>;
using Vertices = std::vector<Eigen::Vector3f>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// Returns the triangles whose boxes overlap [min, max], by the caller's numbers, ascending.
Slots numbers_in(const TriangleMesh& mesh, const double min[3], const double max[3]) {
  Slots slots(mesh.triangles());
  SlotSink sink{slots.data(), slots.size(), 0};
  mesh_overlap(view_of(mesh), min, max, sink);
  slots.resize(static_cast<std::size_t>(sink.size));
  for (auto& slot : slots) slot = view_of(mesh).triangle[slot] & kTriangleNumberMask;
  std::sort(slots.begin(), slots.end());
  return slots;
}

/// Returns the active edges by the caller's triangle numbers.
std::vector<unsigned> edges_of(const TriangleMesh& mesh) {
  std::vector<unsigned> edges(mesh.triangles());
  for (std::size_t slot = 0; slot < edges.size(); ++slot) {
    const std::uint32_t word = view_of(mesh).triangle[slot];
    edges[word & kTriangleNumberMask] = word >> kActiveEdgeShift;
  }
  return edges;
}

std::vector<unsigned> edges_of(const Vertices& vertices, const Slots& corners,
                               double angle = 0.02) {
  TriangleMesh mesh;
  const MeshData data{"", vertices, corners};
  EXPECT_EQ(data.build(mesh, {angle}), Status::ok);
  return edges_of(mesh);
}

TEST(TriangleMeshes, each_triangle_is_stored_once_with_its_corners) {
  for (const MeshData& data : sample_meshes()) {
    TriangleMesh mesh;
    ASSERT_EQ(data.build(mesh), Status::ok);
    ASSERT_EQ(mesh.triangles(), data.triangles());
    std::vector<int> seen(data.triangles());
    for (std::size_t slot = 0; slot < whole_leaves(mesh.triangles()); ++slot) {
      const std::uint32_t number = view_of(mesh).triangle[slot] & kTriangleNumberMask;
      if (slot < mesh.triangles()) ++seen[number];
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(corner_of(view_of(mesh), k, slot), data.corners[3 * number + k]) << data.name;
      }
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<int>(seen.size()));
    for (const auto& v : data.vertices) EXPECT_LE(v.cast<double>().norm(), mesh.radius());
  }
}

TEST(TriangleMeshes, strided_input_of_any_precision_builds_equal_mesh) {
  const MeshData data = torus(9, 7);
  struct Row {
    double unused;
    double at[3];
  };
  struct Face {
    std::uint16_t corner[3];
    std::uint16_t unused;
  };
  std::vector<Row> rows;
  for (const auto& v : data.vertices) rows.push_back({0.0, {v.x(), v.y(), v.z()}});
  std::vector<Face> faces;
  for (std::size_t i = 0; i < data.triangles(); ++i) {
    Face face{};
    for (std::size_t k = 0; k < 3; ++k) {
      face.corner[k] = static_cast<std::uint16_t>(data.corners[3 * i + k]);
    }
    faces.push_back(face);
  }
  TriangleMesh plain;
  TriangleMesh strided;
  ASSERT_EQ(data.build(plain), Status::ok);
  const double* first = rows[0].at;
  ASSERT_EQ(strided.build(PointView({first, first + 1, first + 2}, rows.size(), sizeof(Row)),
                          IndexView(faces[0].corner, faces.size(), sizeof(Face))),
            Status::ok);
  for (std::size_t slot = 0; slot < plain.triangles(); ++slot) {
    EXPECT_EQ(view_of(plain).triangle[slot], view_of(strided).triangle[slot]);
  }
}

/// Returns the decoded value of a bound of a slot's box.
double box_bound(const MeshView& view, std::uint32_t slot, std::size_t bound) {
  const std::size_t axis = bound % 3;
  return static_cast<double>(view.origin[axis]) +
         static_cast<double>(view.box[place_of_bound(slot, bound)]) *
             static_cast<double>(view.step[axis]);
}

TEST(TriangleMeshes, triangle_soup_stores_box_per_triangle) {
  TriangleMesh closed;
  ASSERT_EQ(torus(24, 12).build(closed), Status::ok);
  EXPECT_EQ(view_of(closed).box, nullptr);
  const MeshData data = degenerate_soup(300, 5);
  CountingMemory memory;
  TriangleMesh soup(&memory);
  ASSERT_EQ(data.build(soup), Status::ok);
  ASSERT_EQ(soup.refit(data.points()), Status::ok);
  EXPECT_EQ(soup.footprint().total().reserved, memory.outstanding());
  const MeshView& view = view_of(soup);
  ASSERT_NE(view.box, nullptr);
  for (std::uint32_t slot = 0; slot < view.triangle_count; ++slot) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto x = static_cast<double>(coordinate(view, corner_of(view, k, slot), axis));
        EXPECT_LE(box_bound(view, slot, axis), x);
        EXPECT_GE(box_bound(view, slot, 3 + axis), x);
        EXPECT_LE(bound_of(view, 0, slot / kMeshFanout, axis),
                  view.box[place_of_bound(slot, axis)]);
      }
    }
  }
}

TEST(TriangleMeshes, leaves_with_shared_vertices_list_them) {
  TriangleMesh shared;
  ASSERT_EQ(terrain(20).build(shared), Status::ok);
  EXPECT_EQ(view_of(shared).corner[0], nullptr);
  TriangleMesh crowded;
  ASSERT_EQ(littered_terrain(16).build(crowded), Status::ok);
  EXPECT_EQ(view_of(crowded).corner[0], nullptr);
  EXPECT_NE(view_of(crowded).leaf_more, nullptr);
  TriangleMesh apart;
  ASSERT_EQ(thin_sheets(10).build(apart), Status::ok);
  EXPECT_NE(view_of(apart).corner[0], nullptr);
}

TEST(TriangleMeshes, leaf_points_are_rounded_to_their_box) {
  std::size_t crowded = 0;
  for (const MeshData& data : {terrain(30), terrain(100)}) {
    TriangleMesh mesh;
    ASSERT_EQ(data.build(mesh), Status::ok);
    const MeshView& view = view_of(mesh);
    ASSERT_NE(view.leaf_point, nullptr) << data.name;
    const auto expect_there = [&](std::uint32_t leaf, std::size_t at) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double low = bound_of(view, 0, leaf, axis);
        const double step = (bound_of(view, 0, leaf, 3 + axis) - low) / kMaxLeafPoint;
        const auto x = static_cast<double>(coordinate(view, view.leaf_vertex[at], axis));
        const std::uint32_t point = view.leaf_point[at] >> (kLeafPointBits * axis) & kMaxLeafPoint;
        EXPECT_NEAR(low + point * step, mesh_units(view, axis, x), 0.501 * step) << data.name;
      }
    };
    for (std::uint32_t leaf = 0; leaf < view.count[0]; ++leaf) {
      for (std::size_t i = 0; i < kMeshFanout; ++i) expect_there(leaf, leaf * kMeshFanout + i);
      if (view.leaf_more == nullptr) continue;
      crowded += view.leaf_more[leaf + 1] - view.leaf_more[leaf];
      for (std::size_t block = view.leaf_more[leaf]; block < view.leaf_more[leaf + 1]; ++block) {
        const std::size_t first = (view.count[0] + block) * kMeshFanout;
        for (std::size_t i = 0; i < kMeshFanout; ++i) expect_there(leaf, first + i);
      }
    }
  }
  EXPECT_GT(crowded, 0U);
  TriangleMesh littered;
  ASSERT_EQ(littered_terrain(16).build(littered), Status::ok);
  EXPECT_EQ(view_of(littered).leaf_point, nullptr) << "it would take too much memory";
}

TEST(TriangleMeshes, mesh_takes_at_most_24_bytes_per_triangle) {
  for (const MeshData& data : {torus(100, 50), terrain(70)}) {
    CountingMemory memory;
    TriangleMesh mesh(&memory);
    ASSERT_EQ(data.build(mesh), Status::ok);
    EXPECT_EQ(mesh.footprint().total().reserved, memory.outstanding());
    EXPECT_LE(memory.outstanding(), 24 * mesh.triangles()) << data.name;
    const std::size_t requests = memory.requests();
    ASSERT_EQ(mesh.refit(data.points()), Status::ok);
    EXPECT_EQ(mesh.footprint().total().reserved, memory.outstanding());
    EXPECT_GT(memory.requests(), requests);
    const std::size_t warm = memory.requests();
    ASSERT_EQ(mesh.refit(data.points()), Status::ok);
    EXPECT_EQ(memory.requests(), warm) << "only the first refit allocates";
    const TriangleMesh moved = std::move(mesh);
    EXPECT_EQ(mesh.triangles(), 0U);  // NOLINT(bugprone-use-after-move): moved-from is empty
    EXPECT_EQ(moved.footprint().total().reserved, memory.outstanding());
  }
}

TEST(TriangleMeshes, parallel_build_matches_serial_build) {
  const MeshData data = torus(200, 60);
  TriangleMesh serial;
  ASSERT_EQ(data.build(serial), Status::ok);
  for (const Workers& workers : all_workers()) {
    Threads threads(workers.threads);
    TriangleMesh mesh;
    ASSERT_EQ(threads.run([&] {
      return mesh.build(data.points(), data.indices(), {}, workers.execution());
    }),
              Status::ok);
    EXPECT_TRUE(std::equal(view_of(mesh).triangle, view_of(mesh).triangle + mesh.triangles(),
                           view_of(serial).triangle));
    EXPECT_TRUE(std::equal(view_of(mesh).node[0],
                           view_of(mesh).node[0] + 6 * whole_leaves(view_of(mesh).count[0]),
                           view_of(serial).node[0]));
  }
}

TEST(TriangleMeshes, bad_input_is_refused_and_changes_nothing) {
  const MeshData good = torus(6, 5);
  TriangleMesh mesh;
  ASSERT_EQ(good.build(mesh), Status::ok);
  const auto edges = edges_of(mesh);
  const auto refused = [&](MeshData data, const MeshOptions& options = {}) {
    const Status status = data.build(mesh, options);
    EXPECT_EQ(mesh.triangles(), good.triangles());
    EXPECT_EQ(edges_of(mesh), edges);
    return status;
  };
  MeshData bad = good;
  bad.corners[4] = static_cast<std::uint32_t>(bad.vertices.size());
  EXPECT_EQ(refused(bad), Status::invalid_shape);
  for (const float x : {kNan, kInf, -kInf}) {
    bad = good;
    bad.vertices[3].y() = x;
    EXPECT_EQ(refused(bad), Status::invalid_shape);
    EXPECT_EQ(mesh.refit(bad.points()), Status::invalid_shape);
    EXPECT_EQ(edges_of(mesh), edges);
  }
  EXPECT_EQ(refused({"", good.vertices, {}}), Status::invalid_shape);
  EXPECT_EQ(refused({"", {}, {}}), Status::invalid_shape);
  EXPECT_EQ(refused({"", {}, {0, 0, 0}}), Status::invalid_shape);
  for (const double angle : {-0.1, 3.2, static_cast<double>(kNan)}) {
    EXPECT_EQ(refused(good, {angle}), Status::invalid_argument);
  }
  const std::vector<Eigen::Vector3d> beyond(good.vertices.size(), {1e39, 0, 0});
  EXPECT_EQ(mesh.build(std::span<const Eigen::Vector3d>(beyond), good.indices()),
            Status::invalid_shape);
  EXPECT_EQ(mesh.build(PointView(), good.indices()), Status::invalid_shape);
  PointView without;
  without.count = 3;
  EXPECT_EQ(mesh.build(without, good.indices()), Status::invalid_argument);
  bad = good;
  bad.vertices.pop_back();
  EXPECT_EQ(mesh.refit(bad.points()), Status::size_mismatch);
  EXPECT_EQ(edges_of(mesh), edges);
}

TEST(TriangleMeshes, refused_memory_changes_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  TriangleMesh mesh(&memory);
  const MeshData before = torus(8, 6);
  const MeshData after = terrain(9);
  ASSERT_EQ(before.build(mesh), Status::ok);
  const std::size_t bytes = memory.outstanding();
  std::size_t refusals = 0;
  for (std::size_t grants = 0;; ++grants) {
    memory.refuse_after(grants);
    const Status status = after.build(mesh);
    memory.grant_all();
    if (status == Status::ok) break;
    ++refusals;
    ASSERT_EQ(status, Status::out_of_memory);
    ASSERT_EQ(mesh.triangles(), before.triangles());
    ASSERT_EQ(memory.outstanding(), bytes);
  }
  EXPECT_GT(refusals, 10U);
  EXPECT_EQ(mesh.triangles(), after.triangles());
  const auto edges = edges_of(mesh);
  Vertices flat = after.vertices;
  for (auto& v : flat) v.z() = 0.0F;
  for (std::size_t grants = 0;; ++grants) {
    memory.refuse_after(grants);
    const Status status = mesh.refit({std::span<const Eigen::Vector3f>(flat)});
    memory.grant_all();
    if (status == Status::ok) break;
    ASSERT_EQ(edges_of(mesh), edges);
  }
  EXPECT_NE(edges_of(mesh), edges);
}

TEST(TriangleMeshes, refitted_mesh_matches_rebuilt_mesh) {
  Random random(6);
  for (const MeshData& data : sample_meshes()) {
    TriangleMesh mesh;
    ASSERT_EQ(data.build(mesh), Status::ok);
    MeshData moved = data;
    for (auto& v : moved.vertices) v = Eigen::Vector3f(v.y() * 2.0F, v.x() + 0.3F * v.z(), -v.z());
    ASSERT_EQ(mesh.refit(moved.points()), Status::ok);
    TriangleMesh rebuilt;
    ASSERT_EQ(moved.build(rebuilt), Status::ok);
    EXPECT_EQ(mesh.bounds(), rebuilt.bounds());
    EXPECT_EQ(mesh.radius(), rebuilt.radius());
    EXPECT_EQ(edges_of(mesh), edges_of(rebuilt));
    for (int k = 0; k < 20; ++k) {
      double min[3];
      double max[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        min[axis] = mesh.radius() * random.uniform(-1, 1);
        max[axis] = min[axis] + mesh.radius() * random.uniform(0, 0.5);
      }
      EXPECT_EQ(numbers_in(mesh, min, max), numbers_in(rebuilt, min, max)) << data.name;
    }
  }
}

TEST(ActiveEdges, flat_floor_has_only_border_edges) {
  MeshData floor = terrain(3);
  for (auto& v : floor.vertices) v.z() = 0.5F;
  const auto is_border = [&](std::uint32_t u, std::uint32_t v) {
    const Eigen::Vector3f a = floor.vertices[u];
    const Eigen::Vector3f b = floor.vertices[v];
    return (a.x() == b.x() && (a.x() == 0 || a.x() == 3)) ||
           (a.y() == b.y() && (a.y() == 0 || a.y() == 3));
  };
  const auto expect_border = [&](const MeshData& data, const std::vector<unsigned>& edges) {
    for (std::size_t i = 0; i < floor.triangles(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const bool border = is_border(floor.corners[3 * i + k], floor.corners[3 * i + (k + 1) % 3]);
        EXPECT_EQ((edges[i] >> k & 1U) != 0, border) << data.name << i << " " << k;
      }
    }
  };
  expect_border(floor, edges_of(floor.vertices, floor.corners));
  MeshData split{"split", {}, {}};
  for (const std::uint32_t corner : floor.corners) {
    split.corners.push_back(static_cast<std::uint32_t>(split.vertices.size()));
    split.vertices.push_back(floor.vertices[corner]);
  }
  expect_border(split, edges_of(split.vertices, split.corners));
  // A triangle degenerated to a segment between two triangles does not separate them, and is
  // ignored.
  Slots corners = floor.corners;
  corners.insert(corners.end(), {0, 5, 5, 5, 0, 0});
  const auto edges = edges_of(floor.vertices, corners);
  expect_border(floor, edges);
  EXPECT_EQ(edges[floor.triangles()], 0U);
  EXPECT_EQ(edges[floor.triangles() + 1], 0U);
  // Flip one triangle. Its edges 0 and 2 change places.
  corners = floor.corners;
  std::swap(corners[3 * 8 + 1], corners[3 * 8 + 2]);
  EXPECT_EQ(edges_of(floor.vertices, corners)[8], 0U);
}

TEST(ActiveEdges, convex_edges_beyond_angle_are_active) {
  // Two triangles share the edge from (0, 0, 0) to (0, 1, 0). The right one is tilted by `bend`.
  const auto shared_edge = [](double bend, double angle, bool flip) {
    const Vertices v = {
        {0, 0, 0},
        {0, 1, 0},
        {-1, 0, 0},
        {static_cast<float>(std::cos(bend)), 0, static_cast<float>(-std::sin(bend))}};
    const Slots corners = flip ? Slots{0, 1, 2, 0, 1, 3} : Slots{0, 1, 2, 1, 0, 3};
    const auto edges = edges_of(v, corners, angle);
    EXPECT_EQ(edges[0] & 1U, edges[1] & 1U);
    EXPECT_EQ(edges[0] & 6U, 6U) << "borders";
    return (edges[0] & 1U) != 0;
  };
  const double kHalfTurn = std::acos(-1.0);
  for (const double bend : {0.021, 0.5, 1.5, 2.5, 3.1}) {
    EXPECT_TRUE(shared_edge(bend, 0.02, false)) << bend;
    EXPECT_FALSE(shared_edge(-bend, 0.02, false)) << bend;
    EXPECT_FALSE(shared_edge(bend, bend + 0.01, false)) << bend;
    EXPECT_TRUE(shared_edge(bend, bend - 0.01, false)) << bend;
    // Without a consistent winding both bends count.
    EXPECT_TRUE(shared_edge(bend, 0.02, true)) << bend;
    EXPECT_TRUE(shared_edge(-bend, 0.02, true)) << bend;
    EXPECT_FALSE(shared_edge(-bend, bend + 0.01, true)) << bend;
  }
  EXPECT_FALSE(shared_edge(0.0, 0.0, false));
  EXPECT_FALSE(shared_edge(0.019, 0.02, false));
  EXPECT_TRUE(shared_edge(kHalfTurn, 0.02, false)) << "the edge of a folded sheet";
  EXPECT_TRUE(shared_edge(kHalfTurn, 0.0, false));
  EXPECT_FALSE(shared_edge(kHalfTurn, kHalfTurn, false));
}

TEST(ActiveEdges, edges_of_fans_and_slivers_are_active) {
  const Vertices v = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 2, 0}};
  const auto fan = edges_of(v, {0, 1, 2, 1, 0, 3, 0, 1, 4});
  EXPECT_EQ(fan, (std::vector<unsigned>{7, 7, 7}));
  const auto sliver = edges_of(v, {0, 1, 5, 1, 0, 3});
  EXPECT_EQ(sliver, (std::vector<unsigned>{7, 7}));
  for (const float scale : {1e-38F, 1e38F}) {
    Vertices scaled_v = v;
    for (auto& p : scaled_v) p *= scale;
    EXPECT_EQ(edges_of(scaled_v, {0, 1, 2, 1, 0, 3}), (std::vector<unsigned>{6, 6})) << scale;
    EXPECT_EQ(edges_of(scaled_v, {0, 1, 2, 1, 0, 4}), (std::vector<unsigned>{6, 6})) << scale;
    EXPECT_EQ(edges_of(scaled_v, {1, 0, 2, 0, 1, 4}), (std::vector<unsigned>{7, 7})) << scale;
  }
}

}  // namespace
}  // namespace winnow::test
