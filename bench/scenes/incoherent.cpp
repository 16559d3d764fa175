#include "bench/scenes/incoherent.h"

#include "bench/scenes/bodies.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace winnow::bench {
namespace {

/// In every frame every body gets a new place.
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

/// Every body flies on, but for a tenth of them, others in each frame, which get new places.
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
  std::vector<std::uint32_t> order_;  // in which they get new places
  std::size_t next_ = 0;
};

/// Bodies that flow along x, the faster the higher, and come in again on the other side.
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
  /// Edges per frame that bodies one edge apart on y move against each other: twice what the
  /// fastest of `uniform` do.
  static constexpr double kRate = 0.2;
};

/// Every body takes a step of one length in a new direction in every frame.
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
  /// In a direction that is uniform on the sphere: that of a point of the ball.
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

/// `Scene` of the bodies of `uniform`.
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
