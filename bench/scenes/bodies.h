#pragma once

#include <winnow/core/vec3.h>
#include "bench/common/random.h"
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace winnow::bench {

/// A moving cube.
struct Body {
  Vec3d centre;
  Vec3d velocity;     ///< per frame
  double half = 0.5;  ///< half an edge
};

/// Bounds of the bodies' centres; a body that reaches a wall is reflected.
struct Walls {
  Vec3d low;
  Vec3d high;

  [[nodiscard]] static Walls cube(double side) noexcept { return {{}, Vec3d::constant(side)}; }
};

/// Bodies between walls.
struct Bodies {
  Walls walls;
  std::vector<Body> all;
  Random random;                 ///< for values drawn in each frame
  std::optional<Aabb> ground{};  ///< replaces the box of the first body
  std::size_t present;           ///< number of bodies that are in the scene already

  Bodies(const Walls& between, std::vector<Body> bodies, std::uint64_t seed)
      : walls(between), all(std::move(bodies)), random(mix(seed)), present(all.size()) {}
};

/// Bodies, and the function that moves them by one frame.
struct MovingBodies {
  Bodies bodies;
  std::function<void(Bodies&)> move;
};

/// Draws a uniform velocity of at most 5 % of the edge along each axis.
[[nodiscard]] Vec3d draw_velocity(Random& random, double edge) noexcept;
/// Draws a uniform point between the walls.
[[nodiscard]] Vec3d draw_point(Random& random, const Walls& walls) noexcept;
/// Moves a body in a straight line for one frame, with reflections at the walls.
void drift(Body& body, const Walls& walls) noexcept;

/// The boxes of moving bodies; they move forever.
class BodyScene final : public FrameSource {
 public:
  BodyScene(std::string name, MovingBodies moving);

  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] Aabb world() const override { return world_; }
  [[nodiscard]] std::span<const Aabb> boxes() const override {
    return std::span(boxes_).first(moving_.bodies.present);
  }
  [[nodiscard]] std::size_t objects() const override { return boxes_.size(); }
  bool advance() override;

 private:
  void place() noexcept;

  std::string name_;
  MovingBodies moving_;
  std::vector<Aabb> boxes_;
  Aabb world_;
};

}  // namespace winnow::bench
