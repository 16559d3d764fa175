#include "bench/scenes/bodies.h"

#include "bench/common/exact_math.h"

#include <Eigen/Core>
#include <algorithm>

namespace winnow::bench {

Vector draw_velocity(Random& random, double edge) noexcept {
  Vector velocity{};
  for (double& v : velocity) v = edge * random.in(-0.05, 0.05);
  return velocity;
}

Vector draw_point(Random& random, const Walls& walls) noexcept {
  Vector point{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    point[axis] = random.in(walls.low[axis], walls.high[axis]);
  }
  return point;
}

void drift(Body& body, const Walls& walls) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = walls.low[axis];
    const double high = walls.high[axis];
    double c = body.centre[axis] + body.velocity[axis];
    if (c < low || c > high) {
      c = c < low ? low + (low - c) : high - (c - high);
      body.velocity[axis] = -body.velocity[axis];
    }
    // If the walls are closer together than one step, a reflection can leave the centre outside.
    body.centre[axis] = std::clamp(c, low, high);
  }
}

Aabb box_of(const Body& body) noexcept {
  Aabb box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    box.min[a] = static_cast<float>(body.centre[axis] - body.half);
    box.max[a] = static_cast<float>(body.centre[axis] + body.half);
  }
  return box;
}

Walls uniform_walls(std::size_t objects) noexcept {
  return Walls::cube(cube_root(2.0 * static_cast<double>(objects)));
}

std::vector<Body> uniform_bodies(std::size_t objects, std::uint64_t seed, const Walls& walls) {
  Random random(seed);
  std::vector<Body> bodies(objects);
  for (Body& body : bodies) {
    body.centre = draw_point(random, walls);
    body.velocity = draw_velocity(random, 1.0);
  }
  return bodies;
}

Walls walls_for(const Sizes& sizes, std::size_t objects) noexcept {
  return Walls::cube(cube_root(sizes.volume * static_cast<double>(objects)));
}

std::vector<Body> log_uniform_bodies(const Sizes& sizes, std::size_t objects, std::uint64_t seed,
                                     const Walls& walls) {
  Random random(seed);
  std::vector<Body> bodies(objects);
  for (Body& body : bodies) {
    const double edge = sizes.smallest * power(sizes.ratio, random.unit());
    body.half = 0.5 * edge;
    body.centre = draw_point(random, walls);
    body.velocity = draw_velocity(random, edge);
  }
  return bodies;
}

BodyScene::BodyScene(std::string name, const Walls& walls, std::vector<Body> bodies,
                     std::uint64_t seed)
    : name_(std::move(name)),
      walls_(walls),
      bodies_(std::move(bodies)),
      boxes_(bodies_.size()),
      random_(mix(seed)) {
  double half = 0.0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    place(i);
    half = std::max(half, bodies_[i].half);
  }
  // A little larger than the boxes, so that it contains all of them after rounding to float.
  Eigen::Vector3d low = Eigen::Vector3d(walls_.low.data()).array() - half * 1.000001;
  Eigen::Vector3d high = Eigen::Vector3d(walls_.high.data()).array() + half * 1.000001;
  world_ = Aabb::outward(low, high);
}

}  // namespace winnow::bench
