#include "bench/scenes/incoherent.h"

#include "bench/scenes/bodies.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace winnow::bench {
namespace {

/// Every body gets a new random position in every frame.
class Teleporting final : public BodyScene {
 public:
  using BodyScene::BodyScene;

  bool advance() override {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      bodies_[i].centre = draw_point(random_, walls_);
      place(i);
    }
    return true;
  }
};

/// All bodies move in straight lines, except a tenth of them, a different one in each frame, which
/// get new positions.
class Respawning final : public BodyScene {
 public:
  Respawning(std::string name, const Walls& walls, std::vector<Body> bodies, std::uint64_t seed)
      : BodyScene(std::move(name), walls, std::move(bodies), seed), order_(bodies_.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    for (std::size_t i = order_.size(); i > 1; --i) {
      std::swap(order_[i - 1], order_[random_.below(static_cast<std::uint32_t>(i))]);
    }
  }

  bool advance() override {
    for (Body& body : bodies_) drift(body, walls_);
    const std::size_t reborn = std::max<std::size_t>(1, order_.size() / 10);
    for (std::size_t k = 0; k < reborn; ++k) {
      bodies_[order_[next_]].centre = draw_point(random_, walls_);
      next_ = (next_ + 1) % order_.size();
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) place(i);
    return true;
  }

 private:
  std::vector<std::uint32_t> order_;  // order in which bodies get new positions
  std::size_t next_ = 0;
};

/// Bodies flow along x at a speed that grows with y, and re-enter on the opposite side.
class Shearing final : public BodyScene {
 public:
  using BodyScene::BodyScene;

  bool advance() override {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const double width = walls_.high[0] - walls_.low[0];
      double& x = bodies_[i].centre[0];
      x += kRate * (bodies_[i].centre[1] - walls_.low[1]);
      while (x > walls_.high[0]) x -= width;
      place(i);
    }
    return true;
  }

 private:
  /// Relative speed, in edges per frame, of bodies one edge apart in y: twice the fastest of
  /// `uniform`.
  static constexpr double kRate = 0.2;
};

/// Every body takes a step of fixed length in a new random direction in every frame.
class Jumping final : public BodyScene {
 public:
  using BodyScene::BodyScene;

  bool advance() override {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      bodies_[i].velocity = draw_step(4.0 * bodies_[i].half);
      drift(bodies_[i], walls_);
      place(i);
    }
    return true;
  }

 private:
  /// Draws a step in a uniform direction by rejection sampling in the unit ball.
  [[nodiscard]] Vector draw_step(double length) noexcept {
    for (;;) {
      Vector step{};
      double square = 0.0;
      for (double& s : step) {
        s = random_.in(-1.0, 1.0);
        square += s * s;
      }
      if (square > 1.0 || square < 1e-6) continue;
      for (double& s : step) s *= length / std::sqrt(square);
      return step;
    }
  }
};

/// Returns a `Scene` with the bodies of `uniform`.
template <typename Scene>
std::unique_ptr<FrameSource> of_uniform(const char* name, std::size_t objects, std::uint64_t seed) {
  const Walls walls = uniform_walls(objects);
  return std::make_unique<Scene>(name, walls, uniform_bodies(objects, seed, walls), seed);
}

}  // namespace

std::unique_ptr<FrameSource> make_teleport(std::size_t objects, std::uint64_t seed) {
  return of_uniform<Teleporting>("teleport", objects, seed);
}

std::unique_ptr<FrameSource> make_teleport_mixed(std::size_t objects, std::uint64_t seed) {
  const Walls walls = walls_for(kMixedSizes, objects);
  return std::make_unique<Teleporting>("teleport_mixed", walls,
                                       log_uniform_bodies(kMixedSizes, objects, seed, walls), seed);
}

std::unique_ptr<FrameSource> make_respawn(std::size_t objects, std::uint64_t seed) {
  return of_uniform<Respawning>("respawn", objects, seed);
}

std::unique_ptr<FrameSource> make_shear(std::size_t objects, std::uint64_t seed) {
  return of_uniform<Shearing>("shear", objects, seed);
}

std::unique_ptr<FrameSource> make_jumps(std::size_t objects, std::uint64_t seed) {
  return of_uniform<Jumping>("jumps", objects, seed);
}

}  // namespace winnow::bench
