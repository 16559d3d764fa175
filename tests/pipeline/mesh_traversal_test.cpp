// Traversals of mesh trees (overlap, pairs, cast, near, rays) on every ISA, compared with tests of
// all triangles in long double.

#include "pipeline/mesh/mesh_traversal.h"
#include <gtest/gtest.h>
#include "pipeline/mesh/mesh_rays.kernel.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "tests/support/config.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Real = long double;
using Point = std::array<Real, 3>;

struct ReferenceTriangle {
  Point corner[3];

  [[nodiscard]] Real low(std::size_t axis) const {
    return std::min({corner[0][axis], corner[1][axis], corner[2][axis]});
  }
  [[nodiscard]] Real high(std::size_t axis) const {
    return std::max({corner[0][axis], corner[1][axis], corner[2][axis]});
  }
};

/// Returns the placed triangles of a mesh by slot.
std::vector<ReferenceTriangle> reference_triangles(const MeshView& mesh,
                                                   const MeshPlacement& placement = {}) {
  std::vector<ReferenceTriangle> result(mesh.triangle_count);
  for (std::size_t slot = 0; slot < result.size(); ++slot) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t row = 0; row < 3; ++row) {
        Real x = static_cast<Real>(placement.offset[row]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          x += static_cast<Real>(placement.matrix[row][axis]) *
               static_cast<Real>(coordinate(mesh, corner_of(mesh, k, slot), axis));
        }
        result[slot].corner[k][row] = x;
      }
    }
  }
  return result;
}

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Returns the gap between a and b, b grown by the margin, along an axis. Negative if they overlap.
Real gap_along(const ReferenceTriangle& a, const ReferenceTriangle& b, const double margin[3],
               const Point& axis) {
  const Real length = std::sqrt(dot(axis, axis));
  if (length == 0) return -1;
  Real ends[2][2];
  for (int side = 0; side < 2; ++side) {
    const ReferenceTriangle& t = side == 0 ? a : b;
    const Real x = dot(axis, t.corner[0]);
    const Real y = dot(axis, t.corner[1]);
    const Real z = dot(axis, t.corner[2]);
    ends[side][0] = std::min({x, y, z});
    ends[side][1] = std::max({x, y, z});
  }
  Real grow = 0;
  for (std::size_t k = 0; k < 3; ++k) grow += std::abs(axis[k]) * static_cast<Real>(margin[k]);
  return (std::max(ends[0][0] - ends[1][1], ends[1][0] - ends[0][1]) - grow) / length;
}

Real box_gap(const ReferenceTriangle& a, const ReferenceTriangle& b, const double margin[3]) {
  Real result = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const Real between = std::max(a.low(k) - b.high(k), b.low(k) - a.high(k));
    result = std::max(result, between - static_cast<Real>(margin[k]));
  }
  return result;
}

/// Returns the largest gap along the frame's axes and the normals, and with `all` also along cross
/// products of edges. If the triangles, one of them grown, overlap, no gap is positive.
Real gap(const ReferenceTriangle& a, const ReferenceTriangle& b, const double margin[3], bool all) {
  Real result = box_gap(a, b, margin);
  if (result > 0) return result;
  Point edges[2][3];
  for (std::size_t k = 0; k < 3; ++k) {
    edges[0][k] = minus(a.corner[(k + 1) % 3], a.corner[k]);
    edges[1][k] = minus(b.corner[(k + 1) % 3], b.corner[k]);
  }
  for (const auto& e : edges) result = std::max(result, gap_along(a, b, margin, cross(e[0], e[1])));
  if (!all) return result;
  for (const Point& e : edges[0]) {
    for (const Point& f : edges[1]) result = std::max(result, gap_along(a, b, margin, cross(e, f)));
  }
  return result;
}

/// Calls body on every ISA and expects equal results.
template <typename Body>
auto on_all_isas(Body&& body) {
  std::vector<decltype(body())> results;
  for (const Isa isa : available_isas()) {
    const IsaScope scope(isa);
    results.push_back(body());
    EXPECT_TRUE(results.back() == results.front()) << to_string(isa);
  }
  return results.front();
}

class Meshes : public testing::Test {
 protected:
  Meshes() {
    for (const MeshData& data : sample_meshes()) {
      meshes_.emplace_back();
      EXPECT_EQ(data.build(meshes_.back()), Status::ok) << data.name;
    }
  }
  std::vector<TriangleMesh> meshes_;
};

using Slots = std::vector<std::uint32_t>;
using SlotPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Traverses twice: first without capacity, then with the counted capacity.
template <typename Traverse>
Slots collect(Traverse&& traverse) {
  SlotSink sink;
  traverse(sink);
  Slots slots(static_cast<std::size_t>(sink.size));
  sink = {slots.data(), slots.size(), 0};
  traverse(sink);
  EXPECT_EQ(sink.size, slots.size());
  return slots;
}

Slots overlap(const MeshView& mesh, const double min[3], const double max[3]) {
  return collect([&](SlotSink& sink) { mesh_overlap(mesh, min, max, sink); });
}

SlotPairs overlap_pairs(const MeshView& a, const MeshView& b, const MeshPlacement& placement,
                        const double margin[3]) {
  SlotPairSink sink;
  mesh_overlap_pairs(a, b, placement, margin, sink);
  Slots first(static_cast<std::size_t>(sink.size));
  Slots second(first.size());
  sink = {first.data(), second.data(), first.size(), 0};
  mesh_overlap_pairs(a, b, placement, margin, sink);
  EXPECT_EQ(sink.size, first.size());
  SlotPairs pairs;
  for (std::size_t i = 0; i < first.size(); ++i) pairs.emplace_back(first[i], second[i]);
  return pairs;
}

MeshPlacement random_placement(Random& random, double reach) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond(random.uniform(-1, 1), random.uniform(-1, 1),
                                                     random.uniform(-1, 1), random.uniform(-1, 1))
                                      .normalized();
  const Eigen::Matrix3d rotation = turn.toRotationMatrix();
  MeshPlacement placement;
  for (int row = 0; row < 3; ++row) {
    placement.offset[row] = random.uniform(-reach, reach);
    for (int column = 0; column < 3; ++column) {
      const double scale = random.chance(0.5) ? 1.0 : random.uniform(-2, 2);
      placement.matrix[row][column] = rotation(row, column) * scale;
    }
  }
  return placement;
}

/// Checks that each overlapping pair is found exactly once, and no pair whose boxes are apart by
/// more than 64 ulps of the coordinates.
void expect_pairs(const TriangleMesh& a, const TriangleMesh& b, const MeshPlacement& placement,
                  const double margin[3]) {
  const SlotPairs found =
      on_all_isas([&] { return overlap_pairs(view_of(a), view_of(b), placement, margin); });
  const std::set<SlotPairs::value_type> set(found.begin(), found.end());
  EXPECT_EQ(set.size(), found.size());
  const auto own = reference_triangles(view_of(a));
  const auto placed = reference_triangles(view_of(b), placement);
  const Real rounding = static_cast<Real>((a.radius() + b.radius() * 4.0 + 2.0) * 64 * 0x1p-24);
  std::size_t missed = 0;
  std::size_t apart = 0;
  for (std::uint32_t i = 0; i < own.size(); ++i) {
    for (std::uint32_t j = 0; j < placed.size(); ++j) {
      const Real between = box_gap(own[i], placed[j], margin);
      const bool is_found = set.count({i, j}) != 0;
      apart += is_found && between > rounding;
      missed += !is_found && between <= 0 && gap(own[i], placed[j], margin, true) <= 0;
    }
  }
  EXPECT_EQ(missed, 0U);
  EXPECT_EQ(apart, 0U);
}

/// Returns the distance of a point from a triangle: from its plane if the projection is inside,
/// else from an edge.
Real distance(const ReferenceTriangle& t, const Point& point) {
  const auto& c = t.corner;
  const Point normal = cross(minus(c[1], c[0]), minus(c[2], c[0]));
  const Real length = std::sqrt(dot(normal, normal));
  Real nearest = std::numeric_limits<Real>::infinity();
  bool inside = length > 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point edge = minus(c[(k + 1) % 3], c[k]);
    const Point from = minus(point, c[k]);
    const Real square = dot(edge, edge);
    const Real along = square > 0 ? std::clamp<Real>(dot(from, edge) / square, 0, 1) : 0;
    const Point away = minus(from, {edge[0] * along, edge[1] * along, edge[2] * along});
    nearest = std::min(nearest, std::sqrt(dot(away, away)));
    inside = inside && dot(cross(normal, edge), from) >= 0;
  }
  return inside ? std::abs(dot(normal, minus(point, c[0]))) / length : nearest;
}

TEST_F(Meshes, trees_of_different_depth_find_all_pairs) {
  TriangleMesh deep;
  TriangleMesh shallow;
  ASSERT_EQ(torus(70, 40).build(deep), Status::ok);
  ASSERT_EQ(gear(3).build(shallow), Status::ok);
  ASSERT_EQ(view_of(deep).levels, 3U);
  ASSERT_EQ(view_of(shallow).levels, 1U);
  const double margin[3] = {0, 0, 0};
  const MeshPlacement tilted{{{0.8, -0.6, 0}, {0.6, 0.8, 0}, {0, 0, 1}}, {0.9, 0.1, 0.2}};
  expect_pairs(deep, shallow, tilted, margin);
  expect_pairs(shallow, deep, tilted, margin);
}

TEST_F(Meshes, small_buffer_delivers_all_pairs_in_order) {
  const MeshPlacement placement{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0.4, 0.2, 0.1}};
  const double margin[3] = {0, 0, 0};
  const MeshView& mesh = view_of(meshes_[0]);
  const SlotPairs expected = overlap_pairs(mesh, mesh, placement, margin);
  ASSERT_GT(expected.size(), 100U);
  for (const std::size_t room : {std::size_t{16}, std::size_t{40}}) {
    SlotPairs taken;
    const auto take = [](void* context, SlotPairSink& sink) {
      for (std::size_t i = 0; i < sink.size; ++i) {
        static_cast<SlotPairs*>(context)->emplace_back(sink.first[i], sink.second[i]);
      }
      sink.size = 0;
    };
    Slots first(room);
    Slots second(room);
    SlotPairSink sink{first.data(), second.data(), room, 0, take, &taken};
    mesh_overlap_pairs(mesh, mesh, placement, margin, sink);
    take(&taken, sink);
    EXPECT_EQ(taken, expected);
  }
}

TEST_F(Meshes, pairs_separated_by_planes_are_dropped) {
  const TriangleMesh& mesh = meshes_[0];
  const MeshPlacement placement{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {1.3, 0.2, 0.1}};
  const double margin[3] = {0, 0, 0};
  const auto own = reference_triangles(view_of(mesh));
  const auto placed = reference_triangles(view_of(mesh), placement);
  const SlotPairs found = overlap_pairs(view_of(mesh), view_of(mesh), placement, margin);
  EXPECT_GT(found.size(), 20U);
  for (const auto& [i, j] : found) EXPECT_LE(gap(own[i], placed[j], margin, false), 1e-5L);
}

TEST_F(Meshes, extreme_scales_and_margins_miss_no_pair) {
  // At any common scale, a mesh overlaps itself in every triangle.
  for (const float scale : {1e-40F, 1e-30F, 1.0F, 1e30F, 1e37F}) {
    MeshData data = torus(12, 8);
    for (auto& v : data.vertices) v *= scale;
    TriangleMesh mesh;
    ASSERT_EQ(data.build(mesh), Status::ok);
    const double margin[3] = {0, 0, 0};
    const SlotPairs found =
        on_all_isas([&] { return overlap_pairs(view_of(mesh), view_of(mesh), {}, margin); });
    const std::set<SlotPairs::value_type> set(found.begin(), found.end());
    for (std::uint32_t i = 0; i < data.triangles(); ++i) EXPECT_TRUE(set.count({i, i})) << scale;
  }
  const TriangleMesh& mesh = meshes_[0];
  for (const double huge : {1e100, 1e300}) {
    MeshPlacement placement;
    for (int k = 0; k < 3; ++k) placement.matrix[k][k] = huge;
    const double margin[3] = {0, 0, huge};
    // At 1e300, products of coordinates leave the range of double, so every pair is reported.
    const SlotPairs found =
        on_all_isas([&] { return overlap_pairs(view_of(mesh), view_of(mesh), placement, margin); });
    for (const auto& [i, j] : found) EXPECT_LT(std::max(i, j), mesh.triangles());
    if (huge > 1e200) {
      EXPECT_EQ(found.size(), mesh.triangles() * mesh.triangles());
    }
  }
}

struct Seen {
  Slots slots;
  double answer = 0.0;
  bool keep = false;

  static double visit(void* context, const std::uint32_t* slots, std::uint32_t count,
                      double limit) {
    auto& seen = *static_cast<Seen*>(context);
    EXPECT_GE(count, 1U);
    EXPECT_LE(count, 16U);
    seen.slots.insert(seen.slots.end(), slots, slots + count);
    return seen.keep ? limit : seen.answer;
  }
};

/// Returns the time when the box [min, max] starts to overlap a triangle's box, or infinity if it
/// does not until the limit.
Real moving_box_time(const ReferenceTriangle& triangle, const double min[3], const double max[3],
                     const double direction[3], Real limit, Real slack) {
  Real first = 0;
  Real last = limit;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Real near = triangle.low(axis) - static_cast<Real>(max[axis]) - slack;
    const Real far = triangle.high(axis) - static_cast<Real>(min[axis]) + slack;
    const auto d = static_cast<Real>(direction[axis]);
    if (d == 0) {
      if (near > 0 || far < 0) return std::numeric_limits<Real>::infinity();
      continue;
    }
    first = std::max(first, std::min(near / d, far / d));
    last = std::min(last, std::max(near / d, far / d));
  }
  return first <= last ? first : std::numeric_limits<Real>::infinity();
}

TEST_F(Meshes, cast_visits_all_triangles_until_limit) {
  Random random(3);
  for (const TriangleMesh& mesh : meshes_) {
    const auto triangles = reference_triangles(view_of(mesh));
    const Eigen::Vector3d middle = (mesh.bounds().min + mesh.bounds().max).cast<double>() * 0.5;
    for (std::size_t k = 0; k < scaled(40); ++k) {
      const double r = mesh.radius();
      double min[3];
      double max[3];
      double direction[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        min[axis] = middle[static_cast<int>(axis)] + r * random.uniform(-1, 1);
        max[axis] = min[axis] + (random.chance(0.5) ? 0.0 : r * random.uniform(0, 0.1));
        direction[axis] = random.chance(0.2) ? 0.0 : r * random.uniform(-1, 1);
      }
      // The inverse of this component overflows, so the traversal treats it as zero and enlarges
      // the box instead.
      const bool slow = random.chance(0.1);
      if (slow) direction[0] = 1e-310;
      const double limit = random.chance(0.3) ? std::numeric_limits<double>::infinity() : 1.5;
      const Slots shown = on_all_isas([&] {
        Seen seen{{}, 0.0, true};
        mesh_cast(view_of(mesh), min, max, direction, limit, {Seen::visit, &seen});
        return seen.slots;
      });
      const std::set<std::uint32_t> set(shown.begin(), shown.end());
      EXPECT_EQ(set.size(), shown.size());
      Real earliest = std::numeric_limits<Real>::infinity();
      for (std::uint32_t slot = 0; slot < triangles.size(); ++slot) {
        const Real time = moving_box_time(triangles[slot], min, max, direction, limit, 0);
        earliest = std::min(earliest, time);
        EXPECT_TRUE(time > static_cast<Real>(limit) || std::isinf(time) || set.count(slot) != 0);
        if (set.count(slot) == 0 || slow) continue;
        EXPECT_FALSE(
            std::isinf(moving_box_time(triangles[slot], min, max, direction, limit, r * 1e-9)))
            << "visited a triangle that the cast never reaches";
      }
      // The visitor returns the earliest time after the first leaf. The traversal may then visit
      // only earlier leaves.
      Seen seen{{}, static_cast<double>(earliest), false};
      mesh_cast(view_of(mesh), min, max, direction, limit, {Seen::visit, &seen});
      EXPECT_LE(seen.slots.size(), shown.size());
      if (!shown.empty()) {
        EXPECT_TRUE(std::any_of(seen.slots.begin(), seen.slots.end(), [&](std::uint32_t slot) {
          return moving_box_time(triangles[slot], min, max, direction, limit, 0) == earliest;
        }));
      }
      seen = {{}, -1.0, false};
      mesh_cast(view_of(mesh), min, max, direction, limit, {Seen::visit, &seen});
      EXPECT_LE(seen.slots.size(), 16U);
    }
  }
}

/// Returns a random point of a triangle, sometimes on an edge or a corner.
Eigen::Vector3d point_of(const ReferenceTriangle& triangle, Random& random) {
  double weight[3];
  for (double& w : weight) w = random.chance(0.3) ? 0.0 : random.uniform(0, 1);
  const double sum = weight[0] + weight[1] + weight[2];
  if (sum == 0.0) weight[0] = 1.0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] += weight[k] / (sum == 0.0 ? 1.0 : sum) *
                     static_cast<double>(triangle.corner[k][static_cast<std::size_t>(axis)]);
    }
  }
  return point;
}

SingleSurfaceRay lone(const SurfaceRay& ray) {
  SingleSurfaceRay result{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.ray.origin[axis][0] = ray.origin[axis];
    result.ray.direction[axis][0] = ray.direction[axis];
  }
  result.slack[0] = ray.slack;
  result.low[0] = ray.low;
  result.high[0] = ray.high;
  return result;
}

TEST_F(Meshes, ray_visits_triangle_at_which_it_aims) {
  Random random(11);
  for (const TriangleMesh& mesh : meshes_) {
    const auto triangles = reference_triangles(view_of(mesh));
    for (std::size_t k = 0; k < scaled(200); ++k) {
      const auto aim = static_cast<std::uint32_t>(random.below(triangles.size()));
      const Eigen::Vector3d at = point_of(triangles[aim], random);
      const double far = mesh.radius() * random.log_uniform(1e-3, 1e6);
      Eigen::Vector3d way(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      if (random.chance(0.3)) way[static_cast<int>(random.below(3))] = 0.0;
      way *= 0.75 / std::max(way.cwiseAbs().maxCoeff(), 1e-9);
      const Eigen::Vector3d from = at - far * way;
      SurfaceRay ray{};
      Eigen::Vector3d::Map(ray.origin) = from;
      Eigen::Vector3d::Map(ray.direction) = way;
      ray.slack = 0x1p-48 * (from.cwiseAbs().maxCoeff() + at.cwiseAbs().maxCoeff() + far);
      const double limit =
          random.chance(0.3) ? std::numeric_limits<double>::infinity() : far * (1.0 + 1e-9);
      ray.high = limit;
      const Slots shown = on_all_isas([&] {
        Seen seen{{}, 0.0, true};
        mesh_ray_kernels().all(view_of(mesh), lone(ray), limit,
                               {[](void* context, std::uint32_t slot, const SurfaceHit&,
                                   double most) { return Seen::visit(context, &slot, 1, most); },
                                [](void* context, std::uint32_t slot, double most) {
                                  return Seen::visit(context, &slot, 1, most);
                                },
                                &seen});
        std::sort(seen.slots.begin(), seen.slots.end());
        return std::binary_search(seen.slots.begin(), seen.slots.end(), aim) ? Slots{aim} : Slots{};
      });
      EXPECT_FALSE(shown.empty()) << "triangle " << aim << " from " << far;
      double corner[3][3];
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          corner[c][axis] = static_cast<double>(triangles[aim].corner[c][axis]);
        }
      }
      SurfaceHit hit{};
      const Crossing crossing = mesh_ray_kernels().cross(ray, corner, hit);
      EXPECT_NE(crossing, Crossing::none);
      if (crossing != Crossing::found) continue;
      const Point normal = cross(minus(triangles[aim].corner[1], triangles[aim].corner[0]),
                                 minus(triangles[aim].corner[2], triangles[aim].corner[0]));
      const Point step{static_cast<Real>(way[0]), static_cast<Real>(way[1]),
                       static_cast<Real>(way[2])};
      const Point start{static_cast<Real>(from[0]), static_cast<Real>(from[1]),
                        static_cast<Real>(from[2])};
      const Real t = dot(normal, minus(triangles[aim].corner[0], start)) / dot(normal, step);
      const Real sine = std::abs(dot(normal, step)) / std::sqrt(dot(normal, normal));
      EXPECT_NEAR(static_cast<double>(t), hit.t,
                  1e-14 * (far + mesh.radius()) / static_cast<double>(sine));
    }
  }
}

/// Returns whether the traversal of the ray from `from` along `way` reports triangle `aim`.
bool is_shown(const TriangleMesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& way,
              std::uint32_t aim) {
  SurfaceRay ray{};
  Eigen::Vector3d::Map(ray.origin) = from;
  Eigen::Vector3d::Map(ray.direction) = way * (0.75 / way.cwiseAbs().maxCoeff());
  ray.slack = 0x1p-46 * (from.cwiseAbs().maxCoeff() + mesh.radius());
  ray.high = std::numeric_limits<double>::infinity();
  struct Sought {
    std::uint32_t slot;
    bool is_seen;
  } sought{aim, false};
  mesh_ray_kernels().all(view_of(mesh), lone(ray), ray.high,
                         {[](void* context, std::uint32_t slot, const SurfaceHit&, double most) {
                            auto& by = *static_cast<Sought*>(context);
                            by.is_seen = by.is_seen || by.slot == slot;
                            return most;
                          },
                          [](void* context, std::uint32_t slot, double most) {
                            auto& by = *static_cast<Sought*>(context);
                            by.is_seen = by.is_seen || by.slot == slot;
                            return most;
                          },
                          &sought});
  return sought.is_seen;
}

TEST(MeshRays, rays_hit_flat_and_thin_meshes) {
  Random random(17);
  constexpr std::uint32_t kCells = 24;
  for (const double height : {0.0, 1e-30, 1e-12, 1e-4, 1.0}) {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<std::uint32_t> corners;
    for (std::uint32_t y = 0; y <= kCells; ++y) {
      for (std::uint32_t x = 0; x <= kCells; ++x) {
        vertices.emplace_back(x, y, height * random.uniform(0, 1));
        if (x == kCells || y == kCells) continue;
        const std::uint32_t i = y * (kCells + 1) + x;
        const std::uint32_t above = i + kCells + 1;
        corners.insert(corners.end(), {i, i + 1, above + 1, i, above + 1, above});
      }
    }
    TriangleMesh mesh;
    ASSERT_EQ(mesh.build(std::span<const Eigen::Vector3d>(vertices),
                         std::span<const std::uint32_t>(corners)),
              Status::ok);
    const auto triangles = reference_triangles(view_of(mesh));
    for (std::size_t k = 0; k < scaled(400); ++k) {
      const auto aim = static_cast<std::uint32_t>(random.below(triangles.size()));
      const Eigen::Vector3d at = point_of(triangles[aim], random);
      Eigen::Vector3d way(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      if (random.chance(0.3)) way[2] *= 1e-9;
      if (random.chance(0.2)) way.head<2>().setZero();
      if (random.chance(0.1)) way[2] = 0.0;
      if (way.isZero()) way[2] = 1.0;
      const Eigen::Vector3d from = at - random.log_uniform(1e-6, 1e6) * way;
      for (const Isa isa : available_isas()) {
        const IsaScope scope(isa);
        EXPECT_TRUE(is_shown(mesh, from, way, aim))
            << "height " << height << " from " << from.transpose() << " by " << way.transpose();
      }
    }
  }
}

constexpr std::uint32_t kNone = ~0U;

/// The closest hits of rays. Counts the triangles in doubt, and ignores them.
template <std::uint32_t Room>
struct Closest {
  static constexpr SurfaceFrame kFrame = {{}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, false, 0.0, 0.0};

  explicit Closest(const SurfaceRayColumns<Room>& given) : rays(given) {
    hits.any = false;
    hits.is_one_sided = false;
    hits.frame = &kFrame;
    hits.first_part = 0;
    hits.test = [](void* context, std::uint32_t ray, std::uint32_t, double limit) {
      ++static_cast<Closest*>(context)->in_doubt[ray];
      return limit;
    };
    hits.context = this;
    std::fill_n(hits.own_limit, Room, -1.0);
  }
  void set(std::uint32_t i, double limit) {
    hits.limit[i] = hits.own_limit[i] = limit;
    hits.unit[i] = 1.0;
    hits.best[i] = &found[i];
  }
  [[nodiscard]] auto result(std::uint32_t i) const {
    const PartHit& hit = found[i];
    return hit.found ? std::tuple(hit.part, hit.t, hit.normal[0]) : std::tuple(kNone, 0.0, 0.0);
  }

  SurfaceRayColumns<Room> rays;
  ClosestHits<Room> hits;
  PartHit found[Room];
  int in_doubt[Room] = {};
};

/// Returns the closest of all triangles that the ray certainly crosses, by number and t.
std::pair<std::uint32_t, double> closest_of_all(const MeshView& mesh, const SingleSurfaceRay& ray,
                                                double limit) {
  struct Found {
    const MeshView& mesh;
    double limit;
    std::pair<double, std::uint32_t> best;
  } found{mesh, limit, {std::numeric_limits<double>::infinity(), kNone}};
  mesh_ray_kernels().all(
      mesh, ray, limit,
      {[](void* context, std::uint32_t slot, const SurfaceHit& hit, double most) {
         auto& to = *static_cast<Found*>(context);
         const std::uint32_t number = to.mesh.triangle[slot] & kTriangleNumberMask;
         if (hit.t <= to.limit) to.best = std::min(to.best, std::pair(hit.t, number));
         return most;
       },
       [](void*, std::uint32_t, double most) { return most; }, &found});
  return {found.best.second, found.best.second == kNone ? 0.0 : found.best.first};
}

TEST_F(Meshes, closest_hits_of_packet_match_single_rays) {
  Random random(13);
  for (const TriangleMesh& mesh : meshes_) {
    const auto triangles = reference_triangles(view_of(mesh));
    for (const std::uint32_t count : {1U, 2U, 9U, kRaysAtOnce}) {
      SurfaceRays rays{};
      double limits[kRaysAtOnce] = {};
      for (std::uint32_t i = 0; i < count; ++i) {
        const Eigen::Vector3d at = point_of(triangles[random.below(triangles.size())], random);
        for (int axis = 0; axis < 3; ++axis) {
          const double way = random.chance(0.1) ? 0.0 : random.uniform(-1, 1);
          rays.ray.direction[axis][i] = axis == 0 ? 0.75 : way;
          rays.ray.origin[axis][i] = at[axis] - mesh.radius() * rays.ray.direction[axis][i];
        }
        rays.slack[i] = 0x1p-46 * mesh.radius();
        rays.t_scale[i] = 1.0;
        rays.high[i] = 4.0 * mesh.radius();
        limits[i] = random.chance(0.2) ? -1.0 : mesh.radius() * random.uniform(0, 3);
      }
      for (const Isa isa : available_isas()) {
        const IsaScope scope(isa);
        Closest<kRaysAtOnce> together(rays);
        for (std::uint32_t i = 0; i < count; ++i) together.set(i, limits[i]);
        mesh_ray_kernels().closest(view_of(mesh), rays, count, together.hits);
        for (std::uint32_t i = 0; i < count; ++i) {
          SingleSurfaceRay ray = lone(rays[i]);
          ray.t_scale[0] = 1.0;
          Closest<1> single(ray);
          single.set(0, limits[i]);
          mesh_ray_kernels().closest_of_one(view_of(mesh), ray, single.hits);
          EXPECT_EQ(together.result(i), single.result(0)) << "ray " << i << " of " << count;
          const auto [number, t] = closest_of_all(view_of(mesh), ray, limits[i]);
          EXPECT_EQ(number, std::get<0>(single.result(0)));
          EXPECT_EQ(t, std::get<1>(single.result(0)));
        }
      }
    }
  }
}

/// Records pairs and keeps the limit.
struct SeenPairs {
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;

  static double visit(void* context, std::uint32_t a, std::uint32_t b, double limit) {
    EXPECT_TRUE(static_cast<SeenPairs*>(context)->pairs.emplace(a, b).second) << "visited twice";
    return limit;
  }
};

TEST_F(Meshes, near_pairs_are_visited_for_any_direction) {
  Random random(12);
  for (std::size_t k = 0; k < scaled(30); ++k) {
    const TriangleMesh& a = meshes_[random.below(meshes_.size())];
    const TriangleMesh& b = meshes_[random.below(meshes_.size())];
    if (a.triangles() * b.triangles() > 2'000'000) continue;
    const MeshPlacement placement = random_placement(random, a.radius() + b.radius());
    const auto own = reference_triangles(view_of(a));
    const auto others = reference_triangles(view_of(b), placement);
    const double limit = random.chance(0.2) ? 0.0 : a.radius() * random.uniform(0, 1);
    Eigen::Vector3f direction(static_cast<float>(random.uniform(-1, 1)),
                              static_cast<float>(random.uniform(-1, 1)),
                              static_cast<float>(random.uniform(-1, 1)));
    direction.normalize();
    const double doubt[3] = {0.0, 0.0, 0.0};
    const auto shown = on_all_isas([&] {
      SeenPairs seen;
      mesh_near_pairs(view_of(a), view_of(b), placement, doubt, limit,
                      {SeenPairs::visit, &seen, direction.data()});
      return seen.pairs;
    });
    for (std::uint32_t i = 0; i < own.size(); ++i) {
      for (std::uint32_t j = 0; j < others.size(); ++j) {
        Real least = std::numeric_limits<Real>::infinity();
        for (const Point& p : own[i].corner) {
          for (const Point& q : others[j].corner) {
            least = std::min(least, dot(minus(p, q), minus(p, q)));
          }
        }
        if (least > static_cast<Real>(limit) * static_cast<Real>(limit)) continue;
        EXPECT_TRUE(shown.count({i, j}) != 0) << i << " and " << j;
      }
    }
  }
}

/// Returns the points of a triangle's edges nearest to a point, and the projection onto the
/// triangle if it is inside.
std::vector<Point> nearest_points(const ReferenceTriangle& triangle, const Point& to) {
  const auto& corner = triangle.corner;
  const auto along = [](const Point& from, const Point& way, Real share) {
    return Point{from[0] + share * way[0], from[1] + share * way[1], from[2] + share * way[2]};
  };
  std::vector<Point> points;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point edge = minus(corner[(k + 1) % 3], corner[k]);
    const Real square = dot(edge, edge);
    const Real share = square > 0 ? dot(minus(to, corner[k]), edge) / square : Real(0);
    points.push_back(along(corner[k], edge, std::clamp(share, Real(0), Real(1))));
  }
  const Point normal = cross(minus(corner[1], corner[0]), minus(corner[2], corner[0]));
  bool is_over = dot(normal, normal) > 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point edge = minus(corner[(k + 1) % 3], corner[k]);
    is_over = is_over && dot(cross(edge, minus(to, corner[k])), normal) >= 0;
  }
  if (is_over) {
    points.push_back(along(to, normal, dot(normal, minus(corner[0], to)) / dot(normal, normal)));
  }
  return points;
}

TEST_F(Meshes, triangles_near_box_are_visited_at_any_scale) {
  Random random(4);
  for (const TriangleMesh& mesh : meshes_) {
    for (std::size_t k = 0; k < scaled(40); ++k) {
      double scale[3];
      MeshPlacement placement;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        scale[axis] = random.chance(0.3) ? 1.0 : random.uniform(-3, 3);
        placement.matrix[axis][axis] = scale[axis];
      }
      const auto triangles = reference_triangles(view_of(mesh), placement);
      double min[3];
      double max[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        min[axis] = mesh.radius() * random.uniform(-2, 2);
        max[axis] = min[axis] + (k % 2 == 0 ? 0.0 : mesh.radius() * random.uniform(0, 0.2));
      }
      const double limit = mesh.radius() * random.uniform(0, 1);
      const Slots shown = on_all_isas([&] {
        Seen seen{{}, 0.0, true};
        mesh_near(view_of(mesh), scale, min, max, limit, {Seen::visit, &seen});
        return seen.slots;
      });
      const std::set<std::uint32_t> set(shown.begin(), shown.end());
      EXPECT_EQ(set.size(), shown.size());
      Point middle;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        middle[axis] = (static_cast<Real>(min[axis]) + static_cast<Real>(max[axis])) / 2;
      }
      const auto from_box = [&](const auto& low, const auto& high) {
        Real square = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const Real below = static_cast<Real>(min[axis]) - high(axis);
          const Real above = low(axis) - static_cast<Real>(max[axis]);
          const Real away = std::max({Real(0), below, above});
          square += away * away;
        }
        return std::sqrt(square);
      };
      for (std::uint32_t slot = 0; slot < triangles.size(); ++slot) {
        const ReferenceTriangle& triangle = triangles[slot];
        Real least = std::numeric_limits<Real>::infinity();
        for (const Point& point : nearest_points(triangle, middle)) {
          const auto at = [&](std::size_t axis) { return point[axis]; };
          least = std::min(least, from_box(at, at));
        }
        EXPECT_TRUE(least > static_cast<Real>(limit) || set.count(slot) != 0) << slot;
        if (set.count(slot) == 0) continue;
        const Real of_box = from_box([&](std::size_t axis) { return triangle.low(axis); },
                                     [&](std::size_t axis) { return triangle.high(axis); });
        EXPECT_LE(of_box, static_cast<Real>(limit * (1 + 1e-9)));
        const Point normal = cross(minus(triangle.corner[1], triangle.corner[0]),
                                   minus(triangle.corner[2], triangle.corner[0]));
        if (k % 2 != 0 || !(dot(normal, normal) > 0)) continue;
        EXPECT_LE(least, static_cast<Real>(limit * (1 + 1e-4) + 1e-6 * mesh.radius()))
            << "for a point the triangle is measured, not its box";
      }
    }
  }
}

TEST_F(Meshes, decoded_nodes_contain_their_triangles) {
  for (const TriangleMesh& mesh : meshes_) {
    const MeshView& view = view_of(mesh);
    const auto triangles = reference_triangles(view);
    std::uint32_t below = kMeshFanout;
    for (std::uint32_t level = 0; level < view.levels; ++level, below *= kMeshFanout) {
      for (std::uint32_t slot = 0; slot < triangles.size(); ++slot) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto decode = [&](std::uint16_t q) {
            return static_cast<Real>(static_cast<double>(view.origin[axis]) +
                                     q * static_cast<double>(view.step[axis]));
          };
          EXPECT_LE(decode(bound_of(view, level, slot / below, axis)), triangles[slot].low(axis));
          EXPECT_GE(decode(bound_of(view, level, slot / below, 3 + axis)),
                    triangles[slot].high(axis));
        }
      }
    }
  }
}

TEST_F(Meshes, box_overlap_matches_triangle_boxes) {
  Random random(1);
  for (const TriangleMesh& mesh : meshes_) {
    const auto triangles = reference_triangles(view_of(mesh));
    const Eigen::Vector3f size = mesh.bounds().max - mesh.bounds().min;
    for (std::size_t k = 0; k < scaled(60); ++k) {
      double min[3];
      double max[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<int>(axis);
        min[axis] = static_cast<double>(mesh.bounds().min[a] +
                                        size[a] * static_cast<float>(random.uniform(-0.1, 1.0)));
        max[axis] = min[axis] + static_cast<double>(size[a]) * random.uniform(0.0, 0.3);
        // A box that ends at a corner touches it.
        const auto& corner = triangles[random.below(triangles.size())].corner[0];
        if (random.chance(0.2)) max[axis] = static_cast<double>(corner[axis]);
        if (random.chance(0.1)) max[axis] = std::numeric_limits<double>::infinity();
        min[axis] = std::min(min[axis], max[axis]);
      }
      Slots expected;
      for (std::uint32_t slot = 0; slot < triangles.size(); ++slot) {
        bool overlaps = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          overlaps = overlaps && triangles[slot].low(axis) <= static_cast<Real>(max[axis]) &&
                     triangles[slot].high(axis) >= static_cast<Real>(min[axis]);
        }
        if (overlaps) expected.push_back(slot);
      }
      EXPECT_EQ(on_all_isas([&] { return overlap(view_of(mesh), min, max); }), expected);
    }
  }
}

TEST_F(Meshes, mesh_pairs_match_brute_force) {
  Random random(2);
  for (const TriangleMesh& a : meshes_) {
    const TriangleMesh& b = meshes_[random.below(meshes_.size())];
    for (std::size_t k = 0; k < scaled(6); ++k) {
      const double grow = random.chance(0.5) ? 0.0 : 0.05;
      const double margin[3] = {grow, 2 * grow, grow};
      expect_pairs(a, b, random_placement(random, 1.0), margin);
    }
  }
}

TEST_F(Meshes, ball_overlap_matches_triangle_distances) {
  Random random(11);
  std::size_t dropped = 0;
  for (const TriangleMesh& mesh : meshes_) {
    const auto triangles = reference_triangles(view_of(mesh));
    for (std::size_t k = 0; k < scaled(60); ++k) {
      const auto& corner = triangles[random.below(triangles.size())].corner[0];
      const double radius = mesh.radius() * random.log_uniform(1e-5, 0.5);
      double center[3];
      double min[3];
      double max[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        center[axis] = static_cast<double>(corner[axis]) + radius * random.uniform(-1.5, 1.5);
        min[axis] = center[axis] - radius;
        max[axis] = center[axis] + radius;
      }
      const Slots found = on_all_isas([&] {
        return collect([&](SlotSink& sink) {
          mesh_overlap(view_of(mesh), min, max, center, radius, nullptr, sink);
        });
      });
      Slots expected = overlap(view_of(mesh), min, max);
      const std::size_t in_box = expected.size();
      const Real slack = static_cast<Real>(2e-4 * mesh.radius());
      std::erase_if(expected, [&](std::uint32_t slot) {
        const Point middle = {center[0], center[1], center[2]};
        const Real away = distance(triangles[slot], middle) - static_cast<Real>(radius);
        const bool is_found = std::binary_search(found.begin(), found.end(), slot);
        EXPECT_TRUE(away > 0 || is_found) << slot;
        EXPECT_TRUE(away <= slack || !is_found) << slot;
        return !is_found;
      });
      EXPECT_EQ(found, expected);
      dropped += in_box - found.size();
    }
  }
  EXPECT_GT(dropped, 0U);
}

}  // namespace
}  // namespace winnow::test
