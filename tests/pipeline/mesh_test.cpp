#include <gtest/gtest.h>
#include <winnow/pipeline/height_field.h>
#include <winnow/pipeline/mesh/mesh_walks.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "../support/config.h"
#include "../support/counting_memory.h"
#include "../support/meshes.h"
#include "../support/random.h"

namespace winnow::test {
namespace {

using Slots = std::vector<std::uint32_t>;
using Vertices = std::vector<Eigen::Vector3f>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kNumber = (1U << kActiveEdgeShift) - 1U;

/// The caller's numbers of the triangles whose boxes meet [min, max], in order.
Slots numbers_in(const TriangleMesh& mesh, const double min[3], const double max[3]) {
  Slots slots(mesh.triangles());
  SlotSink sink{slots.data(), slots.size(), 0};
  mesh_overlap(mesh.view(), min, max, sink);
  slots.resize(sink.size);
  for (auto& slot : slots) slot = mesh.view().triangle[slot] & kNumber;
  std::sort(slots.begin(), slots.end());
  return slots;
}

/// Active edges by the caller's numbers.
std::vector<unsigned> edges_of(const TriangleMesh& mesh) {
  std::vector<unsigned> edges(mesh.triangles());
  for (std::size_t slot = 0; slot < edges.size(); ++slot) {
    const std::uint32_t word = mesh.view().triangle[slot];
    edges[word & kNumber] = word >> kActiveEdgeShift;
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

TEST(TriangleMeshes, hold_each_triangle_once_with_its_own_corners) {
  for (const MeshData& data : sample_meshes()) {
    TriangleMesh mesh;
    ASSERT_EQ(data.build(mesh), Status::ok);
    ASSERT_EQ(mesh.triangles(), data.triangles());
    std::vector<int> seen(data.triangles());
    for (std::size_t slot = 0; slot < mesh.triangles(); ++slot) {
      const std::uint32_t number = mesh.view().triangle[slot] & kNumber;
      ++seen[number];
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(mesh.view().corner[k][slot], data.corners[3 * number + k]);
      }
    }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<int>(seen.size()));
    for (const auto& v : data.vertices) EXPECT_LE(v.cast<double>().norm(), mesh.radius());
  }
}

TEST(TriangleMeshes, read_strided_columns_of_either_precision_and_short_indices_alike) {
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
    EXPECT_EQ(plain.view().triangle[slot], strided.view().triangle[slot]);
  }
}

TEST(TriangleMeshes, take_at_most_24_bytes_a_triangle_and_account_for_each) {
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
    EXPECT_EQ(mesh.triangles(), 0U);  // NOLINT(bugprone-use-after-move): what it is left as
    EXPECT_EQ(moved.footprint().total().reserved, memory.outstanding());
  }
}

TEST(TriangleMeshes, are_the_same_built_by_any_number_of_threads) {
  const MeshData data = torus(200, 60);
  TriangleMesh serial;
  ASSERT_EQ(data.build(serial), Status::ok);
  for (const int count : thread_counts()) {
    Threads threads(count);
    TriangleMesh mesh;
    ASSERT_EQ(threads.run([&] {
      return mesh.build(data.points(), data.indices(), {}, Execution::parallel());
    }),
              Status::ok);
    EXPECT_TRUE(std::equal(mesh.view().triangle, mesh.view().triangle + mesh.triangles(),
                           serial.view().triangle));
    for (int c = 0; c < 6; ++c) {
      EXPECT_TRUE(std::equal(mesh.view().node[0][c], mesh.view().node[0][c] + mesh.view().count[0],
                             serial.view().node[0][c]));
    }
  }
}

TEST(TriangleMeshes, refuse_bad_input_and_stay_as_they_were) {
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

TEST(TriangleMeshes, stay_as_they_were_when_memory_is_refused) {
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

TEST(TriangleMeshes, refitted_find_what_rebuilt_ones_find) {
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

TEST(ActiveEdges, of_a_flat_floor_are_its_border_however_it_is_wound_or_welded) {
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
  // A sliver closed to a segment between two triangles parts them not, and may be left out.
  Slots corners = floor.corners;
  corners.insert(corners.end(), {0, 5, 5, 5, 0, 0});
  const auto edges = edges_of(floor.vertices, corners);
  expect_border(floor, edges);
  EXPECT_EQ(edges[floor.triangles()], 0U);
  EXPECT_EQ(edges[floor.triangles() + 1], 0U);
  // One triangle turned over, edges 0 and 2 of which are now 2 and 0.
  corners = floor.corners;
  std::swap(corners[3 * 8 + 1], corners[3 * 8 + 2]);
  EXPECT_EQ(edges_of(floor.vertices, corners)[8], 0U);
}

TEST(ActiveEdges, are_those_that_bend_outward_by_more_than_the_angle) {
  // Two triangles with the edge from (0, 0, 0) to (0, 1, 0), the right one tilted by `bend`.
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
    // Without an agreed outside both bends count.
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

TEST(ActiveEdges, of_three_triangles_and_of_slivers_are_all_active) {
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

/// Waves with two holes.
struct Field {
  std::uint32_t columns;
  std::uint32_t rows;
  std::vector<float> heights;
  HeightField field;

  Field(std::uint32_t columns_, std::uint32_t rows_) : columns(columns_), rows(rows_) {
    Random random(7);
    for (std::uint32_t i = 0; i < columns * rows; ++i) {
      heights.push_back(
          static_cast<float>(2 * std::sin(0.2 * (i % columns)) * std::cos(0.3 * (i / columns)) +
                             random.uniform(0, 0.3)));
    }
    heights[columns + 1] = kNan;
    heights[heights.size() / 2] = kNan;
    EXPECT_EQ(field.build(samples()), Status::ok);
  }
  [[nodiscard]] HeightSamples samples() const { return {heights, columns, rows, 0, {0.5, 0.7}}; }
};

struct FieldBox {
  double low[3];
  double high[3];
};

FieldBox box_of(const TriangleShape& t) {
  FieldBox box{};
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min({t.vertex[0][axis], t.vertex[1][axis], t.vertex[2][axis]});
    box.high[axis] = std::max({t.vertex[0][axis], t.vertex[1][axis], t.vertex[2][axis]});
  }
  return box;
}

Slots field_overlap(const HeightField& field, const double min[3], const double max[3]) {
  SlotSink sink;
  field.overlap(min, max, sink);
  Slots found(sink.size);
  sink = {found.data(), found.size(), 0};
  field.overlap(min, max, sink);
  EXPECT_EQ(sink.size, found.size());
  return found;
}

Slots brute_overlap(const HeightField& field, const double min[3], const double max[3]) {
  Slots expected;
  for (std::uint32_t i = 0; i < field.triangles(); ++i) {
    TriangleShape shape;
    if (!field.triangle(i, shape)) continue;
    const FieldBox box = box_of(shape);
    bool met = true;
    for (int k = 0; k < 3; ++k) met = met && box.low[k] <= max[k] && box.high[k] >= min[k];
    if (met) expected.push_back(i);
  }
  return expected;
}

TEST(HeightFields, show_the_triangles_that_a_box_meets_after_any_update) {
  Random random(8);
  Field f(90, 40);
  for (std::size_t k = 0; k < scaled(120); ++k) {
    if (k % 10 == 5) {
      const auto column = static_cast<std::uint32_t>(random.below(80));
      const auto row = static_cast<std::uint32_t>(random.below(30));
      std::vector<float> patch(8 * 10);
      for (float& h : patch)
        h = random.chance(0.05) ? kNan : static_cast<float>(random.uniform(-5, 5));
      ASSERT_EQ(f.field.update(column, row, {patch, 7, 10, 8}), Status::ok);
    }
    double min[3] = {random.uniform(-5, 45), random.uniform(-5, 28), random.uniform(-4, 4)};
    double max[3];
    for (int axis = 0; axis < 3; ++axis) max[axis] = min[axis] + random.uniform(0, 6);
    if (random.chance(0.3)) min[0] = 0.5 * static_cast<double>(random.below(91));
    if (random.chance(0.3)) max[1] = 0.7 * static_cast<double>(random.below(41));
    if (random.chance(0.1)) max[2] = std::numeric_limits<double>::infinity();
    if (random.chance(0.1)) min[0] = -std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) max[axis] = std::max(max[axis], min[axis]);
    EXPECT_EQ(field_overlap(f.field, min, max), brute_overlap(f.field, min, max));
  }
}

struct Shown {
  Slots numbers;
  double answer;

  static double visit(void* context, const std::uint32_t* numbers, std::uint32_t count,
                      double limit) {
    auto& shown = *static_cast<Shown*>(context);
    shown.numbers.insert(shown.numbers.end(), numbers, numbers + count);
    return std::min(limit, shown.answer);
  }
};

/// All are shown that may be within the limit, and after the visitor says so only what is nearer.
template <typename Walk, typename Measure>
void expect_walk(const HeightField& field, double limit, Walk&& walk, Measure&& measure) {
  Shown all{{}, std::numeric_limits<double>::infinity()};
  walk(limit, SlotVisitor{Shown::visit, &all});
  std::sort(all.numbers.begin(), all.numbers.end());
  double nearest = std::numeric_limits<double>::infinity();
  std::uint32_t first = 0;
  for (std::uint32_t i = 0; i < field.triangles(); ++i) {
    TriangleShape shape;
    const bool shown = std::binary_search(all.numbers.begin(), all.numbers.end(), i);
    if (!field.triangle(i, shape)) {
      EXPECT_FALSE(shown);
      continue;
    }
    const double m = measure(box_of(shape));
    if (m < nearest) first = i;
    nearest = std::min(nearest, m);
    EXPECT_TRUE(m > limit || std::isinf(m) || shown) << i;
    EXPECT_TRUE(m <= limit * (1 + 1e-9) || !shown) << i << " " << m << " " << limit;
  }
  EXPECT_EQ(std::adjacent_find(all.numbers.begin(), all.numbers.end()), all.numbers.end());
  if (all.numbers.empty()) return;
  Shown some{{}, nearest};
  walk(limit, SlotVisitor{Shown::visit, &some});
  EXPECT_EQ(std::count(some.numbers.begin(), some.numbers.end(), first), 1);
  EXPECT_LE(some.numbers.size(), all.numbers.size());
}

TEST(HeightFields, show_what_a_sweep_meets_and_what_is_near) {
  Random random(9);
  const Field f(50, 70);
  for (std::size_t k = 0; k < scaled(60); ++k) {
    double min[3] = {random.uniform(-5, 30), random.uniform(-5, 53), random.uniform(-6, 6)};
    double max[3];
    double d[3];
    for (int axis = 0; axis < 3; ++axis) {
      max[axis] = min[axis] + (random.chance(0.5) ? 0.0 : random.uniform(0, 1));
      d[axis] = random.chance(0.2) ? 0.0 : random.uniform(-10, 10);
    }
    const double limit = random.uniform(0, 4);
    expect_walk(
        f.field, limit,
        [&](double t, const SlotVisitor& visitor) { f.field.sweep(min, max, d, t, visitor); },
        [&](const FieldBox& box) {
          double entry = 0;
          double exit = limit;
          for (int axis = 0; axis < 3; ++axis) {
            const double near = box.low[axis] - max[axis];
            const double far = box.high[axis] - min[axis];
            if (d[axis] == 0.0) {
              if (near > 0 || far < 0) entry = std::numeric_limits<double>::infinity();
              continue;
            }
            entry = std::max(entry, std::min(near / d[axis], far / d[axis]));
            exit = std::min(exit, std::max(near / d[axis], far / d[axis]));
          }
          return entry <= exit ? entry : std::numeric_limits<double>::infinity();
        });
    expect_walk(
        f.field, limit,
        [&](double t, const SlotVisitor& visitor) { f.field.near(min, max, t, visitor); },
        [&](const FieldBox& box) {
          double square = 0;
          for (int axis = 0; axis < 3; ++axis) {
            const double gap =
                std::max({0.0, min[axis] - box.high[axis], box.low[axis] - max[axis]});
            square += gap * gap;
          }
          return std::sqrt(square);
        });
  }
}

TEST(HeightFields, have_the_active_edges_of_the_same_mesh) {
  Field f(12, 9);
  // A mesh of the triangles that are there.
  MeshData data{"field", {}, {}};
  Slots number;
  for (std::uint32_t i = 0; i < f.field.triangles(); ++i) {
    TriangleShape shape;
    if (!f.field.triangle(i, shape)) {
      EXPECT_EQ(f.field.active_edges(i), 7U);
      continue;
    }
    number.push_back(i);
    for (const auto& v : shape.vertex) {
      data.corners.push_back(static_cast<std::uint32_t>(data.vertices.size()));
      data.vertices.emplace_back(static_cast<float>(v[0]), static_cast<float>(v[1]),
                                 static_cast<float>(v[2]));
    }
  }
  ASSERT_LT(number.size(), f.field.triangles());
  const auto edges = edges_of(data.vertices, data.corners);
  for (std::size_t i = 0; i < number.size(); ++i) {
    EXPECT_EQ(f.field.active_edges(number[i]), edges[i]) << number[i];
  }
  TriangleShape shape;
  EXPECT_FALSE(f.field.triangle(f.field.triangles(), shape));
}

TEST(HeightFields, refuse_bad_input_and_stay_as_they_were) {
  Field f(20, 10);
  const Aabb before = f.field.bounds();
  const auto refused = [&](const HeightSamples& samples) {
    const Status status = f.field.build(samples);
    EXPECT_EQ(f.field.bounds(), before);
    EXPECT_EQ(f.field.columns(), 20U);
    return status;
  };
  const std::vector<float> h(100, 1.0F);
  EXPECT_EQ(refused({h, 1, 50}), Status::invalid_shape);
  EXPECT_EQ(refused({h, 50, 0}), Status::invalid_shape);
  EXPECT_EQ(refused({h, 11, 10}), Status::size_mismatch);
  EXPECT_EQ(refused({h, 10, 10, 11}), Status::size_mismatch);
  EXPECT_EQ(refused({h, 10, 10, 9}), Status::invalid_argument);
  EXPECT_EQ(refused({h, 1U << 31U, 1U << 31U}), Status::too_many_objects);
  for (const double bad : {0.0, -1.0, 1e38, static_cast<double>(kInf), static_cast<double>(kNan)}) {
    EXPECT_EQ(refused({h, 10, 10, 0, {1.0, bad}}), Status::invalid_shape) << bad;
  }
  std::vector<float> infinite = h;
  infinite[99] = kInf;
  EXPECT_EQ(refused({infinite, 10, 10}), Status::invalid_shape);
  EXPECT_EQ(f.field.update(11, 0, {h, 10, 10}), Status::invalid_argument);
  EXPECT_EQ(f.field.update(0, 0, {infinite, 10, 10}), Status::invalid_shape);
  EXPECT_EQ(f.field.update(0, ~0U, {h, 10, 10}), Status::invalid_argument);
  EXPECT_EQ(f.field.update(20, 10, {}), Status::ok);
  EXPECT_EQ(f.field.bounds(), before);
  const std::vector<float> holes(200, kNan);
  EXPECT_EQ(f.field.update(0, 0, {holes, 20, 10}), Status::ok);
  EXPECT_EQ(f.field.bounds(), Aabb());
  EXPECT_EQ(f.field.radius(), 0.0);
}

TEST(HeightFields, account_for_their_memory_and_survive_its_refusal) {
  CountingMemory memory;
  const std::vector<float> h(64 * 64, 1.0F);
  HeightField field(&memory);
  std::size_t refusals = 0;
  for (std::size_t grants = 0;; ++grants) {
    memory.refuse_after(grants);
    const Status status = field.build({h, 64, 64});
    memory.grant_all();
    if (status == Status::ok) break;
    ++refusals;
    EXPECT_EQ(status, Status::out_of_memory);
    EXPECT_EQ(field.triangles(), 0U);
  }
  EXPECT_EQ(refusals, 2U);
  EXPECT_EQ(field.footprint().total().reserved, memory.outstanding());
  EXPECT_LE(memory.outstanding(), 64 * 64 * 4 + 256);
  const std::size_t requests = memory.requests();
  EXPECT_EQ(field.update(3, 4, {h, 10, 10}), Status::ok);
  EXPECT_EQ(memory.requests(), requests);
  const HeightField moved = std::move(field);
  EXPECT_EQ(field.triangles(), 0U);  // NOLINT(bugprone-use-after-move): what it is left as
  EXPECT_EQ(moved.triangles(), 63U * 63U * 2U);
}

}  // namespace
}  // namespace winnow::test
