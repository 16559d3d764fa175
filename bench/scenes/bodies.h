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

/// A cube in motion.
struct Body {
  Vector centre{};
  Vector velocity{};  ///< a frame
  double half = 0.5;  ///< half an edge
};

/// Where centres may go; a body that reaches a wall is reflected.
struct Walls {
  Vector low{};
  Vector high{};

  [[nodiscard]] static Walls cube(double side) noexcept {
    return {{0.0, 0.0, 0.0}, {side, side, side}};
  }
};

/// A uniformly drawn velocity of at most 5 % of the edge along each axis.
[[nodiscard]] Vector draw_velocity(Random& random, double edge) noexcept;
/// A uniformly drawn point between the walls.
[[nodiscard]] Vector draw_point(Random& random, const Walls& walls) noexcept;
/// One frame of straight flight between the walls.
void drift(Body& body, const Walls& walls) noexcept;
[[nodiscard]] Aabb box_of(const Body& body) noexcept;

/// Of unit cubes with two of their volumes each.
[[nodiscard]] Walls uniform_walls(std::size_t objects) noexcept;
/// Unit cubes spread evenly between the walls, each with a velocity.
[[nodiscard]] std::vector<Body> uniform_bodies(std::size_t objects, std::uint64_t seed,
                                               const Walls& walls);

/// Of cubes with log-uniform edges.
struct Sizes {
  double smallest;
  double ratio;   ///< of the largest edge to the smallest
  double volume;  ///< of the world, per object
};
// Two cubes with edges a and b overlap with probability (a + b)^3 / volume: the volume per
// object that gives ten pairs per object is a twentieth of the mean of (a + b)^3.
inline constexpr Sizes kMixedSizes{0.1, 100.0, 14.2};

[[nodiscard]] Walls walls_for(const Sizes& sizes, std::size_t objects) noexcept;
/// Cubes of such edges spread evenly between the walls, each with a velocity.
[[nodiscard]] std::vector<Body> log_uniform_bodies(const Sizes& sizes, std::size_t objects,
                                                   std::uint64_t seed, const Walls& walls);

/// A scene made of bodies; what they do in a frame is up to the derived one.
class BodyScene : public FrameSource {
 public:
  BodyScene(std::string name, const Walls& walls, std::vector<Body> bodies, std::uint64_t seed);

  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] Aabb world() const override { return world_; }
  [[nodiscard]] std::span<const Aabb> boxes() const override { return boxes_; }

 protected:
  /// Copies the body's place into its box.
  void place(std::size_t i) noexcept { boxes_[i] = box_of(bodies_[i]); }

  std::string name_;
  Walls walls_;
  std::vector<Body> bodies_;
  std::vector<Aabb> boxes_;
  Aabb world_;
  Random random_;  ///< for what is drawn anew in each frame
};

}  // namespace winnow::bench
