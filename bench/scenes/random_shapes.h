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

/// A shape and the radius of the ball about its frame's origin that contains it; of a half-space,
/// whose plane passes through that origin, of one as large as other shapes.
struct DrawnShape {
  ShapeId id;
  double radius = 0.0;
};

/// Which shapes are drawn: 0.5 to 2 across times `scale`.
struct ShapeStyle {
  ShapeKind kind{};
  std::uint32_t hull_vertices = 0;
  std::uint32_t hulls = 0;  ///< different ones
  double scale = 1.0;
  double thinness = 1.0;  ///< of triangles: at most 1, of their height
  /// Hulls are prisms with a vertical axis, and an edge of triangles is vertical.
  bool upright = false;
  /// Where lenses are kept, which are drawn as sets of a program's own.
  std::deque<Lens>* lenses = nullptr;
};

/// Draws shapes of one kind into a pool. Hulls are made when it is made.
class ShapeSource {
 public:
  ShapeSource(ShapePool& pool, const ShapeStyle& style, Random& random);

  /// Throws std::runtime_error if the pool refuses.
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

/// Uniform on the unit sphere.
[[nodiscard]] Eigen::Vector3d random_unit(Random& random);
/// Uniform in the ball of the radius.
[[nodiscard]] Eigen::Vector3d random_in_ball(Random& random, double radius);
/// Uniform over all rotations.
void turn_at_random(Random& random, Pose& pose);
/// Uniform over all rotations about the vertical axis, which is z.
void turn_upright(Random& random, Pose& pose);
/// `pose` becomes `from` turned about a random axis by the angle whose half has the tangent
/// `angle` / 2.
void turn_from(Random& random, const Pose& from, double angle, Pose& pose);

}  // namespace winnow::bench
