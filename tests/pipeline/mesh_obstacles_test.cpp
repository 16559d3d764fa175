// Impacts of deformable meshes with moving rigid shapes, compared with distances at sampled times
// that together cover the whole step (motion_reference.h).

#include <gtest/gtest.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/deformable_mesh.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "pipeline/solver/solver.h"
#include "tests/pipeline/motion_reference.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr double kGap = 1e-6;

/// Triangles without shared vertices, each with its own motion and deformation.
struct BendingSoup {
  std::vector<Vec3d> start;
  std::vector<Vec3d> end;
  std::vector<std::uint32_t> corners;

  BendingSoup(std::size_t faces, const Vec3d& offset, Random& random) {
    const auto around = [&](double reach) {
      return Vec3d(random.uniform(-reach, reach), random.uniform(-reach, reach),
                   random.uniform(-reach, reach));
    };
    for (std::size_t i = 0; i < faces; ++i) {
      const Vec3d at = offset + around(1.5);
      const Vec3d way = around(3.0);
      for (int k = 0; k < 3; ++k) {
        start.push_back(at + around(0.7));
        end.push_back(start.back() + way + around(0.7));
        corners.push_back(static_cast<std::uint32_t>(corners.size()));
      }
    }
  }
  [[nodiscard]] Status put(DeformableMesh& mesh, double distance = 0.0) const {
    const Status status = mesh.build(start, std::span<const std::uint32_t>(corners));
    return status == Status::ok ? mesh.move(start, end, distance) : status;
  }
};

/// A shape and its convex parts in the frame of the body.
struct Obstacle {
  ShapeId shape;
  std::vector<ShapeId> parts;
  double reach;
};

class ObstacleReference {
 public:
  ObstacleReference(const ShapePool& pool, const Obstacle& obstacle, const RigidMotion& motion,
                    const BendingSoup& soup)
      : tables_(pool.tables()), obstacle_(obstacle), motion_(motion), soup_(soup) {
    tables_.triangles = triangles_.data();
    triangles_.assign(pool.tables().triangles, pool.tables().triangles + triangle_count(pool));
    triangles_.emplace_back();
    tables_.triangles = triangles_.data();
  }

  [[nodiscard]] DistanceAt distance(std::uint32_t face, double time) {
    const Vec3d& origin = motion_.start.position;
    Pose pose = place_at(motion_, time, origin);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& from = soup_.start[3 * face + k];
      const Vec3d way = soup_.end[3 * face + k] - from;
      for (int i = 0; i < 3; ++i) {
        const long double at = static_cast<long double>(from[i]) - origin[i];
        triangles_.back().vertex[k][i] =
            static_cast<double>(at + static_cast<long double>(time) * way[i]);
      }
    }
    const ShapeId own =
        ShapeId::of(ShapeKind::triangle, static_cast<std::uint32_t>(triangles_.size() - 1));
    DistanceAt least{std::numeric_limits<double>::infinity(), 0.0};
    for (const ShapeId part : obstacle_.parts) {
      SolverCounts counts;
      const PairAnswer answer =
          solve_pair(tables_, part, pose, own, Pose{}, ContactLevel::distance, 0.0, counts);
      if (answer.distance < least.distance) least = {answer.distance, answer.error_bound};
    }
    return least;
  }

  /// Returns an upper bound of the speed at which any point of the face and any point of the
  /// obstacle approach each other.
  [[nodiscard]] double speed(std::uint32_t face) const {
    double most = 0.0;
    double far = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d at = soup_.start[3 * face + k] - Vec3d(motion_.start.position);
      const Vec3d way = soup_.end[3 * face + k] - soup_.start[3 * face + k];
      most = std::max(most, (way - Vec3d(motion_.travel)).norm());
      far = std::max(far, at.norm() + way.norm() + Vec3d(motion_.travel).norm());
    }
    const double reach = std::isfinite(obstacle_.reach) ? obstacle_.reach : far;
    return most + Vec3d(motion_.turn).norm() * reach + 1e-9;
  }

 private:
  static std::size_t triangle_count(const ShapePool& pool) {
    return pool.tables().count[static_cast<std::size_t>(ShapeKind::triangle)];
  }

  ShapeTables tables_;
  std::vector<TriangleShape> triangles_;
  const Obstacle& obstacle_;
  const RigidMotion& motion_;
  const BendingSoup& soup_;
};

/// Shapes of all kinds, of size about 1.
class Obstacles {
 public:
  Obstacles() {
    put(SphereShape{0.7}, 0.7);
    put(CapsuleShape{0.3, 0.6}, 0.9);
    put(BoxShape{{0.8, 0.5, 0.02}}, 1.0);
    put(CylinderShape{0.5, 0.4}, 0.7);
    put(ConeShape{0.5, 0.6}, 0.8);
    put(EllipsoidShape{{0.3, 0.6, 0.9}}, 0.9);
    put(TriangleShape{{{-1, 0, 0}, {1, 0, 0.2}, {0, 1, 0}}}, 1.1);
    put(HalfSpaceShape{{0, 0.6, 0.8}, -0.5}, std::numeric_limits<double>::infinity());
    put_torus();
  }

  ShapePool pool;
  CompositePool composites{pool};
  std::vector<Obstacle> all;

 private:
  template <typename Shape>
  ShapeId added(const Shape& shape) {
    ShapeId id = expect_ok(pool.add(shape));
    return id;
  }
  template <typename Shape>
  void put(const Shape& shape, double reach) {
    const ShapeId id = added(shape);
    all.push_back({id, {id}, reach});
  }
  void put_torus() {
    const MeshData mesh = torus(6, 5);
    Obstacle obstacle;
    obstacle.shape = expect_ok(composites.add_mesh(mesh.points(), mesh.indices()));
    for (std::size_t i = 0; i < mesh.triangles(); ++i) {
      TriangleShape triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        for (int x = 0; x < 3; ++x) {
          triangle.vertex[k][x] = mesh.vertices[mesh.corners[3 * i + k]][x];
        }
      }
      obstacle.parts.push_back(added(triangle));
    }
    obstacle.reach = composites.radius(obstacle.shape);
    all.push_back(std::move(obstacle));
  }
};

RigidMotion random_motion(const Vec3d& about, double turn, Random& random) {
  RigidMotion motion;
  for (int i = 0; i < 3; ++i) {
    motion.start.position[i] = about[i] + random.uniform(-1.0, 1.0);
    motion.travel[i] = random.uniform(-2.0, 2.0);
    motion.turn[i] = random.uniform(-turn, turn);
  }
  return motion;
}

std::vector<MeshShapeImpact> impacts_of(const DeformableMesh& mesh, const MeshObstacle& obstacle,
                                        const ImpactOptions& options) {
  std::vector<MeshShapeImpact> all;
  EXPECT_EQ(mesh.impacts_with(obstacle, options,
                              [&](std::span<const MeshShapeImpact> chunk) {
                                all.insert(all.end(), chunk.begin(), chunk.end());
                              }),
            Status::ok);
  return all;
}

TEST(MeshObstacles, impacts_are_never_late_and_within_tolerance) {
  Obstacles obstacles;
  Random random(17);
  std::size_t hits = 0;
  std::size_t unproved = 0;
  const std::size_t faces = scaled(60);
  for (const Obstacle& obstacle : obstacles.all) {
    for (const double turn : {0.0, 1.0, 12.0}) {
      for (const double offset : {0.0, 1e7}) {
        SCOPED_TRACE(testing::Message() << to_string(obstacle.shape.kind()) << " " << turn);
        const Vec3d about(offset, -offset, 0.0);
        const BendingSoup soup(faces, about, random);
        const RigidMotion motion = random_motion(about, turn, random);
        DeformableMesh mesh({.origin = about, .chunk = 7});
        ASSERT_EQ(soup.put(mesh), Status::ok);
        std::map<std::uint32_t, MeshShapeImpact> impacts;
        for (const MeshShapeImpact& impact :
             impacts_of(mesh, {obstacles.pool, obstacle.shape, motion},
                        {.composites = &obstacles.composites})) {
          EXPECT_TRUE(impacts.emplace(impact.face, impact).second);
        }
        hits += impacts.size();
        ObstacleReference reference(obstacles.pool, obstacle, motion, soup);
        for (std::uint32_t face = 0; face < faces; ++face) {
          const auto found = impacts.find(face);
          const double until = found == impacts.end() ? 1.0 : found->second.time;
          const Before then = before([&](double at) { return reference.distance(face, at); },
                                     reference.speed(face), 1e-12 + 1e-15 * offset, until, 400);
          EXPECT_NE(then, Before::overlapping) << face;
          unproved += then == Before::apart ? 0 : 1;
          if (found == impacts.end()) continue;
          const DistanceAt at = reference.distance(face, until);
          EXPECT_LE(at.distance - at.error, 1.2 * kGap + 1e-15 * offset) << face;
          EXPECT_NEAR(found->second.normal.norm(), 1.0, 1e-9);
        }
      }
    }
  }
  EXPECT_GT(hits, obstacles.all.size() * faces);
  EXPECT_LT(unproved, obstacles.all.size() * 6 * faces / 20);
}

TEST(MeshObstacles, impacts_keep_requested_separation) {
  Obstacles obstacles;
  Random random(18);
  const BendingSoup soup(scaled(100), {}, random);
  DeformableMesh mesh;
  ASSERT_EQ(soup.put(mesh, 0.2), Status::ok);
  for (const Obstacle& obstacle : obstacles.all) {
    const RigidMotion motion = random_motion({}, 1.0, random);
    ObstacleReference reference(obstacles.pool, obstacle, motion, soup);
    for (const MeshShapeImpact& impact :
         impacts_of(mesh, {obstacles.pool, obstacle.shape, motion, 0.1},
                    {.composites = &obstacles.composites})) {
      if (impact.time == 0.0) continue;
      EXPECT_NEAR(reference.distance(impact.face, impact.time).distance, 0.1, 2.0 * kGap);
    }
  }
}

TEST(MeshObstacles, order_matches_on_any_threads_and_isa) {
  Obstacles obstacles;
  Random random(19);
  const BendingSoup soup(300, {}, random);
  const RigidMotion motion = random_motion({}, 1.0, random);
  const MeshObstacle obstacle{obstacles.pool, obstacles.all.back().shape, motion};
  std::vector<MeshShapeImpact> expected;
  for (const Isa isa : available_isas()) {
    const IsaScope scope(isa);
    for (const int threads : {1, 2}) {
      for (const std::size_t chunk : {std::size_t{3}, std::size_t{1000}}) {
        Threads(threads).run([&] {
          DeformableMesh mesh({.execution = Workers{threads}.execution(), .chunk = chunk});
          ASSERT_EQ(soup.put(mesh), Status::ok);
          const auto found = impacts_of(mesh, obstacle, {.composites = &obstacles.composites});
          if (expected.empty()) expected = found;
          ASSERT_EQ(found.size(), expected.size());
          for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i].face, expected[i].face);
            EXPECT_EQ(found[i].part, expected[i].part);
            EXPECT_EQ(found[i].time, expected[i].time);
            EXPECT_EQ(found[i].point, expected[i].point);
          }
        });
      }
    }
  }
  EXPECT_GT(expected.size(), 20U);
}

TEST(MeshObstacles, invalid_obstacles_are_refused) {
  Obstacles obstacles;
  Random random(20);
  const BendingSoup soup(4, {}, random);
  const ShapeId ball = obstacles.all.front().shape;
  const RigidMotion at_rest = RigidMotion::stationary(Pose{});
  const auto status_of = [&](const DeformableMesh& mesh, const MeshObstacle& obstacle,
                             const ImpactOptions& options = {}) {
    return mesh.impacts_with(obstacle, options, [](std::span<const MeshShapeImpact>) { FAIL(); });
  };
  DeformableMesh mesh;
  EXPECT_EQ(status_of(mesh, {obstacles.pool, ball, at_rest}), Status::invalid_argument);
  ASSERT_EQ(soup.put(mesh, 0.2), Status::ok);
  EXPECT_EQ(status_of(mesh, {obstacles.pool, ShapeId{}, at_rest}), Status::invalid_key);
  EXPECT_EQ(status_of(mesh, {obstacles.pool, obstacles.all.back().shape, at_rest}),
            Status::unsupported);
  RigidMotion bad = at_rest;
  bad.travel[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(status_of(mesh, {obstacles.pool, ball, bad}), Status::invalid_pose);
  EXPECT_EQ(status_of(mesh, {obstacles.pool, ball, at_rest}, {.tolerance = 0.0}),
            Status::invalid_argument);
  for (const double separation : {-1.0, 0.11, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(status_of(mesh, {obstacles.pool, ball, at_rest, separation}),
              Status::invalid_argument);
  }
}

}  // namespace
}  // namespace winnow::test
