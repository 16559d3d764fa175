#include "bench/scenes/bodies.h"

#include <algorithm>

namespace winnow::bench {

Vec3d draw_velocity(Random& random, double edge) noexcept {
  Vec3d velocity;
  for (int axis = 0; axis < 3; ++axis) velocity[axis] = edge * random.in(-0.05, 0.05);
  return velocity;
}

Vec3d draw_point(Random& random, const Walls& walls) noexcept {
  Vec3d point;
  for (int axis = 0; axis < 3; ++axis) point[axis] = random.in(walls.low[axis], walls.high[axis]);
  return point;
}

void drift(Body& body, const Walls& walls) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
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

BodyScene::BodyScene(std::string name, MovingBodies moving)
    : name_(std::move(name)), moving_(std::move(moving)), boxes_(moving_.bodies.all.size()) {
  const Bodies& bodies = moving_.bodies;
  double half = 0.0;
  for (const Body& body : bodies.all) half = std::max(half, body.half);
  // A little larger than the boxes, so that it contains all of them after rounding to float.
  const Vec3d around = Vec3d::constant(half * 1.000001);
  world_ = Aabb::outward(bodies.walls.low - around, bodies.walls.high + around);
  if (bodies.ground) world_.merge(*bodies.ground);
  place();
}

bool BodyScene::advance() {
  moving_.move(moving_.bodies);
  place();
  return true;
}

void BodyScene::place() noexcept {
  const Bodies& bodies = moving_.bodies;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const Vec3d half = Vec3d::constant(bodies.all[i].half);
    boxes_[i] = {(bodies.all[i].centre - half).cast<float>(),
                 (bodies.all[i].centre + half).cast<float>()};
  }
  if (bodies.ground) boxes_[0] = *bodies.ground;
}

}  // namespace winnow::bench
