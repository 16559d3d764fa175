#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shape_pool.h>
#include "bench/common/random.h"
#include "bench/scenes/lens.h"

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <vector>

namespace winnow::bench {

/// A shape and the radius of the ball about its frame's origin that contains it. A half-space,
/// whose plane contains that origin, gets a radius like other shapes.
struct DrawnShape {
  ShapeId id;
  double radius = 0.0;
};

/// Distribution of shapes: 0.5 to 2 across, times `scale`.
struct ShapeStyle {
  ShapeKind kind{};
  std::uint32_t hull_vertices = 0;
  std::uint32_t hulls = 0;  ///< number of different hulls
  double scale = 1.0;
  double thinness = 1.0;  ///< of triangles: factor of their height, at most 1
  /// Hulls are prisms with a vertical axis, and each triangle has a vertical edge.
  bool upright = false;
  /// Storage of lenses, which are drawn as user shapes.
  std::deque<Lens>* lenses = nullptr;
};

/// Draws shapes of one kind into a pool. The constructor draws the hulls.
class ShapeSource {
 public:
  ShapeSource(ShapePool& pool, const ShapeStyle& style, Random& random);

  /// Throws std::runtime_error if the pool rejects the shape.
  [[nodiscard]] DrawnShape draw();

 private:
  template <typename Shape>
  [[nodiscard]] DrawnShape put(const Shape& shape, double radius);
  [[nodiscard]] DrawnShape draw_hull();
  [[nodiscard]] std::vector<Eigen::Vector3d> draw_corners();
  [[nodiscard]] DrawnShape draw_triangle();
  [[nodiscard]] DrawnShape draw_lens();
  [[nodiscard]] double length(double least, double most) {
    return style_.scale * random_.in(least, most);
  }

  ShapePool& pool_;
  ShapeStyle style_;
  Random& random_;
  std::vector<DrawnShape> hulls_;
};

/// Returns a uniform point on the unit sphere.
[[nodiscard]] Eigen::Vector3d random_unit(Random& random);
/// Returns a uniform point in a ball of this radius.
[[nodiscard]] Eigen::Vector3d random_in_ball(Random& random, double radius);
/// Sets a uniform random orientation.
void turn_at_random(Random& random, Pose& pose);
/// Sets a uniform random rotation about the vertical axis, z.
void turn_upright(Random& random, Pose& pose);
/// Sets `pose`'s orientation to `from`'s, rotated about a random axis by the angle whose half has
/// the tangent `angle` / 2.
void turn_from(Random& random, const Pose& from, double angle, Pose& pose);

}  // namespace winnow::bench
