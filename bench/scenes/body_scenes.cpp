// Builds the scenes of rigid bodies that the races of the whole pipeline use: a heap, balls and a
// landscape. bench/measure and bench/rows call make_heap() and the others; meshes.cpp
// makes the meshes.

#include "bench/scenes/body_scenes.h"

#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/scene.h>
#include "bench/common/exact_math.h"
#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/scenes/random_shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace winnow::bench {
namespace {

/// Number of different hulls that the bodies share.
constexpr std::size_t kHulls = 64;
/// Edge of the lattice cell of each body in the heap.
constexpr double kRoom = 0.812;
constexpr int kPushes = 40;
/// Scale of the positions after the bodies were pushed apart, so that neighbours overlap a little.
constexpr double kSqueeze = 0.995;
/// Depth of the bodies in the terrain.
constexpr double kSunk = 0.01;

Eigen::Vector3d direction(Random& random) {
  for (;;) {
    const Eigen::Vector3d v(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1));
    const double length = v.norm();
    if (length > 0.1 && length <= 1.0) return v / length;
  }
}

/// Adds a hull of points on a sphere; each point is a vertex.
ShapeId add_hull(ShapePool& pool, Random& random, std::size_t vertices, double radius) {
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < vertices; ++i) points.push_back(radius * direction(random));
  const ShapeId id = need(pool.add_hull(points, 0.0), "a hull");
  return id;
}

void add_heap_shapes(BodySet& set, std::size_t bodies, Random& random) {
  std::vector<ShapeId> hulls;
  for (std::size_t i = 0; i < kHulls; ++i) {
    hulls.push_back(add_hull(set.pool, random, 16, random.in(0.4, 0.6)));
  }
  const auto draw = [&](std::size_t kind) -> ShapeId {
    switch (kind) {
      case 0:
        return set.pool.add(SphereShape{random.in(0.3, 0.5)});
      case 1:
        return set.pool.add(CapsuleShape{random.in(0.15, 0.25), random.in(0.7, 1.2)});
      case 2:
        return set.pool.add(BoxShape{random.in_cube(0.08, 0.65)});
      default:
        return hulls[random.below(kHulls)];
    }
  };
  for (std::size_t i = 0; i < bodies; ++i) set.shapes.push_back(draw(i % 4));
}

/// Separates overlapping bodies, all in parallel, and keeps them inside the cube.
void push_apart(BodySet& set, double side) {
  Scene scene(set.pool);
  const std::vector<Key> keys = add_bodies(set, scene);
  Contacts contacts;
  for (int push = 0; push < kPushes; ++push) {
    need(scene.collide(ContactLevel::distance, contacts), "the heap");
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Vec3d normal{contacts.normal(0)[i], contacts.normal(1)[i], contacts.normal(2)[i]};
      const Vec3d by = -0.4 * contacts.distance()[i] * normal;
      set.poses[contacts.data_a()[i]].position -= by;
      set.poses[contacts.data_b()[i]].position += by;
    }
    for (Pose& pose : set.poses) {
      pose.position = pose.position.max(Vec3d()).min(Vec3d::constant(side));
    }
    need(scene.move(keys, set.poses), "the heap");
  }
}

/// Moves a hull vertically until its lowest vertex is kSunk below the terrain.
void lay_down(const HullShape& hull, const Heights& heights, Pose& pose) {
  const Eigen::Quaterniond turn = pose.orientation;
  double gap = 1e9;
  for (std::uint32_t v = 0; v < hull.vertex_count; ++v) {
    const Eigen::Vector3d at =
        turn * Eigen::Vector3d(hull.vertex[0][v], hull.vertex[1][v], hull.vertex[2][v]);
    gap = std::min(gap, at.z() - heights.at(pose.position[0] + at.x(), pose.position[1] + at.y()));
  }
  pose.position[2] = -gap - kSunk;
}

}  // namespace

std::unique_ptr<BodySet> make_heap(std::size_t bodies, std::uint64_t seed) {
  auto set = std::make_unique<BodySet>();
  Random random(seed);
  add_heap_shapes(*set, bodies, random);
  const double side = kRoom * cube_root(static_cast<double>(bodies));
  set->poses.resize(bodies);
  // Draws one position in each cell of a lattice. Fully random positions would leave holes.
  const auto across = static_cast<std::size_t>(std::ceil(side / kRoom - 1e-9));
  for (std::size_t i = 0; i < bodies; ++i) {
    const Vec3d cell(static_cast<double>(i % across), static_cast<double>(i / across % across),
                     static_cast<double>(i / across / across));
    set->poses[i].position = kRoom * (cell + random.in_cube(0.0, 1.0));
    turn_at_random(random, set->poses[i]);
  }
  // Shuffles the positions, because kinds alternate by row and would form layers.
  random.shuffle(set->poses);
  push_apart(*set, side);
  for (Pose& pose : set->poses) pose.position *= kSqueeze;
  return set;
}

std::unique_ptr<BodySet> make_balls(std::size_t bodies, std::uint64_t seed) {
  constexpr double kContactsPerBody = 7.5;
  // Two balls overlap if one's centre is inside the unit ball around the other's centre.
  constexpr double kUnitBall = 4.18879020478639;
  auto set = std::make_unique<BodySet>();
  set->shapes.assign(bodies, set->pool.add(SphereShape{0.5}));
  const double side = cube_root(static_cast<double>(bodies) * kUnitBall / (2 * kContactsPerBody));
  Random random(seed);
  set->poses.resize(bodies);
  for (Pose& pose : set->poses) pose.position = random.in_cube(0.0, side);
  return set;
}

std::unique_ptr<BodySet> make_landscape(std::size_t bodies, std::uint32_t cells,
                                        std::uint64_t seed) {
  constexpr double kEdge = 0.85;
  auto set = std::make_unique<BodySet>();
  Random random(seed);
  const Heights heights = make_hills(cells, kEdge, 24.0, seed);
  set->mesh = make_terrain(heights);
  std::vector<ShapeId> hulls;
  for (std::size_t i = 0; i < kHulls; ++i) {
    hulls.push_back(add_hull(set->pool, random, 16 + random.below(17), random.in(0.8, 1.2)));
  }
  const auto across = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(bodies))));
  const double room = kEdge * cells / static_cast<double>(across + 1);
  for (std::size_t i = 0; i < bodies; ++i) {
    const ShapeId hull = hulls[random.below(kHulls)];
    Pose pose = Pose::at(room * (1.0 + static_cast<double>(i % across)),
                         room * (1.0 + static_cast<double>(i / across)), 0.0);
    if (i % 40 == 1) {
      pose.position[0] = set->poses.back().position[0] + 1.5;
      pose.position[1] = set->poses.back().position[1];
    }
    turn_at_random(random, pose);
    lay_down(set->pool.tables().hulls[hull.index()], heights, pose);
    set->shapes.push_back(hull);
    set->poses.push_back(pose);
  }
  return set;
}

std::vector<Key> add_bodies(const BodySet& set, Scene& scene) {
  std::vector<BodyDefinition> bodies(set.poses.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i] = {.shape = set.shapes[i], .pose = set.poses[i], .data = i};
  }
  std::vector<Key> keys(bodies.size());
  need(scene.add(bodies, keys), "the bodies");
  return keys;
}

void apply_pose_noise(const BodySet& set, const PoseNoise& by, std::uint64_t frame,
                      std::vector<Pose>& poses) {
  poses = set.poses;
  Random random(mix(frame));
  for (Pose& pose : poses) {
    pose.position += random.in_cube(-by.along, by.along);
    double length = 0.0;
    for (double& q : pose.orientation) {
      q += random.in(-0.5 * by.about, 0.5 * by.about);
      length += q * q;
    }
    for (double& q : pose.orientation) q /= std::sqrt(length);
  }
}

}  // namespace winnow::bench
