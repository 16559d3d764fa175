#include "bench/scenes/nearly_still.h"

#include "bench/scenes/bodies.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace winnow::bench {
namespace {

/// Seven bodies (all, if there are fewer) move in every frame; the others never move.
class FewMovers final : public BodyScene {
 public:
  FewMovers(const Walls& walls, std::vector<Body> bodies, std::uint64_t seed)
      : BodyScene("few_movers", walls, std::move(bodies), seed) {
    const std::size_t mover_count = std::min<std::size_t>(7, bodies_.size());
    while (movers_.size() < mover_count) {
      const std::uint32_t one = random_.below(static_cast<std::uint32_t>(bodies_.size()));
      if (std::find(movers_.begin(), movers_.end(), one) == movers_.end()) movers_.push_back(one);
    }
  }

  bool advance() override {
    for (const std::uint32_t i : movers_) {
      drift(bodies_[i], walls_);
      place(i);
    }
    return true;
  }

 private:
  std::vector<std::uint32_t> movers_;
};

/// Bodies that jitter about fixed positions, except every hundredth, which does not move.
class Jittering final : public BodyScene {
 public:
  Jittering(const Walls& walls, std::vector<Body> bodies, std::uint64_t seed)
      : BodyScene("jitter", walls, std::move(bodies), seed) {
    for (const Body& body : bodies_) rest_positions_.push_back(body.centre);
  }

  bool advance() override {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (i % 100 == 99) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        bodies_[i].centre[axis] = rest_positions_[i][axis] + random_.in(-kJitter, kJitter);
      }
      place(i);
    }
    return true;
  }

 private:
  static constexpr double kJitter = 1e-5;  // in edges

  std::vector<Vector> rest_positions_;
};

}  // namespace

std::unique_ptr<FrameSource> make_few_movers(std::size_t objects, std::uint64_t seed) {
  const Walls walls = uniform_walls(objects);
  return std::make_unique<FewMovers>(walls, uniform_bodies(objects, seed, walls), seed);
}

// Positions are on a lattice whose step does not divide the edge. Along each axis two cubes
// therefore overlap or are separate by at least half a step, which is fifty times the jitter, so
// that no pair begins or ends.
std::unique_ptr<FrameSource> make_jitter(std::size_t objects, std::uint64_t seed) {
  constexpr double kStep = 2.0 / 2001.0;
  const Walls walls = uniform_walls(objects);
  std::vector<Body> bodies = uniform_bodies(objects, seed, walls);
  for (Body& body : bodies) {
    for (double& c : body.centre) c = kStep * std::floor(c / kStep);
  }
  Walls around = walls;  // with room for the jitter
  for (double& low : around.low) low -= kStep;
  return std::make_unique<Jittering>(around, std::move(bodies), seed);
}

}  // namespace winnow::bench
