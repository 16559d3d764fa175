#include "bench/scenes/drifting.h"

#include "bench/common/exact_math.h"
#include "bench/scenes/bodies.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace winnow::bench {
namespace {

/// A scene in which every body moves in every frame.
class Drifting : public BodyScene {
 public:
  using BodyScene::BodyScene;

  bool advance() override {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      drift(bodies_[i], walls_);
      place(i);
    }
    return true;
  }
};

/// A scene in which a random twentieth of the bodies moves in each frame.
class Sleepy final : public BodyScene {
 public:
  Sleepy(std::string name, const Walls& walls, std::vector<Body> bodies, std::uint64_t seed)
      : BodyScene(std::move(name), walls, std::move(bodies), seed), order_(bodies_.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
  }

  bool advance() override {
    const auto count = static_cast<std::uint32_t>(order_.size());
    const std::uint32_t moving = std::max(1U, count / 20);
    for (std::uint32_t k = 0; k < moving; ++k) {
      std::swap(order_[k], order_[k + random_.below(count - k)]);
      drift(bodies_[order_[k]], walls_);
      place(order_[k]);
    }
    return true;
  }

 private:
  std::vector<std::uint32_t> order_;  // a permutation; the bodies at its front move
};

/// A scene in which every body takes a new random step in every frame.
class Brownian final : public BodyScene {
 public:
  using BodyScene::BodyScene;

  bool advance() override {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      bodies_[i].velocity = draw_velocity(random_, 2.0 * bodies_[i].half);
      drift(bodies_[i], walls_);
      place(i);
    }
    return true;
  }
};

std::unique_ptr<FrameSource> drifting_sizes(const char* name, const Sizes& sizes,
                                            std::size_t objects, std::uint64_t seed) {
  const Walls walls = walls_for(sizes, objects);
  return std::make_unique<Drifting>(name, walls, log_uniform_bodies(sizes, objects, seed, walls),
                                    seed);
}

}  // namespace

std::unique_ptr<FrameSource> make_uniform(std::size_t objects, std::uint64_t seed) {
  const Walls walls = uniform_walls(objects);
  return std::make_unique<Drifting>("uniform", walls, uniform_bodies(objects, seed, walls), seed);
}

std::unique_ptr<FrameSource> make_sleepy(std::size_t objects, std::uint64_t seed) {
  const Walls walls = uniform_walls(objects);
  return std::make_unique<Sleepy>("sleepy", walls, uniform_bodies(objects, seed, walls), seed);
}

std::unique_ptr<FrameSource> make_brownian(std::size_t objects, std::uint64_t seed) {
  const Walls walls = uniform_walls(objects);
  return std::make_unique<Brownian>("brownian", walls, uniform_bodies(objects, seed, walls), seed);
}

std::unique_ptr<FrameSource> make_mixed(std::size_t objects, std::uint64_t seed) {
  return drifting_sizes("mixed", kMixedSizes, objects, seed);
}

std::unique_ptr<FrameSource> make_mixed_1000(std::size_t objects, std::uint64_t seed) {
  return drifting_sizes("mixed_1000", {0.01, 1000.0, 8.0}, objects, seed);
}

std::unique_ptr<FrameSource> make_clustered(std::size_t objects, std::uint64_t seed) {
  constexpr std::size_t kClusterSize = 500;
  constexpr double kDeviation = 3.5;
  const Walls walls = Walls::cube(2.0 * cube_root(2.0 * static_cast<double>(objects)));
  Random random(seed);
  std::vector<Vector> centres(std::max<std::size_t>(1, objects / kClusterSize));
  for (Vector& centre : centres) centre = draw_point(random, walls);
  std::vector<Body> bodies(objects);
  for (Body& body : bodies) {
    const Vector& centre = centres[random.below(static_cast<std::uint32_t>(centres.size()))];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      body.centre[axis] = std::clamp(centre[axis] + kDeviation * random.normal(), walls.low[axis],
                                     walls.high[axis]);
    }
    body.velocity = draw_velocity(random, 1.0);
  }
  return std::make_unique<Drifting>("clustered", walls, std::move(bodies), seed);
}

std::unique_ptr<FrameSource> make_wall(std::size_t objects, std::uint64_t seed) {
  const double side = std::sqrt(2.0 * static_cast<double>(objects));
  const Walls walls{{-0.25, 0.0, 0.0}, {0.25, side, side}};
  return std::make_unique<Drifting>("wall", walls, uniform_bodies(objects, seed, walls), seed);
}

}  // namespace winnow::bench
