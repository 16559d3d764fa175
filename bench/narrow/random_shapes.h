#pragma once

#include "scenes/random.h"

#include <winnow/core/pose.h>
#include <winnow/pipeline/shape_pool.h>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// A shape and the radius of the ball about its frame's origin that contains it.
struct DrawnShape {
  ShapeId id;
  double radius = 0.0;
};

/// Draws shapes of one kind into a pool, 0.5 to 2 across times `scale`. Hulls are drawn from
/// `hulls` different ones, which it makes when it is made.
class ShapeSource {
 public:
  ShapeSource(ShapePool& pool, ShapeKind kind, std::uint32_t hull_vertices, std::uint32_t hulls,
              double scale, Random& random);

  /// Throws std::runtime_error if the pool refuses.
  [[nodiscard]] DrawnShape draw();

 private:
  template <typename Shape>
  [[nodiscard]] DrawnShape put(const Shape& shape, double radius);
  [[nodiscard]] DrawnShape draw_hull(std::uint32_t vertices);
  [[nodiscard]] DrawnShape draw_triangle();
  [[nodiscard]] double length(double least, double most) {
    return scale_ * random_.in(least, most);
  }

  ShapePool& pool_;
  ShapeKind kind_;
  double scale_;
  Random& random_;
  std::vector<DrawnShape> hulls_;
};

/// Uniform on the unit sphere.
[[nodiscard]] Eigen::Vector3d random_unit(Random& random);
/// Uniform in the ball of the radius.
[[nodiscard]] Eigen::Vector3d random_in_ball(Random& random, double radius);
/// Uniform over all rotations.
void turn_at_random(Random& random, Pose& pose);

}  // namespace winnow::bench
