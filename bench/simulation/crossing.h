#pragma once

#include <Eigen/Geometry>

namespace winnow::bench {

/// Returns whether the segment between two points crosses a triangle: its ends are on different
/// sides of the plane, and its line passes all edges on the same side.
[[nodiscard]] inline bool crosses(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                  const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                  const Eigen::Vector3d& c) {
  using Point = Eigen::Vector3d;
  const auto volume = [](const Point& p, const Point& q, const Point& r, const Point& s) {
    return (q - p).cross(r - p).dot(s - p);
  };
  if ((volume(a, b, c, from) > 0.0) == (volume(a, b, c, to) > 0.0)) return false;
  const bool side = volume(from, to, a, b) > 0.0;
  return side == (volume(from, to, b, c) > 0.0) && side == (volume(from, to, c, a) > 0.0);
}

}  // namespace winnow::bench
