// Deformable meshes, feature impacts, and surfaces and hulls that are read from another pool, in C,
// compared with the C++ object behind each handle.

#include "tests/c/handles_of_c.h"

#include <winnow/pipeline/deformable_mesh.h>
#include <winnow/pipeline/impacts.h>

#include <array>
#include <cmath>
#include <cstring>
#include <vector>

namespace winnow::test {
namespace {

/// A square cloth of kEdge x kEdge vertices.
struct ClothOfC {
  static constexpr std::uint32_t kEdge = 6;

  explicit ClothOfC(double height = 0.0) : mesh(winnow_deformable_mesh_create, nullptr) {
    for (std::uint32_t i = 0; i < kEdge * kEdge; ++i) {
      // The right half is folded over the left half, a little above it.
      const double x = i % kEdge;
      const bool is_folded = x > 2.0;
      start.insert(start.end(), {is_folded ? 5.0 - x : x, static_cast<double>(i / kEdge),
                                 height + (is_folded ? 1.0 : 0.0)});
      end.insert(end.end(), {start[3 * i], start[3 * i + 1], height + (is_folded ? 0.25 : 0.5)});
    }
    for (std::uint32_t row = 0; row + 1 < kEdge; ++row) {
      for (std::uint32_t column = 0; column + 1 < kEdge; ++column) {
        const std::uint32_t at = row * kEdge + column;
        corners.insert(corners.end(), {at, at + 1, at + kEdge, at + 1, at + kEdge + 1, at + kEdge});
      }
    }
    const winnow_point_view rest = winnow_points(start.data(), start.size() / 3);
    const winnow_point_view after = winnow_points(end.data(), end.size() / 3);
    const winnow_index_view triangles = {corners.data(), 0, corners.size() / 3, WINNOW_UINT32};
    EXPECT_EQ(winnow_deformable_mesh_move(mesh, &rest, &after, 2.0), WINNOW_INVALID_ARGUMENT);
    EXPECT_EQ(winnow_deformable_mesh_build(mesh, &rest, &triangles), WINNOW_OK);
    EXPECT_EQ(winnow_deformable_mesh_move(mesh, &rest, &after, 2.0), WINNOW_OK);
  }

  OwnedMesh mesh;
  std::vector<double> start;
  std::vector<double> end;
  std::vector<std::uint32_t> corners;
};

/// Collects chunks of results of C.
template <typename OfC, typename Chunks>
class Collector {
 public:
  [[nodiscard]] const Chunks* chunks() noexcept { return &chunks_; }
  /// True if the collected results are the results of the C++ call, and there are some.
  template <typename OfCpp, typename Run>
  [[nodiscard]] bool equals(Run&& run) {
    std::vector<OfCpp> expected;
    const auto take = [&](std::span<const OfCpp> chunk) {
      expected.insert(expected.end(), chunk.begin(), chunk.end());
    };
    if (run(take) != Status::ok || expected.size() != all_.size() || all_.empty()) return false;
    return std::equal(all_.begin(), all_.end(), expected.begin(),
                      [](const OfC& a, const OfCpp& b) { return have_same_bits(a, b); });
  }

 private:
  static void take(void* context, const OfC* first, std::size_t count) {
    auto& all = static_cast<Collector*>(context)->all_;
    all.insert(all.end(), first, first + count);
  }
  std::vector<OfC> all_;
  Chunks chunks_{&take, this};
};
using PairsOfC = Collector<winnow_pair, winnow_pair_chunks>;
using ImpactsOfC = Collector<winnow_mesh_impact, winnow_mesh_impact_chunks>;
using CloseOfC = Collector<winnow_mesh_proximity, winnow_mesh_proximity_chunks>;
using ShapeImpactsOfC = Collector<winnow_mesh_shape_impact, winnow_mesh_shape_impact_chunks>;

TEST(CInterface, counts_of_a_deformable_mesh_equal_cpp) {
  const ClothOfC cloth;
  EXPECT_EQ(got<std::size_t>(winnow_deformable_mesh_triangles, cloth.mesh), 50U);
  EXPECT_EQ(got<std::size_t>(winnow_deformable_mesh_vertices, cloth.mesh), 36U);
  EXPECT_EQ(got<std::size_t>(winnow_deformable_mesh_edges, cloth.mesh), cloth.mesh->edges());
  std::array<std::uint32_t, 2> edge{};
  EXPECT_EQ(winnow_deformable_mesh_edge(cloth.mesh, 3, edge.data()), WINNOW_OK);
  EXPECT_EQ(edge, cloth.mesh->edge(3));
  EXPECT_EQ(winnow_deformable_mesh_edge(cloth.mesh, cloth.mesh->edges(), edge.data()),
            WINNOW_INVALID_ARGUMENT);
  const auto bytes = got<winnow_footprint>(winnow_deformable_mesh_footprint, cloth.mesh);
  EXPECT_EQ(bytes.structure.reserved,
            cloth.mesh->footprint().structure.reserved + sizeof(winnow_deformable_mesh));
}

TEST(CInterface, cloth_gives_the_results_of_cpp) {
  const ClothOfC cloth;
  const ClothOfC other(0.125);
  const OwnedMesh& mesh = cloth.mesh;
  const OwnedMesh& with = other.mesh;
  for (const winnow_feature_pair kind : {WINNOW_FEATURES_VERTEX_FACE, WINNOW_FEATURES_EDGE_EDGE}) {
    const auto same = static_cast<FeaturePair>(kind);
    PairsOfC pairs;
    EXPECT_EQ(winnow_deformable_mesh_self_candidates(mesh, kind, pairs.chunks()), WINNOW_OK);
    EXPECT_TRUE(pairs.equals<Pair>([&](auto& t) { return mesh->self_candidates(same, t); }));
    PairsOfC pairs_with;
    EXPECT_EQ(winnow_deformable_mesh_candidates_with(mesh, with, kind, pairs_with.chunks()),
              WINNOW_OK);
    EXPECT_TRUE(
        pairs_with.equals<Pair>([&](auto& t) { return mesh->candidates_with(*with, same, t); }));
    ImpactsOfC impacts;
    EXPECT_EQ(winnow_deformable_mesh_self_impacts(mesh, kind, nullptr, impacts.chunks()),
              WINNOW_OK);
    EXPECT_TRUE(
        impacts.equals<MeshImpact>([&](auto& t) { return mesh->self_impacts(same, {}, t); }));
    ImpactsOfC impacts_with;
    winnow_feature_impact_options options = WINNOW_FEATURE_IMPACT_OPTIONS;
    options.min_separation = 0.25;
    EXPECT_EQ(
        winnow_deformable_mesh_impacts_with(mesh, with, kind, &options, impacts_with.chunks()),
        WINNOW_OK);
    EXPECT_TRUE(impacts_with.equals<MeshImpact>(
        [&](auto& t) { return mesh->impacts_with(*with, same, {.min_separation = 0.25}, t); }));
    CloseOfC close;
    EXPECT_EQ(winnow_deformable_mesh_self_proximity(mesh, kind, 0.5, close.chunks()), WINNOW_OK);
    EXPECT_TRUE(
        close.equals<MeshProximity>([&](auto& t) { return mesh->self_proximity(same, 0.5, t); }));
    CloseOfC close_with;
    EXPECT_EQ(winnow_deformable_mesh_proximity_with(mesh, with, kind, 0.5, close_with.chunks()),
              WINNOW_OK);
    EXPECT_TRUE(close_with.equals<MeshProximity>(
        [&](auto& t) { return mesh->proximity_with(*with, same, 0.5, t); }));
  }
  EXPECT_EQ(winnow_deformable_mesh_self_candidates(mesh, 2, PairsOfC().chunks()),
            WINNOW_INVALID_ARGUMENT);
}

TEST(CInterface, cloth_that_touches_a_shape_gives_impacts) {
  const ClothOfC cloth;
  const OwnedShapes shapes(winnow_shape_pool_create, nullptr);
  const winnow_shape ball = {WINNOW_SHAPE_SPHERE, {.sphere = {0.5}}};
  winnow_mesh_obstacle obstacle = WINNOW_MESH_OBSTACLE;
  ShapeImpactsOfC impacts;
  EXPECT_EQ(
      winnow_deformable_mesh_impacts_with_shape(cloth.mesh, &obstacle, nullptr, impacts.chunks()),
      WINNOW_INVALID_ARGUMENT);
  obstacle.shapes = shapes;
  obstacle.shape = got<winnow_shape_id>(winnow_shape_pool_add, shapes, &ball);
  obstacle.motion.start.position[0] = 1.25;
  obstacle.motion.start.position[1] = 2.25;
  obstacle.motion.start.position[2] = 3.0;
  obstacle.motion.travel[2] = -3.0;
  EXPECT_EQ(
      winnow_deformable_mesh_impacts_with_shape(cloth.mesh, &obstacle, nullptr, impacts.chunks()),
      WINNOW_OK);
  const MeshObstacle same{*shapes, {obstacle.shape}, *c::as_cpp(&obstacle.motion)};
  EXPECT_TRUE(impacts.equals<MeshShapeImpact>(
      [&](auto& t) { return cloth.mesh->impacts_with(same, {}, t); }));
}

TEST(CInterface, feature_impacts_equal_cpp_one_by_one) {
  const std::array<double, 12> start = {0.25, 0.25, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::array<double, 12> end = start;
  end[2] = -1.0;
  const auto one = [&](const std::array<double, 12>& after) {
    return got<winnow_feature_hit>(winnow_feature_impact, WINNOW_FEATURES_VERTEX_FACE, start.data(),
                                   after.data(), nullptr);
  };
  EXPECT_TRUE(one(end).hit);
  EXPECT_NEAR(one(end).time, 0.5, 1e-9);
  EXPECT_FALSE(one(start).hit);
  winnow_feature_columns columns{};
  columns.count = 1;
  for (std::size_t i = 0; i < 12; ++i) {
    columns.start[i / 3][i % 3] = &start[i];
    columns.end[i / 3][i % 3] = &end[i];
  }
  double time = 0.0;
  EXPECT_EQ(winnow_feature_impacts(WINNOW_FEATURES_VERTEX_FACE, &columns, &time, nullptr),
            WINNOW_OK);
  EXPECT_EQ(time, one(end).time);
  columns.end[3][2] = nullptr;
  EXPECT_EQ(winnow_feature_impacts(WINNOW_FEATURES_VERTEX_FACE, &columns, &time, nullptr),
            WINNOW_INVALID_ARGUMENT);
}

/// A pool with one triangle, one height field and one convex shape.
struct SurfacesOfC {
  SurfacesOfC()
      : shapes(winnow_shape_pool_create, nullptr),
        pool(winnow_composite_pool_create, static_cast<const winnow_shape_pool*>(shapes), nullptr) {
    const double points[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::uint32_t corners[3] = {0, 1, 2};
    const winnow_point_view vertices = winnow_points(points, 3);
    const winnow_index_view triangles = {corners, 0, 1, WINNOW_UINT32};
    mesh = got<winnow_shape_id>(winnow_composite_pool_add_mesh, pool, &vertices, &triangles,
                                nullptr, nullptr);
    const float heights[4] = {0.0F, 1.0F, 2.0F, 3.0F};
    const winnow_height_samples samples = {heights, 4, 2, 2, 0, {1.0, 1.0}};
    field = got<winnow_shape_id>(winnow_composite_pool_add_height_field, pool, &samples);
  }

  OwnedShapes shapes;
  OwnedComposites pool;
  winnow_shape_id mesh = WINNOW_NO_SHAPE;
  winnow_shape_id field = WINNOW_NO_SHAPE;
};

TEST(CInterface, surfaces_become_one_sided_and_two_sided) {
  const SurfacesOfC surfaces;
  for (const winnow_shape_id id : {surfaces.mesh, surfaces.field}) {
    EXPECT_FALSE(got<bool>(winnow_composite_pool_is_one_sided, surfaces.pool, id));
    EXPECT_EQ(winnow_composite_pool_set_one_sided(surfaces.pool, id, true), WINNOW_OK);
    EXPECT_TRUE(got<bool>(winnow_composite_pool_is_one_sided, surfaces.pool, id));
  }
  EXPECT_EQ(winnow_composite_pool_set_one_sided(surfaces.pool, 77, true), WINNOW_INVALID_KEY);
}

TEST(CInterface, saved_surfaces_are_added_to_another_pool) {
  const SurfacesOfC from;
  const SurfacesOfC into;
  const OwnedSnapshot snapshot(winnow_snapshot_create, nullptr);
  const double scale[3] = {2.0, 3.0, -1.0};
  EXPECT_EQ(winnow_composite_pool_save_mesh(from.pool, from.mesh, snapshot), WINNOW_OK);
  auto bytes = got_all<std::uint8_t>(winnow_snapshot_bytes, snapshot);
  const auto mesh = got<winnow_shape_id>(winnow_composite_pool_add_saved_mesh, into.pool,
                                         bytes.data(), bytes.size(), scale, nullptr);
  std::array<double, 3> own{};
  EXPECT_EQ(winnow_composite_pool_scale(into.pool, mesh, own.data()), WINNOW_OK);
  EXPECT_EQ(own, (std::array<double, 3>{2.0, 3.0, -1.0}));
  EXPECT_EQ(into.pool->mesh({mesh})->triangles(), 1U);
  winnow_shape_id none = WINNOW_NO_SHAPE;
  EXPECT_EQ(
      winnow_composite_pool_add_saved_height_field(into.pool, bytes.data(), bytes.size(), &none),
      WINNOW_INVALID_ARGUMENT);
  EXPECT_EQ(winnow_composite_pool_save_height_field(from.pool, from.field, snapshot), WINNOW_OK);
  bytes = got_all<std::uint8_t>(winnow_snapshot_bytes, snapshot);
  const auto field = got<winnow_shape_id>(winnow_composite_pool_add_saved_height_field, into.pool,
                                          bytes.data(), bytes.size());
  EXPECT_EQ(into.pool->height_field({field})->triangles(), 2U);
  EXPECT_EQ(winnow_composite_pool_save_mesh(from.pool, from.field, snapshot), WINNOW_INVALID_KEY);
  const std::uint64_t before = got<std::uint64_t>(winnow_composite_pool_revision, into.pool);
  EXPECT_EQ(winnow_composite_pool_remove(into.pool, mesh), WINNOW_OK);
  EXPECT_GT(got<std::uint64_t>(winnow_composite_pool_revision, into.pool), before);
}

TEST(CInterface, built_hull_is_stored_bit_for_bit) {
  const SurfacesOfC surfaces;
  const double corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const winnow_point_view points = winnow_points(corners, 4);
  const auto hull = got<winnow_shape_id>(winnow_shape_pool_add_hull, surfaces.shapes, &points, 0.1);
  const auto read = got<winnow_hull>(winnow_shape_pool_hull, surfaces.shapes, hull);
  std::vector<std::uint32_t> sizes;
  std::size_t indices = 0;
  for (std::size_t face = 0; face < read.faces; ++face) {
    sizes.push_back(read.face[face].count);
    indices += read.face[face].count;
  }
  const winnow_hull_faces faces = {read.loop, indices, sizes.data(), sizes.size()};
  const winnow_point_view vertices = {
      {read.vertex[0], read.vertex[1], read.vertex[2]}, 0, read.vertices, WINNOW_DOUBLE};
  const OwnedShapes other(winnow_shape_pool_create, nullptr);
  const auto built = got<winnow_shape_id>(winnow_shape_pool_add_built_hull, other, &vertices,
                                          &faces, read.rounding);
  const HullShape& own = surfaces.shapes->tables().hulls[ShapeId{hull}.index()];
  const HullShape& same = other->tables().hulls[ShapeId{built}.index()];
  EXPECT_EQ(own.vertex_count, same.vertex_count);
  EXPECT_EQ(std::memcmp(own.faces, same.faces, own.face_count * sizeof *own.faces), 0);
}

}  // namespace
}  // namespace winnow::test
