// HeightField: box, cast and proximity traversals compared with all triangles, active edges
// compared with a mesh of the same triangles, refused input and memory.

#include <gtest/gtest.h>
#include <winnow/pipeline/surfaces.h>
#include "pipeline/mesh/height_grid.h"

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

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// A wavy height field with two holes.
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
  height_overlap(grid_of(field), min, max, sink);
  Slots found(static_cast<std::size_t>(sink.size));
  sink = {found.data(), found.size(), 0};
  height_overlap(grid_of(field), min, max, sink);
  EXPECT_EQ(sink.size, found.size());
  return found;
}

Slots brute_overlap(const HeightField& field, const double min[3], const double max[3]) {
  Slots expected;
  for (std::uint32_t i = 0; i < field.triangles(); ++i) {
    TriangleShape shape;
    if (!field.triangle(i, shape)) continue;
    const FieldBox box = box_of(shape);
    bool overlaps = true;
    for (int k = 0; k < 3; ++k)
      overlaps = overlaps && box.low[k] <= max[k] && box.high[k] >= min[k];
    if (overlaps) expected.push_back(i);
  }
  return expected;
}

TEST(HeightFields, box_overlap_after_updates_matches_brute_force) {
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

/// Checks that a traversal visits all triangles within the limit and none beyond it, and that it
/// ends at the nearest triangle once the visitor returns a smaller limit.
template <typename Traverse, typename Measure>
void expect_traversal(const HeightField& field, double limit, Traverse&& traverse,
                      Measure&& measure) {
  Shown all{{}, std::numeric_limits<double>::infinity()};
  traverse(limit, SlotVisitor{Shown::visit, &all});
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
  traverse(limit, SlotVisitor{Shown::visit, &some});
  EXPECT_EQ(std::count(some.numbers.begin(), some.numbers.end(), first), 1);
  EXPECT_LE(some.numbers.size(), all.numbers.size());
}

TEST(HeightFields, cast_and_near_queries_match_brute_force) {
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
    expect_traversal(
        f.field, limit,
        [&](double t, const SlotVisitor& visitor) {
          height_cast(grid_of(f.field), min, max, d, t, visitor);
        },
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
    expect_traversal(
        f.field, limit,
        [&](double t, const SlotVisitor& visitor) {
          height_near(grid_of(f.field), min, max, t, visitor);
        },
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

TEST(HeightFields, active_edges_match_equal_mesh) {
  Field f(12, 9);
  // A mesh of all triangles except the holes.
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
  TriangleMesh mesh;
  ASSERT_EQ(data.build(mesh), Status::ok);
  for (std::size_t slot = 0; slot < number.size(); ++slot) {
    const std::uint32_t word = view_of(mesh).triangle[slot];
    const std::uint32_t i = number[word & (kTriangleNumberMask)];
    EXPECT_EQ(f.field.active_edges(i), word >> kActiveEdgeShift) << i;
  }
  TriangleShape shape;
  EXPECT_FALSE(f.field.triangle(f.field.triangles(), shape));
}

TEST(HeightFields, bad_input_is_refused_and_changes_nothing) {
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

TEST(HeightFields, footprint_is_exact_and_refused_memory_changes_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
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
  EXPECT_EQ(refusals, 3U);
  EXPECT_EQ(field.footprint().total().reserved, memory.outstanding());
  EXPECT_LE(memory.outstanding(), 64 * 64 * 4 + 640);
  const std::size_t requests = memory.requests();
  EXPECT_EQ(field.update(3, 4, {h, 10, 10}), Status::ok);
  EXPECT_EQ(memory.requests(), requests);
  const HeightField moved = std::move(field);
  EXPECT_EQ(field.triangles(), 0U);  // NOLINT(bugprone-use-after-move): moved-from is empty
  EXPECT_EQ(moved.triangles(), 63U * 63U * 2U);
}

}  // namespace
}  // namespace winnow::test
