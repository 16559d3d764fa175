// ShapePool: construction of convex hulls, refused shapes, memory, bounds, and the presence of
// narrow-phase kernels.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/pipeline/shape_pool.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory_resource>
#include <random>
#include <vector>

#include "pipeline/kernels/kernels.h"
#include "tests/support/answers.h"
#include "tests/support/counting_memory.h"
#include "tests/support/heap_count.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

using Points = std::vector<Eigen::Vector3d>;

Points on_a_ball(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Points points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p(normal(random), normal(random), normal(random));
    points.push_back(p.normalized());
  }
  return points;
}

// The corners of a cube and points on its faces.
Points on_a_cube(int count, double scale) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Points points;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d p(uniform(random), uniform(random), uniform(random));
    p[i % 3] = i / 3 % 2 == 0 ? 1.0 : -1.0;
    if (i < 8)
      p = {(i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0, (i & 4) != 0 ? 1.0 : -1.0};
    points.push_back(p * scale);
  }
  return points;
}

#define EXPECT_COUNTS(hull, vertices, face_total, edge_total) \
  EXPECT_EQ((hull).vertex_count, vertices);                   \
  EXPECT_EQ((hull).face_count, face_total);                   \
  EXPECT_EQ((hull).edge_count, edge_total)

class Hulls : public testing::Test {
 protected:
  const HullShape& hull_of(const Points& points, const Eigen::Vector3d& at = {0, 0, 0}) {
    Points moved;
    for (const auto& p : points) moved.push_back(p + at);
    ShapeId id = expect_ok(pool_.add_hull(moved, 0.0));
    return pool_.tables().hulls[id.index()];
  }

  // Checks that every vertex is below every face, that loops and edges agree, and that vertices
  // have as many neighbours as edges.
  static void expect_consistent(const HullShape& hull) {
    for (std::uint32_t f = 0; f < hull.face_count; ++f) {
      const HullFace& face = hull.faces[f];
      for (std::uint32_t v = 0; v < hull.vertex_count; ++v) {
        const double height = face.normal[0] * hull.vertex[0][v] +
                              face.normal[1] * hull.vertex[1][v] +
                              face.normal[2] * hull.vertex[2][v];
        EXPECT_LE(height, face.offset + 1e-12 * hull.radius);
      }
      for (std::uint32_t i = 0; i < face.count; ++i) {
        const HullEdge& edge = hull.edges[hull.loop_edge[face.first + i]];
        const std::uint32_t from = hull.loop[face.first + i];
        const std::uint32_t to = hull.loop[face.first + (i + 1) % face.count];
        const bool forward = edge.vertex[0] == from && edge.vertex[1] == to && edge.face[0] == f;
        const bool back = edge.vertex[1] == from && edge.vertex[0] == to && edge.face[1] == f;
        EXPECT_TRUE(forward || back);
      }
    }
    EXPECT_EQ(hull.neighbour_first[hull.vertex_count], 2 * hull.edge_count);
  }

  ShapePool pool_;
};

TEST_F(Hulls, points_in_general_position_give_triangle_faces) {
  for (const int count : {4, 5, 16, 64, 1000}) {
    const HullShape& hull = hull_of(on_a_ball(count, 1));
    const auto n = static_cast<std::uint32_t>(count);
    EXPECT_COUNTS(hull, n, 2 * n - 4, 3 * n - 6);
    EXPECT_EQ(hull.dimension, 3U);
    expect_consistent(hull);
  }
}

TEST_F(Hulls, points_on_cube_give_cube_at_any_size) {
  for (const double scale : {1.0, 1e-20, 1e-300, 1e100}) {
    const HullShape& hull = hull_of(on_a_cube(100, scale));
    EXPECT_COUNTS(hull, 8U, 6U, 12U);
    EXPECT_NEAR(hull.radius, std::sqrt(3.0) * scale, 1e-12 * scale);
    EXPECT_NEAR(hull.inner_radius, scale, 1e-12 * scale);
    expect_consistent(hull);
  }
}

TEST_F(Hulls, turned_lattice_gives_cube) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.3, 0.4, -0.2, 0.8).normalized();
  Points points;
  for (int i = 0; i < 1000; ++i)
    points.push_back(turn * Eigen::Vector3d(i % 10, i / 10 % 10, i / 100));
  const HullShape& hull = hull_of(points);
  EXPECT_COUNTS(hull, 8U, 6U, 12U);
  expect_consistent(hull);
}

TEST_F(Hulls, flat_sets_give_polygons_segments_and_points) {
  Points grid;
  for (int i = 0; i < 100; ++i) grid.emplace_back(i % 10, i / 10, 0.5 * (i % 10) + 0.25 * (i / 10));
  const HullShape& polygon = hull_of(grid);
  EXPECT_EQ(polygon.dimension, 2U);
  EXPECT_COUNTS(polygon, 4U, 2U, 4U);
  EXPECT_EQ(polygon.inner_radius, 0.0);
  expect_consistent(polygon);

  Points line;
  for (int i = 0; i < 10; ++i) line.emplace_back(0.1 * i, 0.3 * i, -0.7 * i);
  const HullShape& segment = hull_of(line);
  EXPECT_EQ(segment.dimension, 1U);
  EXPECT_COUNTS(segment, 2U, 0U, 1U);

  const HullShape& point = hull_of({{1, 2, 3}, {1, 2, 3}});
  EXPECT_EQ(point.dimension, 0U);
  EXPECT_COUNTS(point, 1U, 0U, 0U);
  EXPECT_EQ(point.vertex[2][15], 3.0);
}

// Point sets that are almost degenerate: numbers of all magnitudes, plates and needles down to
// double precision, noisy lattices, moment curves.
Points hostile_points(int kind, Random& random) {
  using Vec = Eigen::Vector3d;
  const auto centred = [&] { return random.uniform(-0.5, 0.5); };
  const auto any = [&] { return Vec(centred(), centred(), centred()); };
  const auto of_any_size = [&] {
    return random.chance(0.125) ? 0.0
                                : (centred() < 0.0 ? -1.0 : 1.0) * random.log_uniform(1e-9, 1e9);
  };
  const Vec a = any();
  const Vec b = any();
  const Vec c = any();
  const double thin = random.log_uniform(1e-14, 1.0);
  Points points(4 + random.below(60));
  for (Vec& p : points) {
    const double t = random.uniform(-1.0, 1.0);
    switch (kind) {
      case 0:
        p = Vec(of_any_size(), of_any_size(), of_any_size());
        break;
      case 1:
        p = any() + 1e6 * a;
        break;
      case 2:
        p = centred() * a + centred() * b + thin * centred() * c;
        break;
      case 3:
        p = centred() * a + thin * centred() * b + thin * thin * centred() * c;
        break;
      case 4:
        p = Vec(std::round(4.0 * t), std::round(4.0 * centred()), t > 0.0) + thin * any();
        break;
      case 5:
        p = Vec(std::cos(3.2 * t), std::sin(3.2 * t), centred() < 0.0 ? thin : -thin);
        break;
      case 6:
        p = Vec(t, t * t, thin * t * t * t);
        break;
      case 7:
        p = Vec(t, thin * t * t, thin * thin * t * t * t);
        break;
      case 8:
        p = random.chance(0.7) ? Vec(thin * any()) : Vec(of_any_size(), of_any_size(), t);
        break;
      default:
        p = any().normalized().cwiseProduct(Vec(1.0, 1.0, thin));
        break;
    }
  }
  return points;
}
constexpr int kHostileKinds = 10;

TEST_F(Hulls, hostile_sets_lose_no_points) {
  Random random(41);
  for (std::size_t i = 0; i < scaled(4000) + kHostileKinds; ++i) {
    const Points points = hostile_points(static_cast<int>(i % kHostileKinds), random);
    ShapeId id;
    ASSERT_EQ(pool_.add_hull(points, 0.0).get(id), Status::ok) << i;
    const HullShape& hull = pool_.tables().hulls[id.index()];
    const auto farthest = [](const Eigen::Vector3d& along, std::size_t count, auto&& point) {
      double most = -kInf;
      for (std::size_t k = 0; k < count; ++k) most = std::max(most, along.dot(point(k)));
      return most;
    };
    const Eigen::Vector3d center = as_eigen(hull.center);
    const auto expect_reached = [&](const Eigen::Vector3d& along) {
      const double given = farthest(along, points.size(), [&](std::size_t k) -> Eigen::Vector3d {
        return points[k] - center;
      });
      const double reached =
          farthest(along, hull.vertex_count, [&](std::size_t k) -> Eigen::Vector3d {
            return Eigen::Vector3d(hull.vertex[0][k], hull.vertex[1][k], hull.vertex[2][k]) -
                   center;
          });
      EXPECT_LE(given - reached, 1e-12 * hull.radius) << i << ", kind " << i % kHostileKinds;
    };
    for (std::uint32_t f = 0; f < hull.face_count; ++f) {
      expect_reached(as_eigen(hull.faces[f].normal));
    }
    for (int k = 0; k < 20; ++k) {
      const auto one = [&] { return points[random.below(points.size())]; };
      const Eigen::Vector3d along = k % 2 == 0
                                        ? Eigen::Vector3d(one() - one())
                                        : Eigen::Vector3d((one() - one()).cross(one() - one()));
      expect_reached(along.stableNormalized());
    }
    if (HasFailure()) return;
    EXPECT_EQ(pool_.remove(id), Status::ok);
  }
}

TEST_F(Hulls, thickness_of_a_millionth_is_kept) {
  Points plate;
  for (int i = 0; i < 8; ++i) plate.emplace_back(i & 1, i >> 1 & 1, 1e-6 * (i >> 2));
  const HullShape& hull = hull_of(plate);
  EXPECT_EQ(hull.dimension, 3U);
  EXPECT_COUNTS(hull, 8U, 6U, 12U);
}

class Cube : public testing::Test {
 protected:
  const Points corners_{{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                        {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  std::vector<std::uint32_t> triangles_{0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                        1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
  const std::vector<std::uint32_t> threes_ = std::vector<std::uint32_t>(12, 3);
  ShapePool pool_;
  ShapeId id_;

  Status add() { return pool_.add_hull(corners_, HullFaces{triangles_, threes_}, 0.0).get(id_); }
};

TEST_F(Cube, twelve_triangles_merge_into_six_faces) {
  ASSERT_EQ(add(), Status::ok);
  const HullShape& hull = pool_.tables().hulls[id_.index()];
  EXPECT_COUNTS(hull, 8U, 6U, 12U);
  for (std::uint32_t f = 0; f < 6; ++f) EXPECT_EQ(hull.faces[f].offset, 1.0);
}

TEST_F(Cube, open_inverted_or_badly_indexed_cube_is_refused) {
  std::swap(triangles_[0], triangles_[1]);
  EXPECT_EQ(add(), Status::invalid_shape);
  std::swap(triangles_[0], triangles_[1]);
  for (std::size_t i = 0; i < triangles_.size(); i += 3)
    std::swap(triangles_[i], triangles_[i + 1]);
  EXPECT_EQ(add(), Status::invalid_shape);
  triangles_[0] = 8;
  EXPECT_EQ(add(), Status::invalid_shape);
  triangles_.pop_back();
  EXPECT_EQ(add(), Status::invalid_shape);
  EXPECT_EQ(pool_.size(ShapeKind::hull), 0U);
}

TEST_F(Cube, dented_cube_is_refused) {
  Points dented = corners_;
  dented[6] = {0.1, 0.1, 0.1};
  expect_error(pool_.add_hull(dented, HullFaces{triangles_, threes_}, 0.0), Status::invalid_shape);
}

TEST(ShapePools, bad_shapes_are_refused_and_change_nothing) {
  ShapePool pool;
  for (const double bad : {-1.0, kNan, kInf}) {
    expect_error(pool.add(SphereShape{bad}), Status::invalid_shape);
    expect_error(pool.add(CapsuleShape{1.0, bad}), Status::invalid_shape);
    expect_error(pool.add(BoxShape{{1.0, bad, 1.0}}), Status::invalid_shape);
    expect_error(pool.add(BoxShape{{1.0, 1.0, 1.0}, bad}), Status::invalid_shape);
    expect_error(pool.add(CylinderShape{bad, 1.0}), Status::invalid_shape);
    expect_error(pool.add(ConeShape{1.0, bad}), Status::invalid_shape);
    expect_error(pool.add_hull(Points{{0, 0, 0}}, bad), Status::invalid_shape);
  }
  expect_error(pool.add(TriangleShape{{{0, 0, 0}, {1, kNan, 0}, {0, 1, 0}}}),
               Status::invalid_shape);
  expect_error(pool.add(HalfSpaceShape{{0, 0, 0}}), Status::invalid_shape);
  expect_error(pool.add(HalfSpaceShape{{0, 0, 1}, kInf}), Status::invalid_shape);
  expect_error(pool.add_hull(Points{}, 0.0), Status::invalid_shape);
  expect_error(pool.add_hull(Points{{0, kInf, 0}}, 0.0), Status::invalid_shape);
  EXPECT_EQ(pool.footprint().total().reserved, 0U);
}

TEST(ShapePools, removed_slot_is_reused_by_next_shape) {
  ShapePool pool;
  ShapeId first;
  ShapeId second;
  first = expect_ok(pool.add_hull(on_a_ball(16, 1), 0.0));
  ASSERT_EQ(pool.remove(first), Status::ok);
  EXPECT_FALSE(pool.contains(first));
  EXPECT_EQ(pool.tables().hulls[first.index()].vertex_count, 1U);
  EXPECT_EQ(pool.remove(first), Status::invalid_key);
  EXPECT_EQ(pool.remove(ShapeId{}), Status::invalid_key);
  second = expect_ok(pool.add_hull(on_a_ball(20, 1), 0.5));
  EXPECT_EQ(second, first);
  EXPECT_EQ(pool.tables().hulls[second.index()].rounding, 0.5);
}

TEST(ShapePools, footprint_is_exact_and_refused_memory_changes_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  {
    ShapePool pool(&memory);
    ShapeId id = expect_ok(pool.add(SphereShape{1.0}));
    id = expect_ok(pool.add_hull(on_a_ball(64, 2), 0.0));
    EXPECT_EQ(pool.footprint().total().reserved, memory.outstanding());
    const std::size_t before = memory.outstanding();
    memory.refuse_after(0);
    expect_error(pool.add(BoxShape{{1, 1, 1}}), Status::out_of_memory);
    expect_error(pool.add_hull(on_a_ball(64, 2), 0.0), Status::out_of_memory);
    EXPECT_EQ(memory.outstanding(), before);
    EXPECT_EQ(pool.size(ShapeKind::hull), 1U);
  }
  EXPECT_EQ(memory.outstanding(), 0U);
}

// Ways to add a hull. Each of them allocates different scratch memory.
using AddHull = Status (*)(ShapePool& pool, ShapeId& id);

Status add_ball(ShapePool& pool, ShapeId& id) {
  return pool.add_hull(on_a_ball(64, 2), 0.0).get(id);
}
Status add_polygon(ShapePool& pool, ShapeId& id) {
  return pool.add_hull(Points{{0, 0, 1}, {2, 0, 1}, {1, 1, 1}, {2, 2, 1}, {0, 2, 1}}, 0.0).get(id);
}
Status add_segment(ShapePool& pool, ShapeId& id) {
  return pool.add_hull(Points{{0, 0, 0}, {1, 2, 3}, {2, 4, 6}}, 0.0).get(id);
}
Status add_tetrahedron(ShapePool& pool, ShapeId& id) {
  static const Points corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  static const std::vector<std::uint32_t> indices{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  static const std::vector<std::uint32_t> sizes(4, 3);
  return pool.add_hull(corners, HullFaces{indices, sizes}, 0.0).get(id);
}

TEST(ShapePools, refused_memory_of_hull_changes_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  for (const AddHull add : {add_ball, add_polygon, add_segment, add_tetrahedron}) {
    CountingMemory memory;
    ShapePool pool(&memory);
    ShapeId first = expect_ok(pool.add_hull(Points{{1, 2, 3}}, 0.0));
    ASSERT_EQ(pool.remove(first),
              Status::ok);  // the table has a free slot: all requests belong to the hull
    const std::size_t before = memory.outstanding();
    std::size_t granted = 0;
    ShapeId id;
    memory.refuse_one_after(granted);
    Status status = add(pool, id);
    while (status == Status::out_of_memory) {
      EXPECT_EQ(memory.outstanding(), before);
      EXPECT_EQ(pool.size(ShapeKind::hull), 0U);
      EXPECT_EQ(id, ShapeId{});
      memory.refuse_one_after(++granted);
      status = add(pool, id);
    }
    EXPECT_EQ(status, Status::ok);
    EXPECT_EQ(memory.refusals(), granted);
    EXPECT_GT(granted, 1U);
    memory.grant_all();
    EXPECT_TRUE(pool.contains(id));
    EXPECT_EQ(pool.footprint().total().reserved, memory.outstanding());
  }
}

TEST(ShapePools, global_heap_is_not_used) {
  alignas(64) static std::byte room[1U << 20U];
  std::pmr::monotonic_buffer_resource memory(room, sizeof(room), std::pmr::null_memory_resource());
  ShapePool pool(&memory);
  ShapeId id;
  const Points ball = on_a_ball(64, 2);
  ASSERT_EQ(add_tetrahedron(pool, id), Status::ok);  // creates its static corners
  const std::size_t before = heap_requests();
  id = expect_ok(pool.add_hull(ball, 0.0));
  EXPECT_EQ(add_tetrahedron(pool, id), Status::ok);
  EXPECT_EQ(heap_requests(), before);
}

TEST(ShapeBounds, bounds_contain_shape_and_are_tight) {
  ShapePool pool;
  ShapeId box = expect_ok(pool.add(BoxShape{{1.0, 2.0, 3.0}, 0.5}));
  const double h = std::sqrt(0.5);
  const Aabb bounds = pool.bounds(box, {{10.0, 0.0, 1e9}, {h, 0.0, 0.0, h}});
  EXPECT_NEAR(bounds.max.x(), 12.5F, 1e-5F);
  EXPECT_GE(bounds.max.x(), 12.5F);
  EXPECT_NEAR(bounds.min.y(), -1.5F, 1e-5F);
  EXPECT_LE(bounds.min.y(), -1.5F);
  EXPECT_GE(static_cast<double>(bounds.max.z()), 1e9 + 3.5);
}

// Adding a shape of a kind registers the kernels of its pairs.
TEST(NarrowKernels, added_shape_kinds_register_kernels) {
  ShapePool pool;
  ShapeId id = expect_ok(pool.add(SphereShape{1.0}));
  id = expect_ok(pool.add(CapsuleShape{1.0, 1.0}));
  id = expect_ok(pool.add(BoxShape{{1.0, 1.0, 1.0}}));
  id = expect_ok(pool.add(CylinderShape{1.0, 1.0}));
  id = expect_ok(pool.add(ConeShape{1.0, 1.0}));
  id = expect_ok(pool.add(TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}));
  id = expect_ok(pool.add(HalfSpaceShape{}));
  const Points tetrahedron{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<std::uint32_t> corners{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  const std::vector<std::uint32_t> sizes{3, 3, 3, 3};
  id = expect_ok(pool.add_hull(tetrahedron, HullFaces{corners, sizes}, 0.0));
  for (const ShapeKind kind_a : kConvexKinds) {
    for (const ShapeKind kind_b : kConvexKinds) {
      if (kind_b < kind_a || kind_b > ShapeKind::half_space) continue;
      const bool half_spaces = kind_a == ShapeKind::half_space && kind_b == ShapeKind::half_space;
      EXPECT_EQ(narrow_kernels(kind_a, kind_b) == nullptr, half_spaces)
          << to_string(kind_a) << " and " << to_string(kind_b);
    }
  }
}

TEST(ShapeBounds, half_space_bounds_end_only_at_plane) {
  ShapePool pool;
  ShapeId floor = expect_ok(pool.add(HalfSpaceShape{{0.0, 0.0, 2.0}, 1.0}));
  const Aabb bounds = pool.bounds(floor, Pose::at(0.0, 0.0, 5.0));
  EXPECT_EQ(bounds.min.z(), -std::numeric_limits<float>::infinity());
  EXPECT_EQ(bounds.max.x(), std::numeric_limits<float>::infinity());
  EXPECT_GE(bounds.max.z(), 5.5F);
  EXPECT_LE(bounds.max.z(), 5.50001F);
}

}  // namespace
}  // namespace winnow::test
