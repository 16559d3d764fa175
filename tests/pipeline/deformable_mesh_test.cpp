// DeformableMesh: candidates are exactly the features with overlapping boxes, and no impact is
// missed.

#include <winnow/core/volumes.h>
#include <winnow/pipeline/deformable_mesh.h>
#include "core/numbers/rounding.h"
#include "tests/pipeline/feature_oracle.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace winnow::test {
namespace {

constexpr FeaturePair kMeshFeaturePairs[] = {FeaturePair::vertex_face, FeaturePair::edge_edge};

/// A mesh at the start and at the end of a step.
struct MeshStep {
  std::vector<Vec3d> start;
  std::vector<Vec3d> end;
  std::vector<std::uint32_t> corners;

  [[nodiscard]] IndexView triangles() const { return {std::span<const std::uint32_t>(corners)}; }
  [[nodiscard]] Status build(DeformableMesh& mesh) const {
    return mesh.build(PointView(start), triangles());
  }
  [[nodiscard]] Status move(DeformableMesh& mesh, double distance = 0.0) const {
    return mesh.move(PointView(start), PointView(end), distance);
  }
};

/// Returns a mesh whose vertices all move a little in different directions.
MeshStep trembling(const MeshData& mesh, double motion, const Vec3d& offset = {}) {
  Random random(31);
  MeshStep step;
  step.corners = mesh.corners;
  for (const auto& v : mesh.vertices) {
    step.start.push_back(offset + Vec3f(v).cast<double>());
    Vec3d by;
    for (int axis = 0; axis < 3; ++axis) by[axis] = random.uniform(-motion, motion);
    step.end.push_back(step.start.back() + by);
  }
  return step;
}

std::vector<MeshStep> sample_steps() {
  std::vector<MeshStep> steps;
  steps.push_back(trembling(torus(12, 9), 0.1));
  steps.push_back(trembling(thin_sheets(8), 0.01));
  steps.push_back(trembling(thin_sheets(8), 0.01, Vec3d(1e6, -1e7, 3e5)));
  steps.push_back(trembling(gear(9), 0.0));
  steps.push_back(trembling(degenerate_soup(60, 3), 0.2));
  return steps;
}

/// Edges, boxes and features computed directly from their definition.
class MeshReference {
 public:
  MeshReference(const MeshStep& step, const Vec3d& origin, double distance) : step_(step) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::size_t i = 0; i < step.corners.size(); i += 3) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(step.corners[i + k], step.corners[i + (k + 1) % 3]);
        if (a != b) edges.insert({a, b});
      }
    }
    for (const auto& [a, b] : edges) edges_.push_back({a, b});
    for (std::size_t i = 0; i < step.start.size(); ++i) {
      Vec3d low = step.start[i].min(step.end[i]);
      Vec3d high = step.start[i].max(step.end[i]);
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = add_down(add_down(low[axis], -origin[axis]), -0.5 * distance);
        high[axis] = add_up(add_up(high[axis], -origin[axis]), 0.5 * distance);
      }
      boxes_.push_back({round_down(low), round_up(high)});
    }
  }

  [[nodiscard]] std::size_t edges() const { return edges_.size(); }
  [[nodiscard]] std::array<std::uint32_t, 2> edge(std::size_t i) const { return edges_[i]; }

  /// Returns the vertices of feature i on the first or second side of a feature pair.
  [[nodiscard]] std::vector<std::uint32_t> feature(FeaturePair kind, bool second,
                                                   std::size_t i) const {
    if (kind == FeaturePair::edge_edge) return {edges_[i][0], edges_[i][1]};
    if (!second) return {static_cast<std::uint32_t>(i)};
    return {step_.corners[3 * i], step_.corners[3 * i + 1], step_.corners[3 * i + 2]};
  }
  [[nodiscard]] std::size_t count(FeaturePair kind, bool second) const {
    if (kind == FeaturePair::edge_edge) return edges_.size();
    return second ? step_.corners.size() / 3 : boxes_.size();
  }
  [[nodiscard]] Aabb box(const std::vector<std::uint32_t>& vertices) const {
    Aabb box;
    for (const std::uint32_t v : vertices) box.merge(boxes_[v]);
    return box;
  }

 private:
  const MeshStep& step_;
  std::vector<std::array<std::uint32_t, 2>> edges_;
  std::vector<Aabb> boxes_;
};

std::vector<Pair> candidates_by_force(FeaturePair kind, const MeshReference& a,
                                      const MeshReference& b, bool self) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < a.count(kind, false); ++i) {
    const auto first = a.feature(kind, false, i);
    const Aabb box = a.box(first);
    const bool halved = self && kind == FeaturePair::edge_edge;
    for (std::size_t k = halved ? i + 1 : 0; k < b.count(kind, true); ++k) {
      const auto second = b.feature(kind, true, k);
      const bool shared = std::find_first_of(first.begin(), first.end(), second.begin(),
                                             second.end()) != first.end();
      if ((self && shared) || !box.overlaps(b.box(second))) continue;
      pairs.push_back({static_cast<ObjectId>(i), static_cast<ObjectId>(k)});
    }
  }
  return pairs;
}

/// Collects all chunks, in the order of delivery.
template <typename Result, typename Query>
std::vector<Result> collected(Query&& query) {
  std::vector<Result> all;
  EXPECT_EQ(query([&](std::span<const Result> chunk) {
              EXPECT_FALSE(chunk.empty());
              all.insert(all.end(), chunk.begin(), chunk.end());
            }),
            Status::ok);
  return all;
}

std::vector<Pair> candidates_of(const DeformableMesh& mesh, FeaturePair kind) {
  return collected<Pair>([&](auto&& take) { return mesh.self_candidates(kind, take); });
}

std::vector<Pair> in_order(std::vector<Pair> pairs) {
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::array<Vec3d, 4> points_at(const std::vector<Vec3d>& a, const std::vector<std::uint32_t>& first,
                               const std::vector<Vec3d>& b,
                               const std::vector<std::uint32_t>& second) {
  std::array<Vec3d, 4> points;
  std::size_t n = 0;
  for (const std::uint32_t v : first) points[n++] = a[v];
  for (const std::uint32_t v : second) points[n++] = b[v];
  return points;
}

TEST(DeformableMeshes, each_edge_is_stored_once) {
  for (const MeshStep& step : sample_steps()) {
    DeformableMesh mesh;
    ASSERT_EQ(step.build(mesh), Status::ok);
    const MeshReference reference(step, {}, 0.0);
    ASSERT_EQ(mesh.edges(), reference.edges());
    EXPECT_EQ(mesh.triangles(), step.corners.size() / 3);
    EXPECT_EQ(mesh.vertices(), step.start.size());
    for (std::size_t i = 0; i < mesh.edges(); ++i) EXPECT_EQ(mesh.edge(i), reference.edge(i));
  }
}

TEST(DeformableMeshes, self_candidates_are_exactly_overlapping_boxes) {
  for (const MeshStep& step : sample_steps()) {
    for (const double distance : {0.0, 0.02}) {
      const Vec3d origin = step.start[0];
      DeformableMesh mesh({.origin = origin});
      ASSERT_EQ(step.build(mesh), Status::ok);
      ASSERT_EQ(step.move(mesh, distance), Status::ok);
      const MeshReference reference(step, origin, distance);
      for (const FeaturePair kind : kMeshFeaturePairs) {
        EXPECT_EQ(in_order(candidates_of(mesh, kind)),
                  candidates_by_force(kind, reference, reference, true));
      }
    }
  }
}

TEST(DeformableMeshes, candidates_with_mesh_are_exactly_overlapping_boxes) {
  const MeshStep a = trembling(torus(10, 8), 0.1);
  const MeshStep b = trembling(degenerate_soup(50, 4), 0.1);
  DeformableMesh first;
  DeformableMesh second;
  ASSERT_EQ(a.build(first), Status::ok);
  ASSERT_EQ(b.build(second), Status::ok);
  ASSERT_EQ(a.move(first, 0.1), Status::ok);
  ASSERT_EQ(b.move(second), Status::ok);
  for (const FeaturePair kind : kMeshFeaturePairs) {
    const auto found =
        collected<Pair>([&](auto&& take) { return first.candidates_with(second, kind, take); });
    EXPECT_EQ(in_order(found), candidates_by_force(kind, MeshReference(a, {}, 0.1),
                                                   MeshReference(b, {}, 0.0), false));
    EXPECT_FALSE(found.empty());
  }
}

TEST(DeformableMeshes, order_matches_for_any_threads_isa_and_chunk) {
  const MeshStep step = trembling(thin_sheets(24), 0.01);
  std::vector<Pair> expected[2];
  for (const Isa isa : available_isas()) {
    const IsaScope scope(isa);
    for (const int threads : {1, 2}) {
      for (const std::size_t chunk : {std::size_t{1}, std::size_t{100}, std::size_t{1} << 16U}) {
        Threads(threads).run([&] {
          DeformableMesh mesh({.execution = Workers{threads}.execution(), .chunk = chunk});
          ASSERT_EQ(step.build(mesh), Status::ok);
          ASSERT_EQ(step.move(mesh), Status::ok);
          for (const FeaturePair kind : kMeshFeaturePairs) {
            std::vector<Pair>& known = expected[static_cast<std::size_t>(kind)];
            std::vector<Pair> all;
            ASSERT_EQ(mesh.self_candidates(kind,
                                           [&](std::span<const Pair> pairs) {
                                             EXPECT_LE(pairs.size(), chunk);
                                             all.insert(all.end(), pairs.begin(), pairs.end());
                                           }),
                      Status::ok);
            if (known.empty()) known = all;
            EXPECT_EQ(all, known) << chunk;
          }
        });
      }
    }
  }
}

TEST(DeformableMeshes, self_impacts_match_single_queries) {
  for (const MeshStep& step : sample_steps()) {
    DeformableMesh mesh({.origin = step.start[0], .chunk = 7});
    ASSERT_EQ(step.build(mesh), Status::ok);
    const double separation = 1e-3;
    ASSERT_EQ(step.move(mesh, separation), Status::ok);
    const MeshReference reference(step, {}, 0.0);
    for (const FeaturePair kind : kMeshFeaturePairs) {
      for (const double least : {0.0, separation}) {
        const FeatureImpactOptions options{.min_separation = least};
        auto found = collected<MeshImpact>(
            [&](auto&& take) { return mesh.self_impacts(kind, options, take); });
        std::sort(found.begin(), found.end(),
                  [](const MeshImpact& p, const MeshImpact& q) { return p.features < q.features; });
        std::size_t next = 0;
        for (const Pair& pair : candidates_by_force(kind, reference, reference, true)) {
          const auto a = reference.feature(kind, false, pair.first);
          const auto b = reference.feature(kind, true, pair.second);
          FeatureImpact impact =
              expect_ok(feature_impact(kind, points_at(step.start, a, step.start, b),
                                       points_at(step.end, a, step.end, b), options));
          while (next < found.size() && found[next].features < pair) ++next;
          const bool listed = next < found.size() && found[next].features == pair;
          EXPECT_EQ(listed, impact.hit);
          if (listed) {
            EXPECT_EQ(found[next].time, impact.time);
          }
        }
      }
    }
  }
}

TEST(DeformableMeshes, falling_sheet_hits_sheet_below) {
  const MeshData sheets = thin_sheets(10);
  MeshStep below = trembling(sheets, 0.0);
  MeshStep above = below;
  for (Vec3d& v : above.start) v.z() += 5.0;
  for (Vec3d& v : above.end) v.z() -= 5.0;
  DeformableMesh first;
  DeformableMesh second;
  ASSERT_EQ(above.build(first), Status::ok);
  ASSERT_EQ(below.build(second), Status::ok);
  ASSERT_EQ(above.move(first), Status::ok);
  ASSERT_EQ(below.move(second), Status::ok);
  std::set<ObjectId> stopped;
  for (const MeshImpact& impact : collected<MeshImpact>([&](auto&& take) {
         return first.impacts_with(second, FeaturePair::vertex_face, {}, take);
       })) {
    EXPECT_GE(impact.time, 0.0);
    EXPECT_LT(impact.time, 1.0);
    stopped.insert(impact.features.first);
  }
  EXPECT_EQ(stopped.size(), above.start.size());
}

TEST(DeformableMeshes, proximity_returns_near_features_and_witness_points) {
  for (const MeshStep& step : sample_steps()) {
    const double thickness = 0.05;
    const Vec3d origin = step.start[0];
    DeformableMesh mesh({.origin = origin});
    ASSERT_EQ(step.build(mesh), Status::ok);
    ASSERT_EQ(step.move(mesh, thickness), Status::ok);
    const double digits = 1e-9 + 1e-14 * origin.norm();
    const MeshReference reference(step, origin, thickness);
    for (const FeaturePair kind : kMeshFeaturePairs) {
      std::set<Pair> near;
      for (const MeshProximity& one : collected<MeshProximity>(
               [&](auto&& take) { return mesh.self_proximity(kind, thickness, take); })) {
        near.insert(one.features);
        const auto points = points_at(step.end, reference.feature(kind, false, one.features.first),
                                      step.end, reference.feature(kind, true, one.features.second));
        EXPECT_NEAR(one.distance, feature_distance(kind, points, points, 1.0), digits);
        EXPECT_NEAR((one.point[1] - one.point[0]).norm(), one.distance, digits);
        Vec3d sum[2];
        double weights[2] = {0.0, 0.0};
        for (std::size_t k = 0; k < 4; ++k) {
          const std::size_t side =
              kind == FeaturePair::vertex_face ? std::min(k, std::size_t{1}) : k / 2;
          EXPECT_GE(one.weight[k], 0.0);
          sum[side] += one.weight[k] * points[k];
          weights[side] += one.weight[k];
        }
        for (std::size_t side = 0; side < 2; ++side) {
          EXPECT_NEAR(weights[side], 1.0, 1e-12);
          EXPECT_NEAR((sum[side] - one.point[side]).norm(), 0.0, digits);
        }
      }
      for (const Pair& pair : candidates_by_force(kind, reference, reference, true)) {
        const auto points = points_at(step.end, reference.feature(kind, false, pair.first),
                                      step.end, reference.feature(kind, true, pair.second));
        const double distance = feature_distance(kind, points, points, 1.0);
        const bool listed = near.contains(pair);
        EXPECT_TRUE(listed || !(distance < thickness - digits));
        EXPECT_TRUE(!listed || !(distance > thickness + digits));
      }
    }
  }
}

TEST(DeformableMeshes, bad_input_is_refused_and_changes_nothing) {
  const MeshStep step = trembling(torus(6, 5), 0.1);
  DeformableMesh mesh;
  const auto nothing = [](auto) { FAIL(); };
  EXPECT_EQ(step.move(mesh), Status::invalid_argument);
  EXPECT_EQ(mesh.self_candidates(FeaturePair::edge_edge, nothing), Status::invalid_argument);
  ASSERT_EQ(step.build(mesh), Status::ok);
  EXPECT_EQ(mesh.self_candidates(FeaturePair::edge_edge, nothing), Status::invalid_argument);
  EXPECT_EQ(mesh.self_impacts(FeaturePair::edge_edge, {}, nothing), Status::invalid_argument);
  ASSERT_EQ(step.move(mesh), Status::ok);
  const auto before = candidates_of(mesh, FeaturePair::edge_edge);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -1e308}) {
    MeshStep other = step;
    other.end[3].y() = bad;
    EXPECT_EQ(other.move(mesh), Status::invalid_bounds);
    other.start[3].y() = bad;
    EXPECT_EQ(other.build(mesh), Status::invalid_bounds);
    EXPECT_EQ(step.move(mesh, std::abs(bad) > 1e300 ? -bad * bad : bad), Status::invalid_argument);
  }
  MeshStep other = step;
  other.end.pop_back();
  EXPECT_EQ(other.move(mesh), Status::size_mismatch);
  other.corners[4] = static_cast<std::uint32_t>(step.start.size());
  EXPECT_EQ(other.build(mesh), Status::invalid_shape);
  other.corners.clear();
  EXPECT_EQ(other.build(mesh), Status::invalid_shape);
  EXPECT_EQ(mesh.move(PointView(step.start), PointView(), 0.0), Status::size_mismatch);
  PointView no_columns;
  no_columns.count = step.start.size();
  EXPECT_EQ(mesh.move(PointView(step.start), no_columns), Status::invalid_argument);
  EXPECT_EQ(mesh.self_impacts(FeaturePair::edge_edge, {.min_separation = 0.1}, nothing),
            Status::invalid_argument);
  EXPECT_EQ(mesh.self_impacts(FeaturePair::edge_edge, {.tolerance = 0.0}, nothing),
            Status::invalid_argument);
  EXPECT_EQ(mesh.self_proximity(FeaturePair::edge_edge, 0.1, nothing), Status::invalid_argument);
  EXPECT_EQ(mesh.self_proximity(FeaturePair::edge_edge, std::nan(""), nothing),
            Status::invalid_argument);
  DeformableMesh elsewhere({.origin = Vec3d(1.0, 0.0, 0.0)});
  ASSERT_EQ(step.build(elsewhere), Status::ok);
  ASSERT_EQ(step.move(elsewhere), Status::ok);
  EXPECT_EQ(mesh.candidates_with(elsewhere, FeaturePair::edge_edge, nothing),
            Status::invalid_argument);
  EXPECT_EQ(candidates_of(mesh, FeaturePair::edge_edge), before);
  DeformableMesh without_chunk({.chunk = 0});
  EXPECT_EQ(step.build(without_chunk), Status::invalid_argument);
  DeformableMesh moved(std::move(mesh));
  EXPECT_EQ(candidates_of(moved, FeaturePair::edge_edge), before);
  EXPECT_EQ(step.move(mesh), Status::invalid_argument);  // NOLINT(bugprone-use-after-move)
}

TEST(DeformableMeshes, rebuilt_mesh_matches_fresh_mesh) {
  MeshStep step = trembling(torus(12, 9), 0.1);
  DeformableMesh mesh;
  ASSERT_EQ(step.build(mesh), Status::ok);
  ASSERT_EQ(step.move(mesh), Status::ok);
  // Add a face, then a vertex with a face, and remove a face.
  for (const std::uint32_t corner : {0U, 5U, 40U}) step.corners.push_back(corner);
  step.start.push_back(step.start[3] + Vec3d(0.1, 0.2, 0.3));
  step.end.push_back(step.end[3]);
  for (const std::size_t corner : {std::size_t{1}, step.start.size() - 1, std::size_t{7}}) {
    step.corners.push_back(static_cast<std::uint32_t>(corner));
  }
  step.corners.erase(step.corners.begin() + 30, step.corners.begin() + 33);
  ASSERT_EQ(step.build(mesh), Status::ok);
  EXPECT_EQ(mesh.vertices(), step.start.size());
  ASSERT_EQ(step.move(mesh), Status::ok);
  DeformableMesh fresh;
  ASSERT_EQ(step.build(fresh), Status::ok);
  ASSERT_EQ(step.move(fresh), Status::ok);
  for (const FeaturePair kind : kMeshFeaturePairs) {
    EXPECT_EQ(candidates_of(mesh, kind), candidates_of(fresh, kind));
  }
  MeshStep bad = step;
  bad.corners[4] = static_cast<std::uint32_t>(bad.start.size());
  EXPECT_EQ(bad.build(mesh), Status::invalid_shape);
  EXPECT_EQ(candidates_of(mesh, FeaturePair::edge_edge),
            candidates_of(fresh, FeaturePair::edge_edge));
}

TEST(DeformableMeshes, steady_mesh_takes_120_bytes_per_triangle) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  const MeshStep step = trembling(torus(100, 60), 0.01);
  CountingMemory memory;
  DeformableMesh mesh({.memory = &memory, .chunk = 1000});
  ASSERT_EQ(step.build(mesh), Status::ok);
  ASSERT_EQ(step.move(mesh), Status::ok);
  EXPECT_EQ(memory.outstanding(), mesh.footprint().total().reserved);
  EXPECT_LE(memory.outstanding(), 120 * mesh.triangles());
  const std::size_t requests = memory.requests();
  ASSERT_EQ(step.move(mesh, 0.01), Status::ok);
  EXPECT_EQ(memory.requests(), requests);
  memory.refuse_beyond(memory.outstanding() + 1000 * (sizeof(MeshImpact) + sizeof(double)) + 12000);
  EXPECT_EQ(mesh.self_impacts(FeaturePair::edge_edge, {}, [](auto) {}), Status::ok);
  EXPECT_EQ(memory.outstanding(), mesh.footprint().total().reserved);
}

TEST(DeformableMeshes, refused_memory_changes_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  const MeshStep step = trembling(torus(8, 6), 0.1);
  for (std::size_t granted = 0;; ++granted) {
    CountingMemory memory;
    DeformableMesh mesh({.memory = &memory});
    memory.refuse_after(granted);
    const Status built = step.build(mesh);
    if (built == Status::ok) break;
    EXPECT_EQ(built, Status::out_of_memory);
    EXPECT_EQ(mesh.triangles(), 0U);
    EXPECT_EQ(memory.outstanding(), 0U);
  }
  CountingMemory memory;
  DeformableMesh mesh({.memory = &memory});
  ASSERT_EQ(step.build(mesh), Status::ok);
  ASSERT_EQ(step.move(mesh, 0.1), Status::ok);
  memory.refuse_after(0);
  for (const FeaturePair kind : kMeshFeaturePairs) {
    EXPECT_EQ(mesh.self_candidates(kind, [](auto) {}), Status::out_of_memory);
    EXPECT_EQ(mesh.self_impacts(kind, {}, [](auto) {}), Status::out_of_memory);
    EXPECT_EQ(mesh.self_proximity(kind, 0.1, [](auto) {}), Status::out_of_memory);
  }
  DeformableMesh huge({.chunk = std::numeric_limits<std::size_t>::max()});
  ASSERT_EQ(step.build(huge), Status::ok);
  ASSERT_EQ(step.move(huge), Status::ok);
  EXPECT_EQ(huge.self_candidates(FeaturePair::edge_edge, [](auto) {}), Status::out_of_memory);
}

TEST(DeformableMeshes, meshes_of_one_triangle_return_results) {
  MeshStep step;
  step.start = {Vec3d(), Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0.2, 0.2, 1.0)};
  step.end = {Vec3d(), Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0.2, 0.2, -1.0)};
  step.corners = {0, 1, 2};
  DeformableMesh mesh;
  ASSERT_EQ(step.build(mesh), Status::ok);
  ASSERT_EQ(step.move(mesh), Status::ok);
  const auto impacts = collected<MeshImpact>(
      [&](auto&& take) { return mesh.self_impacts(FeaturePair::vertex_face, {}, take); });
  ASSERT_EQ(impacts.size(), 1U);
  EXPECT_EQ(impacts[0].features, (Pair{3, 0}));
  EXPECT_TRUE(candidates_of(mesh, FeaturePair::edge_edge).empty());
  step.corners = {1, 1, 1};
  ASSERT_EQ(step.build(mesh), Status::ok);
  ASSERT_EQ(step.move(mesh), Status::ok);
  EXPECT_EQ(mesh.edges(), 0U);
  EXPECT_TRUE(candidates_of(mesh, FeaturePair::edge_edge).empty());
}

}  // namespace
}  // namespace winnow::test
