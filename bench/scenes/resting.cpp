#include "bench/scenes/resting.h"

#include "bench/common/exact_math.h"
#include "bench/scenes/bodies.h"

#include <algorithm>
#include <cmath>

namespace winnow::bench {
namespace {

constexpr double kJitter = 0.25;

/// Unit cubes that jitter about the points of a lattice, on a ground box (row 0) that does not
/// move.
class Pile final : public BodyScene {
 public:
  Pile(const Walls& walls, std::vector<Body> bodies, std::vector<Vector> homes, const Aabb& ground,
       std::uint64_t seed)
      : BodyScene("pile", walls, std::move(bodies), seed), rest_positions_(std::move(homes)) {
    boxes_[0] = ground;
    world_.merge(ground);
  }

  bool advance() override {
    for (std::size_t i = 1; i < bodies_.size(); ++i) {
      Walls around;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        around.low[axis] = rest_positions_[i][axis] - kJitter;
        around.high[axis] = rest_positions_[i][axis] + kJitter;
      }
      drift(bodies_[i], around);
      place(i);
    }
    return true;
  }

 private:
  std::vector<Vector> rest_positions_;
};

/// Bodies that fall along straight paths, bounce at the end and come to rest there.
class Falling final : public BodyScene {
 public:
  /// A path from `end` + `length` * `direction` to `end`.
  struct Path {
    Vector end{};
    Vector direction{};
    double length = 0.0;
    double speed = 0.0;
  };

  Falling(std::string name, const Walls& walls, std::vector<Path> paths, std::uint64_t seed)
      : BodyScene(std::move(name), walls, std::vector<Body>(paths.size()), seed),
        paths_(std::move(paths)) {
    for (std::size_t i = 0; i < paths_.size(); ++i) follow(i);
  }

  bool advance() override {
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      Path& path = paths_[i];
      if (path.length == 0.0 && path.speed == 0.0) continue;
      path.speed += kGravity;
      path.length -= path.speed;
      if (path.length <= 0.0) {
        path.length = 0.0;
        path.speed *= -kRestitution;
        if (path.speed > -2.0 * kGravity) path.speed = 0.0;
      }
      follow(i);
    }
    return true;
  }

 private:
  static constexpr double kGravity = 0.01;  // per frame squared
  static constexpr double kRestitution = 0.5;

  void follow(std::size_t i) noexcept {
    const Path& path = paths_[i];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bodies_[i].centre[axis] = path.end[axis] + path.length * path.direction[axis];
    }
    place(i);
  }

  std::vector<Path> paths_;
};

}  // namespace

std::unique_ptr<FrameSource> make_pile(std::size_t objects, std::uint64_t seed) {
  constexpr std::size_t kLayers = 4;
  const double area = static_cast<double>(objects) / kLayers;
  const auto across = static_cast<std::size_t>(std::ceil(std::sqrt(std::max(1.0, area))));
  const double side = static_cast<double>(across);
  Random random(seed);
  std::vector<Body> bodies(objects);
  std::vector<Vector> homes(objects);
  for (std::size_t i = 1; i < objects; ++i) {
    const std::size_t cell = (i - 1) / kLayers;
    homes[i] = {static_cast<double>(cell % across), static_cast<double>(cell / across),
                0.5 + static_cast<double>((i - 1) % kLayers)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bodies[i].centre[axis] = homes[i][axis] + random.in(-kJitter, kJitter);
    }
    bodies[i].velocity = draw_velocity(random, 1.0);
  }
  // The undersides of the lowest cubes are within the jitter of z = 0; the ground's top at kJitter
  // touches each of them.
  const auto edge = static_cast<float>(side + 1.0);
  const Aabb ground{{-1.0F, -1.0F, -1.0F}, {edge, edge, static_cast<float>(kJitter)}};
  const Walls walls{{-kJitter, -kJitter, 0.0}, {side, side, kLayers}};
  return std::make_unique<Pile>(walls, std::move(bodies), std::move(homes), ground, seed);
}

std::unique_ptr<FrameSource> make_free_fall(std::size_t objects, std::uint64_t seed) {
  const Walls walls = Walls::cube(cube_root(2.0 * static_cast<double>(objects)));
  Random random(seed);
  std::vector<Falling::Path> paths(objects);
  for (Falling::Path& path : paths) {
    const Vector start = draw_point(random, walls);
    // At rest the heap is a quarter as high as at the start, and four times as dense.
    path.end = {start[0], start[1], 0.25 * start[2]};
    path.direction = {0.0, 0.0, 1.0};
    path.length = 0.75 * start[2];
  }
  return std::make_unique<Falling>("free_fall", walls, std::move(paths), seed);
}

std::unique_ptr<FrameSource> make_gravity(std::size_t objects, std::uint64_t seed) {
  const double side = cube_root(2.0 * static_cast<double>(objects));
  const Walls walls = Walls::cube(side);
  constexpr double kShrink = 0.63;  // its cube is a quarter
  Random random(seed);
  std::vector<Falling::Path> paths(objects);
  for (Falling::Path& path : paths) {
    Vector out = draw_point(random, walls);
    for (double& o : out) o -= 0.5 * side;
    const double distance = std::sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      path.direction[axis] = distance > 0.0 ? out[axis] / distance : 0.0;
      path.end[axis] = 0.5 * side + kShrink * out[axis];
    }
    path.length = (1.0 - kShrink) * distance;
  }
  return std::make_unique<Falling>("gravity", walls, std::move(paths), seed);
}

}  // namespace winnow::bench
