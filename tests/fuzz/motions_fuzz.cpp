// Shapes and mesh features in motion: bad numbers are refused, no time of impact is late, and
// single calls and batches agree on any instruction set.

#include <winnow/winnow.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/target.h"
#include "tests/pipeline/feature_oracle.h"
#include "tests/pipeline/motion_reference.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

using Points = std::array<Vec3d, 4>;

bool is_finite(const Points& points) {
  return std::ranges::all_of(points, [](const Vec3d& p) { return p.all_finite(); });
}

/// Mostly grid values, so that features touch exactly.
Points some_points(Bytes& bytes) {
  Points points;
  const bool wild = bytes.chance(16);
  for (Vec3d& point : points) {
    for (int k = 0; k < 3; ++k) point[k] = wild ? bytes.any<double>() : 0.25 * bytes.grid_value();
  }
  return points;
}

/// Checks a feature pair in single calls and in columns of several.
void check_features(Bytes& bytes) {
  const FeaturePair kind = bytes.chance(2) ? FeaturePair::edge_edge : FeaturePair::vertex_face;
  const Points start = some_points(bytes);
  const Points end = some_points(bytes);
  FeatureImpactOptions options;
  if (bytes.chance(4)) options.min_separation = 0.25 * bytes.extent();
  FeatureImpact impact;
  const Status status = feature_impact(kind, start, end, options).get(impact);
  WINNOW_REQUIRE(status == Status::ok || status == Status::invalid_bounds);
  WINNOW_REQUIRE(status != Status::ok || (is_finite(start) && is_finite(end)));
  constexpr std::size_t kCount = 9;
  std::array<std::array<double, kCount>, 24> numbers;
  FeatureColumns columns{.count = kCount};
  for (std::size_t c = 0; c < 24; ++c) {
    const Points& points = c < 12 ? start : end;
    numbers[c].fill(points[c % 12 / 3][static_cast<int>(c % 3)]);
    (c < 12 ? columns.start : columns.end)[c % 12 / 3][c % 3] = numbers[c].data();
  }
  std::array<double, kCount> times;
  WINNOW_REQUIRE(feature_impacts(kind, columns, times, options) == Status::ok);
  for (const double time : times) {
    WINNOW_REQUIRE(status == Status::ok ? std::bit_cast<std::uint64_t>(time) ==
                                              std::bit_cast<std::uint64_t>(impact.time)
                                        : std::isnan(time));
  }
  if (status != Status::ok) return;
  WINNOW_REQUIRE(impact.hit ? impact.time >= 0.0 && impact.time <= 1.0 : std::isinf(impact.time));
  if (options.min_separation != 0.0) return;
  const ExactImpact truth = exact_impact(kind, start, end, 20);
  WINNOW_REQUIRE(!truth.touch || (impact.hit && impact.time <= truth.to));
}

/// Returns a motion that is usually valid.
RigidMotion some_motion(Bytes& bytes) {
  RigidMotion motion;
  motion.start = bytes.pose();
  const bool wild = bytes.chance(16);
  for (double& x : motion.travel) x = wild ? bytes.any<double>() : 0.25 * bytes.grid_value();
  const double turn = bytes.chance(4) ? 1.0 : 0.03125;
  for (double& x : motion.turn) x = wild ? bytes.any<double>() : turn * bytes.grid_value();
  return motion;
}

ShapeId some_shape(Bytes& bytes, ShapePool& pool) {
  const double size = 0.125 + 0.25 * bytes.extent();
  switch (bytes.below(6)) {
    case 0:
      return pool.add(SphereShape{size});
    case 1:
      return pool.add(CapsuleShape{0.25, size});
    case 2:
      return pool.add(BoxShape{{size, 0.5, 0.03125}});
    case 3:
      return pool.add(CylinderShape{0.5, size, 0.0});
    case 4:
      return pool.add(ConeShape{size, 0.5, 0.0});
    default:
      return pool.add(TriangleShape{{{0, 0, 0}, {size, 0, 0}, {0, 1, 0.25}}, 0.0});
  }
}

void check_shapes(Bytes& bytes) {
  ShapePool pool;
  MovingShapes pair{{some_shape(bytes, pool), some_shape(bytes, pool)},
                    {some_motion(bytes), some_motion(bytes)}};
  const BodyPair pairs[] = {{0, 1}};
  ImpactResult result;
  WINNOW_REQUIRE(time_of_impact(pool, {pair.shape, pair.motion}, pairs, {}, result) == Status::ok);
  const bool good = pair.motion[0].is_valid() && pair.motion[1].is_valid();
  WINNOW_REQUIRE(result.status(0) == (good ? Status::ok : Status::invalid_pose));
  if (!good) return;
  const double time = result.time()[0];
  WINNOW_REQUIRE(time >= 0.0 && time <= 1.0 && (result.hits(0) || time == 1.0));
  // For larger values doubles are too coarse for this check.
  double most = 0.0;
  for (const RigidMotion& motion : pair.motion) {
    for (const double x : motion.travel) most = std::max(most, std::abs(x));
    for (const double x : motion.turn) most = std::max(most, std::abs(x));
  }
  if (most > 1e3) return;
  WINNOW_REQUIRE(before(pool, pair, time, 200) != Before::overlapping);
  if (!result.hits(0)) return;
  const DistanceAt at = distance_at(pool, pair, time);
  WINNOW_REQUIRE(std::abs(at.distance - result.gap()[0]) <=
                 at.error + result.error_bound()[0] + resolution_of(pool, pair) + 1e-12);
}

/// Checks a mesh of hostile triangles and positions.
void check_cloth(Bytes& bytes) {
  CountingMemory memory;
  DeformableMesh mesh({.memory = &memory, .execution = Execution::serial()});
  std::vector<Vec3d> rest(1 + bytes.below(24));
  const auto place = [&](std::vector<Vec3d>& points) {
    const bool wild = bytes.chance(16);
    for (Vec3d& point : points) {
      for (int k = 0; k < 3; ++k) point[k] = wild ? bytes.any<double>() : 0.25 * bytes.grid_value();
    }
  };
  place(rest);
  std::vector<std::uint32_t> corners(bytes.below(90));
  const std::size_t numbers = rest.size() + (bytes.chance(16) ? 1U : 0U);
  for (std::uint32_t& corner : corners) corner = static_cast<std::uint32_t>(bytes.below(numbers));
  const bool built =
      mesh.build(PointView(rest), std::span<const std::uint32_t>(corners)) == Status::ok;
  std::vector<Vec3d> after = rest;
  place(after);
  const bool moved = mesh.move(PointView(rest), PointView(after), 0.25) == Status::ok;
  WINNOW_REQUIRE(built || !moved);
  for (const FeaturePair kind : {FeaturePair::vertex_face, FeaturePair::edge_edge}) {
    std::size_t candidates = 0;
    std::size_t impacts = 0;
    const Status found =
        mesh.self_candidates(kind, [&](auto chunk) { candidates += chunk.size(); });
    const Status hit = mesh.self_impacts(kind, {}, [&](std::span<const MeshImpact> chunk) {
      impacts += chunk.size();
      for (const MeshImpact& one : chunk) WINNOW_REQUIRE(one.time >= 0.0 && one.time <= 1.0);
    });
    WINNOW_REQUIRE((found == Status::ok) == moved && hit == found && impacts <= candidates);
  }
  WINNOW_REQUIRE(mesh.footprint().total().reserved == memory.outstanding());
}

}  // namespace

void fuzz(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  const auto isas = available_isas();
  for (int steps = 0; !bytes.empty() && steps < 20; ++steps) {
    const IsaScope isa(isas[bytes.below(isas.size())]);
    switch (bytes.below(4)) {
      case 0:
        check_shapes(bytes);
        break;
      case 1:
        check_cloth(bytes);
        break;
      default:
        check_features(bytes);
    }
  }
}

std::vector<std::string> fuzz_seeds() {
  return random_seeds(200, 600);
}

}  // namespace winnow::test
