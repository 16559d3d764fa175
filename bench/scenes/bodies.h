#pragma once

#include "bench/common/random.h"
#include "bench/scenes/frame_source.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace winnow::bench {

using Vector = std::array<double, 3>;

/// A moving cube.
struct Body {
  Vector centre{};
  Vector velocity{};  ///< per frame
  double half = 0.5;  ///< half an edge
};

/// Bounds of the bodies' centres; a body that reaches a wall is reflected.
struct Walls {
  Vector low{};
  Vector high{};

  [[nodiscard]] static Walls cube(double side) noexcept {
    return {{0.0, 0.0, 0.0}, {side, side, side}};
  }
};

/// Draws a uniform velocity of at most 5 % of the edge along each axis.
[[nodiscard]] Vector draw_velocity(Random& random, double edge) noexcept;
/// Draws a uniform point between the walls.
[[nodiscard]] Vector draw_point(Random& random, const Walls& walls) noexcept;
/// Moves a body in a straight line for one frame, with reflections at the walls.
void drift(Body& body, const Walls& walls) noexcept;
[[nodiscard]] Aabb box_of(const Body& body) noexcept;

/// Returns walls around a cube whose volume is twice the volume of that many unit cubes.
[[nodiscard]] Walls uniform_walls(std::size_t objects) noexcept;
/// Returns unit cubes spread evenly between the walls, each with a velocity.
[[nodiscard]] std::vector<Body> uniform_bodies(std::size_t objects, std::uint64_t seed,
                                               const Walls& walls);

/// Distribution of cubes with log-uniform edges.
struct Sizes {
  double smallest;
  double ratio;   ///< largest edge / smallest edge
  double volume;  ///< volume of the world per object
};
// Two cubes with edges a and b overlap with probability (a + b)^3 / (volume of the world). There
// are thus ten pairs per object if the volume per object is a twentieth of the mean of (a + b)^3.
inline constexpr Sizes kMixedSizes{0.1, 100.0, 14.2};

[[nodiscard]] Walls walls_for(const Sizes& sizes, std::size_t objects) noexcept;
/// Returns cubes with these edges spread evenly between the walls, each with a velocity.
[[nodiscard]] std::vector<Body> log_uniform_bodies(const Sizes& sizes, std::size_t objects,
                                                   std::uint64_t seed, const Walls& walls);

/// A scene of bodies; derived classes move them in `advance`.
class BodyScene : public FrameSource {
 public:
  BodyScene(std::string name, const Walls& walls, std::vector<Body> bodies, std::uint64_t seed);

  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] Aabb world() const override { return world_; }
  [[nodiscard]] std::span<const Aabb> boxes() const override { return boxes_; }

 protected:
  /// Updates the body's box.
  void place(std::size_t i) noexcept { boxes_[i] = box_of(bodies_[i]); }

  std::string name_;
  Walls walls_;
  std::vector<Body> bodies_;
  std::vector<Aabb> boxes_;
  Aabb world_;
  Random random_;  ///< for values drawn in each frame
};

}  // namespace winnow::bench
