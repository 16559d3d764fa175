#pragma once

// Culling for one-sided triangles: objects behind a triangle do not collide with it.

#include <Eigen/Core>

namespace winnow {

/// Tolerance relative to the size of the box: a box whose centre is behind the plane by no more
/// than this does not count as behind it.
inline constexpr double kBehindSlack = 1e-6;

/// Returns whether the centre of the box lies behind the plane through `corner` with normal
/// `front`, which need not be a unit vector. False for unbounded boxes, which have no centre.
[[nodiscard]] inline bool is_behind(const Eigen::Vector3d& front, const Eigen::Vector3d& corner,
                                    const Eigen::Vector3d& min,
                                    const Eigen::Vector3d& max) noexcept {
  const double slack = kBehindSlack * (max - min).cwiseAbs().sum() * front.norm();
  return front.dot(0.5 * (min + max) - corner) < -slack;
}

}  // namespace winnow
